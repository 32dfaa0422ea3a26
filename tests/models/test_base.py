"""Declarations: what a record says of its variables, and which contradictions are refused."""

from __future__ import annotations

import copy
import dataclasses
import enum
import math
import pickle
from functools import cached_property
from typing import Any

import pytest

from evcosim.models.base import Model, record, time, var, variables, violations


class Mode(enum.IntEnum):
    """Two modes."""

    OFF = 0
    ON = 1


@record
class Everything:
    """One variable of each kind."""

    now: float = time()
    real: float = var(1.0, "m", "A length", min=0.0, max=2.0)
    whole: int = var(3, "", "A count", min=1)
    flag: bool = var(True, "", "A choice")
    mode: Mode = var(Mode.ON, "", "A mode")


@record
class Derived:
    """A record that caches what derives from it."""

    real: float = var(1.0, "m", "A length")

    @cached_property
    def twice(self) -> float:
        """Twice the length [m]."""
        return 2.0 * self.real


@record
class Longer(Everything):
    """A record that extends another."""

    force: float = var(0.0, "N", "A force")


@record
class Nothing:
    """No variable."""


@record
class In:
    """One input."""

    force: float = var(0.0, "N", "A force")


@record
class Position:
    """One output that feeds nothing through."""

    position: float = var(0.0, "m", "A position")


@record
class Direct:
    """One output that feeds the force through."""

    position: float = var(0.0, "m", "A position", depends=("force",))


UNDECLARED = dataclasses.make_dataclass("Outputs", [("speed", float, 0.0)])


def held(p: Any, x: Any) -> Any:
    """Outputs without inputs."""
    return Position()


def direct(p: Any, x: Any, u: Any) -> Any:
    """Outputs of inputs."""
    return Direct()


def declare(**changed: Any) -> type[Model]:
    """A model of the records above, with some of its parts changed."""
    parts = {
        "Parameters": Nothing,
        "Inputs": In,
        "State": Nothing,
        "Outputs": Position,
        "initial": staticmethod(held),
        "step": staticmethod(held),
        "outputs": staticmethod(held),
    }
    return type("Toy", (Model,), {**parts, **changed})


def test_the_start_gives_the_type() -> None:
    found = {v.name: v for v in variables(Everything)}
    assert [v.type for v in found.values()] == ["Real", "Real", "Integer", "Boolean", "Enumeration"]
    assert found["mode"].enumeration is Mode
    assert found["real"].enumeration is None
    assert [v.name for v in found.values() if v.independent] == ["now"]
    assert (found["real"].unit, found["real"].min, found["real"].max) == ("m", 0.0, 2.0)


def test_a_start_of_no_fmi_type_is_refused() -> None:
    @record
    class Text:
        name: str = var("text", "", "No FMI type of ours")  # type: ignore[arg-type]  # the mistake under test

    with pytest.raises(TypeError, match="'text'"):
        variables(Text)


def test_violations_name_variable_rule_and_values() -> None:
    assert violations(Everything()) == []
    assert violations(Everything(real=-1.0)) == ["real = -1.0 m is below its minimum 0.0 m"]
    assert violations(Everything(real=3.0, whole=0)) == [
        "real = 3.0 m is above its maximum 2.0 m",
        "whole = 0 is below its minimum 1",
    ]
    assert violations(Everything(real=math.nan)) == ["real = nan is not a finite number"]


def test_a_record_is_made_as_a_dataclass_is() -> None:
    made = Everything(2.5, 1.5, whole=4)
    assert dataclasses.astuple(made) == (2.5, 1.5, 4, True, Mode.ON)
    for values, named in (((), {"other": 1}), (range(9), {}), ((1.0,), {"now": 2.0})):
        with pytest.raises(TypeError, match="__init__"):
            Everything(*values, **named)


@pytest.mark.parametrize("made", [Everything(real=1.5), Derived(2.0), Longer(real=3.0, force=1.0)])
def test_a_record_is_frozen_and_can_be_copied(made: Any) -> None:
    """With slots, with what it caches, and as an extension of another record."""
    with pytest.raises(dataclasses.FrozenInstanceError):
        made.real = 2.0
    for same in (copy.copy(made), copy.deepcopy(made), pickle.loads(pickle.dumps(made))):
        assert same == made
        assert type(same) is type(made)
        assert hash(same) == hash(made)
    assert dataclasses.replace(made, real=0.5) != made
    assert dataclasses.asdict(dataclasses.replace(made, real=0.5)) == dataclasses.asdict(made) | {"real": 0.5}


def test_what_a_record_caches_belongs_to_it() -> None:
    assert [Derived(x).twice for x in (1.0, 2.0)] == [2.0, 4.0]


def test_a_record_that_caches_keeps_its_hash_but_does_not_pickle_it() -> None:
    """An enumeration among its fields has another hash in another process."""
    made, fresh = Derived(2.0), pickle.dumps(Derived(2.0))
    assert hash(made) == hash(made) == hash(Derived(2.0)) != hash(Derived(3.0))
    assert pickle.dumps(made) == fresh


def test_feedthrough_is_read_from_outputs() -> None:
    assert not declare().feeds_through()
    assert declare(Outputs=Direct, outputs=staticmethod(direct)).feeds_through()


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"Outputs": In}, "force is declared twice, in Inputs and in Outputs"),
        ({"Outputs": object}, "Outputs lacks its '@record'"),
        ({"State": None}, "State lacks its '@record'"),
        (
            {"Outputs": UNDECLARED},
            r"Outputs\.speed: write var",
        ),
        (
            {"Outputs": Direct, "outputs": staticmethod(direct), "Inputs": Nothing},
            "depends on force, which is no input",
        ),
        ({"initial_inputs": ("speed",)}, r"initial_inputs names \['speed'\]"),
        ({"Outputs": Direct}, "if, and only if"),
        ({"outputs": staticmethod(direct)}, "if, and only if"),
    ],
)
def test_contradictions_are_refused(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(TypeError, match=message):
        declare(**changed)


@pytest.mark.parametrize("name", ["Parameters", "Inputs", "State", "Outputs", "initial", "step", "outputs"])
def test_a_part_that_is_not_there_is_named(name: str) -> None:
    parts = {key: value for key, value in vars(declare()).items() if not key.startswith("__")}
    del parts[name]
    with pytest.raises(TypeError, match=rf"Bare: there is no (record|function) {name}"):
        type("Bare", (Model,), parts)
