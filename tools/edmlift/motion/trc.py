"""TRC, the text file of marker positions that OpenSim reads."""

from pathlib import Path

from edmlift.joints import JOINTS
from edmlift.motion.clip import Clip

_KEYS = (
    "DataRate CameraRate NumFrames NumMarkers Units OrigDataRate OrigDataStartFrame OrigNumFrames"
)


def write_trc(path: Path, clip: Clip) -> None:
    """Metres; frames are counted from 1.

    NaN where there is no pose: OpenSim also takes blanks for that, but not at the end of a line.
    """
    count, rate = len(clip.joints), f"{clip.rate:.10g}"
    names = "\t\t\t".join(JOINTS)
    axes = (f"{axis}{n}" for n in range(1, len(JOINTS) + 1) for axis in "XYZ")
    rows = clip.joints.reshape(count, -1)
    line = "%d\t%.5f" + "\t%.5f" * rows.shape[1] + "\n"
    nothing = "%d\t%.5f" + "\tNaN" * rows.shape[1] + "\n"
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(f"PathFileType\t4\t(X/Y/Z)\t{path.name}\n")
        file.write("\t".join(_KEYS.split()) + "\n")
        file.write(f"{rate}\t{rate}\t{count}\t{len(JOINTS)}\tm\t{rate}\t1\t{count}\n")
        file.write(f"Frame#\tTime\t{names}\t\t\n")
        file.write("\t\t" + "\t".join(axes) + "\n\n")
        frames = zip(clip.times.tolist(), clip.ok.tolist(), rows, strict=True)
        for number, (time, ok, row) in enumerate(frames, 1):
            file.write(line % (number, time, *row.tolist()) if ok else nothing % (number, time))
