"""The one-file release: edmlift.h and edmlift.c for each model, and for several, in a zip file."""

import re
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

from channels.amalgamation.amalgamate import amalgamate, known_models
from channels.archives import write_zip
from channels.version import version
from data.paths import DOCS, ROOT
from reports.targets import ToolError, run

SEVERAL = "direct_and_distances"
CONSUMER = ROOT / "tests" / "install" / "consumer.c"
SAYS = "ok left_ankle\n"


def choices() -> dict[str, list[str]]:
    """The folders of the archive, and the models of each.  The paper's networks, which are there to
    compare, are left to tools/amalgamate."""
    models = [model for model in known_models() if model.startswith(("direct", "distances"))]
    return {model: [model] for model in models} | {SEVERAL: models}


def readme() -> bytes:
    """docs/one-file.md without its links, which lead to pages that the archive does not have."""
    page = (DOCS / "one-file.md").read_text("utf-8")
    return re.sub(r"\[([^]]+)\]\([^)]+\)", r"\1", page).encode()


def build(out: Path) -> list[Path]:
    """Writes edmlift-VERSION-one-file.zip into a folder: a folder a choice, with all
    parts; the page, and the program that it compiles."""
    top = f"edmlift-{version()}-one-file"
    files: dict[str, bytes | Path] = {
        f"{top}/README.md": readme(),
        f"{top}/lift.c": ROOT / "examples" / "lift.c",
    }
    with tempfile.TemporaryDirectory() as name:
        for choice, models in choices().items():
            amalgamate(models, ["all"], Path(name) / choice)
            for file in sorted((Path(name) / choice).iterdir()):
                files[f"{top}/{choice}/{file.name}"] = file
        return [write_zip(out / f"{top}.zip", files)]


def check(artefacts: Sequence[Path]) -> None:
    """Compiles what is in the archive, and lifts a pose by each model; raises ToolError."""
    (archive,) = artefacts
    with tempfile.TemporaryDirectory() as name, zipfile.ZipFile(archive) as files:
        files.extractall(name)
        (top,) = Path(name).iterdir()
        for choice, models in choices().items():
            item = top / "edmlift.o"
            run("cc", "-O1", "-Wall", "-Wextra", "-c", top / choice / "edmlift.c", "-o", item)
            for model in models:
                named = f"-Dedml_distances_f32=edml_{model}"  # what the program lifts by
                program = top / "consumer"
                run("cc", named, f"-I{top / choice}", CONSUMER, item, "-lm", "-o", program)
                if (said := run(program)) != SAYS:
                    raise ToolError(f"{choice}, {model}: a lift says {said!r}")
