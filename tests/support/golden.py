"""Golden results: compare, or regenerate and print the differences (run this file)."""

from __future__ import annotations

import csv
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from evcosim import simulate
from evcosim.cosim.results.results import Results

FOLDER = Path(__file__).parent.parent / "systems" / "golden"
CASES: dict[str, dict[str, Any]] = tomllib.loads((FOLDER / "golden.toml").read_text())


def run(case: dict[str, Any]) -> Results:
    """The results of a case's run."""
    return simulate(case["system"], case["scenario"])


def thinned(results: Results, case: dict[str, Any]) -> np.ndarray:
    """Time and the case's signals at every n-th communication point, shape (points, 1 + signals)."""
    columns = [results.time, *(results.column(name) for name in case["signals"])]
    return np.column_stack(columns)[:: case["every"]]


def read(name: str) -> tuple[list[str], np.ndarray]:
    """Header and rows of a golden file."""
    with (FOLDER / f"{name}.csv").open(newline="") as file:
        header, *rows = csv.reader(file)
    return header, np.array(rows, dtype=float)


def regenerate() -> None:
    """Write every golden file anew; print how far each signal moved."""
    for name, case in CASES.items():
        rows = thinned(run(case), case)
        header = ["time", *case["signals"]]
        if (FOLDER / f"{name}.csv").exists():
            _, before = read(name)
            if before.shape == rows.shape:
                for column, change in zip(header, np.abs(rows - before).max(axis=0), strict=True):
                    print(f"{name}  {column:28}  {change:.3g}")
            else:
                print(f"{name}: {before.shape} -> {rows.shape}")
        with (FOLDER / f"{name}.csv").open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(header)
            writer.writerows([f"{value:.10g}" for value in row] for row in rows)


if __name__ == "__main__":
    regenerate()
