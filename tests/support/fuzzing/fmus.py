"""Hostile FMUs: their descriptions changed as texts or as XML, their archives with bytes flipped."""

from __future__ import annotations

import functools
import io
import random
import re
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path
from xml.sax.saxutils import escape

from evcosim.master.builtin import fmu_file
from support.c_fmu import mixed_fmu
from support.fuzzing.changes import DEEP, NUMBERS, QUOTED, TEXTS, Input, encoded, mutated
from support.fuzzing.toml_files import SHORT

DESCRIPTION = "modelDescription.xml"
_ATTRIBUTE = re.compile(r'\s([\w:]+)="([^"]*)"')
_ELEMENT = re.compile(r"<(\w+)((?:\s[^<>]*)?)(/?)>")
_LAUGHS = '<!ENTITY a0 "ha">' + "".join(f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 12))
_DOCTYPES = (
    f"<!DOCTYPE fmiModelDescription [{_LAUGHS}]>",
    '<!DOCTYPE fmiModelDescription [<!ENTITY x SYSTEM "file:///etc/passwd">]>',
    '<!DOCTYPE fmiModelDescription SYSTEM "http://127.0.0.1:9/x.dtd">',
    '<!DOCTYPE fmiModelDescription [<!ENTITY % p SYSTEM "/dev/zero"> %p;]>',
    '<!DOCTYPE fmiModelDescription [<!ATTLIST Real unit CDATA "m">]>',
    "<?xml-stylesheet href='x'?>",
    "<!--" + "-" * 1000 + "-->",
)
_WORDS = (
    "input",
    "output",
    "parameter",
    "local",
    "independent",
    "calculatedParameter",
    "fixed",
    "tunable",
    "exact",
)
_BEYOND = ("", "&a11;", "&x;", "&#0;", "&#x1F;", "&#xD800;", "&undefined;", "m&#10;s", "x" * 1_000_000)


@functools.cache
def entries(name: str) -> dict[str, bytes]:
    """Return the contents of an FMU by name: a built-in one, or mixed1 to mixed3, in C."""
    with tempfile.TemporaryDirectory() as folder:
        known = name.startswith("mixed")
        path = mixed_fmu(Path(folder) / "mixed.fmu", int(name[-1])) if known else fmu_file(name)
        with zipfile.ZipFile(path) as source:
            return {entry: source.read(entry) for entry in source.namelist()}


def packed(contents: dict[str, bytes]) -> bytes:
    """Return the archive of some contents, of the date of no day."""
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as file:
        for name, content in contents.items():
            file.writestr(zipfile.ZipInfo(name), content)
    return archive.getvalue()


def changed(random: random.Random, text: str) -> bytes:
    """Return a description with other attributes and elements, which stays XML more often than not."""
    if random.random() < 0.2:
        return mutated(random, text, random.choice(("<a>", "<", "&", "<!--", "<![CDATA[", '<a b="')))
    for _ in range(random.choice((1, 1, 2, 3, 4))):
        text = random.choice(_CHANGES)(random, text)
    if random.random() < 0.15:
        text = text.replace(
            'encoding="UTF-8"', f'encoding="{random.choice(("utf-16", "x", "", "cp1252", "idna"))}"'
        )
    return encoded(random, text) if random.random() < 0.2 else text.encode("utf-8", "surrogatepass")


def _quoted(text: str) -> str:
    return '"' + escape("".join(c for c in text if c >= " "), {'"': "&quot;"}) + '"'


def _value(random: random.Random, text: str) -> str:
    found = random.choice(list(QUOTED.finditer(text)))
    new = random.choice((*TEXTS, *NUMBERS, *_WORDS))
    return text[: found.start()] + _quoted(new) + text[found.end() :]


def _reference(random: random.Random, text: str) -> str:
    found = random.choice(list(QUOTED.finditer(text)))
    return f'{text[: found.start()]}"{random.choice(_BEYOND)}"{text[found.end() :]}'


def _attributes(random: random.Random, text: str) -> str:
    """Leave an attribute out, give it twice, rename it, put it elsewhere, or give it another one's value."""
    found = list(_ATTRIBUTE.finditer(text))
    one, other = random.choice(found), random.choice(found)
    new = random.choice(
        (
            "",
            one[0] * 2,
            f' {other[1]}="{one[2]}"',
            f' {one[1]}="{other[2]}"',
            f"{one[0]} {other[0]}",
            f' xmlns:{one[1].partition(":")[2] or "a"}="{one[2]}"',
            f' a:{one[1]}="{one[2]}"',
            f" {one[1]}='{one[2]}'",
            f" {one[1]}={one[2]}",
        )
    )
    return text[: one.start()] + new + text[one.end() :]


def _elements(random: random.Random, text: str) -> str:
    """Leave an element's begin out, repeat it, rename it, or wrap something around it."""
    found = list(_ELEMENT.finditer(text))
    one, other = random.choice(found), random.choice(found)
    new = random.choice(
        (
            "",
            one[0] + one[0],
            one[0] + other[0],
            f"<{other[1]}{one[2]}{one[3]}>",
            f'<x:{one[1]}{one[2]} xmlns:x="http://a"{one[3]}>',
            f"{one[0]}text\0{other[2]}".replace("\0", " "),
            "<a>" * 1000 + one[0] + "</a>" * 1000,
            "<a>" * DEEP + one[0],
            f"<![CDATA[{one[0]}]]>",
            one[0] * 5000 if one[3] else one[0],
        )
    )
    return text[: one.start()] + new + text[one.end() :]


def _doctype(random: random.Random, text: str) -> str:
    place = text.index("<fmiModelDescription")
    text = text[:place] + random.choice(_DOCTYPES) + text[place:]
    return _reference(random, text[:place]) + text[place:] if random.random() < 0.3 else text


_CHANGES: tuple[Callable[[random.Random, str], str], ...] = (
    _value,
    _value,
    _value,
    _value,
    _reference,
    _attributes,
    _attributes,
    _elements,
    _doctype,
)


def an_fmu(random: random.Random) -> Input:
    """An FMU with another description or archive, shown, checked, built in, or run by itself."""
    name = random.choice(("Battery", "Battery", "Scooter", "mixed1", "mixed2", "mixed3"))
    contents = dict(entries(name))
    if random.random() < 0.95:
        contents[DESCRIPTION] = changed(random, contents[DESCRIPTION].decode())
    content = packed(contents)
    if random.random() < 0.08:
        content = _flipped(random, content)
    commands = [
        ["info", "F.fmu"],
        ["info", "F.fmu", "--json"],
        ["run", "F.fmu", *SHORT, "--no-plot"],
        ["run", "F.fmu", "-q", "-o", "out", *random.choice(([], ["--no-plot"], ["--strict"]))],
        ["check", "F.fmu", "--as", "scooter.battery"],
        ["check", "F.fmu", "--as", "scooter.battery", "--write", "w.toml"],
        ["check", "F.fmu", "--as", "scooter.battery", "--try", "50ms"],
        ["compile", "F.fmu", "-o", "G.fmu"],
        ["identify", "F.fmu", "--input", "u", "--output", "y", "--duration", "0.5", "--amplitude", "1", "-q"],
    ]
    command = random.choice(commands)
    if name == "Battery" and random.random() < 0.3:
        command = ["run", "scooter", "--fmu", "battery=F.fmu", *SHORT, "--no-plot"]
    return Input("XML", command, {"F.fmu": content})


def _flipped(random: random.Random, content: bytes) -> bytes:
    """Return an archive cut short, or with bytes flipped near its directory, where sizes and names stand."""
    if random.random() < 0.3:
        return content[: random.randrange(len(content))]
    data = bytearray(content)
    for _ in range(random.randint(1, 6)):
        data[random.randrange(max(0, len(data) - 3000), len(data))] = random.randrange(256)
    return bytes(data)
