"""One measurement in a process of its own: python -m benchmarks.worker RUNNER CASE, which answers with JSON.

A master that crashes, hangs or leaves threads behind ends with its process and changes no other figure.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from .case import Case, reference
from .fmus import CannotBuild
from .runners import Measured, Unable


def main() -> None:
    """Measure what the arguments say, and print one line of JSON."""
    name, case = sys.argv[1], Case(**json.loads(sys.argv[2]))
    answer_to = os.dup(1)
    os.dup2(2, 1)  # masters print banners
    answer = _measured(name, case)
    with os.fdopen(answer_to, "w") as out:
        json.dump(answer, out)
        out.flush()
    os._exit(0)  # the destructors of some masters crash, after all is done


def _measured(name: str, case: Case) -> dict[str, Any]:
    try:
        runner = importlib.import_module(f"benchmarks.runners.{name}")
    except ImportError as error:
        return {"error": f"not installed ({error.name or error})"}
    about = {"version": runner.version()}
    with tempfile.TemporaryDirectory() as folder:
        try:
            measured = runner.measure(case, Path(folder))
            return about | _checked(case, measured)
        except (Unable, CannotBuild) as error:
            return about | {"error": str(error)}
        except Exception as error:  # whatever a master raises is its row in the table
            return about | {"error": f"{type(error).__name__}: {error}"}


def _checked(case: Case, measured: Measured) -> dict[str, Any]:
    """The time, if the outputs are those of the reference."""
    expected = reference(case, measured.order)
    wanted = expected if case.record else expected[-1]
    if measured.outputs.shape != wanted.shape:
        return {"error": f"gave outputs of shape {measured.outputs.shape}, not {wanted.shape}"}
    off = float(np.max(np.abs(measured.outputs - wanted)))
    if not off <= measured.digits:
        return {"error": f"its result is off by {off:.3g}: not timed"}
    return {"microseconds": 1e6 * measured.seconds / case.steps, "off": off}


if __name__ == "__main__":
    main()
