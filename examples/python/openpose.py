"""OpenPose: a folder of files, one a frame: openpose.bin --video dance.mp4 --write_json dance"""

import edmlift

found = edmlift.read_detections("dance", "body25")
people = edmlift.track_people(found, fps=30)
for number in sorted(set(people.person)):
    print(number, people.of_person(number))
