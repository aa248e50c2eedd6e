"""Whether all processors compute the same bits: a table of targets, each built and run.

    run.py reports.bits                  prints the table: ten minutes
    run.py reports.bits --only s390x     tries this target, or several
    run.py reports.bits --update         writes the table to docs/targets.md

tests/targets/bits.c and the library are built for each, and must print what tests/bits.txt has.
The microcontrollers are those of CMakePresets.json in QEMU; other processors run a Linux program in
QEMU's user mode, PCs' on this machine, and WebAssembly runs in Node.js.  A target whose bits differ
is an error, and so is one whose arithmetic is not IEEE 754's single precision and that compiles.
"""

import argparse
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

from data.paths import DOCS, ROOT
from reports import markdown
from reports.command import Disagreement
from reports.targets import (
    INCLUDES,
    SMALL_SOURCES,
    TARGETS,
    ToolError,
    build,
    compile_each,
    compile_library,
    emulate,
    library_flags,
    run,
)
from reports.wasm import COMPILE, EXPORTED, LINK

PAGE = DOCS / "targets.md"
TARGETS_FOLDER = ROOT / "tests" / "targets"
PROGRAM = TARGETS_FOLDER / "bits.c"
EXPECTED = ROOT / "tests" / "bits.txt"  # of gcc -O0 on x86-64; by tools/make_tables
LEVEL = "-O2"
PARTS = [f"-DPARTS={1 << n}" for n in range(5)]  # as a microcontroller's flash holds them
REFUSAL = "edmlift computes in float, not in a wider format"


@dataclass(frozen=True)
class Row:
    """A target: how it computes, how it is compiled, and where it runs."""

    target: str
    arithmetic: str
    compiler: str
    flags: str
    emulator: str  # "": this machine
    packages: str  # Debian's
    output: Callable[["Row", Path], str]  # builds it in a folder, and returns what it prints
    libc: str = "libc.a"  # a file of its C library
    same: bool = True  # or refused by the compiler


# ---- How they are built and run ----------------------------------------------------------------


def run_linux(row: Row, folder: Path) -> str:
    """Of a Linux program, linked statically so that it needs nothing of its system."""
    program = folder / "bits"
    command = [*row.compiler.split(), *library_flags(), LEVEL, *row.flags.split(), *INCLUDES]
    objects = compile_each(command, folder, SMALL_SOURCES)
    run(*command, "-static", PROGRAM, *objects, "-lm", "-o", program)
    return run(*filter(None, [row.emulator]), program)


def run_wasm(row: Row, folder: Path) -> str:
    """Of WebAssembly, compiled as for the npm package."""
    program = folder / "bits.wasm"
    command = [*COMPILE, *row.flags.split(), *EXPORTED, *INCLUDES]
    objects = [*compile_each(command, folder, SMALL_SOURCES), folder / "main.o"]
    run(*command, "-c", PROGRAM, "-o", objects[-1])
    run(*LINK, *objects, "-o", program)
    return run("node", TARGETS_FOLDER / "bits.mjs", program)


def run_core(preset: str, folder: Path) -> str:
    """Of a microcontroller, part by part."""
    target = TARGETS[preset]
    if preset == "cortex-m0plus":  # three networks do not fit its board: its code on a larger one
        large = TARGETS["cortex-m3"]
        target = replace(target, board=large.board, flash=large.flash, ram=large.ram)
    library = compile_library(target, LEVEL, folder, SMALL_SOURCES)
    image = folder / "bits.elf"
    return "".join(
        emulate(build(PROGRAM, target, LEVEL, image, part, library=library), target)
        for part in PARTS
    )


# ---- The targets -------------------------------------------------------------------------------


def linux(
    target: str, arithmetic: str, system: str, libc: str, emulator: str, flags: str = ""
) -> Row:
    """By gcc for another processor."""
    packages = f"gcc-{system} libc6-dev-{libc}-cross qemu-user"
    return Row(target, arithmetic, f"{system}-gcc", flags, emulator, packages, run_linux)


def pc(arithmetic: str, compiler: str, flags: str = "") -> Row:
    return Row("x86-64", arithmetic, compiler, flags, "", f"{compiler} libc6-dev", run_linux)


def core(preset: str) -> Row:
    """Of CMakePresets.json."""
    target = TARGETS[preset]
    flags, emulator = " ".join(target.flags), target.system.qemu[0]
    arithmetic = ARITHMETICS.get(preset, "FPU" if "-mfpu" in flags else "none")
    packages = PACKAGES[target.system.cross]
    compiler = f"{target.system.cross}gcc"
    return Row(
        target.name, arithmetic, compiler, flags, emulator, packages,
        lambda _, folder: run_core(preset, folder), "picolibc.specs",
    )  # fmt: skip


ARITHMETICS = {"cortex-m55": "FPU, Helium", "rv32imafc": "FPU, fuses"}
PACKAGES = {
    "arm-none-eabi-": "gcc-arm-none-eabi picolibc-arm-none-eabi qemu-system-arm",
    "riscv64-unknown-elf-":
        "gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf qemu-system-misc",
}  # fmt: skip
FUSE = "-std=gnu11 -ffp-contract=on"  # clang's default, which the sources forbid
I386 = linux("i386", "SSE2", "i686-linux-gnu", "i386", "qemu-i386", "-msse2 -mfpmath=sse")
ARMV7 = linux("armv7", "VFPv3", "arm-linux-gnueabihf", "armhf", "qemu-arm", "-march=armv7-a+fp")
NEON = replace(ARMV7, arithmetic="NEON, fuses", flags="-march=armv7-a+neon-vfpv4")
AARCH64 = linux("aarch64", "NEON, fuses", "aarch64-linux-gnu", "arm64", "qemu-aarch64")
CLANG_ARMV7 = "clang --target=arm-linux-gnueabihf"
WASM = [
    Row("WebAssembly", arithmetic, "clang --target=wasm32", flags, "node", "clang lld nodejs",
        run_wasm, libc="")
    for arithmetic, flags in (("scalar", ""), ("SIMD", "-msimd128"))
]  # fmt: skip
ROWS = [
    pc("SSE2", "gcc"),
    pc("SSE2", "clang"),
    pc("AVX2, fuses", "gcc", "-mavx2 -mfma"),
    pc("AVX2, fuses", "clang", f"-mavx2 -mfma {FUSE}"),
    I386,
    replace(I386, arithmetic="x87", flags="-mno-sse -mfpmath=387", same=False),
    AARCH64,
    replace(AARCH64, compiler="clang --target=aarch64-linux-gnu", flags=FUSE),
    ARMV7,
    NEON,
    replace(NEON, compiler=CLANG_ARMV7, flags=f"-march=armv7-a -mfpu=neon-vfpv4 {FUSE}"),
    *map(core, TARGETS),
    linux("RV64", "FPU, fuses", "riscv64-linux-gnu", "riscv64", "qemu-riscv64"),
    linux("PowerPC", "FPU, fuses, big-endian", "powerpc-linux-gnu", "powerpc", "qemu-ppc"),
    linux("s390x", "FPU, fuses, big-endian", "s390x-linux-gnu", "s390x", "qemu-s390x",
          "-std=gnu99"),
    linux("MIPS", "FPU, big-endian", "mips-linux-gnu", "mips", "qemu-mips"),
    *WASM,
]  # fmt: skip


# ---- What they print ---------------------------------------------------------------------------


def is_there(row: Row) -> bool:
    """Are its compiler, C library and emulator installed?"""
    compiler = row.compiler.split()
    linker = "wasm-ld" if row in WASM else compiler[0]
    if not all(map(shutil.which, filter(None, [compiler[0], linker, row.emulator]))):
        return False
    file = run(*compiler, f"-print-file-name={row.libc}").strip()
    return not row.libc or Path(file).is_absolute()


def require(rows: Iterable[Row]) -> None:
    """Raises ToolError with what is to be installed for these targets."""
    missing = [row for row in rows if not is_there(row)]
    if missing:
        targets = ", ".join(dict.fromkeys(row.target for row in missing))
        packages = " ".join(dict.fromkeys(name for r in missing for name in r.packages.split()))
        raise ToolError(f"for {targets} please install (Debian's names): {packages}")


def compare(row: Row) -> None:
    """Raises Disagreement where a target prints other checksums, or should have been refused."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            said = row.output(row, Path(folder))
        except ToolError as error:
            if not row.same and REFUSAL in str(error):
                return
            raise
    title = f"{row.target}, {row.arithmetic}, {row.compiler} {row.flags}"
    if not row.same:
        raise Disagreement(f"{title}: not refused")
    wanted = EXPECTED.read_text("utf-8")
    if said != wanted:
        others = [line for line in said.splitlines() if line not in wanted.splitlines()]
        raise Disagreement(f"{title}: other bits\n" + "\n".join(others))


def bytes_compared() -> int:
    """Of how many bytes of results the checksums are."""
    row = replace(ROWS[0], flags="-DBYTES")
    require([row])
    with tempfile.TemporaryDirectory() as folder:
        return int(run_linux(row, Path(folder)).split()[-2])


# ---- The page ----------------------------------------------------------------------------------


def version(row: Row) -> str:
    """gcc 12.2.0."""
    compiler = row.compiler.split()[0]
    option = "-dumpversion" if compiler == "clang" else "-dumpfullversion"
    return f"{compiler.rpartition('-')[2]} {run(compiler, option).strip()}"


def bits_table(rows: Sequence[Row], size: int) -> str:
    """A row a target."""
    heads = ["arithmetic", "compiler", "flags", "runs in", "same bits", "bytes compared"]
    cells = [
        (row.target, [row.arithmetic, version(row), f"`{' '.join([LEVEL, *row.flags.split()])}`",
                      row.emulator or "this machine",
                      *(["yes", size] if row.same else ["refused when compiled", ""])])
        for row in rows
    ]  # fmt: skip
    return markdown.table("target", heads, cells, markdown.counted, left=len(heads))


def compare_all(rows: Sequence[Row]) -> None:
    """Two at a time; says of each that it is done."""
    require(rows)
    with ThreadPoolExecutor(2) as pool:
        for row, _ in zip(rows, pool.map(compare, rows), strict=True):
            done = "the same bits" if row.same else "refused"
            print(f"{row.target}, {row.arithmetic}, {row.compiler}: {done}", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    what = parser.add_mutually_exclusive_group()
    names = list(dict.fromkeys(row.target for row in ROWS))
    what.add_argument("--only", nargs="+", choices=names, metavar="TARGET", help=", ".join(names))
    what.add_argument("--update", action="store_true")
    args = parser.parse_args()
    rows = [row for row in ROWS if not args.only or row.target in args.only]
    try:
        compare_all(rows)
        if not args.only:
            table = bits_table(rows, bytes_compared())
            print(table)
            if args.update:
                markdown.write(PAGE, "bits", table)
    except (Disagreement, ToolError, OSError, ValueError) as error:
        print(f"bits: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
