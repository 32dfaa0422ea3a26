"""What an FMU declares of its tool and its steps, beside those of a run: warnings of run and check."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.system.system import load_system
from evcosim.cosim.system.toml import DATA, names_in
from evcosim.master.cli import main
from evcosim.master.fmi.doubts import doubts
from evcosim.master.fmi.fmu import Fmu, read_fmu
from evcosim.master.prepare import prepare
from evcosim.master.simulation import simulate
from support.c_fmu import vehicle_fmu
from support.descriptions import described

DESCRIPTION = """<fmiModelDescription fmiVersion="{fmi}" modelName="m" {token}="g"
  generationTool="Simulator 7"><{kind} modelIdentifier="m" {attributes}/>{experiment}<ModelVariables/>
<ModelStructure/></fmiModelDescription>"""
EXPERIMENT = '<DefaultExperiment stepSize="0.02"/>'
CHANGES = 'canHandleVariableCommunicationStepSize="{}"'


def fmu(folder: Path, attributes: str = "", experiment: str = "", fmi: str = "2.0", kind: str = "") -> Fmu:
    """An FMU with such attributes of its interface, Co-Simulation if it is not said."""
    text = DESCRIPTION.format(
        fmi=fmi, token="guid" if fmi == "2.0" else "instantiationToken", kind=kind or "CoSimulation",
        attributes=attributes, experiment=experiment,
    )  # fmt: skip # the placeholders
    return read_fmu(described(folder, text))


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
@pytest.mark.parametrize("attributes", ["", CHANGES.format("false"), CHANGES.format("0")])
def test_another_step_than_the_declared_one(tmp_path: Path, fmi: str, attributes: str) -> None:
    made = fmu(tmp_path, attributes, EXPERIMENT, fmi)
    (clause,) = doubts(made, [0.01])
    assert "takes steps of 0.02 s only (canHandleVariableCommunicationStepSize" in clause
    assert "its steps here are of 0.01 s" in clause
    assert doubts(made, [0.02]) == doubts(made, [0.02 * (1.0 + 1e-15)]) == []


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_no_step_is_doubtful_where_it_may_change_or_none_is_declared(tmp_path: Path, fmi: str) -> None:
    assert doubts(fmu(tmp_path, CHANGES.format("true"), EXPERIMENT, fmi), [0.01, 0.005]) == []
    assert doubts(fmu(tmp_path, fmi=fmi), [0.01, 0.01]) == []
    assert doubts(fmu(tmp_path, "", '<DefaultExperiment stepSize="0"/>', fmi), [0.01]) == []
    assert doubts(fmu(tmp_path, "", EXPERIMENT, fmi, "ModelExchange"), [0.01]) == []


def test_a_shorter_last_step(tmp_path: Path) -> None:
    (clause,) = doubts(fmu(tmp_path), [0.02, 0.01])
    assert "takes steps of one size only" in clause and "its last step is of 0.01 s, not of 0.02 s" in clause


def test_no_multiple_of_the_internal_step(tmp_path: Path) -> None:
    made = fmu(tmp_path, 'fixedInternalStepSize="0.004" ' + CHANGES.format("true"), EXPERIMENT, "3.0")
    (clause,) = doubts(made, [0.01])
    assert "internal steps of 0.004 s (fixedInternalStepSize)" in clause
    assert doubts(made, [0.012]) == doubts(made, [0.04]) == []
    (clause,) = doubts(made, [0.001])
    assert "its steps here, 0.001 s, are no multiple" in clause


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_a_tool_that_is_needed(tmp_path: Path, fmi: str, kind: str) -> None:
    made = fmu(tmp_path, 'needsExecutionTool="true"', fmi=fmi, kind=kind)
    assert doubts(made, [0.01]) == ["needs Simulator 7 on the machine where it runs (needsExecutionTool)"]


def test_our_own_fmus_are_beyond_doubt() -> None:
    for name in names_in(DATA / "systems"):
        warnings = prepare(load_system(name)).plan.warnings
        assert not [w for w in warnings if "needsExecutionTool" in w or "steps" in w]


def test_run_and_check_warn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    interface = '<CoSimulation modelIdentifier="vehicle"/>'
    needing = interface.replace("/>", ' needsExecutionTool="true"/>')
    changed = {interface: needing + EXPERIMENT}
    made = vehicle_fmu(tmp_path / "vehicle.fmu", 2, **changed)
    path = tmp_path / "alone.toml"
    path.write_text(
        'name = "alone"\n[experiment]\nstop_time = 0.05\n[units.a]\nfmu = "vehicle.fmu"\nisolation = "none"\n'
    )
    warnings = simulate(path, trust=True).manifest["warnings"]
    assert [w for w in warnings if w.startswith("unit 'a' needs its tool on the machine")]
    assert [w for w in warnings if w.startswith("unit 'a' takes steps of 0.02 s only")]
    path.write_text(path.read_text().replace("[units.a]", "[units.a]\nperiod = 0.02"))
    warnings = simulate(path, trust=True).manifest["warnings"]
    assert [w for w in warnings if "its last step is of 0.01 s" in w] and "0.02 s only" not in str(warnings)
    main(["check", str(made), "--as", "scooter.vehicle"])
    printed = capsys.readouterr().out
    assert "warning: the FMU takes steps of 0.02 s only" in printed
    assert "warning: the FMU needs its tool" in printed
    swap = tmp_path / "swap.toml"
    swap.write_text('fmu = "vehicle.fmu"\nperiod = 0.04\nsubsteps = 2\n')
    main(["check", str(swap), "--as", "scooter.vehicle"])
    assert "takes steps" not in capsys.readouterr().out
