"""Would the C tests see a small fault in lib/?  Makes faults and runs the tests on them.

    mutate                        a sample of lib/, and denser ones of some parts (docs/mutation.md)
    mutate --file lib/lift/mds.h  all mutants of a file, or of the files that begin so
    mutate --again                those that lived in the last run, with new tests and sanitizers
    mutate --update               writes the tables of docs/mutation.md
    mutate --list                 prints mutants, and runs none

The mutants are compiled at once into one build of the tests, build/mutation, and chosen at run
time.
A mutant is killed if any of the tests that reach it fails, crashes, or takes five times as long.
"""

import argparse
import json
import os
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

from tqdm import tqdm

from data.paths import DOCS
from mutation import build
from mutation.results import PARTS, Results, argued, line_of, same_code, tables
from mutation.runs import Suite
from reports import markdown
from reports.targets import ToolError

PAGE = DOCS / "mutation.md"
RESULTS = build.WORK / "results.json"


class Choice(NamedTuple):
    """Mutants to look at."""

    mutants: build.Numbered
    sampled: frozenset[int]  # of them, the sample of all lib/
    killers: dict[int, str]  # of those that need not be run


def names_of(mutants: build.Numbered) -> dict[int, tuple[str, ...]]:
    """Names that stay while the text around a mutant changes: its place, and how manieth it is."""
    count: Counter[tuple[str, ...]] = Counter()
    names: dict[int, tuple[str, ...]] = {}
    for number, (file, mutant) in mutants.items():
        name = (file, mutant.function, mutant.operator, mutant.change)
        names[number] = (*name, str(count[name]))
        count[name] += 1
    return names


def choose_again(everything: build.Numbered) -> Choice:
    """Those of the last run.  Tests that came after it kill no less than it did."""
    entries = {tuple(e["name"]): e for e in json.loads(RESULTS.read_text("utf-8"))}
    known = {n: entries[name] for n, name in names_of(everything).items() if name in entries}
    return Choice({n: everything[n] for n in known},
                  frozenset(n for n, e in known.items() if e["sampled"]),
                  {n: e["killer"] for n, e in known.items() if e["killer"]})  # fmt: skip


def choose(args: argparse.Namespace, everything: build.Numbered) -> Choice:
    """By the command line, of those that this machine compiles."""
    build.make_tree()
    if args.again:
        return choose_again(everything)
    build.write_texts(everything)
    compiled = build.compiled_numbers()
    mutants = {n: found for n, found in everything.items() if n in compiled}
    if args.file:
        chosen = {n: m for n, m in mutants.items() if m[0].startswith(tuple(args.file))}
        if not chosen:
            raise ToolError(f"no mutants in {', '.join(args.file)}: name it as in lib/lift/mds.h")
        return Choice(build.sample(chosen, args.sample or len(chosen), args.seed), frozenset(), {})
    sampled = build.sample(mutants, args.sample or 800, args.seed)
    chosen = dict(sampled)
    for start in PARTS.values():
        part = {n: m for n, m in mutants.items() if m[0].startswith(start)}
        chosen |= build.sample(part, args.dense, args.seed)
    return Choice(dict(sorted(chosen.items())), frozenset(sampled), {})


def run_all(suite: Suite, numbers: list[int], results: Results, jobs: int) -> None:
    """Adds the tests that kill these mutants; writes the results now and then."""
    places = {n: f"{file}: {mutant.function}" for n, (file, mutant) in results.mutants.items()}
    with ThreadPoolExecutor(jobs) as pool:
        found = pool.map(suite.killer, numbers, map(places.__getitem__, numbers))
        progress = tqdm(found, total=len(numbers), unit="mutant", desc="Running the tests")
        for count, (number, killer) in enumerate(zip(numbers, progress, strict=True), 1):
            if killer:
                results.killers[number] = killer
            if count % 50 == 0 or count == len(numbers):
                write_json(results)


def run_living(results: Results, kind: str, jobs: int) -> None:
    """Runs those that no test kills yet in a build of a kind of build.FLAGS."""
    living = [n for n in results.mutants if n not in results.killers]
    if not living:
        return
    build.write_texts({n: results.mutants[n] for n in living})
    print(f"{len(living)} mutants; building the tests: {kind}", file=sys.stderr)
    suite = Suite(build.build_tests(kind, max(living)), build.BUDGET[kind])
    run_all(suite, living, results, jobs)


def mutate(args: argparse.Namespace) -> Results:
    everything = build.all_mutants()
    reasons = argued(everything)
    choice, alone = choose(args, everything), build.Alone()
    left = {n: m for n, m in choice.mutants.items() if n not in choice.killers}
    compiled = build.write_what_compiles(left, alone)
    mutants = {n: m for n, m in choice.mutants.items() if n in choice.killers or n in compiled}
    results = Results(mutants, choice.sampled & mutants.keys(), choice.killers, {})
    for kind in ["sanitized"] if args.again else build.FLAGS:
        run_living(results, kind, args.jobs)
    results.equivalent.update((n, reasons[n]) for n in results.living() if n in reasons)
    for number in tqdm(results.living(), unit="mutant", desc="Comparing object code"):
        if same_code(*mutants[number], alone):
            results.equivalent[number] = "the compiler makes the same code of it"
    write_json(results)
    return results


def write_json(results: Results) -> None:
    """What became of each mutant, for whoever reads them one by one, and for --again."""
    sources, names = build.texts(), names_of(build.all_mutants())
    entries = [
        {"number": n, "file": file, "line": m.line, "function": m.function,
         "text": line_of(file, m, sources), "operator": m.operator, "change": m.change,
         "killer": results.killers.get(n), "equivalent": results.equivalent.get(n),
         "sampled": n in results.sampled, "name": names[n]}
        for n, (file, m) in results.mutants.items()
    ]  # fmt: skip
    RESULTS.write_text(json.dumps(entries, indent=1) + "\n", "utf-8")


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="mutate", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--file", action="append", help="of these files alone; may be repeated")
    parser.add_argument("--sample", type=int, help="so many, of lib/ (800) or of the files")
    parser.add_argument("--dense", type=int, default=200, help="so many of each part (200)")
    parser.add_argument("--seed", type=int, default=1, help="of the samples (1)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="at a time")
    parser.add_argument("--again", action="store_true", help="the mutants of the last run")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--update", action="store_true", help="write the tables of docs/mutation.md")
    what.add_argument("--list", action="store_true", help="print the mutants, and run none")
    args = parser.parse_args()
    if args.update and args.file:
        parser.error("--update is of the samples, not of some files")
    return args


def main() -> int:
    args = parse()
    try:
        if args.list:
            for number, (file, mutant) in choose(args, build.all_mutants()).mutants.items():
                print(f"{number} {file}:{mutant.line} {mutant.operator}: {mutant.change}")
            return 0
        results = mutate(args)
        written = tables(results)
        if args.file:
            del written["mutation_scores"]
        print("\n".join(written.values()))
        if args.update:
            for name, text in written.items():
                markdown.write(PAGE, name, text)
    except (ToolError, OSError, ValueError) as error:
        print(f"mutate: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
