"""The CAN database: what is read from a DBC file, and what is refused, in words that name the place."""

from __future__ import annotations

import logging
import math
from pathlib import Path

import cantools
import pytest

from evcosim.cosim.can import dbc
from evcosim.cosim.can.dbc import ConfigError, Message, Signal, load_dbc, schedule

EV = Path(dbc.__file__).parents[1] / "data" / "can" / "ev.dbc"

HEAD = 'VERSION ""\nNS_ :\nBS_:\nBU_: A B\n'
CYCLE = (
    'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;\n'
    'BA_DEF_ BO_ "GenMsgStartDelayTime" INT 0 65535;\n'
    'BA_DEF_ SG_ "GenSigSNA" INT -32768 65535;\n'
    'BA_DEF_ SG_ "GenSigStartValue" FLOAT -1E9 1E9;\n'
    'BA_DEF_DEF_ "GenMsgCycleTime" 0;\n'
    'BA_DEF_DEF_ "GenMsgStartDelayTime" 0;\n'
    'BA_DEF_DEF_ "GenSigSNA" 0;\n'
    'BA_DEF_DEF_ "GenSigStartValue" 0;\n'
)


def write(folder: Path, *signals: str, tail: str = "", length: int = 8, encoding: str = "utf-8") -> Path:
    """A DBC file of one message M (id 1) with these signal lines."""
    lines = "".join(f" SG_ {s}\n" for s in signals)
    path = folder / "test.dbc"
    path.write_bytes(f"{HEAD}\nBO_ 1 M: {length} A\n{lines}\n{CYCLE}{tail}".encode(encoding))
    return path


def refusal(path: Path, signal: str | None = None) -> str:
    """The message of the ConfigError that loading (and asking for the signal) raises."""
    with pytest.raises(ConfigError) as caught:
        message = load_dbc(path).require("M", "scooter.toml")
        message.require(signal or "S", "scooter.toml")
    return str(caught.value)


class TestEv:
    """The project's own database."""

    def test_cantools_reads_it_strictly_without_a_warning(self, caplog: pytest.LogCaptureFixture) -> None:
        with caplog.at_level(logging.DEBUG, logger="cantools"):
            database = cantools.database.load_file(EV, strict=True)
        assert not [record for record in caplog.records if record.levelno >= logging.WARNING]
        assert all(message.comment for message in database.messages)
        assert {message.name for message in database.messages} == set(load_dbc(EV).messages)

    def test_every_signal_can_carry_a_connection_except_the_multiplexed(self) -> None:
        for message in load_dbc(EV).messages.values():
            for name in message.signals:
                if message.multiplexed:
                    with pytest.raises(ConfigError, match="multiplexed"):
                        message.require(name)
                else:
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
        assert schedule(message, 0.01) == (every, 0)

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
            not_available=-2048, comment="Oil",
        )  # fmt: skip # one line a group

    @pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252"])
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
        with pytest.raises(ConfigError, match=r"none\.dbc: cannot read the CAN database: No such file"):
            load_dbc(tmp_path / "none.dbc")

    @pytest.mark.parametrize("text", ["", "hello", "time,speed\n0,1\n", "<xml/>"])
    def test_no_dbc_at_all(self, tmp_path: Path, text: str) -> None:
        path = tmp_path / "test.dbc"
        path.write_text(text)
        with pytest.raises(ConfigError, match=r"test\.dbc: line 1: not valid in a DBC file"):
            load_dbc(path)

    def test_a_wrong_line_is_named_and_shown(self, tmp_path: Path) -> None:
        message = refusal(write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" B', 'T : eight|8@1+ (1,0) [0|0] "" B'))
        assert "test.dbc: line 8: not valid in a DBC file: 'SG_ T : eight|8@1+" in message

    def test_overlapping_signals(self, tmp_path: Path) -> None:
        message = refusal(write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" B', 'T : 6|8@1+ (1,0) [0|0] "" B'))
        assert message.endswith("test.dbc: message 'M': signals 'S' and 'T' overlap in bits 6 to 7")

    def test_a_signal_that_does_not_fit(self, tmp_path: Path) -> None:
        message = refusal(write(tmp_path, 'S : 4|16@1+ (1,0) [0|0] "" B', length=2))
        assert "message 'M': signal 'S' (start bit 4, 16 bits) does not fit into 2 bytes" in message

    def test_a_signal_given_twice(self, tmp_path: Path) -> None:
        message = refusal(write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" B', 'S : 8|8@1+ (1,0) [0|0] "" B'))
        assert "message 'M': signal S is given twice" in message

    @pytest.mark.parametrize(
        ("second", "what"), [("BO_ 1 N: 8 A", "frame id 0x1"), ("BO_ 2 M: 8 A", "message M")]
    )
    def test_a_message_given_twice(self, tmp_path: Path, second: str, what: str) -> None:
        path = tmp_path / "test.dbc"
        path.write_text(f"{HEAD}\nBO_ 1 M: 8 A\n\n{second}\n\n")
        with pytest.raises(ConfigError, match=f"{what} is given twice"):
            load_dbc(path)

    def test_unknown_names_have_the_nearest(self) -> None:
        database = load_dbc(EV)
        with pytest.raises(
            ConfigError, match=r"^s\.toml: .*ev\.dbc: no message 'EMD_Statu' \(did you mean 'EMD_Status'"
        ):
            database.require("EMD_Statu", "s.toml")
        with pytest.raises(
            ConfigError, match=r"'EMD_Status' has no signal 'EMD_Speed'.*signals: EMD_VehicleSpeed, "
        ):
            database.require("EMD_Status").require("EMD_Speed", "s.toml")

    @pytest.mark.parametrize(
        ("signal", "says"),
        [
            ('S : 0|8@1+ (1,0) [0|255] "" B', "sent as raw 0 to 255, but raw 255 means not available"),
            ('S : 0|8@1+ (1,0) [0|300] "" B', "sent as raw 0 to 255, but raw 255 means not available"),
            ('S : 0|8@1+ (0.4,0) [0|101.9] "%" B', "values in [0, 101.9] are sent as raw 0 to 255"),
            ('S : 0|8@1+ (-1,255) [0|100] "" B', "raw 155 to 255"),
            ('S : 0|9@1+ (1,0) [0|0] "" B', "raw 0 to 511, but raw 255 means not available"),
        ],
    )
    def test_a_value_that_would_be_sent_as_not_available(
        self, tmp_path: Path, signal: str, says: str
    ) -> None:
        message = refusal(write(tmp_path, signal, tail='BA_ "GenSigSNA" SG_ 1 S 255;\n'))
        assert message.startswith("scooter.toml: ") and "test.dbc: M.S: " in message and says in message

    def test_a_range_that_was_not_written_ends_before_the_code(self, tmp_path: Path) -> None:
        path = write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" B', tail='BA_ "GenSigSNA" SG_ 1 S 255;\n')
        signal = load_dbc(path).require("M").require("S")
        assert (signal.raw_type_range, signal.raw_range) == ((0, 255), (0, 254))

    @pytest.mark.parametrize(
        ("signal", "says"),
        [
            ('S : 0|8@1+ (0,0) [0|0] "" B', "scale 0 and offset 0: no value can be told from another"),
            ('S : 0|8@1+ (1,0) [5|4] "" B', "minimum 5 is above maximum 4"),
            ('S : 0|8@1+ (1,0) [300|400] "" B', "no value in [300, 400] fits into 8 unsigned bits"),
        ],
    )
    def test_contradictions(self, tmp_path: Path, signal: str, says: str) -> None:
        assert says in refusal(write(tmp_path, signal))

    def test_a_start_value_that_does_not_fit(self, tmp_path: Path) -> None:
        path = write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" B', tail='BA_ "GenSigStartValue" SG_ 1 S 256;\n')
        assert "the start value 256 of S is no raw value of 8 unsigned bits" in refusal(path)

    def test_a_message_nobody_asks_for_stops_nothing(self, tmp_path: Path) -> None:
        path = write(tmp_path, 'S : 0|8@1+ (1,0) [5|4] "" B')
        assert "M" in load_dbc(path).messages


class TestSchedule:
    @staticmethod
    def message(cycle_ms: int | None, delay_ms: int = 0) -> Message:
        cycle = None if cycle_ms is None else cycle_ms / 1000
        return Message("ev.dbc", "M", 1, cycle_time=cycle, start_delay=delay_ms / 1000)

    @pytest.mark.parametrize("cycle", [1, 3, 7, 10, 20, 30, 70, 100, 1000])
    @pytest.mark.parametrize("step", [0.001, 1e-3, 0.0005, 0.0001])
    def test_is_exact(self, cycle: int, step: float) -> None:
        assert schedule(self.message(cycle), step) == (round(cycle / 1000 / step), 0)

    def test_ten_milliseconds_are_one_step_of_a_hundredth(self) -> None:
        assert schedule(self.message(10), 0.01) == (1, 0)
        assert schedule(self.message(30), 0.01) == (3, 0)  # in doubles 0.03 / 0.01 is 3.0000000000000004

    @pytest.mark.parametrize(("delay", "first"), [(0, 0), (1, 1), (9, 1), (10, 1), (11, 2), (70, 7)])
    def test_the_first_is_at_or_after_the_start_delay(self, delay: int, first: int) -> None:
        assert schedule(self.message(20, delay), 0.01) == (2, first)

    def test_no_multiple(self) -> None:
        with pytest.raises(
            ConfigError, match=r"^s\.toml: ev\.dbc: message 'M': its cycle time 0\.015 s is no multiple"
        ):
            schedule(self.message(15), 0.01, "s.toml")
        with pytest.raises(ConfigError, match=r"no multiple of the communication step 0\.02 s"):
            schedule(self.message(10), 0.02)

    def test_no_cycle_time(self) -> None:
        with pytest.raises(ConfigError, match=r"'M' has no cycle time.*GenMsgCycleTime"):
            schedule(self.message(None), 0.01)

    @pytest.mark.parametrize("step", [0.0, -0.01])
    def test_a_step_that_is_none(self, step: float) -> None:
        with pytest.raises(ConfigError, match="must be positive"):
            schedule(self.message(10), step)


def test_float_ranges_are_those_of_ieee_754() -> None:
    single, double = (Signal("S", 0, n, is_float=True).raw_type_range[1] for n in (32, 64))
    assert single == (2 - 2**-23) * 2.0**127
    assert math.nextafter(double, math.inf) == math.inf
