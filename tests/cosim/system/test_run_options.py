"""The options of a run: their names, and what they may be."""

from __future__ import annotations

import re

import numpy as np
import pytest

from evcosim.cosim.can.bus_settings import BusVariation
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.run_options import RunOptions, check_options


def test_the_names_that_there_are_pass() -> None:
    check_options(dict.fromkeys(RunOptions.__optional_keys__))
    check_options({})


def test_every_option_may_be_left_out() -> None:
    assert not RunOptions.__required_keys__


@pytest.mark.parametrize("name", sorted(RunOptions.__optional_keys__))
def test_a_misspelled_name_is_told_the_nearest(name: str) -> None:
    with pytest.raises(TypeError, match=rf"has no option '{name}x' \(did you mean '{name}'\?\); there"):
        check_options({name: None, f"{name}x": None})


@pytest.mark.parametrize("name", sorted(RunOptions.__optional_keys__))
@pytest.mark.parametrize("value", ["no", b"", 1j, [], True])
def test_a_value_of_another_type_is_refused_by_name(name: str, value: object) -> None:
    if (name, value) in ((key, True) for key in ("allow_open", "ideal", "strict", "trust")):
        return check_options({name: value})
    with pytest.raises(ConfigError, match=rf"^{name} = {re.escape(repr(value))}: must be "):
        check_options({name: value})
    return None


def test_numbers_of_numpy_are_numbers() -> None:
    check_options({"stop_time": np.float32(1.5), "bus": BusVariation(delay_steps=np.int64(1))})
