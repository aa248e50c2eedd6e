"""RTMPose (mmpose): everybody in a video."""

from mmpose.apis import MMPoseInferencer

import edmlift

rtmpose = MMPoseInferencer("human")
found = edmlift.Detections.of(list(rtmpose("dance.mp4")), "coco17")
people = edmlift.track_people(found, fps=30)
for number in sorted(set(people.person)):
    print(number, people.of_person(number))
