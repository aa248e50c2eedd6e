"""Trains a lifter: tools/training/train.py, whose --help says how."""

import sys

from training.train import main

if __name__ == "__main__":
    sys.exit(main())
