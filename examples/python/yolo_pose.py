"""YOLO-pose (Ultralytics): everybody in a video."""

from ultralytics import YOLO

import edmlift

results = YOLO("yolo11n-pose.pt").track("dance.mp4", stream=True)
found = edmlift.Detections.of([result.summary() for result in results], "coco17")
people = edmlift.track_people(found, fps=30)
for number in sorted(set(people.person)):
    print(number, people.of_person(number))
