"""python -m edmlift: the command line."""

import sys

from edmlift.cli import main

if __name__ == "__main__":
    sys.exit(main())
