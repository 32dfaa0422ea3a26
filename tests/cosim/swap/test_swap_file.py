"""The swap file: read, put into a system, and written so that reading it gives what was written."""

from __future__ import annotations

import dataclasses
import tempfile
import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.swap.matching import Match
from evcosim.cosim.swap.swap_file import Proposal, SwapFile, entry_of, swapped, write
from evcosim.cosim.system.system import UnitEntry, load_system
from evcosim.cosim.system.toml import read_toml

MATCHES = [
    Match("throttle", "input", "pedal", "fits", "[%]", candidates=("pedal", "brake")),
    Match("brake_force", "input", "F_b", "your choice", "declares no unit of measure", unit="N"),
    Match("grade", "input", "", "missing", "no variable is left", candidates=("a", "b")),
    Match("", "input", "alpha", "unused", "nothing drives it: it keeps 0.0 rad"),
    Match("speed", "output", "v", "fits", "as mapped, inverted: [m/s]", unit="m/s", invert=True),
    Match("mass", "parameter", "m_total", "fits", "[kg]"),
]


def text_of(tmp_path: Path, entry: UnitEntry | None = None, proposal: Proposal | None = None) -> str:
    path = tmp_path / "swap.toml"
    write(path, str(tmp_path / "V.fmu"), "scooter.vehicle", MATCHES, entry, proposal)
    return path.read_text(encoding="utf-8")


# ---- writing


def test_a_written_file_reads_well(tmp_path: Path) -> None:
    assert (
        text_of(tmp_path)
        == """\
# V.fmu in the place of scooter.vehicle; made by evcosim check, to be edited.
fmu = "V.fmu"
replaces = "scooter.vehicle"
# names of the system that the FMU does not have; what needs them is left out
absent = ["grade"]

[map.inputs]
throttle = "pedal"  # [%]; others: brake
brake_force = { variable = "F_b", unit = "N" }  # declares no unit of measure: assumed
# grade = ?  # no variable is left; others: a, b
# alpha: nothing drives it: it keeps 0.0 rad

[map.outputs]
speed = { variable = "v", unit = "m/s", invert = true }  # as mapped, inverted: [m/s]

[map.parameters]
mass = "m_total"  # [kg]
"""
    )


def test_a_proposal_is_marked_with_its_reason(tmp_path: Path) -> None:
    proposal = Proposal(
        substeps=10,
        why_substeps="steps of 10 ms differ",
        invert={("inputs", "throttle"): "it reacts the other way", ("outputs", "speed"): "it falls"},
        remarks=("A trial found:", "problem: x\ny"),
    )
    text = text_of(tmp_path, None, proposal)
    assert "substeps = 10  # proposed: steps of 10 ms differ\n" in text
    assert 'throttle = { variable = "pedal", invert = true }  # [%]; others: brake; proposed: ' in text
    assert 'speed = { variable = "v", unit = "m/s" }  # as mapped, inverted: [m/s]; proposed: ' in text
    assert "proposed: invert = false, since it falls\n" in text
    assert "\n\n# A trial found:\n# problem: x y\n\n[map.inputs]\n" in text


def test_what_is_written_is_what_the_matches_say(tmp_path: Path) -> None:
    text_of(tmp_path)
    assert read_toml(tmp_path / "swap.toml", SwapFile) == SwapFile(
        **dict(entry_of("V.fmu", MATCHES)), replaces="scooter.vehicle"
    )


texts = st.text(max_size=12)  # quotes, control characters, line ends and every language among them
names = texts.filter(bool)
values = st.booleans() | st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False) | texts
matches = st.builds(
    Match,
    need=names,
    role=st.sampled_from(["input", "output", "parameter"]),
    variable=texts,
    verdict=st.sampled_from(["fits", "your choice", "missing", "unused"]),
    reason=texts,
    candidates=st.lists(names, max_size=3).map(tuple),
    unit=texts,
    invert=st.booleans(),
)
entries = st.builds(
    UnitEntry,
    fmu=names,
    parameters=st.dictionaries(texts, values, max_size=3),
    start=st.dictionaries(texts, values, max_size=3),
    period=st.none() | st.floats(1e-6, 1e6),
    offset=st.none() | st.floats(0.0, 1e6),
    substeps=st.integers(1, 1000),
    isolation=st.sampled_from([None, "process", "none"]),
    step_timeout=st.floats(1e-3, 1e3),
    load_timeout=st.floats(1e-3, 1e3),
    memory_limit=st.floats(256e6),
    file_limit=st.floats(1.0, exclude_min=True),
    interface=st.sampled_from([None, "co_simulation", "model_exchange"]),
    tolerance=st.none() | st.floats(1e-12, 0.5),
    strict=st.booleans(),
)


@given(st.lists(matches, max_size=5, unique_by=lambda m: (m.role, m.need)), entries, texts)
def test_every_text_and_every_key_comes_back(found: list[Match], entry: UnitEntry, place: str) -> None:
    """Whatever names an FMU has, and whatever a mapping that is written again says."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "swap.toml"
        write(path, str(Path(folder) / "V.fmu"), place, found, entry)
        read = read_toml(path, SwapFile)
    assert read == SwapFile(**dict(entry_of("V.fmu", found, entry)), replaces=place)


@given(st.lists(matches, max_size=5, unique_by=lambda m: (m.role, m.need)), texts)
def test_no_text_of_an_fmu_ends_its_line(found: list[Match], reason: str) -> None:
    """Comments hold what an FMU says; the keys of the file are those of a mapping all the same."""
    found = [dataclasses.replace(m, variable="v", verdict="fits") for m in found]
    proposal = Proposal(2, reason, {(f"{m.role}s", m.need): reason for m in found}, (reason,))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "swap.toml"
        write(path, str(Path(folder) / "V.fmu"), "s.u", found, None, proposal)
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    assert set(data) == {"fmu", "replaces", "substeps", "absent", "map"}
    assert {(role[:-1], name) for role, table in data["map"].items() for name in table} == {
        (m.role, m.need) for m in found
    }


# ---- reading


def swap(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "swap.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_swap_takes_the_place_of_the_units_entry(tmp_path: Path) -> None:
    (tmp_path / "V.fmu").write_bytes(b"")
    path = swap(tmp_path, "fmu = 'V.fmu'\nreplaces = 'scooter.vehicle'\nsubsteps = 4\n")
    before = load_system("scooter")
    after = swapped(before, {"vehicle": path})
    assert after.file.units["vehicle"] == UnitEntry(fmu=str((tmp_path / "V.fmu").resolve()), substeps=4)
    assert {n: u for n, u in after.file.units.items() if n != "vehicle"} == {
        n: u for n, u in before.file.units.items() if n != "vehicle"
    }
    assert list(after.file.units) == list(before.file.units)
    assert (after.keys_of("vehicle"), after.keys_of("ecu")) == (f"{path}: ", before.keys_of("ecu"))


def test_a_built_in_name_stays_a_name(tmp_path: Path) -> None:
    after = swapped(load_system("scooter"), {"vehicle": swap(tmp_path, "fmu = 'Scooter'\n")})
    assert after.file.units["vehicle"] == load_system("scooter").file.units["vehicle"]


@pytest.mark.parametrize(
    ("text", "period", "offset"),
    [("", 0.02, 0.01), ("period = 0.04\n", 0.04, 0.01), ("offset = 0.0\n", 0.02, 0.0)],
)
def test_period_and_offset_stay_the_systems_unless_the_swap_has_them(
    tmp_path: Path, text: str, period: float, offset: float
) -> None:
    system = load_system("scooter")
    units = system.file.units | {"vehicle": UnitEntry(fmu="Scooter", period=0.02, offset=0.01)}
    system = dataclasses.replace(system, file=system.file.model_copy(update={"units": units}))
    after = swapped(system, {"vehicle": swap(tmp_path, f"fmu = 'Scooter'\n{text}")})
    unit = after.file.units["vehicle"]
    assert (unit.period, unit.offset) == (period, offset)


@pytest.mark.parametrize(
    ("unit", "text", "said"),
    [
        ("vehicel", "fmu = 'V'\n", r"--swap vehicel=.*: there is no unit 'vehicel' .* \(did you mean 'vehicle'\?\)"),
        ("vehicle", "fmu = 'V'\nreplaces = 'scooter.rider'\n", "replaces = 'scooter.rider': it was not written for scooter.vehicle"),
        ("vehicle", "replaces = 'scooter.vehicle'\n", "swap.toml: fmu: this key is needed"),
    ],
)  # fmt: skip # one case a line
def test_a_swap_that_does_not_belong_there_is_refused(
    tmp_path: Path, unit: str, text: str, said: str
) -> None:
    with pytest.raises(ConfigError, match=said):
        swapped(load_system("scooter"), {unit: swap(tmp_path, text)})


def test_a_factor_is_kept_and_turned_by_a_proposal(tmp_path: Path) -> None:
    match = dataclasses.replace(MATCHES[0], unit="%", factor=0.45, offset=2.0, convert=False)
    path = tmp_path / "swap.toml"
    for proposal, sign in ((Proposal(), 1.0), (Proposal(invert={("inputs", "throttle"): "it falls"}), -1.0)):
        write(path, "V.fmu", "scooter.vehicle", [match], None, proposal)
        entry = read_toml(path, SwapFile).map.inputs["throttle"]
        assert (entry.factor, entry.offset, entry.convert) == (sign * 0.45, sign * 2.0, False)
        assert (entry.unit, entry.invert) == ("%", False)
    assert "proposed: the other sign, since it falls" in path.read_text(encoding="utf-8")
    assert entry_of("V.fmu", [match]).map.inputs["throttle"].factor == 0.45


def test_a_guess_of_a_low_likeness_stands_as_a_comment(tmp_path: Path) -> None:
    found = [
        dataclasses.replace(MATCHES[0], likeness=0.31, verdict="your choice"),
        dataclasses.replace(MATCHES[1], likeness=0.4),
        dataclasses.replace(MATCHES[4], likeness=0.6),
    ]
    path = tmp_path / "swap.toml"
    write(path, "V.fmu", "scooter.vehicle", found)
    text = path.read_text(encoding="utf-8")
    assert '# throttle = "pedal"  # [%]; others: brake\n' in text
    assert '# brake_force = { variable = "F_b", unit = "N" }  # declares no unit' in text
    assert "guesses of a likeness below 0.45 stand below as comments" in text
    read = read_toml(path, SwapFile)
    assert (read.open, list(read.map.inputs), list(read.map.outputs)) == (
        ["throttle", "brake_force"], [], ["speed"],
    )  # fmt: skip # one line a thing
    path.write_text(text.replace("# throttle = ", "throttle = "), encoding="utf-8")
    assert list(read_toml(path, SwapFile).map.inputs) == ["throttle"]
    for likeness, names in ((0.0, []), (0.35, ["throttle"]), (1.0, ["throttle", "brake_force", "speed"])):
        write(path, "V.fmu", "scooter.vehicle", found, None, None, likeness)
        assert read_toml(path, SwapFile).open == names
    assert list(entry_of("V.fmu", found).map.inputs) == ["throttle", "brake_force"]  # a trial tries them


@pytest.mark.parametrize(
    ("name", "said"),
    [
        (
            "V.fmu",
            "is an FMU, not a swap file; 'evcosim check {path} --as scooter.vehicle --write swap.toml'",
        ),
        ("v.c", "is C code, not a swap file"),
        (".", "is a folder"),
    ],
)
def test_another_file_is_told_from_a_swap_file(tmp_path: Path, name: str, said: str) -> None:
    path = tmp_path / name
    if not path.exists():
        path.write_bytes(b"PK")
    with pytest.raises(ConfigError) as refused:
        swapped(load_system("scooter"), {"vehicle": path})
    assert said.format(path=path) in str(refused.value)
