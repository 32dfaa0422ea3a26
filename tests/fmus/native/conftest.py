"""One model in Python and by hand in C, as two FMUs that must be the same to whoever calls them."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from evcosim.fmus.build import build_model
from evcosim.fmus.catalog import Experiment
from evcosim.fmus.native.package import NativeParts, build_native, identity_of, token_of
from evcosim.fmus.recipes import digest_of
from evcosim.models.base import Model
from support.compiled_once import compiled_once as compiled_once
from support.needs import need_c_compiler

HANDMADE = Path(__file__).with_name("handmade")
KINDS = {"Handmade": "", "HandmadeSampled": "#define SAMPLED\n", "HandmadePlain": "#define PLAIN\n"}


def _lines(text: str) -> list[int]:
    """Return the numbers of the lines of handmade.py that contain a text."""
    lines = (HANDMADE / "handmade.py").read_text(encoding="utf-8").splitlines()
    return [number for number, line in enumerate(lines, 1) if text in line]


def _zero_division() -> str:
    try:
        return str(1.0 / 0.0)
    except ZeroDivisionError as error:
        return str(error)


def handmade_parts(name: str, more: str = "") -> NativeParts:
    """Return what the native FMU of one of the kinds is made of; `more` stands before its C."""
    model = getattr(import_module("handmade"), name)
    feeding = dict(zip(("Handmade", "HandmadeSampled"), _lines("x.total / (u.speed - 666.0)"), strict=True))
    digest = digest_of(
        [name.encode(), more.encode(), *(f.read_bytes() for f in sorted(HANDMADE.glob("*.*")))]
    )[:32]
    defined = {
        "NAME": f'"{name}"',
        "IDENTITY": f'"{identity_of(name, digest)}"',
        "TOKEN": f'"{token_of(digest)}"',
        "ZERO_DIVISION": f'"{_zero_division()}"',
        "LINE_OF_RUNTIME_ERROR": _lines("raise RuntimeError")[0],
        "LINE_OF_VALUE_ERROR": _lines("raise ValueError")[0],
        "LINE_OF_STEP": _lines("/ p.divisor")[0],
        "LINE_OF_OUTPUTS": feeding.get(name, 0),
    }
    head = "".join(f"#define {key} {value}\n" for key, value in defined.items())
    text = more + head + KINDS[name] + (HANDMADE / "model.c").read_text(encoding="utf-8")
    return NativeParts(model, text, digest, Experiment(), "1.2", "MIT")


@pytest.fixture(autouse=True)
def _compiled_once(compiled_once: None) -> None:
    """Compile the same sources once."""


class Pair(NamedTuple):
    """A model and its FMUs."""

    model: type[Model]
    python: Path
    native: Path


@pytest.fixture(scope="session")
def handmade() -> Iterator[None]:
    """The models of the folder can be imported by name."""
    sys.path.insert(0, str(HANDMADE))
    yield
    sys.path.remove(str(HANDMADE))


@pytest.fixture(scope="session")
def parts(handmade: None) -> Callable[..., NativeParts]:
    """Return what a native FMU is made of, by the name of its kind."""
    need_c_compiler()
    return handmade_parts


@pytest.fixture(scope="session")
def pairs(parts: Callable[..., NativeParts], tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Pair]:
    """Build both FMUs of a kind, once; the native one is of FMI 2.0 or 3.0."""
    made: dict[tuple[str, int], Pair] = {}

    def pair(name: str, fmi: int = 2) -> Pair:
        if (name, fmi) not in made:
            of_this, folder = parts(name), tmp_path_factory.mktemp("native")
            python = build_model(of_this.model, tmp_path_factory.mktemp("python"))
            made[name, fmi] = Pair(of_this.model, python, build_native(of_this, folder, fmi=fmi))
        return made[name, fmi]

    return pair


class Both:
    """A Python FMU and a native one, called alike; what they say is compared word for word."""

    def __init__(self, pair: Pair, load: Callable[[Path], Any], bits: Callable[[Any], Any]) -> None:
        self.model, self._bits = pair.model, bits
        self.units = [load(pair.python), load(pair.native)]
        self.said: list[list[str]] = [[], []]
        self.references = {name: v.valueReference for name, v in self.units[0].variables.items()}

    def call(self, name: str, *arguments: Any) -> Any:
        """Call a function of FMPy's wrapper on both; return the value, or the words of the failure."""
        return self.do(lambda unit: getattr(unit.fmu, name)(*arguments))

    def do(self, action: Callable[[Any], Any]) -> Any:
        """Do something with both; return the same value or the same words."""
        found = []
        for unit, said in zip(self.units, self.said, strict=True):
            before = len(unit.log)
            try:
                value = action(unit)
            except Exception as error:  # FMPy raises its own for each status
                value = f"{type(error).__name__}: {error}" if unit.log[before:] == [] else None
            messages = [_words(text) for _, _, text in unit.log[before:]]
            said += messages
            found.append((self._bits(value) if _is_plain(value) else value, value, messages))
        assert found[0][0] == found[1][0]
        assert found[0][2] == found[1][2]
        return found[0][2] or found[1][1]


def _is_plain(value: Any) -> bool:
    return isinstance(value, list | dict | float) and not isinstance(value, str)


def _words(message: str) -> str:
    """Return a message without what pythonfmu writes above it."""
    return message.partition("\n")[2] if message.startswith("Fatal py exception") else message


@pytest.fixture
def both(
    pairs: Callable[[str], Pair], load: Callable[[Path], Any], bits: Callable[[Any], Any]
) -> Callable[[str], Both]:
    """Instantiate both FMUs of a kind."""
    return lambda name: Both(pairs(name), load, bits)
