"""The output folder: tried before the first step, then filled with the files of a run."""

from __future__ import annotations

import contextlib
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...cosim.results.results import Results
    from ..simulation import Simulation

FIGURES = ("figure.png", "figure.svg")
CAN_LOGS = ("can.log", "can.blf", "can.asc")


def default_folder(*names: str) -> Path:
    """Return the folder of a run for which `--output` names none; names that are "" are left out."""
    return Path("results") / "-".join(name for name in names if name)


def output_folder(folder: Path) -> Path:
    """Make the folder if needed, try to write into it, and return it. Raises ConfigError with the reason."""
    from ...cosim.errors import ConfigError
    from ...cosim.writing import reason, try_folder

    try:
        try_folder(folder)
    except OSError as error:
        said = reason(folder / "results.csv", error)
        raise ConfigError(
            f"output folder {folder}: cannot be written: {said}; --output names another one"
        ) from error
    return folder


def run_folder(folder: Path) -> Path:
    """Make the folder if needed, try to write into it, and return it; a run replaces an earlier one in it.

    Raises ConfigError with the reason, also if a file to be replaced or removed was not written by a run.
    """
    from ...cosim.errors import ConfigError
    from ...cosim.results.results import CSV_NAME, MANIFEST_NAME

    names = (CSV_NAME, MANIFEST_NAME, *FIGURES, *CAN_LOGS)
    taken = [name for name in names if (folder / name).exists()]
    if taken and not _is_of_a_run(folder / MANIFEST_NAME):
        raise ConfigError(
            f"output folder {folder}: {', '.join(taken)} would be replaced, but no {MANIFEST_NAME} says that "
            "a run wrote it; --output names another folder"
        )
    return output_folder(folder)


def _is_of_a_run(manifest: Path) -> bool:
    import json

    try:
        about = json.loads(manifest.read_bytes())
    except (OSError, ValueError):
        return False
    return isinstance(about, dict) and "evcosim" in about


def write_results(folder: Path, results: Results) -> list[str]:
    """Write results.csv and run.json, and return their names.

    Figures and logs of an earlier run are removed: a folder holds one run. If the two cannot be written they
    go to a temporary folder, and RunError names it.
    """
    from ...cosim.errors import ConfigError, RunError
    from ...cosim.results.results import CSV_NAME, MANIFEST_NAME

    for name in (*FIGURES, *CAN_LOGS):
        with contextlib.suppress(OSError):  # the error of writing below has the reason
            (folder / name).unlink(missing_ok=True)
    try:
        results.write(folder)
    except ConfigError as error:
        rescue = Path(tempfile.mkdtemp(prefix="evcosim-results-"))
        results.write(rescue)
        raise RunError(f"{error}\nthe results are kept in {rescue}") from error
    return [CSV_NAME, MANIFEST_NAME]


def write_figure(folder: Path, results: Results) -> list[str]:
    """Draw and write the figure and return the names of its files. Raises ConfigError."""
    from ...cosim.figures import draw as figures

    return [path.name for path in figures.save(results.plot(), folder)]


def write_can_logs(folder: Path, simulation: Simulation) -> list[str]:
    """Write the frames of the run in each format and return the names of the files. Raises ConfigError."""
    for name in CAN_LOGS:
        simulation.write_can_log(folder / name)
    return list(CAN_LOGS)
