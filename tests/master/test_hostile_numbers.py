"""A number at the edge of what there is, at any key of any file, makes a run or a message, never a crash."""

from __future__ import annotations

import copy
import functools
import math
import os
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel

from evcosim.cosim.swap.swap_file import SwapFile
from evcosim.cosim.system.scenario import ScenarioFile, load_scenario
from evcosim.cosim.system.system import SystemFile, load_system
from evcosim.master.simulation import Simulation
from support.every_key import DATABASE, LOG, ON_FRAMES, SWAP, SYSTEM
from support.forked import forked
from support.numeric_keys import Place, numeric_places, with_value
from support.said import said_of

HOSTILE = [1e308, -1e308, 5e-324, math.inf, math.nan, 0, -1, 1e-10, 2**63, -(2**63) - 1, 10**400, 10**5000]
WRONG = [True, "0.5", [1]]
KINDS: dict[str, tuple[type[BaseModel], str]] = {
    "system": (SystemFile, SYSTEM),
    "scenario": (ScenarioFile, ON_FRAMES),
    "swap": (SwapFile, SWAP),
}
UNWRITTEN = re.compile(r"[^\w .,:;/%*+()\[\]-]", re.ASCII)
"""What a TOML text does not have as it is here; an escape is read ten times as slowly."""

PLACES = [(kind, place) for kind, (model, _) in KINDS.items() for place in numeric_places(model)]


def toml(value: Any) -> str:
    """Return a value as an inline part of a TOML text."""
    match value:
        case bool():
            return str(value).lower()
        case float():
            return repr(value)
        case int():
            return hex(value) if value > 10**4000 else str(value)  # Python writes no longer one in decimals
        case str():
            return '"' + UNWRITTEN.sub(lambda found: f"\\u{ord(found[0]):04x}", value) + '"'
        case list():
            return f"[{', '.join(map(toml, value))}]"
        case _:
            return f"{{{', '.join(f'{toml(key)} = {toml(inner)}' for key, inner in value.items())}}}"


def _limited(document: Any, place: Any) -> Any:
    """Return the document with a process for the unit whose limit stands at a place: else it has none."""
    if str(place[-1]).endswith(("_limit", "_timeout")):
        (document["units"]["ecu"] if "units" in document else document)["isolation"] = "process"
    return document


def whole(document: Any) -> str:
    """Return a file with this document."""
    return "\n".join(f"{toml(key)} = {toml(value)}" for key, value in document.items())


@functools.cache
def parsed(kind: str) -> Any:
    """Return the document with nothing hostile."""
    return tomllib.loads(KINDS[kind][1])


@functools.cache
def good(kind: str) -> str:
    """Return its file."""
    return whole(parsed(kind))


def written(folder: Path, kind: str, document: Any) -> dict[str, Path]:
    """Write the three files, one of them with this document, and return their paths."""
    (folder / "bench.dbc").write_text(DATABASE)
    (folder / "bench.log").write_text(LOG)
    paths = {}
    for name in KINDS:
        paths[name] = folder / f"{name}.toml"
        paths[name].write_text(whole(document) if name == kind else good(name))
    return paths


def outcome(paths: dict[str, Path], kind: str, place: Place = ()) -> str:
    """Run, evaluate and draw what a place is of, and return what was said, or "done"."""
    swaps = {"vehicle": paths["swap"]} if kind == "swap" else {}
    scenario = paths["scenario"] if kind == "scenario" else None

    def run() -> None:
        if place[:1] in (("identification",), ("budget",)):  # which no run reads
            load_scenario(load_system(str(paths["system"])), str(paths["scenario"]))
            return
        with Simulation(paths["system"], scenario, swaps=swaps, engine="python") as simulation:
            simulation.run()
        results = simulation.results
        results.metrics()
        if "figure" in place:
            results.plot(paths["system"].with_name("figure.png"))

    return said_of(run)


def test_the_files_run_as_they_are(tmp_path):
    for kind in KINDS:
        assert outcome(written(tmp_path, kind, parsed(kind)), kind) == "done"


def test_the_keys_that_everybody_writes_are_found():
    found = {(kind, *place) for kind, place in PLACES}
    assert {
        ("system", "experiment", "step_size"),
        ("system", "units", "*", "parameters", "*"),
        ("system", "buses", "*", "delay"),
        ("system", "connect", 0, "initial"),
        ("scenario", "stimulus", 0, "table", 0, 1),
        ("scenario", "event", 0, "value"),
        ("scenario", "fault", 0, "period"),
        ("scenario", "stimulus", 0, "time_offset"),
        ("scenario", "parameters", "*", "*"),
        ("swap", "memory_limit"),
    } <= found
    assert len(found) > 70


@pytest.mark.skipif(not hasattr(os, "fork"), reason="each key is tried in a child of this process")
@pytest.mark.parametrize(
    ("kind", "place"), PLACES, ids=lambda v: v if isinstance(v, str) else ".".join(map(str, v))
)
def test_a_hostile_number_is_used_or_refused(kind, place, tmp_path):
    values = [*HOSTILE, *WRONG]

    def tried() -> list[str]:
        documents = [
            _limited(with_value(copy.deepcopy(parsed(kind)), place, value), place) for value in values
        ]
        return [outcome(written(tmp_path, kind, document), kind, place) for document in documents]

    found = forked(tried, limit=60.0)
    assert not found.crash, found.crash
    names = [part for part in place if isinstance(part, str) and part != "*"]
    for value, said in zip(values, found.value, strict=True):
        shown = value if isinstance(value, str) else toml(value)[:40]
        assert said.startswith(("done", "refused", "ended")), f"{shown}: {said}"
        named = any(name in said for name in (*names[-2:], shown))
        assert not said.startswith("refused") or named, f"{shown}: {said}"
        assert len(said) < 2000, f"{shown}: {said}"
