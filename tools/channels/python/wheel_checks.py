"""Whether wheels are what pip and an index of packages want, and compute the same bits.

A library runs where a program that is linked with it does: here, in an emulator, or in Wine.
"""

import base64
import csv
import hashlib
import io
import os
import re
import sys
import sysconfig
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path

import lief

from channels.python.platforms import PLATFORMS, Platform, zig
from data.paths import ROOT
from reports.targets import INCLUDES, ToolError, run

PROGRAM = ROOT / "tests" / "targets" / "bits.c"
BITS = ROOT / "tests" / "bits.txt"
WALK = ROOT / "examples" / "data" / "walk.csv"
TOOLS = Path(sysconfig.get_path("scripts"))  # of the packages that check wheels
lief.logging.disable()  # it warns of files that are right
OF_THE_LINKER = {"__mh_dylib_header", "___dso_handle"}  # what zig's exports on macOS


@dataclass(frozen=True)
class System:
    """Where a library can run on this machine."""

    target: str  # zig's, of a program
    loader: str  # a file that must be there
    packages: str  # Debian's, which bring it
    command: tuple[str, ...] = ()  # what runs the program
    options: tuple[str, ...] = ()  # of zig


def by_qemu(machine: str, target: str, loader: str, package: str) -> System:
    """A processor in QEMU, with the C library of Debian's cross compiler."""
    sysroot = f"/usr/{target}"
    command = (f"qemu-{machine}", "-L", sysroot)
    return System(target, f"{sysroot}/lib/{loader}", f"qemu-user {package}", command)


GLIBC = System("x86_64-linux-gnu", "/lib64/ld-linux-x86-64.so.2", "libc6")
MUSL = System("x86_64-linux-musl", "/lib/ld-musl-x86_64.so.1", "musl", options=("-dynamic",))
ARM64 = by_qemu("aarch64", "aarch64-linux-gnu", "ld-linux-aarch64.so.1", "libc6-arm64-cross")
ARMHF = by_qemu("arm", "arm-linux-gnueabihf", "ld-linux-armhf.so.3", "libc6-armhf-cross")
WINE64 = "/usr/lib/wine/wine64"
WINE = System("x86_64-windows-gnu", WINE64, "wine64", (WINE64,))
SYSTEMS = {
    "linux_x86_64": (GLIBC, MUSL),
    "linux_aarch64": (ARM64,),
    "linux_armv7l": (ARMHF,),
    "windows_amd64": (WINE,),
}
DEBIAN = "bookworm"
PYTHONS = {"linux_aarch64": "arm64", "linux_armv7l": "armhf"}  # Debian's names, for QEMU


def check_wheel(wheel: Path, name: str) -> None:
    """The file, the library in it, and its bits wherever it can run; `name` is its platform's."""
    platform = PLATFORMS[name]
    check_record(wheel)
    if name.startswith("linux"):
        check_oldest_glibc(wheel)
    with tempfile.TemporaryDirectory() as folder:
        library = unpack_library(wheel, platform, Path(folder))
        check_exports(library)
        check_needs(library)
        for system in SYSTEMS.get(name, ()):
            check_bits(library, system)


# ---- The file ------------------------------------------------------------------------------------


def check_metadata(files: list[Path]) -> None:
    """What an index of packages refuses, and usual mistakes in wheels."""
    run(TOOLS / "twine", "check", "--strict", *files)
    run(TOOLS / "check-wheel-contents", *(file for file in files if file.suffix == ".whl"))


def check_record(wheel: Path) -> None:
    """RECORD has each file of the wheel, its size and its SHA-256."""
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (name for name in archive.namelist() if name.endswith(".dist-info/RECORD"))
        rows = csv.reader(io.StringIO(archive.read(name).decode()))
        files = {file: archive.read(file) for file in archive.namelist()}
    wanted = {file: (hash_of(content), str(len(content))) for file, content in files.items()}
    wanted[name] = ("", "")
    if {file: (digest, size) for file, digest, size in rows} != wanted:
        raise ToolError(f"{wheel.name}: its RECORD is not that of its files")


def hash_of(content: bytes) -> str:
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest())
    return "sha256=" + digest.rstrip(b"=").decode()


def check_oldest_glibc(wheel: Path) -> None:
    """auditwheel finds nothing in a wheel of Linux that an older system than its tag's lacks."""
    said = run(TOOLS / "auditwheel", "show", wheel)
    allowed = re.search(r'tag:\s+"manylinux_2_(\d+)_', said)
    tagged = re.search(r"manylinux_2_(\d+)_", wheel.name)
    alone = "requires no external shared libraries" in said
    if not (alone and allowed and tagged and int(allowed[1]) <= int(tagged[1])):
        raise ToolError(f"{wheel.name}: auditwheel says\n{said}")


# ---- The library ---------------------------------------------------------------------------------


def unpack_library(wheel: Path, platform: Platform, folder: Path) -> Path:
    with zipfile.ZipFile(wheel) as archive:
        (folder / platform.library).write_bytes(archive.read(f"edmlift/{platform.library}"))
    return folder / platform.library


def exported(library: Path) -> set[str]:
    """The names that a library of any system exports."""
    binary = lief.parse(library)
    if isinstance(binary, lief.PE.Binary):
        return {entry.name for entry in binary.get_export().entries}
    names = {symbol.name for symbol in binary.exported_symbols}
    if isinstance(binary, lief.MachO.Binary):
        return {name.removeprefix("_") for name in names - OF_THE_LINKER}
    return names


def needed(library: Path) -> set[str]:
    """The libraries that it has loaded."""
    binary = lief.parse(library)
    if isinstance(binary, lief.PE.Binary):
        return {entry.name for entry in binary.imports}
    if isinstance(binary, lief.MachO.Binary):
        return {entry.name for entry in binary.libraries} - {f"@rpath/{library.name}"}
    return set(binary.libraries)


def check_exports(library: Path) -> None:
    """A library exports the public names, and no others."""
    others = {name for name in exported(library) if not re.match("edml_[^_]", name)}
    if others or "edml_lift" not in exported(library):
        raise ToolError(f"{library.name} exports {', '.join(sorted(others)) or 'nothing'}")


def check_needs(library: Path) -> None:
    """A library needs no other, but for what each macOS has."""
    if needed(library) - {"/usr/lib/libSystem.B.dylib"}:
        raise ToolError(f"{library.name} needs {', '.join(sorted(needed(library)))}")


def bits_of(library: Path, system: System) -> str:
    """What tests/targets/bits.c prints with a library, which lies in a folder of its own."""
    if not Path(system.loader).exists():
        raise ToolError(f"{system.loader} is not there: apt-get install {system.packages}")
    folder, program = library.parent, f"bits-{system.target}.exe"
    options = ("-O1", "-DPUBLIC", "-Wl,-rpath,$ORIGIN", *INCLUDES, *system.options)
    zig(system.target, *options, PROGRAM, library.name, "-o", program, folder=folder)
    quiet = {"WINEPREFIX": str(folder / "wine"), "WINEDEBUG": "-all"}
    return run(*system.command, folder / program, cwd=folder, env=os.environ | quiet)


def check_bits(library: Path, system: System) -> None:
    """The same bits as everywhere; without the lines of what no library exports."""
    lines = BITS.read_text("utf-8").splitlines()
    wanted = [line for line in lines if not line.startswith("fconv ")]
    if bits_of(library, system).splitlines() != wanted:
        raise ToolError(f"{library.name}: other bits on {system.target} than {BITS.name}")


# ---- The package ---------------------------------------------------------------------------------


def host() -> str:
    """The name of this machine's platform, which need not be one of PLATFORMS."""
    return sysconfig.get_platform().replace("-", "_")


def platform_of(wheel: Path) -> str:
    """The name of the platform that a wheel is for."""
    tags = set(wheel.stem.rpartition("-")[2].split("."))
    return next(name for name, platform in PLATFORMS.items() if set(platform.tags) == tags)


def pip(*options: object) -> None:
    run(sys.executable, "-m", "pip", "--disable-pip-version-check", *options)


def install(package: Path, folder: Path) -> Path:
    """A fresh environment with a package and what it asks for; returns its Python."""
    run(sys.executable, "-m", "venv", "--without-pip", folder)
    python = folder / "bin" / "python"
    pip("--python", python, "install", "-q", "--no-compile", package)
    return python


def lifted_by(package: Path) -> str:
    """The sample walk, lifted by a package in a fresh environment."""
    with tempfile.TemporaryDirectory() as folder:
        python = install(package, Path(folder) / "venv")
        return run(python, "-I", "-m", "edmlift", "lift", WALK, cwd=folder)


def lifted_in_qemu(wheel: Path, name: str) -> str:
    """The same by Debian's Python and NumPy of another processor."""
    (system,), platform = SYSTEMS[name], PLATFORMS[name]
    with tempfile.TemporaryDirectory() as folder:
        root, site = Path(folder) / "root", Path(folder) / "site"
        about = ("--format", "$(SITE)", "Created-By: Packages", f"Codename: {DEBIAN}")
        mirror, *_ = run("apt-get", "indextargets", *about).split()
        packages = ("--include=python3-numpy", DEBIAN, root, mirror)
        run("mmdebstrap", "--variant=extract", f"--architectures={PYTHONS[name]}", *packages)
        tags = [f"--platform={tag}" for tag in platform.tags]
        pip("install", "-q", "--no-deps", "--only-binary=:all:", *tags, "--target", site, wheel)
        libraries = root / "usr" / "lib" / system.target
        settings = {
            "PYTHONHOME": root / "usr",
            "PYTHONPATH": site,
            "LD_LIBRARY_PATH": f"{libraries / 'blas'}:{libraries / 'lapack'}",
        }
        (python,) = (root / "usr" / "bin").glob("python3.??")
        set_all = [word for name, value in settings.items() for word in ("-E", f"{name}={value}")]
        command = (system.command[0], "-L", root, *set_all, python)
        return run(*command, "-m", "edmlift", "lift", WALK, cwd=folder)
