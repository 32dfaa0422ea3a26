"""The databases of a system's buses, and how much of their flaws a run says."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.plan.buses import open_buses
from evcosim.cosim.system.system import System, SystemFile
from support.databases import HEAD, write
from support.mocks import MockUnit, plan_of, real

S = 'S : 0|8@1+ (1,0) [0|0] "" B'


def system(folder, **buses) -> System:
    file = SystemFile.model_validate({"name": "s", "units": {"a": {"fmu": "a.fmu"}}, "buses": buses})
    return System(folder / "s.toml", file)


def test_a_file_of_two_buses_says_its_flaws_once(tmp_path):
    write(tmp_path, S, tail="nonsense;\n")
    said: list[str] = []
    found = open_buses(system(tmp_path, one={"dbc": "test.dbc"}, two={"dbc": "test.dbc"}), said)
    assert list(found) == ["one", "two"] and list(found["one"].messages) == ["M"]
    (warning,) = said
    assert "test.dbc: line 17: not valid in a DBC file: 'nonsense'" in warning


def test_of_many_flaws_the_first_are_said_and_where_the_others_are(tmp_path):
    path = write(tmp_path, S, tail="nonsense;\n" * 9)
    said: list[str] = []
    open_buses(system(tmp_path, one={"dbc": "test.dbc"}), said)
    assert len(said) == 6
    assert said[-1] == f"{path}: 4 more of this kind; `evcosim info {path}` lists them"


def test_settings_of_no_message(tmp_path):
    write(tmp_path, S)
    one = {"dbc": "test.dbc", "messages": {"N": {"cycle_time": 0.1}}}
    with pytest.raises(ConfigError, match=r"s.toml: buses.one.messages: .*test.dbc: no message 'N'"):
        open_buses(system(tmp_path, one=one), [])


def sent(folder, names, connect, **more):
    """The warnings of a system in which units send messages of the nodes A (M and N) and B (K)."""
    lines = "".join(
        f'BO_ {i} {m}: 8 {node}\n SG_ S : 0|8@1+ (1,0) [0|0] "" B\n'
        for i, m, node in ((1, "M", "A"), (2, "N", "A"), (3, "K", "B"), (4, "Free", "Vector__XXX"))
    )
    (folder / "n.dbc").write_text(HEAD + lines)
    mocks = [MockUnit(name, [real("y", "output"), real("z", "output")]) for name in names]
    bus = {"dbc": str(folder / "n.dbc"), "cycle_time": 0.01}
    found = plan_of(
        mocks,
        {"connect": [{"from": f, "via": f"can0.{m}.S"} for f, m in connect], "buses": {"can0": bus}, **more},
    )
    return [w.split(": ", 1)[1] for w in found.warnings if "message of" in w]


@pytest.mark.parametrize(
    ("connect", "said"),
    [
        ([("a.y", "M"), ("b.y", "K")], None),
        ([("a.y", "M"), ("b.y", "N")], "can0.N is a message of A, but unit 'b' sends it, and not a"),
        ([("x.y", "M"), ("x.z", "N"), ("x.y", "Free")], None),
        ([("x.y", "M"), ("x.z", "K")], "can0.K is a message of B, but unit 'x' sends it, and M of A"),
        ([("x.y", "M"), ("z.y", "K")], None),
    ],
)
def test_a_message_of_another_node_is_said(tmp_path, connect, said):
    names = sorted({source.split(".")[0] for source, _ in connect})
    found = sent(tmp_path, names, connect)
    assert [w.split(";")[0] for w in found] == ([said] if said else [])


def test_a_unit_that_is_several_nodes(tmp_path):
    connect = [("x.y", "M"), ("x.z", "K")]
    assert not sent(tmp_path, ["x"], connect, units={"x": {"fmu": "mock", "nodes": ["A", "B"]}})
    (said,) = sent(tmp_path, ["x"], connect, units={"x": {"fmu": "mock", "nodes": ["A"]}})
    assert said.startswith("can0.K is a message of B, but unit 'x' sends it, which is A")
    with pytest.raises(
        ConfigError, match=r"units.x.nodes: no CAN database has a node 'AA' \(did you mean 'A'"
    ):
        sent(tmp_path, ["x"], connect, units={"x": {"fmu": "mock", "nodes": ["AA"]}})


def test_parts_of_one_node_send_a_message_together(tmp_path):
    path = write(tmp_path, S, 'T : 8|8@1+ (1,0) [0|0] "" B')

    def made(**nodes):
        connect = [{"from": "a.y", "via": "c.M.S"}, {"from": "b.y", "via": "c.M.T"}]
        units = {name: {"fmu": "mock", "nodes": nodes.get(name, [])} for name in "ab"}
        system = {"connect": connect, "units": units, "buses": {"c": {"dbc": str(path), "cycle_time": 0.01}}}
        return plan_of([MockUnit(name, [real("y", "output")]) for name in "ab"], system)

    assert made(a=["A", "B"], b=["A"]).messages[0].senders == {"S": "a.y", "T": "b.y"}
    for nodes in ({}, {"a": ["A"]}, {"a": ["A"], "b": ["B"]}, {"a": ["B"], "b": ["B"]}):
        with pytest.raises(
            ConfigError, match=r"M.T is sent by unit 'b', and M.S by 'a': .* nodes = \[\"A\"\]"
        ):
            made(**nodes)
