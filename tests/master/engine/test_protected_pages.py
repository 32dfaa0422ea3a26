"""Protection and timeouts of a multiplexed message: one counter, one check and one timeout for its pages."""

from __future__ import annotations

import cantools
import numpy as np
import pytest
from e2e import p01

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.toml import DATA
from evcosim.master.simulation import Simulation

PAGED = """BO_ 400 CAM_LaneStatus: 6 CAM
 SG_ CAM_LaneStatusCrc : 0|8@1+ (1,0) [0|255] "" VCU
 SG_ CAM_LaneStatusCounter : 8|4@1+ (1,0) [0|14] "" VCU
 SG_ CAM_Page M : 12|4@1+ (1,0) [0|15] "" VCU
 SG_ CAM_LatDisplacement m2 : 16|16@1- (0.001,0) [-32|32] "m" VCU
 SG_ CAM_HeadingAngle m5 : 32|16@1- (0.01,0) [-180|180] "deg" VCU
"""
SIGNALS = 'crc = "CAM_LaneStatusCrc", counter = "CAM_LaneStatusCounter"'
SETTINGS = f'e2e = {{ profile = "1A", data_id = 0x190, {SIGNALS} }}\n'


def written(tmp_path, settings: str = SETTINGS, pages: str = PAGED):
    """The path of lane keeping with a camera whose message has a page for each of its two signals."""
    dbc = (DATA / "can" / "ev.dbc").read_text()
    start = dbc.index("BO_ 400 ")
    end = dbc.index("\n\n", start)
    (tmp_path / "paged.dbc").write_text(dbc[:start] + pages + dbc[end:])
    system = (DATA / "systems" / "lane_keeping.toml").read_text().replace("can/ev.dbc", "paged.dbc")
    head, _, rest = system.partition("[buses.can0.messages.CAM_LaneStatus]\n")
    _, _, rest = rest.partition("status_optional = true\n")
    path = tmp_path / "s.toml"
    path.write_text(f"{head}[buses.can0.messages.CAM_LaneStatus]\n{settings}{rest}")
    return path


def ran(tmp_path, engine, settings: str = SETTINGS, fault: str = "", steps: int = 100, **options):
    """Columns of a run by name, payloads of the message in their order, and the counts of its pages."""
    text = f'[[fault]]\ntime = 0.5\nduration = 0.1\nmessage = "can0.CAM_LaneStatus"\n{fault}\n'
    step = '[[stimulus]]\nto = "controller.displacement_reference"\nconstant = 0.3\nunit = "m"\n'
    (tmp_path / "run.toml").write_text(step + (text if fault else ""))
    path = written(tmp_path, settings)
    with Simulation(
        path, tmp_path / "run.toml", engine=engine, isolation="none", log_frames=True, **options
    ) as simulation:
        simulation.step(steps)
        results, frames = simulation.results, simulation.manifest()["frames"].get("can0", {"messages": {}})
        simulation.write_can_log(tmp_path / "bus.log")
    lines = (tmp_path / "bus.log").read_text().splitlines()
    payloads = [bytes.fromhex(line.split("#")[1].split()[0]) for line in lines if " 190#" in line]
    columns = {v.name: results[v.name] for v in results.variables}
    return columns, payloads, {k: v for k, v in frames["messages"].items() if k.startswith("CAM_Lane")}


def bits(columns) -> dict[str, bytes]:
    return {name: column.tobytes() for name, column in columns.items()}


def test_results_are_those_without_and_one_counter_runs_through_the_pages(tmp_path):
    bare, plain, _ = ran(tmp_path, "compiled", "")
    found = {engine: ran(tmp_path, engine) for engine in ("python", "compiled")}
    assert bits(found["python"][0]) == bits(found["compiled"][0]) == bits(bare)
    assert found["python"][1:] == found["compiled"][1:]
    _, payloads, counted = found["compiled"]
    database = cantools.database.load_file(tmp_path / "paged.dbc", strict=False)
    message = database.get_message_by_name("CAM_LaneStatus")
    assert [data[1] & 15 for data in payloads] == [n % 15 for n in range(100)]
    for n, (data, other) in enumerate(zip(payloads, plain, strict=True)):
        assert p01.e2e_p01_check(bytearray(data), 0x190, data_id_mode=p01.E2E_P01_DATAID_BOTH)
        decoded, unprotected = (message.decode(each, decode_choices=False) for each in (data, other))
        assert decoded["CAM_Page"] == (2, 5)[n % 2]
        own = ("CAM_LatDisplacement", "CAM_HeadingAngle")[n % 2]
        assert decoded[own] == unprotected[own]
    assert sum(page["rejected"] for page in counted.values()) == 0
    assert [page["statuses"].get("initial", 0) for page in counted.values()] == [1, 0]


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("timing", ["instant", "frame"])
@pytest.mark.parametrize(
    ("fault", "status"),
    [
        ('action = "corrupt"\nbyte = 1\nmask = 128', "wrong_crc"),
        ('action = "lose"', "no_new_data"),
    ],
)
def test_each_page_is_judged(tmp_path, engine, timing, fault, status):
    path = written(tmp_path)
    path.write_text(path.read_text().replace("bitrate = 500_000", f'bitrate = 500_000\ntiming = "{timing}"'))
    (tmp_path / "run.toml").write_text(
        f'[[fault]]\ntime = 0.5\nduration = 0.1\nmessage = "can0.CAM_LaneStatus"\n{fault}\n'
    )
    with Simulation(path, tmp_path / "run.toml", engine=engine, isolation="none") as simulation:
        simulation.step(100)
        counted = simulation.manifest()["frames"]["can0"]["messages"]
    pages = [page for name, page in counted.items() if name.startswith("CAM_Lane")]
    assert [page["statuses"].get(status, 0) for page in pages] == [5, 5]
    assert sum(page["statuses"].get("ok_some_lost", 0) for page in pages) == 1


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_a_timeout_counts_cycles_of_the_message_and_falls_back_on_all_pages(tmp_path, engine):
    settings = SETTINGS + 'timeout = 4\non_timeout = "sna"\n'
    columns, _, counted = ran(tmp_path, engine, settings, 'action = "lose"')
    # lost from 0.5 s on: the fourth cycle without a frame is that of 0.53 s; both pages come by 0.61 s
    gone = np.isclose(columns["controller.displacement"], -32.768)
    assert np.flatnonzero(gone).tolist() == list(range(53, 60))
    gone = np.isclose(columns["controller.heading_angle"], np.deg2rad(-327.68))
    assert np.flatnonzero(gone).tolist() == list(range(53, 61))
    assert sum(page["timeouts"] for page in counted.values()) == 1


def test_what_stands_in_some_frames_only_protects_none(tmp_path):
    path = written(tmp_path, SETTINGS, PAGED.replace("Counter :", "Counter m2 :"))
    said = "CAM_LaneStatusCounter stands in some frames only"
    with pytest.raises(ConfigError, match=rf"messages.CAM_LaneStatus.e2e.counter: {said}"):
        Simulation(path, isolation="none").close()
    path = written(tmp_path, SETTINGS.replace('"CAM_LaneStatusCounter"', '"CAM_Page"'))
    with pytest.raises(ConfigError, match="CAM_Page says which signals a frame has; the protection needs"):
        Simulation(path, isolation="none").close()
