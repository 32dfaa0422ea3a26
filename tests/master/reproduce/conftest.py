"""The runs of the papers, done once for the tests of a page, of its pictures and of its numbers."""

from __future__ import annotations

import multiprocessing

import pytest

from evcosim.master.reproduce import papers
from evcosim.master.studies.parallel import run_all
from support import warm


@pytest.fixture(scope="session")
def braking_runs():
    """What all runs of the braking two-wheeler return, by name."""
    tasks, forking = papers.load("braking").runs(), warm.context()
    with pytest.MonkeyPatch.context() as set_for_it:  # as the fixture warm_workers, which is one test's
        set_for_it.setattr(multiprocessing, "get_context", lambda method=None: forking)
        return {task.name: outcome.result() for task, outcome in zip(tasks, run_all(tasks), strict=True)}


@pytest.fixture(scope="session")
def braking_page(braking_runs):
    return papers.load("braking").page(braking_runs)


@pytest.fixture(scope="session")
def multi_drive_runs():
    """What all runs of the two-motor car return, by name."""
    return {task.name: task() for task in papers.load("multi_drive").runs()}


@pytest.fixture(scope="session")
def multi_drive_page(multi_drive_runs):
    return papers.load("multi_drive").page(multi_drive_runs)


@pytest.fixture(scope="session")
def written(tmp_path_factory):
    """The page of lane keeping, reproduced, and the folder that it was written into."""
    folder = tmp_path_factory.mktemp("pages")
    (page,) = papers.reproduce(["lane_keeping"], folder)
    return page, folder
