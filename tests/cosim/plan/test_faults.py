"""Faults of a scenario: what they name, and what they do to a run, in both engines alike."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.can.bus_settings import BusVariation
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.plan.faults import FOREVER
from evcosim.master.prepare import prepare
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


def test_losses_of_a_variation_follow_the_seed_of_the_bus_and_its_own(tmp_path):
    """The sum of both counts, as with the other draws of a bus."""
    lost = [
        ran(tmp_path, "", system=with_seed("scooter", own), steps=200, bus=BusVariation(loss=0.3, seed=seed))[
            0
        ]
        for own, seed in ((0, 0), (5, 0), (2, 3))
    ]
    assert not np.array_equal(lost[0][SPEED], lost[1][SPEED])
    assert np.array_equal(lost[1][SPEED], lost[2][SPEED])


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_the_loss_of_a_variation_and_that_of_the_scenario_draw_by_themselves(tmp_path, engine):
    """As many are hit by the one with the other beside it as alone, and not the same ones."""
    lose = 'action = "lose"\ntime = 0.0\nmessage = "can0.EMD_Status"\nprobability = 0.3'
    loss = BusVariation(loss=0.3)
    by_itself = hits(tmp_path, lose, engine)["can0.EMD_Status"]
    varied = hits(tmp_path, "", engine, loss)
    both = hits(tmp_path, lose, engine, loss)
    of_both = both.pop("can0.EMD_Status")
    assert of_both == by_itself + varied.pop("can0.EMD_Status")
    assert both == varied
    with Simulation("scooter", tmp_path / "faults.toml", engine=engine, isolation="none", bus=loss) as run:
        run.step(300)
        lost = run.manifest()["frames"]["can0"]["messages"]["EMD_Status"]["lost"]
    assert max(of_both) < lost < sum(of_both)


def hits(tmp_path, fault, engine, loss=None):
    """The numbers of frames that the faults on each message hit, in the order of the faults."""
    text = SCENARIO + fault if fault else SCENARIO.removesuffix("[[fault]]\n")
    (tmp_path / "faults.toml").write_text(text)
    found = {}
    with Simulation("scooter", tmp_path / "faults.toml", engine=engine, isolation="none", bus=loss) as run:
        run.step(300)
        for each in run.manifest()["faults"]:
            found.setdefault(each["on"], []).append(each["frames"])
    return found


def with_seed(name, seed):
    """A system with a seed of its buses."""
    return timed(name, timing="instant", seed=seed)


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_the_first_frame_has_no_payload_before_it_that_could_be_frozen(tmp_path, engine):
    fault = 'action = "freeze"\ntime = 0.0\nmessage = "can0.EMD_Status"\n'
    assert hits(tmp_path, fault, engine) == {"can0.EMD_Status": [299]}
    found, _ = ran(tmp_path, fault + "count = 60", engine)
    assert (found[SPEED][:61] == found[SPEED][0]).all()
    assert found[SPEED][61] != found[SPEED][0]
    assert hits(tmp_path, fault + "every = 2", engine) == {"can0.EMD_Status": [150]}  # the second, fourth ...


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
        ('message = "can0.EMD_Status"\nbyte = 1', 'byte: unknown key with action = "lose"'),
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


# ---- delay, bus_off and babble


def both(tmp_path, fault: str, system="scooter", **options):
    """A run in both engines, which are equal, also in what was counted."""
    runs = [ran(tmp_path, fault, engine, system, **options) for engine in ("python", "compiled")]
    assert runs[0][1] == runs[1][1]
    for name, column in runs[0][0].items():
        assert np.array_equal(column, runs[1][0][name], equal_nan=True), name
    return runs[1]


@pytest.mark.parametrize("by", [0.01, 0.03])
def test_late_frames_are_those_of_a_bus_with_that_delay(tmp_path, by):
    fault = f'action = "delay"\ntime = 0.0\nby = {by}\nnode = "can0.'
    late, messages = both(tmp_path, f'{fault}EMD"\n[[fault]]\n{fault}VCU"')
    expected, _ = ran(tmp_path, "", delay=by)
    for name, column in expected.items():
        assert np.array_equal(column, late[name]), name
    assert messages["EMD_Status"]["delayed"] == 100


@pytest.mark.parametrize("system", ["scooter", "timed"])
def test_a_late_frame_comes_after_newer_ones(tmp_path, system):
    """The frame sampled at 0.3 s alone is 25 ms late: it takes the place of the one that came before it."""
    of = timed("scooter") if system == "timed" else system
    before, _ = ran(tmp_path, "", system=of)
    found, messages = both(
        tmp_path, 'action = "delay"\ntime = 0.3\nduration = 0.01\nby = 0.025\nmessage = "can0.EMD_Status"', of
    )
    lag = 1 if system == "timed" else 0
    expected = before[SPEED].copy()
    expected[30 + lag] = before[SPEED][29 + lag]
    expected[33 : 33 + lag] = before[SPEED][30 + lag]
    assert np.array_equal(found[SPEED][:33], expected[:33])
    assert messages["EMD_Status"]["delayed"] == 1


@pytest.mark.parametrize("system", ["scooter", "timed"])
def test_a_node_off_the_bus_sends_and_receives_nothing(tmp_path, system):
    of = timed("scooter") if system == "timed" else system
    found, messages = both(tmp_path, 'action = "bus_off"\ntime = 0.3\nduration = 0.2\nnode = "can0.EMD"', of)
    throttle = "vehicle.throttle"
    last = 30 if system == "timed" else 29
    assert (found[SPEED][last : 50 + 1] == found[SPEED][last]).all()
    assert (found[throttle][last:50] == found[throttle][last]).all()
    assert found[SPEED][-1] != found[SPEED][last]
    assert messages["EMD_Status"]["held"] == 21  # 20, and one in the 128 x 11 bits of 2 us behind them
    assert messages["VCU_Request"]["unheard"] == 21


def test_a_node_that_stays_off(tmp_path):
    found, messages = both(tmp_path, 'action = "bus_off"\ntime = 0.3\nnode = "can0.EMD"')
    assert (found[SPEED][29:] == found[SPEED][29]).all()
    assert messages["EMD_Status"]["held"] == 70


def test_a_babbling_node_starves_all_others_and_fills_the_bus(tmp_path):
    fault = 'action = "babble"\ntime = 0.3\nduration = 0.2\nbus = "can0"'
    found, messages = both(tmp_path, fault, timed("scooter"))
    assert (found[SPEED][31:51] == found[SPEED][31]).all()
    assert found[SPEED][-1] != found[SPEED][31]
    own = messages["fault_1_0x0"]
    assert own["load"] == pytest.approx(0.2, abs=0.001)
    assert messages["EMD_Status"]["replaced"] == 20


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_faults_at_once_count_and_draw_by_themselves(tmp_path, engine):
    """Three losses and wrong bits of one message: 0.3 of the frames by chance each, every 3rd and 2nd."""
    lose = 'action = "lose"\ntime = 0.0\nmessage = "can0.EMD_Status"\n'
    wrong = lose.replace("lose", "corrupt") + "byte = 0\n"
    given = [lose + "probability = 0.3", lose + "every = 3", lose + "every = 2\ntime = -1.0", wrong]
    given[2] = given[2].replace("time = 0.0\n", "")
    text = "\n[[fault]]\n".join([*given, wrong + "probability = 0.3"])
    (tmp_path / "faults.toml").write_text(SCENARIO + text)
    with Simulation("scooter", tmp_path / "faults.toml", engine=engine, isolation="none") as run:
        run.step(300)
        manifest = run.manifest()
    found = [fault["frames"] for fault in manifest["faults"]]
    assert found[1:4] == [100, 150, 300]
    assert 60 < found[0] < 120 and 60 < found[4] < 120 and found[0] != found[4]
    lost = manifest["frames"]["can0"]["messages"]["EMD_Status"]["lost"]
    assert 200 < lost < 200 + found[0]  # the union


def test_faults_are_in_the_manifest_with_the_frames_that_they_hit(tmp_path):
    text = """action = "lose"
time = 0.5
duration = 0.1
message = "can0.EMD_Status"
[[fault]]
action = "corrupt"
time = 0.2
byte = 0
mask = 1
message = "can0.EMD_Status"
count = 3
[[fault]]
action = "corrupt"
time = 0.2
byte = 1
message = "can0.EMD_Status"
every = 10
"""
    (tmp_path / "faults.toml").write_text(SCENARIO + text)
    with Simulation("scooter", tmp_path / "faults.toml", isolation="none") as run:
        run.step(100)
        found = run.manifest()["faults"]
    assert [(each["action"], each["on"], each["frames"]) for each in found] == [
        ("lose", "can0.EMD_Status", 10),
        ("corrupt", "can0.EMD_Status", 3),
        ("corrupt", "can0.EMD_Status", 8),  # two faults at once, each with a byte of its own
    ]
    assert found[1]["mask"] == 1


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ('action = "babble"\nbus = "can0"', 'fault 1.action: bus can0 has timing = "instant"'),
        ('action = "babble"\nbus = "can1"', "fault 1.bus: nothing is sent on 'can1' (did you mean 'can0'?)"),
        ('action = "bus_off"\nnode = "can0.EMS"', "fault 1.node: nothing is sent by 'can0.EMS'"),
        (
            'action = "bus_off"\nnode = "can0.EMD"\n'
            '[[fault]]\ntime = 9.0\naction = "bus_off"\nnode = "can0.EMD"',
            "fault 2: it overlaps fault 1, bus_off of can0.EMD",
        ),
        (
            'action = "delay"\nby = 1.0\nnode = "can0.EMD"\n'
            '[[fault]]\ntime = 9.0\naction = "delay"\nby = 2.0\nmessage = "can0.EMD_Status"',
            "fault 2: it overlaps fault 1, delay of can0.EMD",
        ),
    ],
)
def test_what_delay_bus_off_and_babble_cannot_do_is_refused(tmp_path, fault, reason):
    with pytest.raises(ConfigError) as error:
        ran(tmp_path, f"time = 0.0\n{fault}\n")
    assert reason in str(error.value)


def test_an_identifier_that_is_sent_cannot_babble(tmp_path):
    with pytest.raises(
        ConfigError, match=r"fault 1.id: 0x148 is the identifier of can0.EMD_Status, which is"
    ):
        ran(tmp_path, 'time = 0.0\naction = "babble"\nbus = "can0"\nid = 328', system=timed("scooter"))


def test_a_fault_that_never_acts_and_an_ideal_run_say_so(tmp_path):
    fault = 'action = "lose"\nmessage = "can0.EMD_Status"\ntime = '
    (tmp_path / "faults.toml").write_text(f"{SCENARIO}{fault}99.0\n[[fault]]\n{fault}-2.0\nduration = 1.0")
    said = " ".join(prepare("scooter", tmp_path / "faults.toml").plan.unreached)
    assert "fault 1, lose of can0.EMD_Status at t = 99 s, never acts: the stop time" in said
    assert "fault 2, lose of can0.EMD_Status at t = -2 s, never acts: it ends before the start" in said
    with Simulation("scooter", tmp_path / "faults.toml", isolation="none", ideal=True) as run:
        assert any("without buses: its 2 faults on buses are left out" in text for text in run.warnings)
        assert run.manifest()["faults"] == []


HOSTILE = [1e308, -1e308, 5e-324, 1e12, -1e12, 0, -1, 1, 1e-10, 3600.0, 2**63, 2**62, -(2**63) - 1]


@pytest.mark.parametrize(
    "fault",
    [
        'action = "delay"\ntime = 0.02\nduration = 0.05\nby = 0.02\nmessage = "can0.EMD_Status"\nevery = 2\n',
        'action = "bus_off"\ntime = 0.02\nduration = 0.05\nnode = "can0.EMD"\n',
        'action = "babble"\ntime = 0.02\nduration = 0.05\nbus = "can0"\nid = 3\nlength = 4\nperiod = 0.001\n',
    ],
)
def test_hostile_numbers_are_used_or_refused(tmp_path, fault):
    keys = [line.split(" = ") for line in fault.splitlines() if '"' not in line]
    system = timed("scooter")
    for key, given in keys:
        for value in HOSTILE:
            text = fault.replace(f"{key} = {given}", f"{key} = {value}")
            try:
                ran(tmp_path, text, "python", system, steps=12)
            except ConfigError as error:
                assert f"fault 1: {key} = " in str(error) or f"fault 1.{key}" in str(error)
