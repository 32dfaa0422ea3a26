"""The unit of sources/watch.c as an FMU: it shows the times that it is told."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from support.c_fmu import SOURCES, compile_fmu

_VARIABLES = [
    # name, value reference, causality, variability, type of FMI 2.0, start
    ("begin", 0, "output", "continuous", "Real", ""),
    ("size", 1, "output", "continuous", "Real", ""),
    ("before", 2, "output", "continuous", "Real", ""),
    ("stop", 3, "output", "continuous", "Real", ""),
    ("y", 4, "output", "continuous", "Real", ""),
    ("u", 5, "input", "continuous", "Real", "0"),
    ("stairs", 6, "output", "discrete", "Integer", ""),
    ("copy", 7, "output", "discrete", "Integer", ""),
    ("count", 8, "input", "discrete", "Integer", "0"),
]


def watch_fmu(
    path: Path, fmi: int = 2, annotations: str = "", tool: str = "cc", flags: Sequence[str] = ()
) -> Path:
    """The unit at `path` in FMI 1.0, 2.0 or 3.0; with vendors' `annotations`, `tool`, compiler `flags`."""
    variables, outputs = [], []
    for i, (name, reference, causality, variability, kind, start) in enumerate(_VARIABLES, 1):
        about = (
            f'name="{name}" valueReference="{reference}" causality="{causality}" variability="{variability}"'
        )
        given = f' start="{start}"' if start else ""
        if fmi == 3:
            variables.append(f"<{'Float64' if kind == 'Real' else 'Int32'} {about}{given}/>")
            outputs.append(f'<Output valueReference="{reference}" dependencies=""/>' if not start else "")
        else:
            variables.append(f"<ScalarVariable {about}><{kind}{given}/></ScalarVariable>")
            outputs.append(f'<Unknown index="{i}" dependencies=""/>' if not start else "")
    body = "".join(outputs)
    if fmi == 3:
        variables.append('<Float64 name="time" valueReference="20" causality="independent"/>')
    token = 'instantiationToken="w"' if fmi == 3 else 'guid="w"'
    structure = f"<ModelStructure>{body if fmi == 3 else f'<Outputs>{body}</Outputs>'}</ModelStructure>"
    kind = '<CoSimulation modelIdentifier="watch" canHandleVariableCommunicationStepSize="true"/>'
    if fmi == 1:
        token += ' modelIdentifier="watch" numberOfContinuousStates="0" numberOfEventIndicators="0"'
        kind, structure = (
            "",
            "<Implementation><CoSimulation_StandAlone><Capabilities/></CoSimulation_StandAlone></Implementation>",
        )
    description = (
        f'<fmiModelDescription fmiVersion="{fmi}.0" modelName="watch" generationTool="{tool}" {token}>{kind}'
        f"{annotations}<ModelVariables>{''.join(variables)}</ModelVariables>{structure}</fmiModelDescription>"
    )
    return compile_fmu(path, SOURCES / "watch.c", description, "watch", fmi, [f"-DFMI={fmi}", *flags])
