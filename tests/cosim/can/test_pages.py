"""The pages of a multiplexed message: cantools decodes their frames to what was sent."""

from __future__ import annotations

from pathlib import Path

import cantools
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.dbc import load_dbc
from evcosim.cosim.can.logs.frames import encoder
from evcosim.cosim.can.pages import pages
from evcosim.cosim.errors import ConfigError

HEAD = 'VERSION ""\nBS_:\nBU_: A B\n'
SIMPLE = f"""{HEAD}BO_ 256 M: 8 A
 SG_ Page M : 0|4@1+ (1,0) [0|15] "" B
 SG_ Always : 8|16@1+ (0.1,0) [0|6000] "V" B
 SG_ P1 m1 : 32|16@1+ (1,0) [0|0] "" B
 SG_ Q1 m1 : 55|8@0+ (1,0) [0|0] "" B
 SG_ P3 m3 : 36|16@1- (1,0) [0|0] "" B
 SG_ P7 m7 : 32|8@1+ (1,0) [0|0] "" B
"""
NESTED = f"""{HEAD}BO_ 256 M: 8 A
 SG_ Page M : 0|4@1+ (1,0) [0|15] "" B
 SG_ Always : 8|8@1+ (1,0) [0|0] "" B
 SG_ Sub m1M : 16|8@1+ (1,0) [0|0] "" B
 SG_ Wide m0 : 16|8@1+ (1,0) [0|0] "" B
 SG_ InAll m0 : 24|8@1+ (1,0) [0|0] "" B
 SG_ S0 m0 : 32|8@1+ (1,0) [0|0] "" B
 SG_ S5 m5 : 32|16@1+ (1,0) [0|0] "" B
 SG_ S6 m6 : 48|16@1+ (1,0) [0|0] "" B
SG_MUL_VAL_ 256 Sub Page 1-1;
SG_MUL_VAL_ 256 Wide Page 0-0, 2-4;
SG_MUL_VAL_ 256 InAll Page 0-15;
SG_MUL_VAL_ 256 S0 Sub 0-0;
SG_MUL_VAL_ 256 S5 Sub 5-9;
SG_MUL_VAL_ 256 S6 Sub 9-10;
"""


def load(folder: Path, text: str) -> Message:
    path = folder / "m.dbc"
    path.write_text(text)
    return load_dbc(path).messages["M"]


@pytest.mark.parametrize(
    ("text", "connected", "selected"),
    [
        (SIMPLE, [], [{"Page": 1}]),
        (SIMPLE, ["Always"], [{"Page": 1}]),
        (SIMPLE, ["Page", "Always"], [{}]),
        (SIMPLE, ["P3"], [{"Page": 3}]),
        (SIMPLE, ["P7", "P1", "Always", "Q1"], [{"Page": 1}, {"Page": 7}]),
        (NESTED, ["Wide"], [{"Page": 0}]),
        (NESTED, ["InAll", "Always"], [{"Page": 0}]),
        (NESTED, ["InAll", "S5"], [{"Page": 1, "Sub": 5}]),
        (NESTED, ["S5", "S6"], [{"Page": 1, "Sub": 9}]),
        (NESTED, ["S0", "S5", "Wide"], [{"Page": 0}, {"Page": 1, "Sub": 0}, {"Page": 1, "Sub": 5}]),
        (NESTED, ["Sub", "Wide"], [{"Page": 0}, {"Page": 1}]),
    ],
)
def test_the_pages_that_are_connected(tmp_path, text, connected, selected):
    found = pages(load(tmp_path, text), connected)
    assert [dict(page.selected) for page in found] == selected


@pytest.mark.parametrize("text", [SIMPLE, NESTED], ids=["simple", "extended"])
def test_every_frame_is_decoded_to_what_was_sent(tmp_path_factory, text):
    message = load(tmp_path_factory.mktemp("pages"), text)
    codec = cantools.database.load_string(text, "dbc").get_message_by_name("M")
    free = [name for name, signal in message.signals.items() if not signal.is_multiplexer]

    @given(st.sets(st.sampled_from(free)), st.data())
    def check(connected, data):
        found = pages(message, sorted(connected))
        assert connected <= {name for page in found for name in page.signals}
        assert len(found) <= max(1, len(connected))
        for page in found:
            sent = page.of(message)
            raws = {
                name: page.selected.get(name, data.draw(st.integers(*map(int, signal.raw_type_range))))
                for name, signal in sent.signals.items()
            }
            assert codec.decode(encoder(sent)(raws), scaling=False) == raws

    check()


def test_a_multiplexer_beside_what_it_selects_is_refused(tmp_path):
    said = r"s.toml: .*m.dbc: M.Page selects M.P1, and both are connected; leave out the multiplexer"
    with pytest.raises(ConfigError, match=said):
        pages(load(tmp_path, SIMPLE), ["Page", "P1"], "s.toml")
    with pytest.raises(ConfigError, match=r"M\.Page selects M\.S5"):
        pages(load(tmp_path, NESTED), ["S5", "Page"])


def test_a_signal_that_cannot_be_used_stands_in_no_page():
    bad = Signal("Bad", 4, 8, problem="it overlaps")
    message = Message("f.dbc", "M", 1, signals={"Good": Signal("Good", 0, 8), "Bad": bad})
    (page,) = pages(message, ["Good"])
    assert page.signals == ("Good",)
    assert list(page.of(message).signals) == ["Good"]
