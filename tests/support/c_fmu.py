"""FMUs in C, compiled when a test needs them.

`compile_fmu` makes an FMU of any C source and model description; `mixed_fmu` the unit of sources/mixed.c,
which has a variable of every type, in any version of FMI.
"""

from __future__ import annotations

import functools
import hashlib
import os
import subprocess
import zipfile
from collections.abc import Sequence
from pathlib import Path

from support import scratch
from support.needs import need_c_compiler

SOURCES = Path(__file__).with_name("sources")
_CACHE = scratch.kept()
PLATFORM = {1: "linux64", 2: "linux64", 3: "x86_64-linux"}


@functools.cache
def compiled(source: Path, flags: tuple[str, ...] = ()) -> bytes:
    """The shared library of a C source, from a cache of this user where it has been."""
    need_c_compiler()
    command = ["cc", "-O1", "-fPIC", "-shared", "-w", *flags]
    content = source.read_bytes() + " ".join(command).encode()
    _CACHE.mkdir(mode=0o700, exist_ok=True)
    path = _CACHE / f"{hashlib.sha256(content).hexdigest()[:24]}.so"
    if not path.exists():
        made = path.with_suffix(f".{os.getpid()}")  # several test processes may compile it at once
        subprocess.run([*command, str(source), "-o", str(made), "-lm"], check=True)
        made.replace(path)
    return path.read_bytes()


def compile_fmu(
    path: Path,
    source: Path,
    description: str,
    identifier: str,
    fmi: int = 2,
    flags: Sequence[str] = (),
    more: dict[str, bytes] | None = None,
) -> Path:
    """Write an FMU whose library is compiled from `source`; `more` are further entries of the archive."""
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", description)
        archive.writestr(f"binaries/{PLATFORM[fmi]}/{identifier}.so", compiled(source, tuple(flags)))
        for name, content in (more or {}).items():
            archive.writestr(name, content)
    return path


_WIDE = ("Int8", "UInt8", "Int16", "UInt16", "UInt32", "Int64", "UInt64")


def mixed_fmu(path: Path, fmi: int, behavior: int = 0, feeding_through: bool = False) -> Path:
    """The unit of sources/mixed.c as an FMU at `path`, in FMI 1.0, 2.0 or 3.0.

    `feeding_through`: its outputs say that they depend on the input u, by index or value reference.
    """
    description = {1: _mixed_1, 2: _mixed_2, 3: _mixed_3}[fmi]()
    if feeding_through:
        description = description.replace('dependencies=""', f'dependencies="{3 - fmi}"')
    flags = (f"-DFMI={fmi}", f"-DBEHAVIOR={behavior}", "-DMODEL=mixed")
    return compile_fmu(path, SOURCES / "mixed.c", description, "mixed", fmi, flags)


_COMMON: list[tuple[str, int, str, str, str]] = [
    # name, value reference, causality, type of FMI 2.0, start
    ("u", 0, "input", "Real", "0"),
    ("y", 1, "output", "Real", ""),
    ("gain", 2, "parameter", "Real", "1"),
    ("count_in", 3, "input", "Integer", "0"),
    ("count", 4, "output", "Integer", ""),
    ("switch_in", 5, "input", "Boolean", "false"),
    ("switch", 6, "output", "Boolean", ""),
    ("title", 7, "parameter", "String", "some text"),
    ("shown", 8, "output", "String", ""),
]


def _scalars(version: int) -> str:
    lines = []
    for name, reference, causality, kind, start in _COMMON:
        variability = {"parameter": "fixed"}.get(causality, "continuous" if kind == "Real" else "discrete")
        if version == 1:
            variability = "parameter" if causality == "parameter" else variability
            causality = "internal" if causality == "parameter" else causality
        given = f' start="{start}"' if start else ""
        lines.append(
            f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
            f'variability="{variability}"><{kind}{given}/></ScalarVariable>'
        )
    return "\n".join(lines)


def _mixed_1() -> str:
    return f"""<?xml version="1.0"?>
<fmiModelDescription fmiVersion="1.0" modelName="mixed" modelIdentifier="mixed" guid="mixed"
  numberOfContinuousStates="0" numberOfEventIndicators="0">
<ModelVariables>{_scalars(1)}</ModelVariables>
<Implementation><CoSimulation_StandAlone><Capabilities canHandleVariableCommunicationStepSize="true"/>
</CoSimulation_StandAlone></Implementation></fmiModelDescription>"""


def _mixed_2() -> str:
    outputs = "".join(
        f'<Unknown index="{i}" dependencies=""/>' for i, v in enumerate(_COMMON, 1) if v[2] == "output"
    )
    return f"""<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="mixed" guid="mixed">
<CoSimulation modelIdentifier="mixed"/>
<ModelVariables>{_scalars(2)}</ModelVariables>
<ModelStructure><Outputs>{outputs}</Outputs></ModelStructure></fmiModelDescription>"""


def _mixed_3() -> str:
    names = {"Real": "Float64", "Integer": "Int32"}
    lines, outputs = ['<Float64 name="time" valueReference="63" causality="independent"/>'], []
    variables = [(n, r, c, names.get(k, k), s) for n, r, c, k, s in _COMMON]
    variables += [("single_in", 10, "input", "Float32", "0"), ("single", 11, "output", "Float32", "")]
    for i, kind in enumerate(_WIDE):
        variables.append((f"{kind.lower()}_in", 20 + 2 * i, "input", kind, "0"))
        variables.append((f"{kind.lower()}", 21 + 2 * i, "output", kind, ""))
    for name, reference, causality, kind, start in variables:
        variability = "fixed" if causality == "parameter" else ""
        about = f'name="{name}" valueReference="{reference}" causality="{causality}"'
        about += f' variability="{variability}"' if variability else ""
        if kind == "String" and start:
            lines.append(f'<String {about}><Start value="{start}"/></String>')
        else:
            lines.append(f"<{kind} {about}" + (f' start="{start}"' if start else "") + "/>")
        if causality == "output":
            outputs.append(f'<Output valueReference="{reference}" dependencies=""/>')
    lines.append('<Float64 name="wheels" valueReference="50" start="0 0"><Dimension start="2"/></Float64>')
    return f"""<?xml version="1.0"?>
<fmiModelDescription fmiVersion="3.0" modelName="mixed" instantiationToken="mixed">
<CoSimulation modelIdentifier="mixed"/>
<ModelVariables>{"".join(lines)}</ModelVariables>
<ModelStructure>{"".join(outputs)}</ModelStructure></fmiModelDescription>"""


_VEHICLE = [
    # name, value reference, causality, unit of measure, start, description
    ("pedal", 0, "input", "1", "0", "Throttle, 0 to 1"),
    ("F_brake", 1, "input", "N", "0", "Brake force, negative when it brakes"),
    ("slope", 2, "input", "rad", "0", "Angle of the road"),
    ("v", 10, "output", "", "0", "Speed"),
    ("a", 11, "output", "m/s2", "", "Acceleration"),
    ("P", 12, "output", "W", "", "Electrical power"),
    ("s", 13, "local", "m", "0", "Distance"),
    ("m_total", 20, "parameter", "kg", "200", "Mass of vehicle and rider"),
]


def vehicle_fmu(path: Path, fmi: int, *flags: str, **changed: str) -> Path:
    """The vehicle of sources/vehicle.c as an FMU at `path`, in FMI 2.0 or 3.0: a stranger to our system.

    `flags` are its compiler flags; `changed` replaces text of its description: a name by its new text.
    """
    variables, structure = [], []
    for i, (name, reference, causality, unit, start, text) in enumerate(_VEHICLE, 1):
        real = (f' unit="{unit}"' if unit else "") + (f' start="{start}"' if start else "")
        about = f'name="{name}" valueReference="{reference}" causality="{causality}" description="{text}"'
        variability = "fixed" if causality == "parameter" else "continuous"
        initial = ' initial="exact"' if start and causality in ("output", "local") else ""
        about += f' variability="{variability}"{initial}'
        if fmi == 3:
            variables.append(f"<Float64 {about}{real}/>")
            structure.append(
                f'<Output valueReference="{reference}" dependencies=""/>' if causality == "output" else ""
            )
        else:
            variables.append(f"<ScalarVariable {about}><Real{real}/></ScalarVariable>")
            structure.append(f'<Unknown index="{i}" dependencies=""/>' if causality == "output" else "")
    if fmi == 3:
        variables.append('<Float64 name="time" valueReference="31" causality="independent"/>')
    body = "".join(structure) if fmi == 3 else f"<Outputs>{''.join(structure)}</Outputs>"
    token = 'instantiationToken="v"' if fmi == 3 else 'guid="v"'
    description = (
        f'<fmiModelDescription fmiVersion="{fmi}.0" modelName="Vehicle" {token}>'
        f'<CoSimulation modelIdentifier="vehicle"/><ModelVariables>{"".join(variables)}</ModelVariables>'
        f"<ModelStructure>{body}</ModelStructure></fmiModelDescription>"
    )
    for old, new in changed.items():
        assert old in description
        description = description.replace(old, new)
    return compile_fmu(path, SOURCES / "vehicle.c", description, "vehicle", fmi, [f"-DFMI={fmi}", *flags])


_ITEMS = (("off", 1), ("on", 2), ("broken", 4))


def typed_fmu(path: Path, fmi: int) -> Path:
    """The unit of sources/mixed.c with inputs of all types but Real, in FMI 1.0, 2.0 or 3.0.

    `flag` is the negation of `flag_in`, `text` after a step is `text_in`; `state_in` has the items off = 1,
    on = 2 and broken = 4. In FMI 1.0, whose enumerations count from 1 on, there is no `state_in`.
    """
    whole = ("state_in", 30 if fmi == 3 else 3, "input", "Enumeration", 'declaredType="State" start="1"')
    count = ("count_in", 20 if fmi == 3 else 9, "input", "Int8" if fmi == 3 else "Integer", 'start="0"')
    variables = [
        ("flag_in", 5, "input", "Boolean", 'start="false"'),
        ("flag", 6, "output", "Boolean", ""),
        ("text_in", 7, "input", "String", 'start="some text"'),
        ("text", 8, "output", "String", ""),
        whole,
        count,
    ]
    if fmi == 1:
        return _typed_1(path, [variable for variable in variables if variable is not whole])
    items = "".join(f'<Item name="{name}" value="{value}"/>' for name, value in _ITEMS)
    lines, structure = [], ""
    for i, (name, reference, causality, kind, rest) in enumerate(variables, 1):
        about = f'name="{name}" valueReference="{reference}" causality="{causality}" variability="discrete"'
        if fmi == 2:
            lines.append(f"<ScalarVariable {about}><{kind} {rest}/></ScalarVariable>")
        elif kind == "String" and rest:
            lines.append(f'<String {about}><Start value="some text"/></String>')
        else:
            lines.append(f"<{kind} {about} {rest}/>")
        if causality == "output":
            structure += (
                f'<Unknown index="{i}" dependencies=""/>'
                if fmi == 2
                else f'<Output valueReference="{reference}"/>'
            )
    definition = (
        f'<SimpleType name="State"><Enumeration>{items}</Enumeration></SimpleType>'
        if fmi == 2
        else f'<EnumerationType name="State">{items}</EnumerationType>'
    )
    time = '<Float64 name="time" valueReference="63" causality="independent" variability="continuous"/>'
    description = (
        f'<?xml version="1.0"?><fmiModelDescription fmiVersion="{fmi}.0" modelName="typed" '
        f'{"guid" if fmi == 2 else "instantiationToken"}="mixed"><CoSimulation modelIdentifier="mixed"/>'
        f"<TypeDefinitions>{definition}</TypeDefinitions>"
        f"<ModelVariables>{''.join(lines)}{time if fmi == 3 else ''}</ModelVariables>"
        f"<ModelStructure>{f'<Outputs>{structure}</Outputs>' if fmi == 2 else structure}</ModelStructure>"
        "</fmiModelDescription>"
    )
    flags = (f"-DFMI={fmi}", "-DBEHAVIOR=0", "-DMODEL=mixed")
    return compile_fmu(path, SOURCES / "mixed.c", description, "mixed", fmi, flags)


def _typed_1(path: Path, variables: Sequence[tuple[str, int, str, str, str]]) -> Path:
    lines = [
        f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
        f'variability="discrete"><{kind} {rest}/></ScalarVariable>'
        for name, reference, causality, kind, rest in variables
    ]
    description = _mixed_1().replace(_scalars(1), "".join(lines))
    flags = ("-DFMI=1", "-DBEHAVIOR=0", "-DMODEL=mixed")
    return compile_fmu(path, SOURCES / "mixed.c", description, "mixed", 1, flags)
