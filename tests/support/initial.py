"""The unit of sources/initial.c, which shows what it saw in its initialization, and systems of it."""

from __future__ import annotations

from pathlib import Path

from support.c_fmu import SOURCES, compile_fmu

# name, value reference, causality, variability, type of FMI 2.0, start, inputs that reach it at once
_VARIABLES = [
    ("u", 0, "input", "continuous", "Real", "7", ""),
    ("p", 1, "parameter", "tunable", "Real", "1", ""),
    ("entered", 2, "output", "continuous", "Real", "", ""),
    ("within", 3, "output", "continuous", "Real", "", ""),
    ("left", 4, "output", "continuous", "Real", "", ""),
    ("gain", 5, "output", "continuous", "Real", "", ""),
    ("y", 6, "output", "continuous", "Real", "", "u"),
    ("h", 7, "local", "continuous", "Real", "0.5", ""),
    ("der_h", 8, "local", "continuous", "Real", "", ""),
    ("told", 9, "output", "continuous", "Real", "", ""),
    ("n", 10, "input", "discrete", "Integer", "0", ""),
    ("n_entered", 11, "output", "discrete", "Integer", "", ""),
    ("b", 20, "input", "discrete", "Boolean", "false", ""),
    ("b_entered", 21, "output", "discrete", "Boolean", "", ""),
]
_STATE, _DERIVATIVE = 7, 8  # places above
SHOWN = ("entered", "within", "left", "gain", "y", "n_entered", "b_entered")


def initial_fmu(
    path: Path, fmi: int, kind: str = "CS", resets: bool = False, refuses: int = 0, tolerance: str = ""
) -> Path:
    """Write the unit in FMI 1.0, 2.0 or 3.0; `kind` is "CS" or "ME".

    `refuses` is a status of early inputs, `tolerance` the declared one.
    """
    flags = (f"-DFMI={fmi}", f"-DRESETS={int(resets)}", f"-DREFUSES={refuses}")
    name = {"CS": "CoSimulation", "ME": "ModelExchange"}[kind]
    described = {1: _describe_1, 2: _describe_2, 3: _describe_3}[fmi](name)
    if tolerance:
        experiment = f'<DefaultExperiment tolerance="{tolerance}"/><ModelVariables>'
        described = described.replace("<ModelVariables>", experiment)
    return compile_fmu(path, SOURCES / "initial.c", described, "initial", fmi, flags)


def _exact(name: str) -> str:
    return ' initial="exact"' if name == "h" else ""


def _scalars(fmi: int) -> str:
    lines = []
    for name, reference, causality, variability, kind, start, depends in _VARIABLES:
        if fmi == 1 and causality in ("parameter", "local"):
            variability, causality = ("parameter" if causality == "parameter" else variability), "internal"
        more = f' start="{start}"' if start else ""
        more += f' derivative="{_STATE + 1}"' if fmi == 2 and name == "der_h" else ""
        names = f"<Name>{depends}</Name>" if depends else ""
        direct = f"<DirectDependency>{names}</DirectDependency>" if fmi == 1 and causality == "output" else ""
        lines.append(
            f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
            f'variability="{variability}"{_exact(name) if fmi == 2 else ""}><{kind}{more}/>{direct}'
            "</ScalarVariable>"
        )
    return "".join(lines)


def _describe_1(kind: str) -> str:
    steps = (
        "<Implementation><CoSimulation_StandAlone><Capabilities "
        'canHandleVariableCommunicationStepSize="true"/></CoSimulation_StandAlone></Implementation>'
    )
    return (
        '<fmiModelDescription fmiVersion="1.0" modelName="initial" modelIdentifier="initial" guid="i" '
        f'numberOfContinuousStates="{int(kind == "ModelExchange")}" numberOfEventIndicators="0">'
        f"<ModelVariables>{_scalars(1)}</ModelVariables>{steps if kind == 'CoSimulation' else ''}"
        "</fmiModelDescription>"
    )


def _describe_2(kind: str) -> str:
    places = {v[0]: i for i, v in enumerate(_VARIABLES, 1)}
    unknowns = "".join(
        f'<Unknown index="{places[v[0]]}" dependencies="{places[v[6]] if v[6] else ""}"/>'
        for v in _VARIABLES
        if v[2] == "output"
    )
    return (
        f'<fmiModelDescription fmiVersion="2.0" modelName="initial" guid="i">'
        f'<{kind} modelIdentifier="initial"/>'
        f"<ModelVariables>{_scalars(2)}</ModelVariables><ModelStructure><Outputs>{unknowns}</Outputs>"
        f'<Derivatives><Unknown index="{_DERIVATIVE + 1}"/></Derivatives><InitialUnknowns>{unknowns}'
        "</InitialUnknowns></ModelStructure></fmiModelDescription>"
    )


def _describe_3(kind: str) -> str:
    types = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean"}
    references = {v[0]: v[1] for v in _VARIABLES}
    lines, structure = ['<Float64 name="time" valueReference="30" causality="independent"/>'], ""
    for name, reference, causality, variability, typed, start, depends in _VARIABLES:
        about = f'name="{name}" valueReference="{reference}" causality="{causality}"'
        about += f' variability="{variability}"' + (f' start="{start}"' if start else "") + _exact(name)
        about += f' derivative="{references["h"]}"' if name == "der_h" else ""
        lines.append(f"<{types[typed]} {about}/>")
        if causality == "output":
            on = references[depends] if depends else ""
            structure += f'<Output valueReference="{reference}" dependencies="{on}"/>'
    structure += f'<ContinuousStateDerivative valueReference="{references["der_h"]}"/>'
    for _, reference, causality, *_, depends in _VARIABLES:
        on = references[depends] if depends else ""
        structure += f'<InitialUnknown valueReference="{reference}" dependencies="{on}"/>' * (
            causality == "output"
        )
    return (
        '<fmiModelDescription fmiVersion="3.0" modelName="initial" instantiationToken="i"><'
        f'{kind} modelIdentifier="initial"/><ModelVariables>{"".join(lines)}</ModelVariables>'
        f"<ModelStructure>{structure}</ModelStructure></fmiModelDescription>"
    )
