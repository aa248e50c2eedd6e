"""Fuzzes targets of tests/fuzz, and says what came of it.

    tools/fuzz                            every target, a minute in all
    tools/fuzz place place_q --minutes 10 --jobs 2
    tools/fuzz --minutes 240 --update     hours, and the figures into docs/fuzzing.md
    tools/fuzz adapt stand --guided 0     pseudo-random inputs alone
    tools/fuzz --list

A target of the library runs guided by coverage, with libFuzzer and sanitizers, for a quarter of
its time (--guided 0.25), and on pseudo-random inputs for the rest; a reader in Python with Atheris.
What was found lies in build/fuzz/findings, the corpora in build/fuzz/corpus; both are kept from run
to run, and figures add up as long as the sources stay as they are.  The exit status is 1 if
anything was found.
"""

import argparse
import shlex
import sys
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed

from data.paths import DOCS
from fuzzing.runs import GUIDED_SHARE, Figures, Lines, coverage_of, fuzz, logged, take_mended
from fuzzing.targets import Target, all_targets, shown, watched_one_in
from reports import markdown

PAGE = DOCS / "fuzzing.md"


def chosen(names: Sequence[str]) -> list[Target]:
    """The targets of these names, or all; ValueError if one is none's."""
    known = {target.name: target for target in all_targets()}
    if unknown := set(names) - set(known):
        raise ValueError(f"no target {', '.join(sorted(unknown))}: tools/fuzz --list names them")
    return [known[name] for name in names] if names else list(known.values())


def run_all(targets: Sequence[Target], minutes: float, jobs: int, guided_share: float) -> int:
    """Runs targets, several at a time; returns how many findings there are."""
    seconds = max(2.0, 60 * minutes * jobs / len(targets))
    found = 0
    with ThreadPoolExecutor(jobs) as pool:
        running = {pool.submit(fuzz, target, seconds, guided_share): target for target in targets}
        for done in as_completed(running):
            target, figures = running[done], done.result()
            print(line_of(target, figures), flush=True)
            found += figures.findings
    return found


def line_of(target: Target, figures: Figures) -> str:
    executions = figures.guided + figures.fast
    what = f"{figures.findings} findings" if figures.findings else "nothing found"
    return f"{target.name:<22}{executions:>14,} executions{figures.edges:>7,} edges  {what}"


def say_findings(targets: Iterable[Target]) -> None:
    """A line that runs each again."""
    for target in targets:
        for path in sorted(target.findings.iterdir()) if target.findings.exists() else ():
            print(f"{target.name}: {shlex.join([*target.guided, shown(path)])}")


# ---- The table -----------------------------------------------------------------------------------


def table_of(targets: Sequence[Target], with_lines: bool) -> str:
    """Executions, coverage and findings by target, of the sources as they are."""
    rows: dict[str, list[markdown.Figure]] = {}
    ran, known = Lines(), Lines()
    for target in targets:
        figures = logged(target)
        lines: markdown.Figure = None
        if target.measured and with_lines:
            now, there_are = coverage_of(target)
            lines = len(now)
            if target.measured == "lib":
                ran |= now
                known |= there_are
        rows[f"`{target.name}`"] = [
            figures.guided, figures.fast or None, watched(target, figures) or None, figures.edges,
            lines, figures.findings,
        ]  # fmt: skip
    sums = [sum(row[n] or 0 for row in rows.values()) for n in (0, 1, 2, 5)]
    rows["all"] = [*sums[:3], None, None, sums[3]]
    columns = ["guided", "fast", "watched", "edges", "lines", "findings"]
    text = markdown.table("target", columns, rows, markdown.counted)
    return f"{text}\n{covered(ran, known)}" if known else text


def watched(target: Target, figures: Figures) -> int:
    """Inputs that integers which watch themselves computed as well."""
    return figures.guided + figures.fast // watched_one_in() if target.name.endswith("_q") else 0


def covered(ran: Lines, known: Lines) -> str:
    """A sentence on all of the library."""
    return (
        f"Together the targets of the library run {len(ran):,} of the {len(known):,} lines of "
        f"`lib/`, {100 * len(ran) / len(known):.1f} %.\n"
    )


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="tools/fuzz", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("targets", nargs="*", metavar="TARGET", help="default: all")
    parser.add_argument("--minutes", type=float, default=1, metavar="N", help="in all (default: 1)")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="at a time (default: 1)")
    parser.add_argument(
        "--guided", type=float, default=GUIDED_SHARE, metavar="SHARE", help="of the time (0.25)"
    )
    parser.add_argument("--list", action="store_true", help="name the targets, and run none")
    parser.add_argument(
        "--update", action="store_true", help=f"write {shown(PAGE)}, of all targets"
    )
    options = parser.parse_args(arguments)
    try:
        targets = chosen(options.targets)
    except ValueError as error:
        parser.error(str(error))
    if options.list:
        print(*(target.name for target in targets), sep="\n")
        return 0
    if not options.minutes >= 0 or options.jobs < 1 or not 0 <= options.guided <= 1:
        parser.error("--minutes must be 0 or more, --jobs 1 or more, --guided 0 to 1")
    found = 0
    if options.minutes:
        found = run_all(targets, options.minutes, options.jobs, options.guided)
    for target in targets:
        take_mended(target)
    say_findings(targets)
    text = table_of(all_targets() if options.update else targets, options.update)
    print(f"\n{text}")
    if options.update:
        markdown.write(PAGE, "fuzzing", text)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
