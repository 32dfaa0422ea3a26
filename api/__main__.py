"""`python -m evcosim` is the command `evcosim`."""

from __future__ import annotations

import sys

from .master.cli import main

if __name__ == "__main__":
    sys.exit(main())
