"""Where this machine has no room, file or process for an isolated unit, the error says so, and what helps."""

from __future__ import annotations

import gc
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest

from evcosim.cosim.errors import ShortageError
from evcosim.master.builtin import build_fmu
from evcosim.master.fmi.fmu import Fmu, read_fmu
from evcosim.master.isolation.process import ProcessLimits
from evcosim.master.isolation.unit import IsolatedUnit
from evcosim.master.simulation import Simulation
from support.c_fmu import mixed_fmu
from support.forked import forked
from support.needs import need_linux
from support.pairs import pair
from support.small_disk import small_disk

NOBODY = 65534


@pytest.fixture
def fmu(tmp_path: Path) -> Fmu:
    return read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 2))


def refusal(fmu: Fmu, before: Callable[[], None]) -> str:
    """What is said of a unit that is made after `before` in a copy of this process, which leaves nothing."""

    def within() -> tuple[str, int]:
        tempfile.gettempdir()
        gc.collect()  # of tests before
        before()
        held, said = len(os.listdir("/proc/self/fd")), ""
        try:
            IsolatedUnit(fmu, "a", fmu.interface, ProcessLimits())
        except ShortageError as error:
            said = str(error)
        gc.collect()
        return said, len(os.listdir("/proc/self/fd")) - held

    need_linux()
    found = forked(within)
    assert not found.crash, found.crash
    said, more = found.value
    assert more == 0  # no file is left open
    return str(said)


def limit(kind: int, most: int) -> Callable[[], None]:
    return lambda: resource.setrlimit(kind, (most, resource.getrlimit(kind)[1]))


def test_every_number_of_open_files_that_is_too_small(fmu: Fmu) -> None:
    def few(more: int) -> None:
        highest = max(map(int, os.listdir("/proc/self/fd")))
        while (last := os.open(os.devnull, os.O_RDONLY)) <= highest:  # no number below is free
            pass
        os.close(last)
        limit(resource.RLIMIT_NOFILE, highest + 1 + more)()

    for said in {refusal(fmu, lambda more=more: few(more)) for more in range(1, 7)}:  # type: ignore[misc]
        assert said.startswith(
            "unit 'a': its process cannot be started: Too many open files: the limit of open"
        )
        assert said.endswith("(`ulimit -n`)")


def test_no_process_is_left(fmu: Fmu) -> None:
    if os.geteuid() != 0:
        pytest.skip("another user, who has no other process, needs root")

    def as_somebody_else() -> None:
        tempfile.tempdir = "/tmp"
        os.setgroups([])
        os.setresuid(NOBODY, NOBODY, NOBODY)
        limit(resource.RLIMIT_NPROC, 1)()

    said = refusal(fmu, as_somebody_else)
    assert said.startswith(
        "unit 'a': its process cannot be started: Resource temporarily unavailable: the limit"
    )
    assert said.endswith("is 1 (`ulimit -u`)")


def test_files_may_have_no_size(fmu: Fmu) -> None:
    said = refusal(fmu, limit(resource.RLIMIT_FSIZE, 1024))
    assert said.startswith(
        "unit 'a': its process cannot be started: File too large: the limit of a file's size"
    )


def test_a_disk_of_every_size_that_is_too_small(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = pair(tmp_path, 0)
    rider = build_fmu("Rider", tmp_path).path  # the built-in one is unpacked already
    path.write_text(path.read_text().replace('fmu = "Rider"', f'fmu = "{rider}"'))
    for pages in (1, 2, 4, 6):
        with small_disk(tmp_path / f"disk{pages}", pages) as folder:
            monkeypatch.setattr(tempfile, "tempdir", str(folder))
            with pytest.raises(ShortageError) as caught:
                Simulation(path, isolation="process")
            said = str(caught.value)
            assert said.startswith("unit '")
            assert "its process cannot be started" in said or "cannot be extracted" in said
            assert f"{folder}" in said
            assert "No space left on device: make room there, or let TMPDIR name another folder" in said
            assert list(folder.iterdir()) == []  # nothing is left


def test_a_folder_that_cannot_be_written(fmu: Fmu, tmp_path: Path) -> None:
    def lost() -> None:
        tempfile.tempdir = str(tmp_path / "is" / "not" / "there")

    said = refusal(fmu, lost)
    assert said.startswith(
        f"unit 'a': its process cannot be started: {tmp_path}/is/not/there: No such file or "
    )
    assert said.endswith("let TMPDIR name a folder that can be written")


def test_a_command_ends_with_the_words(tmp_path: Path) -> None:
    need_linux()
    command = [sys.executable, "-m", "evcosim", "run", str(pair(tmp_path, 0)), "-o", str(tmp_path / "out")]
    limits = {resource.RLIMIT_NOFILE: 12}

    def few() -> None:
        for kind, most in limits.items():
            resource.setrlimit(kind, (most, most))

    run = subprocess.run(command, preexec_fn=few, capture_output=True, text=True, check=False)
    assert run.returncode == 1
    assert run.stderr.startswith("evcosim: unit 'a': its process cannot be started: Too many open files: ")
    assert not (tmp_path / "out").exists()
