"""The command line: edmlift lift, convert, draw, view, models, formats."""

import argparse
import os
import sys
from collections.abc import Sequence

from edmlift._version import __version__
from edmlift.commands import convert, draw, lift, view
from edmlift.commands.errors import INTERRUPTED, TROUBLE, WRONG_OPTION, CommandError, OptionError
from edmlift.formats import FORMATS
from edmlift.networks import models


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="edmlift", description="2D joints of a person in, a 3D pose in metres out."
    )
    parser.add_argument("--version", action="version", version=f"edmlift {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for command in (lift, convert, draw, view):
        command.add(commands)
    names = commands.add_parser("models", help="print the names of the networks")
    names.set_defaults(run=_print_models)
    names = commands.add_parser("formats", help="print the detectors' formats and their keypoints")
    names.set_defaults(run=_print_formats)
    return parser


def _print_models(_options: argparse.Namespace) -> int:
    print(*models(), sep="\n")
    return 0


def _print_formats(_options: argparse.Namespace) -> int:
    for name, keypoints in FORMATS.items():
        print(name, keypoints)
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command; returns its exit status: 0, 1 for trouble with files, 2 for wrong options,
    130 if it was interrupted."""
    options = _parser().parse_args(arguments)
    code = TROUBLE
    try:
        status: int = options.run(options)
        if sys.stdout is not None:
            sys.stdout.flush()
        return status
    except KeyboardInterrupt:
        message, code = "interrupted", INTERRUPTED
    except BrokenPipeError:  # whoever read the output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return TROUBLE
    except OSError as error:
        name = f"{error.filename}: " if error.filename else ""
        message = f"{name}{error.strerror or error}"
    except (CommandError, ImportError, ValueError) as error:
        message = str(error)
        if isinstance(error, OptionError):
            code = WRONG_OPTION
    print(f"edmlift: {message}", file=sys.stderr)
    return code
