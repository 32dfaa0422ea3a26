"""Faults of a scenario: what they name, and what they do to a run, in both engines alike."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.can.bus_settings import BusVariation
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.plan.faults import FOREVER
from evcosim.master.simulation import Simulation
from support.timed import timed

SCENARIO = """leave_out = ["rider"]
[[stimulus]]
to = "ecu.throttle_request"
constant = 100.0
[[fault]]
"""


def ran(tmp_path, fault: str, engine: str = "compiled", system="scooter", steps: int = 100, **options):
    """Columns of a run by name, and what was counted of its messages; `fault` "" is none."""
    text = SCENARIO + fault if fault else SCENARIO.replace("[[fault]]\n", "")
    (tmp_path / "faults.toml").write_text(text)
    with Simulation(system, tmp_path / "faults.toml", engine=engine, isolation="none", **options) as run:
        run.step(steps)
        results, frames = run.results, run.manifest()["frames"].get("can0", {"messages": {}})
        return {v.name: results[v.name] for v in results.variables}, frames["messages"]


SPEED = "ecu.speed_measured"


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("action", ["lose", "silence"])
def test_a_message_that_is_lost_or_not_sent_for_a_while(tmp_path, action, engine):
    before, _ = ran(tmp_path, "")
    fault = f'action = "{action}"\ntime = 0.3\nduration = 0.2\nmessage = "can0.EMD_Status"'
    found, messages = ran(tmp_path, fault, engine)
    assert np.array_equal(found[SPEED][:30], before[SPEED][:30])
    assert (found[SPEED][30:50] == found[SPEED][29]).all()
    assert found[SPEED][50] == np.floor(found["vehicle.speed"][50] * 3.6 + 0.5) != found[SPEED][49]
    assert messages["EMD_Status"]["lost" if action == "lose" else "silenced"] == 20
    assert messages["EMD_Status"]["sent"] == (100 if action == "lose" else 80)


def test_a_node_is_silent_and_every_other_frame_of_ten_is_lost(tmp_path):
    _, messages = ran(tmp_path, 'action = "silence"\ntime = 0.5\nnode = "can0.EMD"')
    assert messages["EMD_Status"]["silenced"] == 50
    fault = 'action = "lose"\ntime = 0.0\nmessage = "can0.EMD_Status"\ncount = 10\nevery = 2'
    _, messages = ran(tmp_path, fault)
    assert messages["EMD_Status"]["lost"] == 10


@pytest.mark.parametrize("system", ["scooter", "timed"])
def test_losses_by_chance_are_equal_in_both_engines_and_follow_their_seed(tmp_path, system):
    of = timed("scooter") if system == "timed" else system
    fault = 'action = "lose"\ntime = 0.0\nmessage = "can0.EMD_Status"\nprobability = 0.3\nseed = {}'
    runs = [ran(tmp_path, fault.format(seed), engine, of, 300)
            for seed, engine in ((1, "python"), (1, "compiled"), (2, "compiled"))]  # fmt: skip # a table
    assert all(np.array_equal(column, runs[1][0][name]) for name, column in runs[0][0].items())
    assert runs[0][1] == runs[1][1]
    assert not np.array_equal(runs[1][0][SPEED], runs[2][0][SPEED])
    assert 60 < runs[1][1]["EMD_Status"]["lost"] < 120


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_flipped_bits_arrive_where_nothing_protects(tmp_path, engine):
    fault = (
        'action = "corrupt"\ntime = 0.3\nduration = 0.01\nmessage = "can0.EMD_Status"\nbyte = 0\nmask = 64'
    )
    found, _ = ran(tmp_path, fault, engine)
    before, _ = ran(tmp_path, "")
    assert found[SPEED][30] == before[SPEED][30] + 64
    assert np.array_equal(found[SPEED][:30], before[SPEED][:30])


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_a_frozen_payload_stays_as_long_as_the_fault(tmp_path, engine):
    fault = 'action = "freeze"\ntime = 0.3\nduration = 0.2\nmessage = "can0.EMD_Status"'
    found, messages = ran(tmp_path, fault, engine)
    assert (found[SPEED][29:50] == found[SPEED][29]).all()
    assert messages["EMD_Status"]["arrived"] == 100


def test_faults_act_on_a_bus_with_a_delay_too(tmp_path):
    before, _ = ran(tmp_path, "", delay=0.03)
    fault = 'action = "lose"\ntime = 0.3\nduration = 0.2\nmessage = "can0.EMD_Status"'
    found, _ = ran(tmp_path, fault, delay=0.03)
    assert np.array_equal(found[SPEED][:33], before[SPEED][:33])
    assert (found[SPEED][33:53] == found[SPEED][32]).all()


def test_without_a_duration_it_lasts_to_the_end():
    assert FOREVER > 10**12 * 3600 * 24 * 7


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ('message = "can0.EMD_State"', "fault 1.message: nothing is sent by 'can0.EMD_State' (did you mean"),
        ('node = "can0.EMS"', "fault 1.node: nothing is sent by 'can0.EMS'"),
        ('node = "can0.EMD"\nmessage = "can0.EMD_Status"', "a 'message' or a 'node', and not both"),
        ("", "a 'message' or a 'node', and not both"),
        ('message = "can0.EMD_Status"\nprobability = 1.5', "probability"),
        ('message = "can0.EMD_Status"\nbyte = 1', "'byte' says which one 'corrupt' acts on"),
    ],
)
def test_what_a_fault_cannot_hit_is_refused(tmp_path, fault, reason):
    with pytest.raises(ConfigError) as error:
        ran(tmp_path, f'action = "lose"\ntime = 0.0\n{fault}\n')
    assert reason in str(error.value)


def test_a_byte_that_a_message_has_not(tmp_path):
    with pytest.raises(ConfigError, match=r"fault 1.byte: can0.VCU_Request has the bytes 0 to 2, and no"):
        ran(tmp_path, 'action = "corrupt"\ntime = 0.0\nmessage = "can0.VCU_Request"\nbyte = 3\n')


def test_values_that_are_not_quantized_have_no_faults(tmp_path):
    with pytest.raises(ConfigError, match=r'fault 1: buses.can0: with resolution = "ideal".*hits frames'):
        ran(
            tmp_path,
            'action = "lose"\ntime = 0.0\nmessage = "can0.VCU_Request"\n',
            bus=BusVariation(resolution="ideal"),
        )
