"""CAN logs in scenario files."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.can_log_spec import CanLogEntry
from evcosim.cosim.system.scenario import ScenarioFile, StimulusEntry
from evcosim.cosim.system.toml import validate

LOG = {"can_log": "a.blf", "bus": "can0"}


def read(*entries: dict) -> ScenarioFile:
    return validate({"stimulus": list(entries)}, ScenarioFile, "s.toml")


def test_logs_stand_among_stimuli_with_the_numbers_of_the_file() -> None:
    file = read(LOG, {"to": "a.b", "constant": 1}, LOG | {"channel": 2, "time_offset": -1.5})
    assert [(n, type(e)) for n, e in file.can_logs] == [(1, CanLogEntry), (3, CanLogEntry)]
    assert [(n, type(e)) for n, e in file.stimuli] == [(2, StimulusEntry)]
    assert ScenarioFile(stimulus=file.entries).entries == file.entries


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ({"can_log": "a.blf"}, "s.toml: stimulus 2.bus: this key is needed"),
        (LOG | {"offset": 1.0}, "s.toml: stimulus 2.offset: unknown key (did you mean 'time_offset'?)"),
        (
            LOG | {"time_offset": float("nan")},
            "s.toml: stimulus 2.time_offset: Input should be a finite number",
        ),
        (LOG | {"to": {"a.b": "Speed"}}, "a signal of the bus is written as message.signal, not 'Speed'"),
        (LOG | {"to": {"ab": "M.S"}}, "s.toml: stimulus 2.to.ab: "),
        (LOG | {"channel": 1.5}, "s.toml: stimulus 2.channel: "),
        ({"can_log": 3, "bus": "can0"}, "s.toml: stimulus 2.can_log: Input should be a valid string, not 3"),
        ({"to": "a.b"}, "s.toml: stimulus 2: a stimulus has exactly one of constant, table"),
    ],
)
def test_wrong_entries_are_refused_by_place(entry: dict, said: str) -> None:
    with pytest.raises(ConfigError) as caught:
        read(LOG, entry)
    assert said in str(caught.value)
