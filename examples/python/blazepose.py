"""BlazePose (MediaPipe): everybody in a picture; normalised by its size."""

import mediapipe as mp

import edmlift

image = mp.Image.create_from_file("dance.jpg")
blazepose = mp.tasks.vision.PoseLandmarker.create_from_model_path("pose_landmarker_full.task")
landmarks = blazepose.detect(image).pose_landmarks
people = [[(p.x, p.y, p.visibility) for p in person] for person in landmarks]
found = edmlift.Detections.of(people, "blazepose33")
poses = edmlift.lift(found.keypoints, format=found.format, image=(image.width, image.height))
print(poses)
