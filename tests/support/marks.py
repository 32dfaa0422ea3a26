"""A folder in which every text that a stranger can write holds what steers a terminal or hides something."""

from __future__ import annotations

import zipfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

from evcosim.cosim.visible import visible_toml
from support.hostile import units
from support.hostile.case import WHOLE, Case

XML = "\x7f\x85\x9b\u202e\u2066\u200f\u061c\u200b\u2028\ufeff\t\r\nevcosim: all is well"
"""What XML lets stand; the other controls are no characters there."""
ALL = "\x1b[31m\x1b]0;title\x07\x08\x0b" + XML

OUTPUT = f"y{XML[: XML.index(chr(9))]}"
"""The name of an output, which system files write on one line."""


def fmu(path: Path, act: str = "marks", output: str = OUTPUT) -> Path:
    """A unit in FMI 2.0 with marks in all its texts and entries, the name of its output among them."""
    attributes = ["description", "author", "version", "copyright", "license", "generationTool"]
    about = " ".join(f"{name}={quoteattr(name + XML)}" for name in attributes)
    unit = quoteattr(f"u{XML}")
    items = "".join(
        f"<Item name={quoteattr(f'item {i} {XML}')} value='{i}' description={quoteattr('which ' + XML)}/>"
        for i in range(2)
    )
    definitions = (
        f"<TypeDefinitions><SimpleType name={quoteattr('state' + XML)} description={quoteattr(XML)}>"
    )
    definitions += (
        f"<Enumeration quantity={quoteattr('q' + XML)}>{items}</Enumeration></SimpleType></TypeDefinitions>"
    )
    changes = (
        ('modelName="Hostile"', f"modelName={quoteattr('model' + XML)} {about}"),
        ("<UnitDefinitions>", f"<UnitDefinitions><Unit name={unit}><BaseUnit/></Unit>"),
        ("</UnitDefinitions>", f"</UnitDefinitions>{definitions}"),
        ('name="y"', f"name={quoteattr(output)} description={quoteattr('the output' + XML)}"),
        ('name="gain"', f"name={quoteattr('gain' + XML)}"),
        ('<Real start="0" unit="m/s"/>', f'<Real start="0" unit={unit} quantity={quoteattr("q" + XML)}/>'),
        ("<Integer/>", f"<Enumeration declaredType={quoteattr('state' + XML)}/>"),
    )
    case = Case("marks", "", "", WHOLE, act=act, changes=changes)
    units.write(path, case, 2)
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(f"resources/{ALL}.txt".replace("\t", "").replace("\r", "").replace("\n", ""), "")
        archive.writestr(f"documentation/\u202e\x1b/x{ALL[:9]}.html", "")
    return path


def text_of_dbc() -> str:
    """The text in a database, whose lines end none of its texts."""
    return ALL.replace("\n", "")


def dbc(path: Path) -> Path:
    """A database with marks in units, comments, value texts and attributes."""
    text = text_of_dbc()
    path.write_text(
        f'VERSION "{text}"\nNS_ :\nBS_:\nBU_: A B\n\n'
        f'BO_ 1 M: 8 A\n SG_ S : 0|16@1- (0.1,0) [-90|90] "u{text}" B\n\n'
        f'CM_ "{text}";\nCM_ BU_ A "{text}";\nCM_ BO_ 1 "{text}";\nCM_ SG_ 1 S "{text}";\n'
        f'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;\nBA_DEF_ "Note" STRING;\n'
        f'BA_DEF_DEF_ "GenMsgCycleTime" 10;\n'
        f'BA_DEF_DEF_ "Note" "{text}";\nVAL_ 1 S 3 "three{text}" 4 "four" ;\n',
        encoding="utf-8",
        newline="",
    )
    return path


def system(folder: Path, act: str = "marks", fmu_name: str = "bad.fmu") -> Path:
    """A system of such a unit over such a bus, with marks in all its own texts; its FMUs stand beside it."""
    fmu(folder / fmu_name, act)
    units.write(folder / "good.fmu", Case("good", "", "", WHOLE), 2)
    dbc(folder / "can.dbc")
    text = (
        f'name = "marked"\ntitle = "title {ALL}"\nsource = "source {ALL}"\n'
        "[experiment]\nstop_time = 0.1\n"
        f'[units.bad]\nfmu = "{fmu_name}"\nstart = {{ u = 1.0 }}\n[units.good]\nfmu = "good.fmu"\n'
        f'[buses.can0]\ndbc = "can.dbc"\n[buses.can0.units]\n"u{text_of_dbc()}" = "m/s"\n'
        f'[[connect]]\nfrom = "bad.{OUTPUT}"\nto = ["good.u"]\nvia = "can0.M.S"\n'
        f'[figure]\ntitle = "figure {ALL}"\nnote = "note {ALL}"\nshade = "bad.n"\n'
        f'[[figure.panels]]\nlabel = "label {ALL}"\n'
        f'signals = [{{ name = "bad.n", label = "signal {ALL}" }}]\n'
        f'[[metrics]]\nname = "metric {ALL}"\nsignal = "bad.n"\nreduce = "max"\n'
    )
    path = folder / "marked.toml"
    path.write_text(_in_strings(text), encoding="utf-8", newline="")
    return path


def _in_strings(text: str) -> str:
    """Write what stands in strings with TOML's escapes."""
    for character, escape in (("\t", "\\t"), ("\r", "\\r"), ("\nevcosim", "\\nevcosim")):
        text = text.replace(character, escape)
    return visible_toml(text)
