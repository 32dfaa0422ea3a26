"""CoFmuPy: a coordinator that is started by a file in JSON."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

import answers
from cofmupy import Coordinator


def main() -> None:
    """Do the job."""
    job = answers.read()
    config = {
        "fmus": [
            {
                "id": f"unit{number}",
                "path": job.fmu,
                "name": f"unit{number}",
                "initialization": job.parameters | inputs,
            }
            for number, inputs in enumerate(job.inputs)
        ],
        "connections": [],
        "cosim_method": "jacobi",
        "edge_sep": " -> ",
        "root": "",
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "config.json")
        path.write_text(json.dumps(config), encoding="utf-8")
        coordinator = Coordinator()
        coordinator.start(str(path))
        rows: list[list[dict[str, float]]] = [[] for _ in job.inputs]
        for _ in range(job.count):
            coordinator.do_step(job.step)
            for number, of_one in enumerate(rows):
                of_one.append({n: coordinator.get_variable((f"unit{number}", n))[0] for n in job.outputs})
    answers.answer(rows)


main()
