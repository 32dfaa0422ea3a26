"""Runs all hostile FMUs and writes docs/hostile.md: python -m support.hostile, started in tests/."""

from __future__ import annotations

import dataclasses
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from support.hostile import page, runs
from support.hostile.cases import CASES


def main() -> int:
    """0 when all ended as expected."""
    with ProcessPoolExecutor() as pool:
        outcomes = dict(zip(CASES, pool.map(_outcome, range(len(CASES))), strict=True))
    page.PAGE.write_text(page.written(outcomes), encoding="utf-8")
    wrong = [key for key in CASES if not page.as_expected(key[0], outcomes[key])]
    for case, fmi in wrong:
        print(f"{case.name} {fmi}.0: {outcomes[case, fmi]}", file=sys.stderr)
    print(f"{page.PAGE}: {len(CASES) - len(wrong)} of {len(CASES)} as expected")
    return len(wrong) > 0


def _outcome(number: int) -> runs.Outcome:
    with tempfile.TemporaryDirectory() as folder:
        return dataclasses.replace(runs.run(Path(folder), *CASES[number]), results=None)


if __name__ == "__main__":
    sys.exit(main())
