"""The evaluations by name: what `python tools/evaluate.py` can measure."""

from evaluation import (
    accuracy,
    adapters,
    angles,
    body,
    camera,
    command,
    detections,
    eigenpairs,
    h36m,
    mirror,
    motion_files,
    off_axis,
    reproject,
    room,
    scaling,
    video,
)

EVALUATIONS = {
    "accuracy": accuracy.EVALUATION,
    "adapters": adapters.EVALUATION,
    "angles": angles.EVALUATION,
    "body": body.EVALUATION,
    "camera": camera.EVALUATION,
    "detections": detections.EVALUATION,
    "eigenpairs": eigenpairs.EVALUATION,
    "h36m": h36m.EVALUATION,
    "mirror": mirror.EVALUATION,
    "motion_files": motion_files.EVALUATION,
    "off_axis": off_axis.EVALUATION,
    "reproject": reproject.EVALUATION,
    "room": room.EVALUATION,
    "scaling": scaling.EVALUATION,
    "video": video.EVALUATION,
}


def main(arguments: list[str] | None = None) -> int:
    """Exit status 0, or 1 with one line on stderr."""
    return command.run(EVALUATIONS, arguments)
