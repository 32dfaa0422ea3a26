"""Descriptions that were read once are kept, and say all that FMPy's say; FMPy is not imported for them."""

from __future__ import annotations

import inspect
import math
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from evcosim.fmus import cache
from evcosim.fmus.build import built
from evcosim.master.builtin import builtin_names, fmu_file
from evcosim.master.fmi import fmu as reading
from evcosim.master.fmi import stored
from evcosim.master.fmi.fmu import read_fmu
from support.c_fmu import mixed_fmu
from support.needs import need_c_compiler


def require_alike(one: Any, other: Any, seen: dict[int, int]) -> None:
    """Fail unless plain objects say what FMPy's objects say, with the same objects in several places."""
    if isinstance(one, list | tuple):
        assert len(one) == len(other)
        for a, b in zip(one, other, strict=True):
            require_alike(a, b, seen)
    elif hasattr(one, "__attrs_attrs__"):
        if id(one) in seen:
            assert seen[id(one)] == id(other)
            return
        seen[id(one)] = id(other)
        names = {field.name for field in one.__attrs_attrs__}
        names |= {name for name, _ in inspect.getmembers(type(one), lambda each: isinstance(each, property))}
        names = {name for name in names if not name.startswith("_")}
        assert set(vars(other)) == names
        for name in names:
            require_alike(getattr(one, name), getattr(other, name), seen)
    else:
        assert type(one) is type(other) and repr(one) == repr(other)


@pytest.mark.parametrize("units", ["python", "native"])
def test_what_is_kept_is_what_was_read(units: str) -> None:
    if units == "native":
        need_c_compiler()
    for name in builtin_names():
        said = reading._said(fmu_file(name, units=units))
        again = stored.unpacked(stored.packed(said))
        require_alike(said.description, again.description, {})
        assert said[1:] == again[1:]


def test_other_fmus_come_back_too_and_what_json_has_not_is_refused(tmp_path: Path) -> None:
    for fmi in (1, 2, 3):
        said = reading._said(mixed_fmu(tmp_path / f"{fmi}.fmu", fmi))
        again = stored.unpacked(stored.packed(said))
        require_alike(said.description, again.description, {})
        assert said[1:] == again[1:]
    said.description.modelName = {"a": 1}
    with pytest.raises(TypeError, match="dict is no part of a description"):
        stored.packed(said)


def test_numbers_keep_their_types_and_signs() -> None:
    texts = [1, 1.0, True, 0.0, -0.0, math.inf, 1e-320, "1", None]
    made = [stored.SimpleNamespace(x=x) for x in texts]
    root = stored.SimpleNamespace(all=made, first=made[0])
    again = stored.unpacked(stored.packed(stored.Said(root, (), 0, (), frozenset(), None))).description
    assert [repr(each.x) for each in again.all] == [repr(x) for x in texts]
    assert again.first is again.all[0]


@pytest.fixture
def battery(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A built-in FMU in a cache of the test's own, which nobody has read."""
    there = built("Battery")
    folder = tmp_path / "cache"
    folder.mkdir(mode=0o700)
    for suffix in ("", ".sha256"):
        shutil.copyfile(f"{there}{suffix}", folder / f"{there.name}{suffix}")
    monkeypatch.setenv("EVCOSIM_CACHE", str(folder))
    return folder / there.name


def test_a_built_in_fmu_is_read_once(battery: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = read_fmu(battery)
    assert [each.name[:12] for each in battery.parent.glob("description-*")] == ["description-"]
    reading._kept.clear()
    monkeypatch.setattr(reading, "read_description", None)
    again = read_fmu(battery)
    assert type(again.description) is type(first.description) and again.description is not first.description
    assert (again.interface, again.digest, again.binary) == (first.interface, first.digest, first.binary)
    assert again.digest == cache.digest_of(battery)


def test_a_damaged_or_foreign_file_and_another_reader_are_read(
    battery: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    read_fmu(battery)
    (copy := tmp_path / "copy.fmu").write_bytes(battery.read_bytes())
    (entry,) = battery.parent.glob("description-*")
    calls: list[Path] = []
    read = reading.read_description
    monkeypatch.setattr(reading, "read_description", lambda path, xml: calls.append(path) or read(path, xml))
    for path in (copy, battery, battery):
        reading._kept.clear()
        read_fmu(path)
    assert calls == [copy]
    entry.write_bytes(entry.read_bytes().replace(b"Battery", b"Bbttery"))
    reading._kept.clear()
    assert read_fmu(battery).description.modelName == "Battery"
    assert "is damaged" in capsys.readouterr().err and calls == [copy, battery]
    monkeypatch.setattr(stored, "_of_readers", lambda: "another")
    reading._kept.clear()
    read_fmu(battery)
    assert calls == [copy, battery, battery]
    battery.write_bytes(battery.read_bytes() + b"\0")  # what its record says is not what it is
    reading._kept.clear()
    assert read_fmu(battery).digest != cache.digest_of(battery)
    assert len(calls) == 4


def test_a_run_of_built_in_fmus_does_without_fmpy(tmp_path: Path) -> None:
    code = (
        "import sys; from evcosim import simulate; simulate('scooter', stop_time=0.1, engine='python'); "
        "print({'fmpy', 'lxml', 'attr'} & set(sys.modules))"
    )
    told = [
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    ]
    assert told[1] == "set()\n"
