"""The capabilities of an FMU, each with its meaning here."""

from __future__ import annotations

from types import SimpleNamespace

from evcosim.master.cli.info_capabilities import capabilities, limitations


def test_info_says_what_a_capability_means_here(evcosim) -> None:
    about = evcosim("info", "Battery", "--json").json
    (can,) = about["capabilities"].values()
    saves = next(c for c in can if c["what"] == "saves and restores its state")
    assert saves["here"] == "not used in a run; 'evcosim check --try' tests it"
    assert all(c["what"] and c["here"] for c in (*can, *about["limits"]))


def test_capabilities_and_limits_of_an_interface():
    kind = SimpleNamespace(
        canInterpolateInputs=True,
        canGetAndSetFMUstate="false",
        canGetAndSetFMUState=True,
        maxOutputDerivativeOrder=2,
        fixedInternalStepSize="0.002",
        needsExecutionTool=True,
    )
    found = {entry["what"]: entry["here"] for entry in capabilities(kind)}
    assert list(found) == [
        "interpolates inputs within a step",
        "saves and restores its state",
        "output derivatives up to order 2",
        "fixed internal step of 0.002 s",
    ]
    (tool,) = limitations(kind, holds_python=False)
    assert tool == {"what": "needs an execution tool", "here": "the tool that made it has to be installed"}
    assert limitations(kind, holds_python=True)[0]["here"].startswith("Python, which is there")


def test_names_of_fmi_2_and_3_are_one_capability():
    both = SimpleNamespace(canGetAndSetFMUstate=True, canGetAndSetFMUState=True)
    assert len(capabilities(both)) == 1
