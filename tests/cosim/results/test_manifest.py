"""run.json: what is written reads back, and a broken one is named."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.manifest import read_manifest, write_manifest
from evcosim.cosim.results.variable import ResultVariable

SPEED = ResultVariable("vehicle.speed", "m/s", description="Speed")
STATE = ResultVariable("ecu.state", type="Enumeration", items=((0, "driver"), (1, "acceleration")))

plain = (
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text()
)
nested = st.recursive(plain, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=8)


@given(about=st.dictionaries(st.text().filter(lambda key: key != "variables"), nested))
def test_what_is_written_reads_back(about: dict, tmp_path_factory) -> None:
    path = tmp_path_factory.getbasetemp() / "run.json"
    write_manifest(path, about, [SPEED, STATE])
    assert read_manifest(path) == (about, {"vehicle.speed": SPEED, "ecu.state": STATE})


def test_numpy_numbers_paths_and_nan_become_what_json_has(tmp_path: Path) -> None:
    manifest = {"x": np.float64(1.5), "n": np.int64(2), "at": Path("a"), "worst": float("nan"), "t": (1, 2)}
    write_manifest(tmp_path / "run.json", manifest, [SPEED])
    kept = json.loads((tmp_path / "run.json").read_text())
    assert kept.pop("variables")[0]["unit"] == "m/s"
    assert kept == {"x": 1.5, "n": 2, "at": "a", "worst": None, "t": [1, 2]}


def test_a_path_that_is_no_text_is_kept(tmp_path: Path) -> None:
    write_manifest(tmp_path / "run.json", {"at": "a\udc80"}, [])
    assert read_manifest(tmp_path / "run.json")[0] == {"at": "a\udc80"}


def test_without_a_file_nothing_is_known(tmp_path: Path) -> None:
    assert read_manifest(tmp_path / "run.json") == ({}, {})


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("{", "is not a JSON file"),
        ("\xff", "is not a JSON file"),
        ('{"a": ' + "[" * 200_000, "is not a JSON file"),
        ('{"a": ' + "1" * 5000 + "}", "is not a JSON file"),
        ("[]", "a JSON object is needed, not list"),
        ('{"variables": [{"nome": 1}]}', "'variables' does not describe the variables"),
        ('{"variables": [3]}', "'variables' does not describe the variables"),
        ('{"variables": 3}', "'variables' does not describe the variables"),
    ],
)
def test_a_broken_file_is_named(text: str, reason: str, tmp_path: Path) -> None:
    (tmp_path / "run.json").write_text(text, encoding="latin-1")
    with pytest.raises(ConfigError, match=rf"run.json: {reason}"):
        read_manifest(tmp_path / "run.json")
