"""fmucontainer of the FMU Manipulation Toolbox: a container of the FMU, which FMPy simulates."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import answers
from fmpy.simulation import simulate_fmu


def main() -> None:
    """Do the job."""
    job = answers.read()
    name = Path(job.fmu).name
    paths = {f"unit{number}.fmu": job.fmu for number in range(len(job.inputs))}
    with tempfile.TemporaryDirectory() as folder:
        for unit, path in paths.items():
            Path(folder, unit).write_bytes(Path(path).read_bytes())
        named = [
            (unit, n, v)
            for unit, inputs in zip(paths, job.inputs, strict=True)
            for n, v in (job.parameters | inputs).items()
        ]
        outputs = [[unit, n, f"{unit[:-4]}_{n}"] for unit in paths for n in job.outputs]
        config = {
            "name": "container.fmu",
            "fmu": list(paths),
            "input": [
                [f"{unit[:-4]}_{n}", unit, n]
                for unit, inputs in zip(paths, job.inputs, strict=True)
                for n in inputs
            ],
            "output": outputs,
            "start": [[unit, n, v] for unit, n, v in named if n in job.parameters],
            "step_size": job.step,
        }
        Path(folder, "container.json").write_text(json.dumps(config), encoding="utf-8")
        command = Path(sys.executable).with_name("fmucontainer")
        made = subprocess.run(
            [command, "-fmi", str(job.fmi), "-fmu-directory", folder, "-container", "container.json"],
            cwd=folder,
            capture_output=True,
            text=True,
        )
        if not Path(folder, "container.fmu").is_file():
            print(made.stdout + made.stderr)
            raise RuntimeError(f"fmucontainer made no container of {name}")
        result = simulate_fmu(
            str(Path(folder, "container.fmu")),
            stop_time=job.time(job.count),
            output_interval=job.step,
            step_size=job.step,
            start_values={f"{unit[:-4]}_{n}": v for unit, n, v in named if n not in job.parameters},
            output=[shown for _, _, shown in outputs],
        )
    rows = [[{n: row[f"{unit[:-4]}_{n}"] for n in job.outputs} for row in result[1:]] for unit in paths]
    answers.answer(rows)


main()
