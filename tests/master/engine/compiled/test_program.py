"""The program of the kernel: an operation for actions that can be joined, Python's act for the others."""

from __future__ import annotations

import ast
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from evcosim.master.engine.compiled.engine import CompiledEngine
from evcosim.master.engine.compiled.program import Program, _joined, direct
from evcosim.master.engine.initialization import initialize
from evcosim.master.machine import tables as L
from evcosim.master.simulation import Simulation
from support.c_fmu import mixed_fmu
from support.mocks import TICK, clock, plan_of, probe


def program_of_mocks(system=None, scenario=None):
    """The program of a clock and a probe, both written in Python."""
    units = [clock(), probe()]
    plan = plan_of(units, {"connect": TICK} | (system or {}), scenario)
    by_name = {unit.name: unit for unit in units}
    engine = CompiledEngine(plan, by_name)
    initialize(by_name, plan)
    engine.start()
    return Program(engine), engine


def kinds(program):
    return program.ops[:, L.KIND].tolist()


def test_units_written_in_python_are_acts_of_python():
    program, engine = program_of_mocks()
    assert [direct(turn.unit) for turn in engine.turns] == [None, None]
    assert kinds(program).count(L.PYTHON_ACT) == 4  # begin and end of each
    assert not program.holds_python
    acts = [program.actions[i] for i, kind in enumerate(kinds(program)) if kind == L.PYTHON_ACT]
    assert [engine.schedule[at].kind for at in acts] == ["begin", "end", "begin", "end"]


def test_a_chunk_has_the_operations_that_are_due_in_it():
    program, _ = program_of_mocks({"units": {"clock": {"period": 0.05}}})
    for k in (0, 3, 5, 12):
        ops, places = program.chunk(k, 2)
        assert ops.tolist() == program.ops[places].tolist()
        for row in program.ops[places]:
            due = [s for s in (k, k + 1) if s >= row[L.FIRST] and (s - row[L.FIRST]) % row[L.EVERY] == 0]
            assert row[L.DUE] == due[0]
    assert len(program.chunk(1, 2)[1]) < len(program.chunk(0, 5)[1])


@pytest.mark.parametrize("texts", [True, False])
def test_the_tables_of_a_unit_in_c(tmp_path, texts):
    fmu = mixed_fmu(tmp_path / "mixed.fmu", 3, 0)
    path = tmp_path / "one.toml"
    record = "" if texts else "record = ['*', '!a.shown']\n"
    path.write_text(f"name = 'one'\n{record}[units.a]\nfmu = '{fmu}'\n[experiment]\nstop_time = 0.1\n")
    with Simulation(path, engine="compiled", isolation="none") as simulation:
        program = simulation._engine._program
        (turn,) = simulation._engine.turns
        instance = direct(turn.unit)
        assert kinds(program).count(L.STEP) == 1
        # Python makes the calls that move texts and notes the texts of a row, nothing else
        schedule = simulation._engine.schedule
        notes = [at for at, action in enumerate(schedule) if action.kind == "note"]
        acts = [op[L.C] for op in program.ops.tolist() if op[L.KIND] == L.PYTHON_ACT]
        assert acts == ([len(schedule), *notes] if texts else []) and len(notes) == texts
        assert program.stepped == [instance]
        assert set(program.called) == {instance}
        assert program.units[0, L.COMPONENT] == instance.component
        assert program.units.view(np.float64)[0, L.STEP_SIZE] == 0.01
        assert len(program.call_rechecks) == len(program.calls)
        assert len(program.rechecks) == len(program.actions) == len(program.ops)


def shown(profile):
    """How often each kind of operation is in the scooter's program, and the names of its parts."""
    with Simulation("scooter", engine="compiled", profile=profile) as simulation:
        program, plan = simulation._engine._program, simulation.plan
        known = {
            "stimuli",
            "results",
            *(u.name for u in plan.units),
            *(f"{m.bus}.{m.message.name}" for m in plan.messages),
        }
        return Counter(kinds(program)), {name for name, _ in program.parts()}, known


def test_a_profile_keeps_parts_apart_that_are_else_one_operation():
    joined, _, _ = shown(profile=False)
    apart, parts, known = shown(profile=True)
    assert parts == known
    assert all(joined[kind] <= apart[kind] for kind in joined)
    assert joined.total() < apart.total()


def operation(kind, a=0, b=0, c=0, every=1):
    return {L.KIND: kind, L.EVERY: every, L.FIRST: 0, L.A: a, L.B: b, L.C: c}


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [
        (operation(L.TAKE, 3, 2), operation(L.TAKE, 5, 4), operation(L.TAKE, 3, 6)),
        (operation(L.TAKE, 3, 2), operation(L.TAKE, 6, 4), None),
        (operation(L.TAKE, 3, 2), operation(L.TAKE, 5, 4, every=2), None),
        (operation(L.SEND, 0, 2, -1), operation(L.SEND, 2, 1, -1), operation(L.SEND, 0, 3, -1)),
        (operation(L.SEND, 0, 2, 0), operation(L.SEND, 2, 1, 1), None),  # each has a log of its own
        (operation(L.COPY, 10, 20, 3), operation(L.COPY, 13, 23, 1), operation(L.COPY, 10, 20, 4)),
        (operation(L.COPY, 10, 20, 3), operation(L.COPY, 13, 24, 1), None),
        (operation(L.RECORD, 0, 5), operation(L.RECORD, 5, 5), None),
    ],
)
def test_operations_that_follow_each_other(before, after, expected):
    assert _joined(before, after) == expected


def test_no_two_places_of_the_tables_have_one_name():
    """A second assignment would give the columns of one table the numbers of another."""
    tree = ast.parse(Path(L.__file__).read_text(encoding="utf-8"))
    names = [
        node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    ]
    assert len(names) > 80
    assert sorted(set(names)) == sorted(names)
