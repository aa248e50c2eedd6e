"""14 joints of a picture in, a pose in metres out, on MicroPython (docs/packages.md)."""

import edmlift

# x and y in pixels, confidence; the detector did not see the left wrist
keypoints = [
    (512, 254, 1), (509, 336, 1),
    (461, 318, 1), (452, 387, 1), (489, 440, 1),
    (556, 317, 1), (571, 389, 1), None,
    (478, 466, 1), (470, 561, 1), (463, 655, 1),
    (537, 465, 1), (551, 556, 1), (590, 640, 1),
]  # fmt: skip

try:
    for x, y, z in edmlift.lift(keypoints):
        print("%6.3f %6.3f %6.3f" % (x, y, z))
except ValueError as error:
    print("no pose:", error)
