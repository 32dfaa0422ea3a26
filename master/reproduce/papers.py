"""The papers, and their reproduction: all their runs at once on all cores, then a page for each."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...cosim.errors import ConfigError, nearest
from ...cosim.system.system import UnitsName, load_system
from ..builtin import fmu_file, units_run
from ..studies.parallel import Task, TaskProgress, run_all
from .page import Page, Paper
from .render import write_index, write_page

NAMES = ("scooter", "lane_keeping", "braking", "multi_drive")
"""The papers by the name of their system; each is the module of that name in this package."""


class UnwrittenError(ConfigError):
    """A page or the index of papers, which are reproduced as `pages`, that cannot be written."""

    def __init__(self, message: str, pages: list[Page]) -> None:
        super().__init__(message)
        self.pages = pages


def load(name: str) -> Paper:
    """Return the paper of a system. Raises ConfigError with the nearest name for an unknown one."""
    if name not in NAMES:
        raise ConfigError(f"there is no paper '{name}'{nearest(name, NAMES)}; papers: {', '.join(NAMES)}")
    paper: Paper = importlib.import_module(f".{name}", __package__).PAPER
    return paper


def counts(names: Sequence[str]) -> dict[str, int]:
    """Return the number of runs of each paper."""
    return {name: len(load(name).runs()) for name in names}


def _of_kind(units: UnitsName, task: Task[Any]) -> Any:
    with units_run(units):
        return task()


def reproduce(
    names: Sequence[str],
    folder: Path,
    workers: int | None = None,
    progress: TaskProgress | None = None,
    units: UnitsName = "auto",
) -> list[Page]:
    """Reproduce papers and write their pages and an index into `folder`; return the pages.

    `units` is the kind of the built-in FMUs, which are made before the runs, in this process.
    Raises ConfigError for an unknown name, UnwrittenError, which has the pages, where the folder cannot be
    written, RunError naming the run that failed.
    """
    papers = {name: load(name) for name in names}
    with units_run(units):
        for name in names:
            for unit in load_system(name).file.units.values():
                fmu_file(unit.fmu)  # once, not in each of the processes that need it
    runs = {name: paper.runs() for name, paper in papers.items()}
    tasks = [
        Task(f"{name}: {task.name}", _of_kind, (units, task)) for name, some in runs.items() for task in some
    ]
    outcomes = iter(run_all(tasks, workers, progress))
    pages: list[Page] = []
    refused: list[ConfigError] = []
    for name, paper in papers.items():
        pages.append(paper.page({task.name: next(outcomes).result() for task in runs[name]}))
        try:
            write_page(pages[-1], folder)
        except ConfigError as error:  # the others may be smaller
            refused.append(error)
    try:
        write_index(pages, folder)
    except ConfigError as error:
        refused.append(error)
    if refused:
        raise UnwrittenError("\n".join(map(str, refused)), pages) from refused[0]
    return pages
