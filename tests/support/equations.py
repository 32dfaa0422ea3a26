"""The models of sources/equations.c as FMUs, for Model Exchange, Co-Simulation or both."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from support.c_fmu import SOURCES, compile_fmu

MODELS = ("oscillator", "ball", "relay", "timer", "wave", "decay")
_STATES = {"oscillator": 2, "ball": 2, "relay": 1, "decay": 1}
_INDICATORS = {"ball": 1, "relay": 1, "wave": 1}
_TYPES = {"Real": "Float64", "Integer": "Int32"}  # of FMI 3.0, where another than of 2.0

# name, value reference, causality, variability, type of FMI 2.0, start
_VARIABLES = [
    ("x0", 0, "output", "continuous", "Real", ""),
    ("x1", 1, "local", "continuous", "Real", ""),
    ("der_x0", 2, "local", "continuous", "Real", ""),
    ("der_x1", 3, "local", "continuous", "Real", ""),
    ("u", 4, "input", "continuous", "Real", "0"),
    ("y", 5, "output", "continuous", "Real", ""),
    ("p0", 6, "parameter", "fixed", "Real", ""),
    ("p1", 7, "parameter", "fixed", "Real", ""),
    ("last", 8, "output", "discrete", "Real", ""),
    ("level", 9, "input", "discrete", "Real", "0"),
    ("held", 10, "output", "discrete", "Real", ""),
    ("demand", 20, "input", "discrete", "Integer", "0"),
    ("seen", 21, "output", "discrete", "Integer", ""),
    ("count", 22, "output", "discrete", "Integer", ""),
    ("armed", 30, "input", "discrete", "Boolean", "false"),
    ("on", 31, "output", "discrete", "Boolean", ""),
    ("label", 40, "input", "discrete", "String", "a label"),
    ("shown", 41, "output", "discrete", "String", ""),
]


def equations_fmu(
    path: Path,
    model: str,
    fmi: int,
    kinds: str = "ME",
    behavior: int = 0,
    tolerance: str = "1e-8",
    types: Mapping[str, str] | None = None,
    more: str = "",
) -> Path:
    """One of MODELS at `path` in FMI 1.0 ("ME" alone), 2.0 or 3.0; `kinds` is "ME", "CS" or "ME CS".

    In FMI 1.0 and 3.0 `types` are other types of some variables (1.0: Enumeration, with 8 items); in FMI 3.0
    `more` is put to the variables' descriptions.
    """
    experiment = f'<DefaultExperiment tolerance="{tolerance}"/>'
    interfaces = "".join(
        f'<{name} modelIdentifier="equations"{more}/>'
        for kind, name, more in [
            ("ME", "ModelExchange", ' needsCompletedIntegratorStep="true"' if fmi == 3 else ""),
            ("CS", "CoSimulation", ""),
        ]
        if kind in kinds.split()
    )
    flags = [f"-DFMI={fmi}", f"-DMODEL={model.upper()}", f"-DBEHAVIOR={behavior}"]
    if fmi == 1:
        text = _describe_1(model, experiment, types or {})
    elif fmi == 2:
        text = _describe_2(model, interfaces, experiment)
    else:
        text = _describe_3(model, interfaces, experiment, types or {}, more)
    return compile_fmu(path, SOURCES / "equations.c", text, "equations", fmi, flags)


def _describe_1(model: str, experiment: str, types: Mapping[str, str]) -> str:
    lines = []
    for name, reference, causality, variability, kind, start in _VARIABLES:
        given = f' start="{start}"' if start else ""
        given += ' declaredType="Level"' if name in types else ""
        variability = "parameter" if causality == "parameter" else variability
        causality = "internal" if causality in ("parameter", "local") else causality
        depends = "<DirectDependency/>" if causality == "output" else ""
        lines.append(
            f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
            f'variability="{variability}"><{types.get(name, kind)}{given}/>{depends}</ScalarVariable>'
        )
    items = "".join(f'<Item name="level {i}"/>' for i in range(1, 9))
    level = f'<Type name="Level"><EnumerationType min="1" max="8">{items}</EnumerationType></Type>'
    return (
        f'<fmiModelDescription fmiVersion="1.0" modelName="{model}" modelIdentifier="equations" guid="e" '
        f'numberOfContinuousStates="{_STATES.get(model, 0)}" '
        f'numberOfEventIndicators="{_INDICATORS.get(model, 0)}"><TypeDefinitions>{level}</TypeDefinitions>'
        f"{experiment}<ModelVariables>{''.join(lines)}</ModelVariables></fmiModelDescription>"
    )


def _describe_2(model: str, interfaces: str, experiment: str) -> str:
    states = _STATES.get(model, 0)
    lines, outputs = [], []
    for i, (name, reference, causality, variability, kind, start) in enumerate(_VARIABLES, 1):
        given = f' start="{start}"' if start else ""
        given += f' derivative="{i - 2}"' if name.startswith("der_") and i - 3 < states else ""
        lines.append(
            f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
            f'variability="{variability}"><{kind}{given}/></ScalarVariable>'
        )
        outputs += [f'<Unknown index="{i}" dependencies=""/>'] if causality == "output" else []
    derivatives = "".join(f'<Unknown index="{3 + i}"/>' for i in range(states))
    return (
        f'<fmiModelDescription fmiVersion="2.0" modelName="{model}" guid="e" '
        f'numberOfEventIndicators="{_INDICATORS.get(model, 0)}">{interfaces}{experiment}'
        f"<ModelVariables>{''.join(lines)}</ModelVariables><ModelStructure>"
        f"<Outputs>{''.join(outputs)}</Outputs><Derivatives>{derivatives}</Derivatives>"
        "</ModelStructure></fmiModelDescription>"
    )


def _describe_3(model: str, interfaces: str, experiment: str, types: Mapping[str, str], more: str) -> str:
    states = _STATES.get(model, 0)
    lines = ['<Float64 name="time" valueReference="50" causality="independent"/>']
    lines.append('<Float64 name="z" valueReference="51"/>')
    structure = []
    for name, reference, causality, variability, kind, start in _VARIABLES:
        about = (
            f'name="{name}" valueReference="{reference}" causality="{causality}" variability="{variability}"'
        )
        number = int(name[-1]) if name.startswith("der_") else states
        about += f' derivative="{number}"' if number < states else ""
        typed = types.get(name, _TYPES.get(kind, kind))
        if kind == "String":
            lines.append(
                f'<String {about}><Start value="{start}"/></String>' if start else f"<String {about}/>"
            )
        else:
            lines.append(f"<{typed} {about}" + (f' start="{start}"' if start else "") + "/>")
        if causality == "output":
            structure.append(f'<Output valueReference="{reference}" dependencies=""/>')
    structure += [f'<ContinuousStateDerivative valueReference="{2 + i}"/>' for i in range(states)]
    structure += ['<EventIndicator valueReference="51"/>'] * _INDICATORS.get(model, 0)
    return (
        f'<fmiModelDescription fmiVersion="3.0" modelName="{model}" instantiationToken="e">'
        f"{interfaces}{experiment}<ModelVariables>{''.join(lines)}{more}</ModelVariables>"
        f"<ModelStructure>{''.join(structure)}</ModelStructure></fmiModelDescription>"
    )
