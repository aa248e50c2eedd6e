"""Measures the library: tools/evaluation/, whose --help lists what there is to measure."""

import sys

from evaluation.cli import main

if __name__ == "__main__":
    sys.exit(main())
