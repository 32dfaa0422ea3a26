"""The papers, and their reproduction: all their runs at once on all cores, then a page for each."""

from __future__ import annotations

import dataclasses
import importlib
from collections.abc import Sequence
from pathlib import Path

from ...cosim.errors import ConfigError, nearest
from ..studies.parallel import TaskProgress, run_all
from .page import Page, Paper
from .render import write_index, write_page

NAMES = ("scooter", "lane_keeping", "braking", "multi_drive")
"""The papers by the name of their system; each is the module of that name in this package."""


def load(name: str) -> Paper:
    """Return the paper of a system. Raises ConfigError with the nearest name for an unknown one."""
    if name not in NAMES:
        raise ConfigError(f"there is no paper '{name}'{nearest(name, NAMES)}; papers: {', '.join(NAMES)}")
    paper: Paper = importlib.import_module(f".{name}", __package__).PAPER
    return paper


def reproduce(
    names: Sequence[str], folder: Path, workers: int | None = None, progress: TaskProgress | None = None
) -> list[Page]:
    """Reproduce papers and write their pages and an index into `folder`; return the pages.

    Raises ConfigError for an unknown name or a folder that cannot be written, RunError naming the run that
    failed.
    """
    papers = {name: load(name) for name in names}
    runs = {name: paper.runs() for name, paper in papers.items()}
    tasks = [
        dataclasses.replace(task, name=f"{name}: {task.name}") for name, some in runs.items() for task in some
    ]
    outcomes = iter(run_all(tasks, workers, progress))
    pages = []
    for name, paper in papers.items():
        page = paper.page({task.name: next(outcomes).result() for task in runs[name]})
        write_page(page, folder)
        pages.append(page)
    write_index(pages, folder)
    return pages
