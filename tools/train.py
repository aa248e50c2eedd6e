"""Trains a lifter: tools/training/cli.py, whose --help says how."""

import sys

from training.cli import main

if __name__ == "__main__":
    sys.exit(main())
