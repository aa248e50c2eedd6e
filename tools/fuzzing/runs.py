"""Runs of a target: guided by coverage, fast, and to measure its coverage."""

import hashlib
import json
import re
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from data.paths import ROOT
from fuzzing.targets import OUT, Target, shown, sources_of

LOG = OUT / "log.jsonl"
SEEDS = 32  # pseudo-random inputs that a corpus begins with
GUIDED_SHARE = 0.25  # of a target's time, unless another is asked for
COVERAGE_SECONDS = 1  # of pseudo-random inputs, besides the corpus
SLOWEST = 30  # seconds that an input may take
MEMORY = 1024  # MiB that an input may take; of a reader, Python and its packages included
READERS_MEMORY = 2048

Lines = set[tuple[str, int]]  # file, line


@dataclass
class Figures:
    """What runs of a target add up to.  Findings are those that are left."""

    target: str
    sources: str  # hash of what was fuzzed
    guided: int = 0  # executions
    fast: int = 0
    edges: int = 0
    findings: int = 0


def hash_of(paths: Sequence[Path]) -> str:
    """Of what is compiled: comments of C do not count."""
    texts = (path.read_text("utf-8") for path in paths)
    code = "".join(re.sub(r"(/\*.*?\*/|\s)+", " ", text, flags=re.S) for text in texts)
    return hashlib.sha256(code.encode()).hexdigest()[:12]


def logged(target: Target) -> Figures:
    """The sum of the runs of these sources, and the findings that are left."""
    total = Figures(target.name, hash_of(sources_of(target)))
    for line in LOG.read_text("utf-8").splitlines() if LOG.exists() else ():
        run = Figures(**json.loads(line))
        if (run.target, run.sources) == (total.target, total.sources):
            total.guided += run.guided
            total.fast += run.fast
            total.edges = max(total.edges, run.edges)
    total.findings = len(list(target.findings.glob("*")))
    return total


def fuzz(target: Target, seconds: float, guided_share: float = GUIDED_SHARE) -> Figures:
    """Runs a target for about so long, and notes it."""
    figures = Figures(target.name, hash_of(sources_of(target)))
    for folder in (target.corpus, target.findings, work_of(target)):
        folder.mkdir(parents=True, exist_ok=True)
    take_mended(target)
    before = set(target.findings.iterdir())
    if target.program == "readers":
        run_guided(target, seconds, figures)
    else:
        save_seeds(target)
        if guided_share > 0:
            run_guided(target, guided_share * seconds, figures)
        if guided_share < 1:
            run_fast(target, (1 - guided_share) * seconds, figures)
    figures.findings = len(set(target.findings.iterdir()) - before)
    with LOG.open("a", encoding="utf-8") as file:
        file.write(json.dumps(asdict(figures)) + "\n")
    return figures


def take_mended(target: Target) -> None:
    """Moves findings that are none any more into the corpus."""
    for path in sorted(target.findings.iterdir()) if target.findings.exists() else ():
        command = [*target.guided, *target.options, f"-timeout={SLOWEST}", shown(path)]
        if run_logged(command, ROOT, target, "again")[0] == 0:
            path.rename(target.corpus / path.name)


def work_of(target: Target) -> Path:
    """Where a target's programs run."""
    return OUT / "work" / target.name


def save_seeds(target: Target) -> None:
    if not any(target.corpus.iterdir()):
        options = [f"-runs={SEEDS}", f"-save={target.corpus}"]
        run_logged([*target.unguided("fast"), *options], work_of(target), target, "seeds")


def run_guided(target: Target, seconds: float, figures: Figures) -> None:
    """libFuzzer, or Atheris, which has its options."""
    memory = READERS_MEMORY if target.program == "readers" else MEMORY
    command = [
        *target.guided, *target.options, f"-max_total_time={max(1, round(seconds))}",
        f"-timeout={SLOWEST}", f"-rss_limit_mb={memory}", "-print_final_stats=1",
        f"-artifact_prefix={shown(target.findings)}/", shown(target.corpus), *target.seeds,
    ]  # fmt: skip
    text = run_logged(command, ROOT, target, "guided")[1]
    executed = re.findall(r"stat::number_of_executed_units: (\d+)|^Done (\d+) runs", text, re.M)
    executed = executed or re.findall(r"^#(\d+)()\t", text, re.M)
    figures.guided = int("".join(executed[-1])) if executed else 0
    figures.edges = max(map(int, re.findall(r"\bcov: (\d+)", text)), default=0)


def run_fast(target: Target, seconds: float, figures: Figures) -> None:
    """Pseudo-random inputs, from where the last run ended."""
    folder, first = work_of(target), logged(target).fast
    options = [f"-seconds={max(1, round(seconds))}", f"-seed={first}"]
    status, text = run_logged([*target.unguided("fast"), *options], folder, target, "fast")
    executed = re.findall(r": (\d+) inputs$", text, re.M)
    figures.fast = int(executed[-1]) if executed else 0
    if status != 0:
        last = folder / f"fuzz_{target.name}.input"
        name = hashlib.sha256(last.read_bytes()).hexdigest()[:16]
        shutil.copy(last, target.findings / f"fast-{name}")


def run_logged(command: Sequence[str], folder: Path, target: Target, kind: str) -> tuple[int, str]:
    """Exit status and output of a command, which a file gets as well."""
    log = work_of(target) / f"{kind}.log"
    with log.open("wb") as file:
        status = subprocess.run(
            command, cwd=folder, stdout=file, stderr=subprocess.STDOUT
        ).returncode
    return status, log.read_text("utf-8", errors="replace")


# ---- Coverage ------------------------------------------------------------------------------------


def coverage_of(target: Target) -> tuple[Lines, Lines]:
    """Lines that the corpus and some pseudo-random inputs run, and all lines there are."""
    raw, merged = work_of(target) / "raw.profile", work_of(target) / "merged.profile"
    program = target.unguided("coverage")
    inputs = [str(target.corpus), *target.seeds, f"-seconds={COVERAGE_SECONDS}"]
    environment = {"LLVM_PROFILE_FILE": str(raw)}
    subprocess.run(
        [*program, *inputs], cwd=ROOT, env=environment, stdout=subprocess.DEVNULL, check=True
    )
    subprocess.run(["llvm-profdata", "merge", "-sparse", raw, "-o", merged], check=True)
    command = ["llvm-cov", "export", "-format=lcov", f"-instr-profile={merged}", program[0]]
    return read_lcov(
        subprocess.run(command, capture_output=True, text=True, check=True).stdout, target
    )


def read_lcov(text: str, target: Target) -> tuple[Lines, Lines]:
    """Lines of the target's folder that ran, and all, of a report of lcov."""
    ran, known, file = Lines(), Lines(), ""
    folder = f"{ROOT / target.measured}/"
    for line in text.splitlines():
        if line.startswith("SF:"):
            file = line[3:]
        elif line.startswith("DA:") and file.startswith(folder):
            number, count = line[3:].split(",")[:2]
            known.add((file, int(number)))
            if int(count) > 0:
                ran.add((file, int(number)))
    return ran, known
