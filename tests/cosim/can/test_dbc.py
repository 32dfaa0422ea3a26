"""The CAN database: what is read from a DBC file, and what is refused, in words that name the place."""

from __future__ import annotations

import logging
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
        with pytest.raises(ConfigError, match=r"none\.dbc: the CAN database cannot be read: No such file"):
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
