"""Native FMUs in the cache: built once, refused once, compared once; and the names of files in failures."""

from __future__ import annotations

import importlib
import shutil
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import fmpy
import pytest

from evcosim.fmus import recipes, records
from evcosim.fmus.build import build_model
from evcosim.fmus.catalog import Experiment
from evcosim.fmus.native import basis, build, check, emit, lower, toolchain
from evcosim.fmus.native.build import difference, native_built, native_parts, why_not
from evcosim.fmus.native.errors import ToolchainError, Unsupported
from evcosim.fmus.native.package import build_native
from evcosim.fmus.recipes import recipe_of
from evcosim.models.base import Model
from support import compiled_once
from support.needs import need_c_compiler

MODEL = '''
"""A model of a user's own, which fails where a helper in a file beside it divides by 0."""
from evcosim.models.base import Model, record, var
from share.parts import part


class Divided(Model):
    "A number divided by another."

    @record
    class Parameters:
        top: float = var(1.0, "", "Numerator")

    @record
    class Inputs:
        bottom: float = var(1.0, "", "Denominator")

    @record
    class State:
        x: float = var(0.0, "", "Quotient")

    @record
    class Outputs:
        y: float = var(0.0, "", "Quotient")

    @staticmethod
    def initial(p, u):
        return Divided.State()

    @staticmethod
    def step(p, x, u, dt):
        if u.bottom == 2.0:
            raise ValueError(f"{u.bottom:g} is not taken")
        return Divided.State(part(p.top, u.bottom))

    @staticmethod
    def outputs(p, x):
        return Divided.Outputs(x.x)
'''
PART = "def part(a, b):\n    return a / b\n"


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache of the test's own."""
    need_c_compiler()
    monkeypatch.setenv("EVCOSIM_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture
def divided(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[type[Model]]:
    """The model of a user's own, with a helper in a package beside it."""
    (tmp_path / "share").mkdir()
    (tmp_path / "share" / "__init__.py").write_text("")
    (tmp_path / "share" / "parts.py").write_text(PART)
    (tmp_path / "divided.py").write_text(MODEL)
    monkeypatch.syspath_prepend(str(tmp_path))
    yield importlib.import_module("divided").Divided
    for name in ("divided", "share", "share.parts"):
        del sys.modules[name]


def fails(*_: Any, **__: Any) -> Any:
    """Stand for what must not be called any more."""
    raise AssertionError("done again")


def fake_compiler(folder: Path, text: str) -> Path:
    """Write a program that passes for a compiler."""
    path = folder / "fakecc"
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return path


@pytest.mark.parametrize("content", [None, b"", b"damaged"])
def test_an_fmu_whose_record_is_lost_is_made_anew_and_stays_ours(
    content: bytes | None, own_cache: Path
) -> None:
    built = native_built("Rider")
    (record,) = own_cache.glob("built-here-*")
    record.unlink() if content is None else record.write_bytes(content)
    assert not records.is_own(record.name.removeprefix("built-here-"))
    before = built.read_bytes()
    assert native_built("Rider") == built
    assert built.read_bytes() == before
    assert records.is_own(record.name.removeprefix("built-here-"))


def test_a_native_fmu_is_found_without_model_translator_and_compiler(
    own_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = native_built("Battery")
    assert first.parent == own_cache and first.name.startswith("Battery_native_")
    assert difference("Battery") == "" == why_not("Battery")
    for place, name in (
        (lower, "lower"),
        (emit, "c_source"),
        (check, "first_difference"),
        (build, "import_module"),
    ):
        monkeypatch.setattr(place, name, fails)
    monkeypatch.setattr(toolchain, "compiler", fails)
    assert native_built("Battery") == first
    assert difference("Battery") == "" == why_not("Battery")
    with pytest.raises(AssertionError, match="done again"):
        difference("Battery", 999)  # that many have not been compared
    with pytest.raises(AssertionError, match="done again"):
        native_built("Battery", anew=True)


def test_a_native_fmu_is_one_of_ours_and_the_same_when_it_is_built_anew() -> None:
    first = native_built("Battery")
    content = first.read_bytes()
    assert fmpy.read_model_description(first).modelName == "Battery"
    assert records.is_own(_digest(content))
    assert not records.is_own(_digest(content + b" "))
    compiled_once.forget()
    assert native_built("Battery", anew=True).read_bytes() == content


def _digest(content: bytes) -> str:
    import hashlib

    return hashlib.sha256(content).hexdigest()


def test_a_damaged_one_is_made_anew(capsys: pytest.CaptureFixture[str]) -> None:
    path = native_built("Battery")
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    assert native_built("Battery").read_bytes() == content
    assert "is damaged" in capsys.readouterr().err


def test_another_translator_runtime_python_or_model_is_another_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(toolchain, "compiled", lambda folder, sources, target: b"a library")
    names = {native_built("Battery").name}
    for changed in ("emit_blocks.py", "c/instance.c", "c/python_math.h"):
        shutil.copytree(build._HERE, tmp_path / changed.replace("/", "-"))
        with (tmp_path / changed.replace("/", "-") / changed).open("a") as file:
            file.write("\n")
        with monkeypatch.context() as other:
            other.setattr(build, "_HERE", tmp_path / changed.replace("/", "-"))
            names.add(native_built("Battery").name)
    with monkeypatch.context() as other:
        other.setattr(build, "python_minor", lambda: 99)
        names.add(native_built("Battery").name)
    with monkeypatch.context() as other:
        other.setattr(build, "catalog_digests", lambda name: recipes.Digests("0" * 32, "1" * 32))
        names.add(native_built("Battery").name)
    assert len(names) == 6


@pytest.mark.parametrize(("minor", "followed"), [(9, 11), (11, 11), (13, 13), (14, 14), (20, 14)])
def test_the_python_that_is_followed_is_one_that_the_runtime_knows(
    minor: int, followed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(basis, "sys", _Version(minor))
    assert basis.python_minor() == followed


class _Version:
    def __init__(self, minor: int) -> None:
        self.version_info = type("Info", (), {"minor": minor})


def test_the_mathematical_library_is_known_by_its_file() -> None:
    library = basis.mathematical_library()
    assert len(library) == 4
    assert sys.platform != "linux" or len(library[-1]) == 64


# -- what is not built ---------------------------------------------------------------------------------------


def test_a_model_without_a_native_form_is_lowered_once(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = []

    def refuse(model: type[Model]) -> None:
        tried.append(model.__name__)
        raise Unsupported("battery.py:75: x.append(1): a list that grows; write [0.0] * N")

    monkeypatch.setattr(lower, "lower", refuse)
    for _ in range(3):
        assert why_not("Battery").startswith("battery.py:75: x.append(1)")
    with pytest.raises(Unsupported, match=r"battery\.py:75"):
        difference("Battery")
    assert tried == ["Battery"]


def test_a_compiler_that_fails_is_not_asked_again_until_it_is_another(
    own_cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = tmp_path / "calls"
    path = fake_compiler(tmp_path, f"echo called >> {calls}\necho 'model.c:1: it is broken' >&2\nexit 3")
    monkeypatch.setenv("CC", str(path))
    for _ in range(3):
        said = why_not("Battery")
        assert "it is broken" in said and "exit code 3" in said
    assert calls.read_text().count("called") == 1
    assert not list(own_cache.glob("*.fmu"))
    fake_compiler(tmp_path, 'exec cc "$@"')
    assert why_not("Battery") == ""


def test_without_a_compiler_nothing_is_lowered_and_nothing_is_kept(
    own_cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lower, "lower", fails)
    with monkeypatch.context() as bare:
        bare.delenv("CC", raising=False)
        bare.setenv("PATH", str(tmp_path))
        bare.setattr(toolchain, "has_zig", lambda: False)
        with pytest.raises(ToolchainError, match="there is no C compiler here"):
            native_built("Battery")
    assert not list(own_cache.glob("native-*"))
    monkeypatch.undo()
    monkeypatch.setenv("EVCOSIM_CACHE", str(own_cache))
    assert why_not("Battery") == ""


def test_an_unknown_name_has_the_nearest() -> None:
    with pytest.raises(ValueError, match="did you mean 'Battery'"):
        native_built("Batery")


# -- names of files ------------------------------------------------------------------------------------------


def test_a_failure_has_the_words_and_the_file_of_the_python_fmu(
    divided: type[Model], tmp_path: Path, load: Callable[[Path], Any]
) -> None:
    recipe = recipe_of("Divided", "divided", tmp_path / "divided.py", Experiment(), "", "")
    paths = (
        build_model(divided, tmp_path / "python"),
        build_native(native_parts(recipe, divided), tmp_path / "native"),
    )
    said: list[list[str]] = []
    for path in paths:
        unit = load(path)
        unit.initialize()
        before = len(unit.log)
        for value in (0.0, 2.0):
            unit.set({"bottom": value})
            with pytest.raises(Exception, match="fmi2DoStep"):
                unit.fmu.doStep(0.0, 0.01)
        said.append([text.rpartition("\n")[2] for _, _, text in unit.log[before:]])
    assert said[0] == said[1]
    assert said[1][0].endswith("(share/parts.py:2)")
    line = MODEL.partition("raise ValueError")[0].count("\n") + 1
    assert said[1][1].endswith(f"ValueError: 2 is not taken (divided.py:{line})")
