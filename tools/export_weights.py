"""Turns trained weights into a C header: tools/export/cli.py, whose --help says how."""

import sys

from export.cli import main

if __name__ == "__main__":
    sys.exit(main())
