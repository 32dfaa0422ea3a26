"""A model description without defects, and what is made of it for tests."""

from __future__ import annotations

import zipfile
from pathlib import Path

GOOD = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g">
<CoSimulation modelIdentifier="m"/>
<TypeDefinitions><SimpleType name="Speed"><Real unit="m/s"/></SimpleType></TypeDefinitions>
<ModelVariables>
<ScalarVariable name="u" valueReference="0" causality="input"><Real start="1.5" unit="km/h"/></ScalarVariable>
<ScalarVariable name="y" valueReference="1" causality="output"><Real declaredType="Speed"/></ScalarVariable>
<ScalarVariable name="n" valueReference="2" causality="parameter" variability="fixed">
<Integer start="3"/></ScalarVariable>
</ModelVariables>
<ModelStructure><Outputs><Unknown index="2" dependencies="1"/></Outputs></ModelStructure>
</fmiModelDescription>"""


def described(folder: Path, text: str) -> Path:
    """Write an FMU that is this description alone into a folder, and return its file."""
    path = folder / "a.fmu"
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("modelDescription.xml", text)
    return path


def changed(*changes: tuple[str, str]) -> str:
    """The good description with changes (old text, new text)."""
    text = GOOD
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return text


def redescribed(fmu: Path, *changes: tuple[str, str]) -> Path:
    """Change the description of an FMU (old text, new text), and return its file."""
    with zipfile.ZipFile(fmu) as file:
        content = {name: file.read(name) for name in file.namelist()}
    text = content["modelDescription.xml"].decode()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    with zipfile.ZipFile(fmu, "w") as file:
        for name, each in (content | {"modelDescription.xml": text.encode()}).items():
            file.writestr(name, each)
    return fmu
