"""Runs a program of the research tools by the name of its file.

    python tools/run.py                                    lists them
    python tools/run.py data.mocap FOLDER --out FILE.npz   tools/data/mocap.py
    python tools/run.py channels.browser.npm FOLDER
"""

import ast
import runpy
import sys
from pathlib import Path

TOOLS = Path(__file__).resolve().parent
# The others have tools of their own.
FOLDERS = ("data", "fitting", "reports", "experiments", "channels", "fuzzing", "mutation")


def programs() -> dict[str, str]:
    """First line of the docstring of each module that has a main(), by its name."""
    found = {}
    for path in sorted(p for folder in FOLDERS for p in (TOOLS / folder).rglob("*.py")):
        tree = ast.parse(path.read_text("utf-8"))
        if any(isinstance(node, ast.FunctionDef) and node.name == "main" for node in tree.body):
            about = (ast.get_docstring(tree) or "").partition("\n")[0]
            found[".".join(path.relative_to(TOOLS).with_suffix("").parts)] = about
    return found


def main() -> int:
    known = programs()
    if len(sys.argv) < 2 or sys.argv[1] not in known:
        width = max(map(len, known))
        lines = "\n".join(f"  {name:<{width}}  {about}" for name, about in known.items())
        print(f"usage: run.py PROGRAM ...\n\n{lines}", file=sys.stderr)
        return 1
    name = sys.argv.pop(1)
    sys.argv[0] = f"{name.rpartition('.')[2]}"
    runpy.run_module(name, run_name="__main__", alter_sys=False)
    return 0


if __name__ == "__main__":
    sys.exit(main())
