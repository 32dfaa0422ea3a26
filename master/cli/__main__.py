"""`python -m evcosim.master.cli` is `evcosim`."""

from __future__ import annotations

import sys

from . import main

if __name__ == "__main__":
    sys.exit(main())
