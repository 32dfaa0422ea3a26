"""The FMU that every case begins with: sources/hostile.c and its description in FMI 1.0, 2.0 and 3.0."""

from __future__ import annotations

import zipfile
from pathlib import Path

from support.c_fmu import PLATFORM, SOURCES, compiled
from support.hostile.case import Case, Entries

_VARIABLES = [
    # name, value reference, causality, type of FMI 2.0, further attributes of the value
    ("u", 0, "input", "Real", ' start="0" unit="m/s"'),
    ("y", 1, "output", "Real", ' unit="m/s"'),
    ("gain", 2, "parameter", "Real", ' start="1"'),
    ("n", 3, "output", "Integer", ""),
    ("b", 4, "output", "Boolean", ""),
    ("s", 5, "output", "String", ""),
]
_UNITS = '<UnitDefinitions><Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit></UnitDefinitions>'


def description(fmi: int, token: str = "hostile:") -> str:
    """modelDescription.xml of a good unit. What the versions can share is written alike."""
    lines = [_variable(fmi, *variable) for variable in _VARIABLES]
    if fmi == 1:
        return (
            '<?xml version="1.0" encoding="UTF-8"?>\n<fmiModelDescription fmiVersion="1.0" '
            f'modelName="Hostile" modelIdentifier="hostile" guid="{token}" numberOfContinuousStates="0" '
            f'numberOfEventIndicators="0">\n<ModelVariables>\n{"".join(lines)}</ModelVariables>\n'
            "<Implementation><CoSimulation_StandAlone><Capabilities/></CoSimulation_StandAlone></Implementation>"
            "\n</fmiModelDescription>"
        )
    guid = "instantiationToken" if fmi == 3 else "guid"
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<fmiModelDescription fmiVersion="{fmi}.0" '
        f'modelName="Hostile" {guid}="{token}">\n<CoSimulation modelIdentifier="hostile"/>\n{_UNITS}\n'
        f"<ModelVariables>\n{''.join(lines)}</ModelVariables>\n{_structure(fmi)}\n</fmiModelDescription>"
    )


def _variable(fmi: int, name: str, reference: int, causality: str, kind: str, more: str) -> str:
    about = f'name="{name}" valueReference="{reference}" causality="{causality}"'
    if fmi == 1:
        about = about.replace('"parameter"', '"internal" variability="parameter"')
        more = more.replace(' unit="m/s"', "")
        return f"<ScalarVariable {about}><{kind}{more}/></ScalarVariable>\n"
    if causality == "parameter":
        about += ' variability="fixed"'
    elif kind != "Real":
        about += ' variability="discrete"'
    if fmi == 2:
        return f"<ScalarVariable {about}><{kind}{more}/></ScalarVariable>\n"
    kind = {"Real": "Float64", "Integer": "Int32"}.get(kind, kind)
    return f"<{kind} {about}{more}/>\n"


def _structure(fmi: int) -> str:
    outputs = [(i, v[1]) for i, v in enumerate(_VARIABLES, 1) if v[2] == "output"]
    if fmi == 3:
        lines = [f'<Output valueReference="{reference}" dependencies=""/>' for _, reference in outputs]
        return f"<ModelStructure>{''.join(lines)}</ModelStructure>"
    lines = [f'<Unknown index="{index}" dependencies=""/>' for index, _ in outputs]
    return f"<ModelStructure><Outputs>{''.join(lines)}</Outputs></ModelStructure>"


def library(fmi: int, loading: int = 0) -> bytes:
    """The shared library; `loading` is what its constructor does wrong."""
    flags = (f"-DFMI={fmi}", "-lpthread", *([f"-DLOADING={loading}"] if loading else []))
    return compiled(SOURCES / "hostile.c", flags)


def binary(fmi: int) -> str:
    """Where the library stands in the archive."""
    return f"binaries/{PLATFORM[fmi]}/hostile.so"


def entries(case: Case, fmi: int) -> Entries:
    """The entries of a case's archive."""
    text = description(fmi, f"hostile:{case.act}")
    for old, new in case.changes:
        assert old in text, (case.name, old)
        text = text.replace(old, new)
    made = {"modelDescription.xml": text.encode(), binary(fmi): library(fmi, case.loading)}
    return made if case.mutate is None else case.mutate(made, fmi)


def write(path: Path, case: Case, fmi: int) -> None:
    """Write the FMU of a case."""
    (case.pack or zipped)(path, entries(case, fmi))


def zipped(path: Path, content: Entries) -> None:
    """The archive that everyone makes."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            archive.writestr(name, data)
