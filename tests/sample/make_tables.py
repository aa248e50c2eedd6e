"""Writes tests/sample/tables.md: what tools/make_tables measures of motion, of the sample motion.

    python tests/sample/make_tables.py

The commands are read from tools/make_tables, so that a new one is among them; pages and manifests
are copies.  tests/python/reports/test_sample.py compares.
"""

import importlib.util
import re
import shlex
import shutil
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / folder) for folder in ("tools", "tests/python", "tests/sample")]

import motion  # noqa: E402
from support import run_tool  # noqa: E402

from reports import markdown  # noqa: E402

PAGE = ROOT / "tests" / "sample" / "tables.md"
# The sets of people that stand for the variables of tools/make_tables.
MOTION = {
    "$test": "cmu14_test.npz",
    "$others": "labs14_test.npz",
    "$train": "cmu14_train.npz",
    "$others_train": "labs14_train.npz",
    "$5": "labs14_test.npz",
}
HEAD = """\
# The tables of tools/make_tables, of the sample motion

Do not edit: `python tests/sample/make_tables.py` writes them. They say nothing of the library,
because the people are few and not its own; they show that what measures it still does.
"""


def commands() -> list[list[str]]:
    """The words of the commands of tools/make_tables that measure motion."""
    text = (ROOT / "tools" / "make_tables").read_text("utf-8").replace("\\\n", " ")
    found = [shlex.split(line, comments=True) for line in re.findall(r"python (tools/.*)", text)]
    return [words for words in found if MOTION.keys() & set(words)]


def written(text: str) -> list[str]:
    """The names of the tables of a page."""
    return re.findall(r"<!-- begin (\w+) -->", text)


def tables(words: list[str], people: Path, folder: Path) -> dict[str, str]:
    """What a command writes into pages, by the names of the marks; ValueError with what it says if
    it fails.

    people: a folder with the sample motion; folder: an empty one, for copies of docs/ and gen/.
    """
    pages = [folder / word for word in words if re.fullmatch(r"docs/.*\.md", word)]
    (folder / "docs").mkdir()
    for page in pages:
        text = (ROOT / page.relative_to(folder)).read_text("utf-8")
        page.write_text(re.sub(r"(?s)(<!-- begin .*? -->\n).*?(?=<!-- end )", r"\1", text), "utf-8")
    if "gen" in words:
        shutil.copytree(ROOT / "gen", folder / "gen", ignore=shutil.ignore_patterns("*.h", "*.npz"))
    program, *options = (_word(word, people, folder) for word in words if word != "tools/run.py")
    done = run_tool(program.removeprefix("tools/"), *options)
    if done.returncode != 0:
        raise ValueError(f"{shlex.join(words)}: {done.stdout}{done.stderr}")
    found = {
        name: markdown.read(page, name)
        for page in pages
        for name in written(page.read_text("utf-8"))
    }
    return {name: text for name, text in found.items() if text}


def lacks(words: list[str]) -> str | None:
    """What a command needs that is not installed."""
    if "scaling" in words and importlib.util.find_spec("cvxpy") is None:
        return "no cvxpy: pip install -r tools/requirements-sdp.txt"
    return None


def _word(word: str, people: Path, folder: Path) -> str:
    if word in MOTION:
        return str(people / MOTION[word])
    return str(folder / word) if word == "gen" or word.startswith("docs/") else word


def main() -> None:
    found: dict[str, str] = {}
    with tempfile.TemporaryDirectory() as name:
        motion.write(people := Path(name))
        for number, words in enumerate(commands()):
            if problem := lacks(words):
                sys.exit(f"{shlex.join(words)}: {problem}")
            print(*words, file=sys.stderr)
            (folder := people / str(number)).mkdir()
            found |= tables(words, people, folder)
    texts = [f"<!-- begin {name} -->\n{text}<!-- end {name} -->\n" for name, text in found.items()]
    PAGE.write_text("\n".join([HEAD, *texts]), "utf-8")


if __name__ == "__main__":
    main()
