"""The papers, and their reproduction on all cores: their runs, then their pictures, and a page for each.

The pictures of a paper are drawn as soon as its runs have ended, each as a task of its own, and the page is
written when the last one is there. A worker reads what the runs have returned from a file.
"""

from __future__ import annotations

import functools
import importlib
import pickle
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...cosim import leftovers
from ...cosim.errors import ConfigError, RunError, nearest
from ...cosim.shortage import of_temporary_files
from ...cosim.system.system import UnitsName, load_system
from ..builtin import fmu_file, units_run
from ..studies.parallel import Outcome, Task, TaskProgress, run_all
from .page import Page, Paper
from .render import write_index, write_page, write_picture

NAMES = ("scooter", "lane_keeping", "braking", "multi_drive")
"""The papers by the name of their system; each is the module of that name in this package."""

_MANY = 24  # pictures that a page is taken to have, for the progress, before it is known how many


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

    `units` is the kind of the built-in FMUs, which are made before the runs, in this process. A page is
    written when its last picture is drawn: where this is interrupted, what was done before stays.
    Raises ConfigError for an unknown name, UnwrittenError, which has the pages, where the folder cannot be
    written, RunError naming the run that failed.
    """
    papers = [load(name) for name in names]
    with units_run(units):
        for name in names:
            for unit in load_system(name).file.units.values():
                fmu_file(unit.fmu)  # once, not in each of the processes that need it
    with leftovers.temporary() as spilled:
        works = [_Work(paper, folder, spilled) for paper in papers]
        tasks = [(work, task) for work in works for task in work.tasks(units)]
        parts = [work for work, _ in tasks]

        def then(place: int, outcome: Outcome[Any]) -> list[Task[Any]]:
            more = parts[place].take(outcome)
            parts.extend([parts[place]] * len(more))
            return more

        def report(done: int, known: int, name: str) -> None:
            if progress is not None:
                progress(done, known + sum(_MANY for work in works if work.page is None), name)

        run_all([task for _, task in tasks], workers, report, then)
    return _pages(works, folder)


def _pages(works: Sequence[_Work], folder: Path) -> list[Page]:
    """Write the index and return the pages. Raises as `reproduce` does."""
    for work in works:
        for outcome in work.ended.values():
            outcome.result()
    pages = [work.page for work in works if work.page is not None]
    refused = [work.refused for work in works if work.refused is not None]
    try:
        write_index(pages, folder)
    except ConfigError as error:
        refused.append(error)
    if refused:
        raise UnwrittenError("\n".join(map(str, refused)), pages) from refused[0]
    return pages


class _Work:
    """The work on a paper: its runs, then its pictures, then the page.

    `ended` has the outcomes of the runs by the name of the task; `page` is None before all have ended, and
    where one failed; `refused` is the first error of a file that cannot be written.
    """

    def __init__(self, paper: Paper, folder: Path, spilled: Path) -> None:
        self.paper, self.folder, self.spilled = paper, folder, spilled
        self.runs = paper.runs()
        self.ended: dict[str, Outcome[Any]] = {}
        self.drawn: dict[str, Outcome[Any]] = {}
        self.page: Page | None = None
        self.refused: ConfigError | None = None

    def tasks(self, units: UnitsName) -> list[Task[Any]]:
        """Return the runs with this kind of units; without any, what follows them."""
        if not self.runs:
            return self._pictures()
        return [Task(self._label(task.name), _of_kind, (units, task)) for task in self.runs]

    def take(self, outcome: Outcome[Any]) -> list[Task[Any]]:
        """Take the outcome of a task, and return those that it makes possible.

        Raises what the paper's module raises, RunError where the runs find no room in the temporary folder.
        """
        if self.page is not None:
            self.drawn[outcome.name] = outcome
            self._finish(self.page)
            return []
        self.ended[outcome.name] = outcome
        if len(self.ended) < len(self.runs) or any(each.failure for each in self.ended.values()):
            return []
        return self._pictures()

    def _label(self, part: str) -> str:
        return f"{self.paper.name}: {part}"

    def _pictures(self) -> list[Task[Any]]:
        """Make the page, and return the tasks of its pictures; write it where it has none."""
        found = {task.name: self.ended[self._label(task.name)].result() for task in self.runs}
        self.page = self.paper.page(found)
        if not self.page.pictures:
            self._finish(self.page)
            return []
        path = self.spilled / f"{self.paper.name}.found"
        try:
            path.write_bytes(pickle.dumps(found))
        except OSError as error:
            raise RunError(f"{self.paper.name}: {of_temporary_files(error)}") from error
        return [
            Task(self._label(f"picture {picture.stem}"), _drawn, (self.paper.name, path, i, self.folder))
            for i, picture in enumerate(self.page.pictures)
        ]

    def _finish(self, page: Page) -> None:
        """Write the page if all its pictures are drawn."""
        if len(self.drawn) < len(page.pictures):
            return
        try:
            write_page(page, self.folder, {p.stem: self._panels(p.stem) for p in page.pictures})
        except ConfigError as error:  # other pages may be smaller
            self.refused = error

    def _panels(self, stem: str) -> str:
        """Return the panels of a picture. Raises ConfigError where its files cannot be written."""
        outcome = self.drawn[self._label(f"picture {stem}")]
        if outcome.failure is not None and outcome.failure.kind == ConfigError.__name__:
            raise ConfigError(outcome.failure.reason)
        panels: str = outcome.result()
        return panels


# ---- in a worker


def _drawn(paper: str, path: Path, place: int, folder: Path) -> str:
    """Write a picture of what was found, which is in a file, and return its panels. Raises ConfigError."""
    return write_picture(paper, load(paper).pictures(_found(path))[place], folder)


@functools.lru_cache(maxsize=len(NAMES))
def _found(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = pickle.loads(path.read_bytes())
    return found
