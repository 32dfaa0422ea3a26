"""The task of an identification: its keys and its band."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.identification_spec import IdentificationSpec
from evcosim.cosim.system.toml import validate

TASK = {"input": "ecu.throttle", "output": "vehicle.speed", "amplitude": 1.0}


@given(st.floats(1e-3, 1.0), st.floats(4.0, 100.0))
def test_the_band_lies_in_the_sweep(lowest: float, ratio: float) -> None:
    spec = IdentificationSpec.model_validate(TASK | {"sweep": [lowest, lowest * ratio]})
    low, high = spec.fit_band
    assert spec.sweep[0] < low < high < spec.sweep[1]


def test_a_band_that_is_given_counts() -> None:
    assert IdentificationSpec.model_validate(TASK | {"band": [0.05, 0.3]}).fit_band == (0.05, 0.3)


@pytest.mark.parametrize("key", TASK)
def test_what_a_task_needs(key: str) -> None:
    with pytest.raises(ConfigError, match=rf"^f: {key}: this key is needed$"):
        validate({k: v for k, v in TASK.items() if k != key}, IdentificationSpec, "f")


def test_a_sweep_has_two_ends() -> None:
    with pytest.raises(ConfigError, match=r"^f: sweep 2: this value is needed$"):
        validate(TASK | {"sweep": [0.1]}, IdentificationSpec, "f")
    with pytest.raises(ConfigError, match=r"^f: band: Tuple should have at most 2 items after validation"):
        validate(TASK | {"band": [0.1, 0.2, 0.3]}, IdentificationSpec, "f")
