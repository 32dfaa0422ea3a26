"""The part of one unit in the plan, which the process of an isolated unit loads."""

from __future__ import annotations

import pickle
import subprocess
import sys

from evcosim.cosim.plan.unit_plan import SlotGroup
from support.car import BUS, SENT, plan
from support.mocks import real


def test_a_group_knows_its_names():
    group = SlotGroup("input", "Real", (real("a", "input"), real("b", "input")), 3)
    assert group.names == ("a", "b")


def test_it_loads_neither_the_files_nor_the_bus():
    code = "import sys, evcosim.cosim.plan.unit_plan; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(run.stdout.split())
    assert not {"numpy", "pydantic", "cantools", "evcosim.cosim.system", "evcosim.cosim.can"} & loaded


def test_it_crosses_to_another_process():
    for unit in plan([SENT], **BUS).units:
        assert pickle.loads(pickle.dumps(unit)) == unit
