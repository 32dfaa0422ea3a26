"""The CAN database: what is read from a DBC file, and what is refused, in words that name the place."""

from __future__ import annotations

import logging
import re
from pathlib import Path

import cantools
import pytest

from evcosim.cosim.can.database import Signal
from evcosim.cosim.can.dbc import load_dbc
from evcosim.cosim.can.send_steps import send_steps
from evcosim.cosim.errors import ConfigError
from support.databases import EV, HEAD, refusal, write


class TestEv:
    """The project's own database."""

    def test_cantools_reads_it_strictly_without_a_warning(self, caplog: pytest.LogCaptureFixture) -> None:
        with caplog.at_level(logging.DEBUG, logger="cantools"):
            database = cantools.database.load_file(EV, strict=True)
        assert not [record for record in caplog.records if record.levelno >= logging.WARNING]
        assert all(message.comment for message in database.messages)
        assert {message.name for message in database.messages} == set(load_dbc(EV).messages)

    def test_every_signal_can_carry_a_connection(self) -> None:
        database = load_dbc(EV)
        assert database.warnings == ()
        for message in database.messages.values():
            for name in message.signals:
                message.require(name)

    def test_no_signal_can_be_sent_as_its_not_available_code(self) -> None:
        coded = [
            s
            for m in load_dbc(EV).messages.values()
            for s in m.signals.values()
            if s.not_available is not None
        ]
        assert len(coded) >= 12
        for s in coded:
            assert s.choices[s.not_available or 0] == "SNA"
            assert s.minimum is not None and s.maximum is not None
            assert not s.minimum <= (s.not_available or 0) * s.scale + s.offset <= s.maximum

    @pytest.mark.parametrize(
        ("name", "sender", "every"),
        [
            ("VCU_Request", "VCU", 1),
            ("EMD_Status", "EMD", 1),
            ("VCU_State", "VCU", 10),
            ("BMS_Status", "BMS", 10),
        ],
    )
    def test_the_scooter_s_messages(self, name: str, sender: str, every: int) -> None:
        message = load_dbc(EV).require(name)
        assert message.senders == (sender,)
        assert send_steps(message, 0.01) == (every, 0)

    def test_the_published_resolutions(self) -> None:
        speed = load_dbc(EV).require("EMD_Status").require("EMD_VehicleSpeed")
        assert (speed.scale, speed.offset, speed.minimum, speed.maximum, speed.unit) == (1, 0, 0, 254, "km/h")
        throttle = load_dbc(EV).require("VCU_Request").require("VCU_ThrottleRequest")
        assert (throttle.scale, throttle.minimum, throttle.maximum, throttle.unit) == (0.4, 0, 100, "%")
        state = load_dbc(EV).require("VCU_State").require("VCU_ControllerState")
        assert state.choices == {0: "Driver", 1: "Acceleration", 2: "Velocity", 3: "Fault", 7: "SNA"}


class TestReading:
    def test_all_of_a_signal(self, tmp_path: Path) -> None:
        path = write(
            tmp_path,
            'S : 7|12@0- (0.5,-40) [-100|100.5] "°C" B',
            tail='CM_ SG_ 1 S "Oil";\nBA_ "GenSigSNA" SG_ 1 S 2048;\nBA_ "GenSigStartValue" SG_ 1 S -5;\n'
            'VAL_ 1 S 3 "Three" ;\n',
        )
        assert load_dbc(path).require("M").require("S") == Signal(
            name="S", start=7, length=12, little_endian=False, signed=True, scale=0.5, offset=-40,
            minimum=-100, maximum=100.5, unit="°C", choices={3: "Three"}, start_raw=-5,
            not_available=-2048, comment="Oil", receivers=("B",),
        )  # fmt: skip # one line a group

    @pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
    def test_both_encodings_of_a_degree_sign(self, tmp_path: Path, encoding: str) -> None:
        path = write(tmp_path, 'S : 0|8@1+ (1,-40) [0|0] "°C" B', encoding=encoding)
        assert load_dbc(path).messages["M"].signals["S"].unit == "°C"

    def test_minimum_and_maximum_of_zero_are_no_limits(self, tmp_path: Path) -> None:
        signal = load_dbc(write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" B')).messages["M"].signals["S"]
        assert (signal.minimum, signal.maximum) == (None, None)

    def test_integer_scale_and_offset_stay_integers(self, tmp_path: Path) -> None:
        path = write(tmp_path, 'S : 0|8@1+ (2.0,3) [0|0] "" B', 'T : 8|8@1+ (2,0.5) [0|0] "" B')
        s, t = load_dbc(path).messages["M"].signals.values()
        assert [type(x) for x in (s.scale, s.offset, t.scale, t.offset)] == [int, int, int, float]

    def test_an_extended_id(self, tmp_path: Path) -> None:
        path = tmp_path / "test.dbc"
        path.write_text(f"{HEAD}\nBO_ {0x80000000 + 0x18FEF100} M: 8 A\n\n")
        message = load_dbc(path).messages["M"]
        assert (message.frame_id, message.extended, message.cycle_time) == (0x18FEF100, True, None)

    def test_a_code_is_recognized_by_its_description(self, tmp_path: Path) -> None:
        path = write(tmp_path, 'S : 0|8@1+ (1,0) [0|250] "" B', tail='VAL_ 1 S 255 "Not_Available" ;\n')
        assert load_dbc(path).messages["M"].signals["S"].not_available == 255

    def test_bits_are_those_that_cantools_sets(self, tmp_path: Path) -> None:
        for order, start, length in [(1, 3, 17), (0, 4, 17), (0, 7, 8), (0, 0, 3), (1, 63, 1), (0, 56, 1)]:
            path = write(tmp_path, f'S : {start}|{length}@{order}+ (1,0) [0|0] "" B')
            signal = load_dbc(path).messages["M"].signals["S"]
            codec = cantools.database.load_file(path).get_message_by_name("M")
            for i, bit in enumerate(signal.bits):
                data = codec.encode({"S": 1 << i})
                assert int.from_bytes(data, "little") == 1 << bit, (order, start, length, i)


class TestRefusals:
    def test_a_missing_file(self, tmp_path: Path) -> None:
        with pytest.raises(ConfigError, match=r"none\.dbc: the CAN database cannot be read: No such file"):
            load_dbc(tmp_path / "none.dbc")

    @pytest.mark.parametrize("text", ["", "hello", "time,speed\n0,1\n", "<xml/>"])
    def test_no_dbc_at_all(self, tmp_path: Path, text: str) -> None:
        path = tmp_path / "test.dbc"
        path.write_text(text)
        with pytest.raises(ConfigError, match=r"test\.dbc: line 1: not valid in a DBC file"):
            load_dbc(path)

    def test_a_wrong_line_is_named_and_shown_to_who_uses_its_signal(self, tmp_path: Path) -> None:
        path = write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" B', 'T : eight|8@1+ (1,0) [0|0] "" B')
        said = "test.dbc: line 8: not valid in a DBC file: 'SG_ T : eight|8@1+"
        assert said in refusal(path, "T")
        database = load_dbc(path)
        assert database.require("M").require("S").length == 8
        assert [warning for warning in database.warnings if said in warning] == list(database.warnings)


S = 'S : 0|8@1+ (1,0) [0|0] "" B'
OK = 'Fine : 56|8@1+ (1,0) [0|0] "" B'


class TestFlaws:
    """A contradiction stops who uses what it is about; for all others it is a warning with its line."""

    @pytest.mark.parametrize(
        ("signals", "tail", "used", "line", "said"),
        [
            ([S, 'T : 6|8@1+ (1,0) [0|0] "" B'], "", "S", 7, "'S' and 'T' overlap in bits 6 to 7"),
            ([S, 'T : 6|8@1+ (1,0) [0|0] "" B'], "", "T", 8, "'S' and 'T' overlap in bits 6 to 7"),
            (['S : 60|16@1+ (1,0) [0|0] "" B'], "", "S", 7, "start bit 60, 16 bits: it does not fit into 8"),
            (['S : 0|65536@1+ (1,0) [0|0] "" B'], "", "S", 7, "65536 bits from bit 0 on are no signal"),
            (['S : 0|0@1+ (1,0) [0|0] "" B'], "", "S", 7, "0 bits from bit 0 on are no signal"),
            ([S, 'S : 8|8@1+ (1,0) [0|0] "" B'], "", "S", 7, "signal S is given twice, in the lines 7 and 8"),
            ([S], 'BA_ "GenSigStartValue" SG_ 1 S 256;\n', "S", 7, "the start value 256 is no raw value"),
            ([S], 'BA_ "GenSigStartValue" SG_ 1 S 0.5;\n', "S", 7, "the start value 0.5 is no raw value"),
            ([S], "SIG_VALTYPE_ 1 S : one;\n", "S", 7, "not valid in a DBC file: 'SIG_VALTYPE_ 1 S : one'"),
            (['S m : 0|8@1+ (1,0) [0|0] "" B'], "", "S", 7, "'m' is no multiplexer's mark: M, m3 or m3M"),
            (['S m0 : 0|8@1+ (1,0) [0|0] "" B'], "", "S", 7, "'m0': no signal could select it, and no"),
        ],
    )
    def test_of_a_signal(self, tmp_path: Path, signals, tail, used, line, said) -> None:
        path = write(tmp_path, *signals, OK, tail=tail)
        database = load_dbc(path)
        flaws = {s.name: s.problem for s in database.messages["M"].signals.values()}
        assert said in flaws[used] and not flaws["Fine"]
        assert any(
            f"test.dbc: line {line}: message 'M': signal '{used}'" in w and said in w
            for w in database.warnings
        )
        if not any(s.is_multiplexer for s in database.messages["M"].signals.values()):
            assert f"test.dbc: line {line}: M.{used}: " in refusal(path, used) and said in refusal(path, used)
            database.require("M").require("Fine")

    @pytest.mark.parametrize(
        ("second", "said"),
        [
            ("BO_ 1 N: 8 A", "frame id 0x1 is given twice, to M and N, in the lines 6 and 10"),
            ("BO_ 2 M: 8 A", "the name is given twice, in the lines 6 and 10"),
        ],
    )
    def test_of_a_message_that_is_given_twice(self, tmp_path: Path, second: str, said: str) -> None:
        path = tmp_path / "test.dbc"
        path.write_text(f"{HEAD}\nBO_ 1 M: 8 A\n SG_ {S}\n\n\n{second}\n\nBO_ 3 K: 8 A\n SG_ {S}\n")
        assert said in refusal(path)
        database = load_dbc(path)
        assert f"{path}: line 6: message 'M' cannot be used: {said}" in database.warnings
        database.require("K").require("S")

    @pytest.mark.parametrize(
        ("line", "said"),
        [
            ('VAL_ 9 S 0 "Off" ;', "VAL_ for a message with the id 9, which there is not"),
            ('VAL_ 1 T 0 "Off" ;', "VAL_ for a signal 'T' in message 'M', which there is not"),
            ("SIG_VALTYPE_ 9 S : 1;", "SIG_VALTYPE_ for a message with the id 9"),
            ("SIG_VALTYPE_ 1 T : 1;", "SIG_VALTYPE_ for a signal 'T' in message 'M'"),
            ("SG_MUL_VAL_ 1 T S 0-1;", "SG_MUL_VAL_ for a signal 'T'"),
            ("BO_TX_BU_ 9 : A,B;", "BO_TX_BU_ for a message with the id 9"),
            ('CM_ BO_ 9 "text";', "CM_ for a message with the id 9"),
            ('CM_ SG_ 1 T "text";', "CM_ for a signal 'T'"),
            ('BA_ "GenMsgCycleTime" BO_ 9 10;', "BA_ for a message with the id 9"),
            ('BA_ "GenSigSNA" SG_ 1 T 10;', "BA_ for a signal 'T'"),
            ('BA_ "Mystery" BO_ 1 10;', 'the attribute "Mystery" is not defined'),
            ('BA_ "GenMsgCycleTime" BO_ 1 "often";', "'M': GenMsgCycleTime: a finite number is needed"),
            ('BA_ "GenMsgCycleTime" BO_ 1 1e999;', "'M': GenMsgCycleTime: a finite number is needed"),
            ('BA_ "GenMsgCycleTime" BO_ 1 -5;', "message 'M': GenMsgCycleTime: -5 ms is no time"),
            ('BA_ "GenSigSNA" SG_ 1 S "?";', "message 'M': signal S: GenSigSNA: a finite number is needed"),
            ('CM_ 1 "no keyword";', "not valid in a DBC file: 'CM_ 1 \"no keyword\"'"),
            ("nonsense ;", "not valid in a DBC file: 'nonsense'"),
            ("BO_ nine N: 8 A", "not valid in a DBC file: 'BO_ nine N: 8 A'"),
            (f"BO_ 9 N: {'9' * 500} A", "is beyond all that a DBC file needs"),
        ],
    )
    def test_of_an_entry(self, tmp_path: Path, line: str, said: str) -> None:
        path = write(tmp_path, S, tail=f"{line}\n")
        number = path.read_text().splitlines().index(line) + 1
        database = load_dbc(path)
        (warning,) = database.warnings
        assert warning.startswith(f"{path}: line ") and said in warning
        assert f"line {number}: " in warning or "-5 ms" in warning  # which is of the message
        database.require("M").require("S")

    def test_a_flaw_of_a_message_names_it(self, tmp_path: Path) -> None:
        path = tmp_path / "test.dbc"
        path.write_text(f"{HEAD}\nBO_ 4294967295 M: 8 A\n SG_ {S}\nBO_ 2 Long: 1786 A\n SG_ {S}\n")
        assert "M.S: frame id 0x7fffffff is beyond 0x1fffffff, the greatest of an extended frame" in refusal(
            path
        )
        first, second = load_dbc(path).warnings
        assert "line 6: message 'M' cannot be used" in first
        assert "line 8: message 'Long' cannot be used: the message has 1786 bytes; at most 1785" in second

    def test_an_id_of_more_than_11_bits_is_an_extended_one(self, tmp_path: Path) -> None:
        path = tmp_path / "test.dbc"
        path.write_text(f"{HEAD}\nBO_ 2048 M: 8 A\n SG_ {S}\nBO_ 2047 N: 8 A\n SG_ {S}\n")
        database = load_dbc(path)
        assert [(m.frame_id, m.extended) for m in database.messages.values()] == [(2048, True), (2047, False)]
        (warning,) = database.warnings
        assert "line 6: message 'M': the id 2048 has more than 11 bits; it is taken as an extended" in warning

    def test_a_statement_without_its_semicolon_leaves_the_next(self, tmp_path: Path) -> None:
        path = write(
            tmp_path, S, tail='CM_ SG_ 1 S "one"\nVAL_ 1 S 3 "Three" ;\nBA_ "GenMsgCycleTime" BO_ 1 20\n'
        )
        message = load_dbc(path).messages["M"]
        assert (message.signals["S"].comment, message.signals["S"].choices) == ("one", {3: "Three"})
        assert message.cycle_time == 0.02

    def test_sections_that_are_missing(self, tmp_path: Path) -> None:
        path = tmp_path / "test.dbc"
        path.write_text(f'VERSION ""\n\nNS_ :\n  NS_DESC_\n  CM_\n\nBO_ 256 M: 8 A\n SG_ {S}\n')
        database = load_dbc(path)
        assert database.require("M").require("S").line == 8
        assert database.warnings == ()

    def test_a_file_that_ends_in_the_middle(self, tmp_path: Path) -> None:
        text = write(tmp_path, S, OK, tail='CM_ SG_ 1 S "a comment";\nVAL_ 1 S 3 "Three" ;\n').read_text()
        path = tmp_path / "cut.dbc"
        for end in range(text.index(" SG_ Fine"), len(text), 7):
            path.write_text(text[:end])
            load_dbc(path).require("M").require("S")

    def test_keywords_in_a_comment_are_text(self, tmp_path: Path) -> None:
        comment = 'BO_ 7 X: 8 A;\n SG_ Y : 0|1@1+ (1,0) [0|0] \\"\\" B\nVAL_ 1 S 4 //'
        path = write(tmp_path, S, tail=f'CM_ BO_ 1 "{comment}";// CM_ BO_ 1 "no";\n')
        database = load_dbc(path)
        assert list(database.messages) == ["M"] and database.warnings == ()
        assert database.messages["M"].comment == comment.replace('\\"', '"')


LONG = """VERSION ""
BU_: A B
BO_ 1 M: 8 A
 SG_ Sel M : 0|4@1+ (1,0) [0|15] "" B
 SG_ Sub m1M : 4|4@1+ (1,0) [0|15] "" B
 SG_ Deep m1 : 8|8@1+ (1,0) [0|0] "" B
SG_MUL_VAL_ 1 Sub Sel 1-1;
SG_MUL_VAL_ 1 Deep Sub 1-3, 5-5;
BO_ 2 N: 8 A
 SG_ Sel M : 0|4@1+ (1,0) [0|15] "" B
 SG_ Value m1 : 8|8@1+ (1,0) [0|0] "" B
BA_DEF_ SG_ "SystemSignalLongSymbol" STRING ;
BA_DEF_ BU_ "SystemNodeLongSymbol" STRING ;
BA_ "SystemSignalLongSymbol" SG_ 1 Sel "ALongSelector";
BA_ "SystemSignalLongSymbol" SG_ 1 Sub "AnotherLongSelector";
BA_ "SystemSignalLongSymbol" SG_ 2 Sel "TheLongestSelector";
BA_ "SystemNodeLongSymbol" BU_ A "ANodeWithALongName";
"""


@pytest.mark.parametrize(
    "name", ["GenMsgCycleTime", "GenMsgStartDelayTime", "GenMsgDelayTime", "GenMsgCycleTimeFast"]
)
@pytest.mark.parametrize("value", ["1e20", "1e25", "3600001", "-1"])
def test_a_time_that_no_message_has_is_a_flaw(tmp_path: Path, name: str, value: str) -> None:
    tail = f'BA_DEF_ BO_ "{name}" FLOAT 0 0;\nBA_ "{name}" BO_ 1 {value};\n'
    database = load_dbc(write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" X', tail=tail))
    message = database.messages["M"]
    assert (
        message.cycle_time is message.fast_cycle is None and message.start_delay == message.min_interval == 0
    )
    (said,) = database.warnings
    assert re.search(
        rf"test\.dbc: line \d+: message 'M': {name}: .* ms is (more than 3600 s|no time); it is left", said
    )


def test_a_range_that_ends_before_it_begins_stops_who_uses_its_signal(tmp_path: Path) -> None:
    signals = [
        'A M : 0|8@1+ (1,0) [0|0] "" X',
        'X m0 : 8|8@1+ (1,0) [0|0] "" X',
        'Y m0 : 8|8@1+ (1,0) [0|0] "" X',
    ]
    path = write(tmp_path, *signals, tail="SG_MUL_VAL_ 1 X A 4-4, 9-3;\nSG_MUL_VAL_ 1 Y A 5-5;\n")
    assert "the range 9-3 ends before it begins" in refusal(path, "X")
    database = load_dbc(path)
    assert "X" in database.warnings[0] and not database.messages["M"].signals["Y"].problem


@pytest.mark.parametrize(("kind", "written", "cycle"), [
    ('ENUM "10","20"', "1", 0.02), ('ENUM "10","20"', '"10"', 0.01), ("INT 0 100", "1", 0.001),
])  # fmt: skip # rows
def test_the_choices_of_a_time_may_be_numbers(tmp_path: Path, kind: str, written: str, cycle: float) -> None:
    tail = f'BA_DEF_ BO_ "GenMsgCycleTime" {kind};\nBA_ "GenMsgCycleTime" BO_ 1 {written};\n'
    database = load_dbc(write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" X', tail=tail))
    assert (database.messages["M"].cycle_time, database.warnings) == (cycle, ())


def test_a_send_type_that_is_no_enum_is_a_flaw(tmp_path: Path) -> None:
    tail = 'BA_DEF_ BO_ "GenMsgSendType" INT 0 10;\nBA_ "GenMsgSendType" BO_ 1 1;\n'
    database = load_dbc(write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" X', tail=tail))
    assert database.messages["M"].send_type == ""
    assert database.warnings[0].endswith(
        "message 'M': GenMsgSendType: the attribute is no ENUM, so that 1 says nothing"
    )


def test_long_names_are_those_of_multiplexers_and_nodes_too(tmp_path: Path) -> None:
    path = tmp_path / "long.dbc"
    path.write_text(LONG)
    database = load_dbc(path)
    assert (database.warnings, database.nodes) == ((), ("ANodeWithALongName", "B"))
    found = {}
    for message in database.messages.values():
        assert message.senders == ("ANodeWithALongName",)
        found |= {name: message.require(name).multiplexer for name in message.signals}
    assert found == {
        "ALongSelector": "", "AnotherLongSelector": "ALongSelector", "Deep": "AnotherLongSelector",
        "TheLongestSelector": "", "Value": "TheLongestSelector",
    }  # fmt: skip # pairs


@pytest.mark.parametrize(("low", "high"), [("0", "0"), ("0.0", "0.0"), ("0", "0.0"), ("-0", "0E0")])
def test_a_range_from_0_to_0_is_none_however_it_is_written(tmp_path: Path, low: str, high: str) -> None:
    path = tmp_path / "range.dbc"
    path.write_text(f'{HEAD}\nBO_ 1 M: 8 A\n SG_ S : 0|8@1+ (0.5,0) [{low}|{high}] "" B\n')
    signal = load_dbc(path).messages["M"].signals["S"]
    assert (signal.minimum, signal.maximum) == (None, None)


def test_what_a_file_says_twice_or_undefined_is_a_flaw(tmp_path: Path) -> None:
    own = 'BA_ "GenMsgCycleTime" BO_ 1 10;\nBA_ "GenMsgCycleTime" BO_ 1 20;\n'
    tail = own + 'VAL_ 1 S 0 "off" 1 "on" 1 "error";\nSIG_VALTYPE_ 1 T : 9;\n'
    signals = ['S : 0|8@1+ (1,0) [0|0] "" X', 'T : 8|8@1+ (1,0) [0|0] "" X']
    database = load_dbc(write(tmp_path, *signals, tail=tail))
    message = database.messages["M"]
    assert message.cycle_time == 0.02 and message.signals["S"].choices == {0: "off", 1: "error"}
    assert "9 is no type of value" in message.signals["T"].problem
    rules = ["cannot be used: line", "given a second time; this one counts", "has two texts for 1; the last"]
    assert len(database.warnings) == 3
    assert all(rule in said for rule, said in zip(rules, database.warnings, strict=True))


def test_a_start_value_that_is_far_too_great_is_said_in_a_line(tmp_path: Path) -> None:
    path = write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" X', tail='BA_ "GenSigStartValue" SG_ 1 S 1e300;\n')
    said = load_dbc(path).messages["M"].signals["S"].problem
    assert (
        said.startswith("the start value 1000")
        and "... is no raw value of 8 unsigned bits" in said
        and len(said) < 150
    )
