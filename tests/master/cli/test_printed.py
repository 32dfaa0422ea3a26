"""What is printed of files and FMUs holds nothing that steers a terminal or hides a difference."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest

from evcosim.cosim.errors import RunError
from evcosim.cosim.results.results import Results
from evcosim.cosim.visible import visible
from evcosim.master.cli import completion
from evcosim.master.simulation import simulate
from support import marks
from support.hostile import units
from support.hostile.case import WHOLE, Case

pytestmark = pytest.mark.usefixtures("warm_units")

SCENARIO = "sc\x1b[2J\u202e\nevcosim: all is well.toml"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of strangers' files, with the results of a run, and of one that failed."""
    made = tmp_path_factory.mktemp("marks")
    (made / "failing").mkdir()
    marks.system(made / "failing", "log_escapes")
    system = marks.system(made)
    event = 'time = 0.05\naction = "set"\nvariable = "bad.u"\nvalue = 2\n'
    (made / SCENARIO).write_text(f'title = "x\\u001b"\n[[event]]\n{event}')
    simulate(system).write(made / "results")
    with pytest.raises(RunError) as caught:
        simulate(made / "failing" / "marked.toml")
    assert caught.value.results is not None
    caught.value.results.write(made / "failed")
    (made / "swap.toml").write_text('fmu = "bad.fmu"\n[map.outputs]\n"y\\u001b" = "n"\n')
    return made


IDENTIFY = ["--input", "bad.u", "--amplitude", "0.1", "--sweep", "1,10", "--duration", "3", "--at-input", "1"]
COMMANDS = [
    ["info", "bad.fmu"],
    ["info", "bad.fmu", "--search", "\u202e"],
    ["info", "bad.fmu", "--strict"],
    ["info", "bad.fmu", "--json"],
    ["info", "marked.toml"],
    ["info", "marked.toml", "--json"],
    ["info", "marked.toml", "--diagram", "diagram.svg"],
    ["info", "\udcff\x1b.fmu"],
    ["check", "bad.fmu", "--as", "marked.toml.bad", "--write", "written.toml"],
    ["check", "bad.fmu", "--as", "scooter.vehicle", "--write", "other.toml"],
    ["check", "swap.toml", "--as", "marked.toml.bad", "--json"],
    ["check", "bad.fmu", "--as", "marked.toml.bad", "--try", "20ms"],
    ["run", "marked.toml", "-o", "out"],
    ["run", "marked.toml", "-o", "out", "--json", "--can-log", "can.asc", "--replace"],
    ["run", "marked.toml", "-s", SCENARIO, "-o", "out", "-q", "--replace", "--engine", "python"],
    ["run", "marked.toml", "-o", "alone", "--isolation", "none"],
    ["run", "marked.toml", "--set", "bad.gian=3"],
    ["run", "marked.toml", "--swap", "bad=swap.toml"],
    ["run", "marked.toml", "-s", "no\x1b\u202e"],
    ["run", "failing/marked.toml", "-o", "out2", "--no-plot"],
    ["run", "failing/marked.toml", "-o", "out3", "--no-plot", "--isolation", "none"],
    ["run", "bad.fmu", "-o", "out4", "--stop-time", "0.1", "--step-size", "0.01"],
    ["run", "bad.fmu", "--input", "\x1b[2J=3"],
    ["plot", "results", "-o", "plot.svg"],
    ["plot", "results", "--signals", "n\x1b", "-o", "plot.svg"],
    ["compare", "results", "failed", "--plot", "compared.svg"],
    ["identify", "marked.toml", "--output", "good.y", *IDENTIFY],
    ["identify", "marked.toml", "--output", "bad.n", *IDENTIFY],
    ["budget", "marked.toml"],
    ["results", "recover", "results"],
    ["results", "recover", "no\x1b[2J\u202e"],
    ["build", "\x1b[2J\u202e"],
    ["compile", "bad.fmu"],
    ["schema", "\x1b\u202e"],
    ["reproduce", "\x1b\u202e"],
    ["\x1b[2J"],
    ["run", "marked.toml", "--\x1b\u202e"],
    ["--debug", "run", "marked.toml", "--set", "bad.gian=3"],
]  # fmt: skip # a command a line


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: ascii(" ".join(command)))
def test_nothing_that_is_printed_steers_or_hides(
    folder: Path, command: list[str], monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    from evcosim.master.cli import main

    monkeypatch.chdir(folder)
    assert main(command) in (0, 1, 2)
    captured = capfd.readouterr()
    for printed in captured:
        assert visible(printed) == printed
    lines = captured.out.splitlines() if "--debug" in command else "".join(captured).splitlines()
    assert not [line for line in lines if line.startswith("evcosim: all is well")]
    for page in folder.glob("*.svg"):
        assert visible(page.read_text(encoding="utf-8")) == page.read_text(encoding="utf-8")


def test_what_is_printed_says_what_it_is(evcosim, folder: Path) -> None:
    about = evcosim("info", folder / "bad.fmu").out
    assert "model\\x7f\\x85\\x9b\\u202e\\u2066\\u200f\\u061c\\u200b\\u2028\\ufeff evcosim: all" in about
    ran = evcosim("run", folder / "marked.toml", "--no-plot", "-o", "out").out
    assert "warned \\x1b[31m\\u202e\\x07 red \\x9b" in ran
    failed = evcosim("run", folder / "failing" / "marked.toml", "--no-plot", "-o", "failed").err
    assert "[Error] \\x1b[2J\\x1b]0;title\\x07\\rover" in failed


def test_json_has_the_texts_as_they_are(evcosim, folder: Path) -> None:
    printed = evcosim("info", folder / "bad.fmu", "--json")
    assert visible(printed.out) == printed.out
    assert printed.json["name"] == "model" + marks.XML
    assert printed.json["variables"][1]["name"] == marks.OUTPUT
    path = folder / "results" / "run.json"
    text = path.read_text(encoding="utf-8")
    assert visible(text) == text
    warning = "warned \x1b[31m\u202e\x07\tred\r\x9b\nevcosim: all is well"
    assert any(warning in said for said in json.loads(text)["warnings"])
    assert f"bad.{marks.OUTPUT}" in Results.read(folder / "results")


def test_a_swap_file_has_the_escapes_of_toml(evcosim, folder: Path) -> None:
    evcosim("check", folder / "bad.fmu", "--as", f"{folder / 'marked.toml'}.bad", "--write", "swap.toml")
    text = Path("swap.toml").read_text(encoding="utf-8")
    assert visible(text) == text
    assert tomllib.loads(text)["map"]["outputs"][marks.OUTPUT] == marks.OUTPUT
    ran = evcosim("run", folder / "marked.toml", "--swap", "bad=swap.toml", "--no-plot", "-o", "out")
    assert ran.code == 0
    undecoded = folder / "v\udcff.fmu"
    marks.fmu(undecoded)
    refused = evcosim("check", undecoded, "--as", f"{folder / 'marked.toml'}.bad", "--write", "other.toml")
    assert (refused.code, Path("other.toml").exists()) == (2, False)
    assert "v\\udcff.fmu: the bytes of this name are no UTF-8" in refused.err


def test_an_error_in_python_is_as_visible(folder: Path) -> None:
    with pytest.raises(RunError) as caught:
        simulate(folder / "failing" / "marked.toml", isolation="none")
    assert visible(str(caught.value)) == str(caught.value)


@pytest.mark.parametrize(
    ("act", "said"), [("segfault", "this process crashed"), ("exit0", "ended the process of evcosim")]
)
def test_a_crash_and_an_exit_name_the_unit_visibly(process, tmp_path: Path, act: str, said: str) -> None:
    path = marks.system(tmp_path, act, "b\x1b\u202e.fmu")
    started = process(
        *("run", path, "--isolation", "none", "--engine", "python", "--no-plot", "-o", tmp_path / "out")
    )
    _, printed = started.communicate(timeout=60)
    assert said in printed
    assert "b\\x1b\\u202e.fmu" in printed
    assert visible(printed) == printed


def test_the_tab_key_offers_no_such_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "scenarios" / "marked"
    folder.mkdir(parents=True)
    for name in ("good", "b\x1b[2J", "c\u202e", "d\n"):
        (folder / f"{name}.toml").write_text("")
    (tmp_path / "s.toml").write_text('name = "marked"\n')

    class Line:
        params = {"system": str(tmp_path / "s.toml")}
        args: tuple[str, ...] = ()

    assert completion.scenarios(Line()) == ["good"]  # type: ignore[arg-type] # what it reads of a context


BREAK = "\n\r\tINJECTED"
NAMED = f"y{BREAK}"
LINES = [
    ["info", "named.fmu"],
    ["info", "named.fmu", "--causality", "input"],
    ["check", "named.fmu", "--as", "scooter.vehicle"],
    ["run", "named.fmu", "--no-plot", "-o", "one"],
    ["run", "named.fmu", "--no-plot", "-o", "one", "--set", f"{NAMED[:3]}=1"],
    ["run", "named.fmu", "--input", f"{NAMED}=1"],
    ["run", "named.fmu", "--input", "u=columns.csv"],
    ["run", "named.fmu", "--input", f"u=columns.csv:{NAMED}", "-q", "--no-plot", "-o", "two"],
    ["run", "named.fmu", "--input", f"u=t{BREAK}.csv"],
    ["run", "nan.fmu", "--no-plot", "-o", "three"],
    ["run", "nan.fmu", "--no-plot", "-o", "three", "--isolation", "none", "--trust"],
    ["run", "initialize_nan.fmu", "--no-plot", "-o", "four"],
    ["run", "beyond.fmu", "--no-plot", "-o", "five", "-q"],
    ["run", f"s{BREAK}.toml", "--no-plot", "-o", "six"],
    ["run", f"none{BREAK}.toml"],
    ["run", "bus.toml"],
    ["run", "scooter", "-s", f"none{BREAK}.toml"],
    ["run", "scooter", "--fmu", f"vehicle=none{BREAK}.fmu"],
    ["run", "scooter", "--stop-time", "1.1", "--no-plot", "-o", f"out{BREAK}"],
    ["plot", "columns.csv", "--signals", "z"],
    ["plot", "twice.csv"],
    ["plot", "wrong.csv"],
    ["plot", f"none{BREAK}.csv"],
    ["compare", "columns.csv", "other.csv"],
    ["compare", "one", "columns.csv"],
    ["results", "recover", f"none{BREAK}"],
]


@pytest.fixture(scope="module")
def broken(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of strangers' files whose names have line ends."""
    made = tmp_path_factory.mktemp("broken")
    name = f"name={quoteattr(NAMED)}"
    unit = f"unit={quoteattr('m/s' + BREAK)}"
    limit = '<Real unit="m/s" max="-5"/>'
    for act, *changes in (
        ("named", ('name="y"', name), ('name="gain"', f"name={quoteattr('gain' + BREAK)}")),
        ("nan", ('name="y"', name), ('<Real unit="m/s"/>', f"<Real {unit}/>")),
        ("initialize_nan", ('name="y"', name)),
        ("beyond", ('name="y"', name), ('<Real unit="m/s"/>', limit)),
    ):
        case = Case(act, "", "", WHOLE, act=act if "nan" in act else "", changes=tuple(changes))
        units.write(made / f"{act}.fmu", case, 2)
    cell = f'"{NAMED}"'
    (made / "columns.csv").write_text(f"time,{cell},a\n0,1,2\n1,2,3\n", newline="")
    (made / "other.csv").write_text(f"time,{cell},b{BREAK[2:]}\n0,1,2\n1,2,4\n", newline="")
    (made / "twice.csv").write_text(f"time,{cell},{cell}\n0,1,2\n", newline="")
    (made / "wrong.csv").write_text(f'time,{cell}\n0,"1{BREAK}"\n', newline="")
    system = '"broken"\n[units.a]\nfmu = "{}"\n'
    (made / f"s{BREAK}.toml").write_text(f"name = {system.format('none.fmu')}", newline="")
    bus = '[buses.can0]\ndbc = "a.dbc"\n[[connect]]\nfrom = "a.y"\nto = []\nvia = "can0.M.S"\n'
    units.write(made / "good.fmu", Case("good", "", "", WHOLE), 2)
    (made / "bus.toml").write_text(f"name = {system.format('good.fmu')}{bus}", newline="")
    marks.dbc(made / "a.dbc")
    text = (made / "a.dbc").read_text(encoding="utf-8").replace(f'"u{marks.text_of_dbc()}"', f'"u{BREAK}"')
    (made / "a.dbc").write_text(text, encoding="utf-8", newline="")
    return made


@pytest.mark.parametrize("command", LINES, ids=lambda command: ascii(" ".join(command)))
def test_a_name_takes_no_line_of_its_own(
    broken: Path, command: list[str], monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    from evcosim.master.cli import main

    monkeypatch.chdir(broken)
    assert main(command) in (0, 1, 2)
    lines = "\n".join(capfd.readouterr()).splitlines()
    assert not [line for line in lines if line.strip().startswith("INJECTED")], lines
