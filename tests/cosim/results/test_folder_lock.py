"""One process at a time writes into a folder, and its end ends the lock."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.folder_lock import FolderLock, lives, status

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no flock")


def test_the_second_is_refused_while_the_first_lives(tmp_path: Path) -> None:
    folder = tmp_path / "new" / "out"
    with FolderLock(folder):
        assert lives(folder)
        with pytest.raises(ConfigError, match=f"output folder {folder}: another run is writing into it"):
            FolderLock(folder)
    assert not lives(folder)
    FolderLock(folder).release()
    assert list(folder.iterdir()) == []


def test_the_first_is_named(tmp_path: Path) -> None:
    process = {"id": 7, "host": "here", "since": "2026-01-01T00:00:00+00:00"}
    about = {"status": "running", "system": "scooter", "scenario": "fig8", "process": process}
    (tmp_path / "run.json").write_text(json.dumps(about))
    with FolderLock(tmp_path), pytest.raises(ConfigError, match="the run 'scooter fig8', process 7 on here"):
        FolderLock(tmp_path)


def test_the_lock_ends_with_its_process(tmp_path: Path) -> None:
    code = (
        "import sys, time; from pathlib import Path\n"
        "from evcosim.cosim.results.folder_lock import FolderLock\n"
        "lock = FolderLock(Path(sys.argv[1])); print('locked', flush=True); time.sleep(60)"
    )
    with subprocess.Popen([sys.executable, "-c", code, str(tmp_path)], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        assert lives(tmp_path)
        process.kill()
        process.wait()
    assert not lives(tmp_path)


def test_a_run_that_does_not_live_was_killed(tmp_path: Path) -> None:
    assert status(tmp_path, {"status": "running"}) == "killed"
    assert status(tmp_path, {"status": "failed"}) == "failed"
    assert status(tmp_path, {}) is None
    with FolderLock(tmp_path):
        assert status(tmp_path, {"status": "running"}) == "running"


def test_a_file_in_the_place_of_the_folder_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(ConfigError, match=r"cannot be written: .*file is a file, not a folder"):
        FolderLock(tmp_path / "file" / "out")
