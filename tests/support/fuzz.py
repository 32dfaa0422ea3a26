"""Hostile inputs of the command line, made from good ones by a seed; each ends cleanly, or is reported.

    python tests/support/fuzz.py --count 2000 --seed 1

Each input runs in a child of this process: exit code 0, 1, 2 or 130, no "unexpected error", no traceback, and
at most 10 s. What does otherwise is printed, with its files in a folder, and the exit code is 1.
"""

from __future__ import annotations

import argparse
import collections
import contextlib
import io
import os
import random
import re
import shutil
import sys
import tempfile
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import escape

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))

from evcosim.cosim.system.toml import DATA
from evcosim.master.builtin import fmu_file
from evcosim.master.cli import main
from support.forked import Outcome, forked

LIMIT = 10.0
"""Seconds that an input may take."""

NUMBERS = [
    "0",
    "-1",
    "1e308",
    "-1e308",
    "5e-324",
    "1e-300",
    "inf",
    "-inf",
    "nan",
    "1e400",
    "9223372036854775808",
    "-9223372036854775809",
    "2147483648",
    "4294967296",
    "0x1fffffffffffffffff",
    "0.1",
    "1e9",
    "1e18",
    "0b1",
    "1_000",
    "-0.0",
    "+1",
    "1.",
    ".5",
    "1,5",
    "true",
    "9" * 5000,
    "1" + "0" * 400,
]
TEXTS = (
    "",
    " ",
    "\0",
    "\\u0000",
    "\u202e",
    "\x1b[31m",
    "\\u001b[2J",
    "\ud7ff\ufffd",
    "x" * 10_000,
    "../" * 20,
    "/dev/zero",
    "/dev/stdin",
    ".",
    "$x_{1$",
    "\\frac{",
    "$\\frac{}",
    "#",
    "??",
    "\N{EURO SIGN}",
    "V(",
    "9**9**9**9",
    "m^0.5",
    "a.b.c.d",
    "*",
    "[*",
    "'",
    '"',
    "]]",
    "{}",
    "%s%n",
    "\r\n",
    "\N{LATIN SMALL LETTER SHARP S}",
    "none",
    "process",
)
WORD = re.compile(r"[A-Za-z_][\w.]*")
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?")
QUOTED = re.compile(r'"[^"\n]*"')


class Input(NamedTuple):
    """A command line, and the files that it names, by their names in the working folder."""

    kind: str
    arguments: list[str]
    files: dict[str, bytes]


def mutated(random: random.Random, text: str, nested: str = "[") -> bytes:
    """Return a text with one to four changes; `nested` is what nests in its language."""
    for _ in range(random.choice((1, 1, 1, 2, 2, 3, 4))):
        text = random.choice(_CHANGES)(random, text, nested)
    data = bytearray(text.encode("utf-8", "surrogatepass"))
    if random.random() < 0.1 and data:
        for _ in range(random.randint(1, 8)):
            data[random.randrange(len(data))] = random.randrange(256)
    return bytes(data)


def _replaced(pattern: re.Pattern[str], choices: tuple[str, ...] | list[str], quote: str = "") -> _Change:
    def change(random: random.Random, text: str, nested: str) -> str:
        found = list(pattern.finditer(text))
        if not found:
            return text
        chosen = random.choice(found)
        new = quote + random.choice(choices) + quote
        return text[: chosen.start()] + new + text[chosen.end() :]

    return change


def _line(random: random.Random, text: str, nested: str) -> str:
    """Leave out, repeat or exchange lines."""
    lines = text.splitlines(keepends=True) or [""]
    i, j = random.randrange(len(lines)), random.randrange(len(lines))
    match random.randrange(3):
        case 0:
            del lines[i]
        case 1:
            lines.insert(j, lines[i])
        case _:
            lines[i], lines[j] = lines[j], lines[i]
    return "".join(lines)


def _inserted(random: random.Random, text: str, nested: str) -> str:
    place = random.randrange(len(text) + 1)
    return text[:place] + random.choice((*TEXTS, *NUMBERS, nested * 200_000, "\n")) + text[place:]


def _cut(random: random.Random, text: str, nested: str) -> str:
    return text[: random.randrange(len(text) + 1)]


def _exchanged(random: random.Random, text: str, nested: str) -> str:
    """Put a word of the text in the place of another one."""
    words = list(WORD.finditer(text))
    if not words:
        return text
    one, other = random.choice(words), random.choice(words)
    return text[: one.start()] + other[0] + text[one.end() :]


_Change = Callable[[random.Random, str, str], str]
_CHANGES: tuple[_Change, ...] = (
    _replaced(NUMBER, NUMBERS),
    _replaced(NUMBER, NUMBERS),
    _replaced(QUOTED, TEXTS, '"'),
    _replaced(QUOTED, NUMBERS),
    _replaced(NUMBER, TEXTS, '"'),
    _replaced(WORD, TEXTS),
    _line,
    _line,
    _inserted,
    _cut,
    _exchanged,
)

SHORT = ["--stop-time", "0.05", "-q", "-o", "out"]
_SCENARIO = 'leave_out = ["rider"]\n[[stimulus]]\nto = "ecu.throttle_request"\n{}\n'
_SWAP = """
fmu = "Scooter"
period = 0.01
substeps = 2
absent = []
[parameters]
mass = 180.0
[map.inputs]
throttle = "throttle"
"""


def _read(*parts: str) -> str:
    return DATA.joinpath(*parts).read_text(encoding="utf-8")


def _plot(random: random.Random) -> list[str]:
    return [] if random.random() < 0.15 else ["--no-plot"]


def a_system(random: random.Random) -> Input:
    """A system file."""
    name = random.choice(("scooter", "lane_keeping", "braking", "multi_drive"))
    text = mutated(random, _read("systems", f"{name}.toml"))
    if random.random() < 0.4:
        return Input("TOML", ["info", "s.toml"], {"s.toml": text})
    return Input("TOML", ["run", "s.toml", *SHORT, *_plot(random)], {"s.toml": text})


def a_scenario(random: random.Random) -> Input:
    """A scenario of a built-in system, with a figure and stimuli."""
    name = random.choice(("fig8", "udds", "identification", "ece15"))
    files = {"c.toml": mutated(random, _read("scenarios", "scooter", f"{name}.toml"))}
    return Input("TOML", ["run", "scooter", "-s", "c.toml", *SHORT, *_plot(random)], files)


def a_swap(random: random.Random) -> Input:
    """A swap file, run or checked."""
    files = {"w.toml": mutated(random, _SWAP)}
    if random.random() < 0.5:
        return Input("TOML", ["check", "w.toml", "--as", "scooter.vehicle"], files)
    return Input("TOML", ["run", "scooter", "--swap", "vehicle=w.toml", *SHORT, "--no-plot"], files)


def a_database(random: random.Random) -> Input:
    """A CAN database, run, shown, or with its frames logged."""
    text = mutated(random, _read("can", "ev.dbc"), random.choice(("(", '"', "SG_ ")))
    files = {"s.toml": _read("systems", "scooter.toml").encode(), "can/ev.dbc": text}
    command = random.choice(
        (["info", "s.toml"], ["run", "s.toml", *SHORT, "--no-plot"], ["run", "s.toml", "--can-log"])
    )
    return Input(
        "DBC", command if "--stop-time" in command or command[0] == "info" else [*command, *SHORT], files
    )


def a_table(random: random.Random) -> Input:
    """A CSV file of a stimulus or of results."""
    rows = "".join(f"{0.01 * k:.2f},{k % 7}.5,{k}\n" for k in range(6))
    text = mutated(random, "time,a,b\n" + rows, random.choice(('"', ",", ";")))
    if random.random() < 0.5:
        scenario = _SCENARIO.format(
            random.choice(('csv = "t.csv"', 'csv = "t.csv"\ncolumn = "b"\ninterpolation = "hold"'))
        )
        return Input(
            "CSV",
            ["run", "scooter", "-s", "c.toml", *SHORT, "--no-plot"],
            {"t.csv": text, "c.toml": scenario.encode()},
        )
    about = mutated(random, '{"evcosim": "0.2.0", "system": "x", "variables": [{"name": "a", "unit": "m"}]}')
    files = {"r/results.csv": text, "r/run.json": about, "q/results.csv": ("time,a,b\n" + rows).encode()}
    return Input("CSV", random.choice((["compare", "r", "q"], ["compare", "q", "r"], ["plot", "r"])), files)


def _description(random: random.Random, text: str) -> bytes:
    """Return a description with other attributes, which stays XML more often than not."""
    if random.random() < 0.3:
        return mutated(random, text, random.choice(("<a>", "<", "&")))
    for _ in range(random.randint(1, 4)):
        new = escape("".join(c for c in random.choice((*TEXTS, *NUMBERS)) if c >= " "), {'"': "&quot;"})
        found = random.choice(list(QUOTED.finditer(text)))
        text = f'{text[: found.start()]}"{new}"{text[found.end() :]}'
    return text.encode("utf-8", "surrogatepass")


def an_fmu(random: random.Random) -> Input:
    """An FMU with another description, shown, checked or run."""
    packed = io.BytesIO()
    with zipfile.ZipFile(fmu_file("Battery")) as source, zipfile.ZipFile(packed, "w") as target:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                content = _description(random, content.decode())
            target.writestr(zipfile.ZipInfo(name), content)  # the date of no day
    command = random.choice(
        (["info", "F.fmu"], ["info", "F.fmu"], ["check", "F.fmu", "--as", "scooter.battery"])
    )
    if random.random() < 0.2:
        command = ["run", "scooter", "--fmu", "battery=F.fmu", *SHORT, "--no-plot"]
    return Input("XML", command, {"F.fmu": packed.getvalue()})


_LINES = """
run scooter --stop-time 0.05 --set vehicle.mass=180 --algorithm jacobi --engine python -q --no-plot -o out
run scooter --scenario fig8 --stop-time 0.05 --ideal -q --no-plot -o out
run scooter --stop-time 0.05 --fmu battery=Battery --swap vehicle=none.toml --no-plot -q -o out
info scooter --json
info Scooter --causality input --search speed
info scooter --diagram out.svg
list
build Battery -o out
check Battery --as scooter.battery
check Battery --as scooter.battery --try 5ms
compare scooter scooter --tolerance 1e-6
plot out
schema swap -o out
budget scooter --set vehicle.mass=none --workers 1
identify Scooter --input throttle --output speed --amplitude 2 --sweep 1,2 --duration 0.05
compile Battery -o out
results recover out
"""


def a_command(random: random.Random) -> Input:
    """A command line with other words in it."""
    words = random.choice(_LINES.strip().splitlines()).split()
    for _ in range(random.choice((1, 1, 2, 3))):
        i = random.randrange(len(words))
        values = [
            j for j in range(1, len(words)) if words[j - 1].startswith("--") and not words[j].startswith("-")
        ]
        if values and random.random() < 0.6:
            words[i := random.choice(values)] = random.choice((*TEXTS, *NUMBERS))
            continue
        match random.randrange(6):
            case 0:
                words[i] = random.choice((*TEXTS, *NUMBERS))
            case 1:
                words[i] = words[i].partition("=")[0] + "=" + random.choice((*TEXTS, *NUMBERS))
            case 2:
                words.insert(i, random.choice((*TEXTS, *NUMBERS, "--set", "--debugx", "-s", "--json")))
            case 3:
                words.insert(i, random.choice(words))
            case 4 if len(words) > 1:
                del words[i]
            case _:
                words[i] = words[i] + random.choice((*TEXTS, *NUMBERS))
    return Input("CLI", [word.replace("\0", "") for word in words], {})


_MAKERS = (a_system, a_scenario, a_swap, a_database, a_table, an_fmu, a_command)


def inputs(count: int, seed: int) -> Iterator[Input]:
    """Yield so many inputs, of all kinds in turn; a seed gives the same ones again."""
    for number in range(count):
        yield _MAKERS[number % len(_MAKERS)](random.Random(f"{seed} {number}"))


def tried(case: Input, folder: Path) -> tuple[Outcome, str]:
    """Return what became of an input in a new folder: the exit code as its value, and what was printed."""
    folder.mkdir(parents=True)
    for name, content in case.files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(content)
    said = folder / "said.txt"

    def run() -> int:
        os.chdir(folder)
        with said.open("w", errors="replace") as out, open(os.devnull) as nothing:
            os.dup2(nothing.fileno(), 0)
            for descriptor in (1, 2):
                os.dup2(out.fileno(), descriptor)
            sys.stdin, sys.stdout, sys.stderr = nothing, out, out
            return main(case.arguments)

    outcome = forked(run, LIMIT)
    return outcome, said.read_text(errors="replace") if said.exists() else ""


def fault(outcome: Outcome, said: str) -> str:
    """Return what is wrong with an end, or ""."""
    if outcome.crash:
        return outcome.crash.strip().splitlines()[-1]
    if outcome.value not in (0, 1, 2, 130):
        return f"exit code {outcome.value}"
    # what an FMU in a process of its own printed stands in a message, not at its beginning
    for sign in ("unexpected error", "Warning: ", "\nTraceback"):
        if sign in said and "it printed:" not in said:
            return next(line for line in said.splitlines() if sign.strip() in line)
    return ""


def warm() -> None:
    """Import and compile what the inputs need, which their children then have."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        quiet = io.StringIO()
        with contextlib.redirect_stdout(quiet), contextlib.redirect_stderr(quiet):
            assert main(["run", "scooter", "--stop-time", "0.05", "-o", "out"]) == 0
            assert main(["info", "Battery"]) == 0


def campaign(count: int, seed: int, first: int = 0) -> int:
    """Try so many inputs, print a table and each fault, and return the number of faults."""
    warm()
    root = Path(tempfile.mkdtemp(prefix="evcosim-fuzz-"))
    codes: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    faults, slowest = 0, 0.0
    for number, case in enumerate(inputs(count, seed)):
        if number < first:
            continue
        folder = root / str(number)
        outcome, said = tried(case, folder)
        slowest = max(slowest, outcome.seconds)
        if wrong := fault(outcome, said):
            faults += 1
            shown = " ".join(word[:40] for word in case.arguments)
            print(f"{folder}: {case.kind}: {shown!r}: {wrong[:200]!r}", flush=True)
        else:
            shutil.rmtree(folder, ignore_errors=True)
        codes[case.kind][str(outcome.value)] += 1
    for kind, counted in sorted(codes.items()):
        print(f"{kind}: " + ", ".join(f"{n} with exit code {code}" for code, n in sorted(counted.items())))
    print(f"{count - first} inputs of seed {seed}: {faults} faults, the slowest took {slowest:.1f} s")
    if not faults:
        shutil.rmtree(root, ignore_errors=True)
    return faults


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="the number of the first input that is tried")
    given = parser.parse_args()
    sys.exit(1 if campaign(given.count, given.seed, given.first) else 0)
