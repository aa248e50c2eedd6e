"""MoveNet (TensorFlow): one person in a picture; y, x, score in shares of a padded square."""

import tensorflow as tf
import tensorflow_hub as hub

import edmlift

movenet = hub.load("https://tfhub.dev/google/movenet/singlepose/thunder/4")
image = tf.io.decode_jpeg(tf.io.read_file("dance.jpg"))
square = tf.cast(tf.image.resize_with_pad(image[None], 256, 256), tf.int32)
keypoints = movenet.signatures["serving_default"](square)["output_0"].numpy()[0]  # [1,17,3]
size = image.shape[1], image.shape[0]
poses = edmlift.lift(keypoints, format="movenet17", image=size)
print(poses)
