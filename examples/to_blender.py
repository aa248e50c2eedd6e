"""A video to a file that Blender opens: a person who walks through the room."""

import edmlift

camera = (1145, 1145, 500, 500)  # fx, fy, cx, cy in pixels, as calibrated
up = (0, -0.989, -0.148)  # the camera looks down by 8.5 degrees

keypoints = edmlift.read_keypoints("examples/data/walk.csv")  # frames of a video, 30 a second
poses = edmlift.track(keypoints, fps=30, up=up)
placed = edmlift.place(poses, camera)  # without it the person walks on the spot
edmlift.write_motion("walk.glb", poses, fps=30, up=up, root=placed)
