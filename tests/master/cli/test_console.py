"""Tables that fit any terminal, and JSON without NaN."""

from __future__ import annotations

import json
import os
import re
import shutil
import struct
import subprocess
import sys

import numpy as np
import pytest

from evcosim.master.cli import app, console
from evcosim.master.reproduce import papers
from evcosim.master.reproduce.page import Page, Row
from evcosim.master.studies import bus_budget
from support.judged_budget import judged


@pytest.mark.parametrize("columns", ["20", "40", "80", "200"])
def test_tables_lose_nothing_however_narrow(capsys, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", columns)
    text = "a long description of the thing that has to be wrapped somewhere"
    console.print_table(
        ("name", "unit", "about"), [("speed", "m/s", text), ("mass", "kg", "")], right=("unit",)
    )
    said = capsys.readouterr().out
    assert "speed   m/s" in said
    assert " ".join(said.split()).endswith("mass kg")
    assert all(word in said.split() for word in text.split())
    assert not any(line != line.rstrip() for line in said.splitlines())


def test_a_wrapped_table_is_no_wider_than_the_terminal(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    console.print_wrapped(("what", "obtained"), [("a long name of a quantity", "a long text\nof two lines")])
    said = capsys.readouterr().out
    assert max(map(len, said.splitlines())) <= 40
    assert "a long name of a     a long text of two" in said


def test_json_has_no_nan(capsys):
    console.print_json({"a": [float("nan"), np.float64(1.0)], "b": float("inf")})
    assert json.loads(capsys.readouterr().out) == {"a": [None, 1.0], "b": None}


@pytest.mark.parametrize(
    ("terminal", "environment", "bold"),
    [
        (True, {}, True),
        (False, {}, False),
        (True, {"NO_COLOR": "1"}, False),
        (True, {"NO_COLOR": ""}, True),
        (True, {"TERM": "dumb"}, False),
        (True, {"TERM": "xterm", "CLICOLOR": "1"}, True),
        (True, {"CLICOLOR": "0"}, False),
        (False, {"CLICOLOR": "1"}, False),
        (False, {"FORCE_COLOR": "1"}, True),
        (False, {"FORCE_COLOR": "0"}, False),
        (False, {"CLICOLOR_FORCE": "1", "TERM": "dumb"}, True),
        (True, {"NO_COLOR": "1", "FORCE_COLOR": "1"}, False),
    ],
)
def test_where_headings_are_bold(terminal, environment, bold):
    assert console.is_bold(terminal, environment) is bold


VERBS = [
    ("list",),
    ("info", "scooter"),
    ("info", "Battery"),
    ("check", "Battery", "--as", "scooter.vehicle"),
    ("compare", "a", "b"),
    ("reproduce", "lane_keeping"),
    ("run", "Battery", "--stop-time", "0.1", "--no-plot", "--no-report", "--profile"),
    ("schema", "swap"),
    ("new", "made"),
    ("run", "nothing"),
    ("compile", "nothing"),
    ("results", "recover", "a"),
]
LONGER = [
    ("identify", "Scooter", "--input", "throttle", "--output", "speed", "--amplitude", "5", "--at-input",
     "30", "--duration", "40", "--sweep", "0.2,2", "-o", "out"),
    ("budget", "scooter", "-o", "out"),
    ("bus", "braking", "--stop-time", "0.1", "-o", "out"),
    ("build", "Battery", "-o", "out"),
    ("plot", "a", "-o", "out.png"),
]  # fmt: skip # a line each


def test_each_verb_is_tried():
    """Its output has no color where nobody wants any; a new verb gets its line above."""
    assert set(app.command().commands) == {verb for verb, *_ in (*VERBS, *LONGER)}


@pytest.mark.parametrize("arguments", LONGER, ids=lambda arguments: arguments[0])
def test_no_color_keeps_escapes_out_of_what_takes_longer(evcosim, request, monkeypatch, arguments):
    if arguments[0] == "plot":
        request.getfixturevalue("two_runs")
    if arguments[0] == "budget":
        monkeypatch.setattr(bus_budget, "budget", lambda *_, **__: judged([1.0] * 5))
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("NO_COLOR", "1")
    answer = evcosim(*arguments)
    assert answer.code == 0 and answer.out and "\x1b" not in answer.out + answer.err


@pytest.mark.parametrize("command", VERBS, ids=lambda command: " ".join(command[:2]))
def test_color_adds_escapes_to_what_a_verb_prints_and_no_color_keeps_them_out(
    evcosim, request, monkeypatch, command
):
    """Only headings are set off, so that the text is the same without."""
    if command[0] in ("compare", "results"):
        request.getfixturevalue("two_runs")
    if command[0] == "reproduce":
        page = Page("lane_keeping", "t", "s", "a", (Row("(1)", "x", "", "", "1", "calibrated"),), (), (), ())
        monkeypatch.setattr(papers, "reproduce", lambda *_: [page])
    for name in ("NO_COLOR", "FORCE_COLOR", "CLICOLOR", "CLICOLOR_FORCE"):
        monkeypatch.delenv(name, raising=False)
    said = []
    for environment in ({}, {"FORCE_COLOR": "1"}, {"FORCE_COLOR": "1", "NO_COLOR": "1"}):
        for name, value in environment.items():
            monkeypatch.setenv(name, value)
        answer = evcosim(*command, *(("-o", "out") if command[0] in ("run", "reproduce") else ()))
        shutil.rmtree("made", ignore_errors=True)
        said.append(answer.out + answer.err)
    assert [("\x1b" in text) for text in said] == [
        False,
        command[0] in COLORED and command[1:] != ("nothing",),
        False,
    ]
    plain, colored, _ = (re.sub(r"\d[\d.e+-]*", "#", re.sub("\x1b\\[[01]m", "", text)) for text in said)
    assert plain.split() == colored.split()


COLORED = {"list", "info", "check", "compare", "reproduce", "run"}


@pytest.mark.skipif(sys.platform == "win32", reason="no pty")
@pytest.mark.parametrize(
    ("more", "bold"), [({}, True), ({"NO_COLOR": "1"}, False), ({"TERM": "dumb"}, False)]
)
def test_a_terminal_of_60_columns(tmp_path, more, bold):
    """Messages are wrapped there, and a pipe has each on a line."""
    outside = ("COLUMNS", "NO_COLOR", "FORCE_COLOR", "CLICOLOR", "CLICOLOR_FORCE")
    environment = {k: v for k, v in os.environ.items() if k not in outside} | {"TERM": "xterm"} | more
    verbs = "main(['list']); main(['run', 'mine/systems/scoter.toml'])"
    program = f"from evcosim.master.cli import main; {verbs}"
    said = in_terminal([sys.executable, "-c", program], tmp_path, environment, columns=60)
    assert ("\x1b[1m" in said) is bold
    assert "evcosim: mine/systems/scoter.toml: there is no such system\r\n  file\r\n" in said
    assert max(len(re.sub("\x1b\\[[01]m", "", line)) for line in said.splitlines()) <= 60
    if more:
        return
    run = [sys.executable, "-c", program]
    piped = subprocess.run(run, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert piped.stderr == "evcosim: mine/systems/scoter.toml: there is no such system file\n"
    assert "\x1b" not in piped.stdout


def in_terminal(command, folder, environment, columns):
    """Return what a program prints to a terminal of so many columns."""
    import fcntl
    import pty
    import termios

    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    running = subprocess.Popen(command, cwd=folder, env=environment, stdout=slave, stderr=slave, stdin=slave)
    os.close(slave)
    said = b""
    while True:
        try:
            part = os.read(master, 65536)
        except OSError:  # Linux says so that nobody has the other end any more
            part = b""
        if not part:
            break
        said += part
    os.close(master)
    running.wait(timeout=60)
    return said.decode()
