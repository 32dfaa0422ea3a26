"""What is no file in the place of any file, and names that no file has, are refused by name, and at once."""

from __future__ import annotations

import contextlib
import io
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from evcosim.cosim.system.toml import DATA
from evcosim.master.builtin import fmu_file
from evcosim.master.cli import main
from support.forked import forked
from support.small_bench import bench

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no pipes with names")

SCENARIO = '[[stimulus]]\nto = "ecu.throttle_request"\ncsv = "CSV"\ninterpolation = "hold"\n'
SWAP = 'fmu = "FMU"\n'
RUN = "run s.toml --no-plot -q --engine python -o out --replace"


def long_file(path: Path) -> None:
    """Make a file without a byte on the disk."""
    with path.open("wb") as file:
        file.truncate(70 << 30)


PLACES = {
    "a system": (f"{RUN}", "s.toml"),
    "a system that is shown": ("info s.toml", "s.toml"),
    "a scenario": (f"{RUN} -s c.toml", "c.toml"),
    "a swap file": (f"{RUN} --swap vehicle=w.toml", "w.toml"),
    "a swap file that is checked": ("check w.toml --as s.toml.vehicle", "w.toml"),
    "the FMU of a unit": (RUN, "v.fmu"),
    "an FMU that is put in": (f"{RUN} --fmu vehicle=v.fmu", "v.fmu"),
    "an FMU that is shown": ("info v.fmu", "v.fmu"),
    "an FMU alone": ("run v.fmu -q", "v.fmu"),
    "an FMU that is compiled": ("compile v.fmu -o w.fmu", "v.fmu"),
    "the FMU of a swap file": ("check w.toml --as s.toml.vehicle", "v.fmu"),
    "a database": (RUN, "a.dbc"),
    "a table": (f"{RUN} -s c.toml", "t.csv"),
    "a table of an FMU alone": ("run Scooter --input throttle=t.csv -q --stop-time 0.03", "t.csv"),
    "results": ("compare t.csv q.csv", "t.csv"),
    "results that are drawn": ("plot t.csv", "t.csv"),
    "rows that were saved": ("plot k", "k/results.rows"),
}
ODD: dict[str, Callable[[Path], object]] = {
    "a folder": lambda path: path.mkdir(),
    "a pipe": lambda path: os.mkfifo(path),
    "a device without an end": lambda path: path.symlink_to("/dev/zero"),
    "a link to itself": lambda path: path.symlink_to(path.name),
    "70 GB of zeros": lambda path: long_file(path),
}


def made(folder: Path, fmu: str = "v.fmu", dbc: str = "a.dbc", csv: str = "t.csv") -> None:
    """Write good files of all kinds, which name these ones."""
    (folder / "s.toml").write_text(bench(dbc, fmu))
    (folder / "c.toml").write_text(SCENARIO.replace("CSV", csv))
    (folder / "w.toml").write_text(SWAP.replace("FMU", fmu))
    shutil.copy(fmu_file("Scooter"), folder / "v.fmu")
    shutil.copy(DATA / "can" / "ev.dbc", folder / "a.dbc")
    for name in ("t.csv", "q.csv", "k/results.rows"):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text("time,a\n0.0,1.0\n1.0,2.0\n")


def outcome(command: str) -> tuple[int, str]:
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        code = main(command.split())
    return code, said.getvalue()


def refused(code: int, said: str, *names: str) -> bool:
    clean = "unexpected error" not in said and "Traceback" not in said
    return code == 2 and clean and any(name in said for name in names) and len(said) < 2000


@pytest.mark.parametrize("place", PLACES)
def test_what_is_no_file_is_refused_by_name(place, tmp_path, monkeypatch):
    command, name = PLACES[place]
    made(tmp_path)
    monkeypatch.chdir(tmp_path)

    def tried() -> list[tuple[int, str]]:
        found = []
        for make in ODD.values():
            path = tmp_path / name
            shutil.rmtree(path) if path.is_dir() else path.unlink()
            make(path)
            found.append(outcome(command))
        return found

    found = forked(tried, limit=60.0)
    assert not found.crash, found.crash
    for odd, (code, said) in zip(ODD, found.value, strict=True):
        assert refused(code, said, Path(name).name, "k/results"), f"{place} is {odd}: {code}: {said[:1000]}"


@pytest.mark.parametrize(
    "name", ["a\\u0000b", "\\u0000", "x/../../\\u0000", "a" * 5000, "a/" * 3000, "\\ud7ff"]
)
@pytest.mark.parametrize("key", ["fmu", "dbc", "csv"])
def test_a_name_that_no_file_has_is_refused(key, name, tmp_path, monkeypatch):
    made(tmp_path, **{key: name})
    monkeypatch.chdir(tmp_path)
    code, said = outcome(f"{RUN} -s c.toml" if key == "csv" else RUN)
    assert refused(code, said, f"{key}", "s.toml"), said[:1000]
