"""The output of the verbs: tables and JSON on stdout, a progress bar on stderr."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import sys
import textwrap
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import typer

from ...cosim.visible import flowing, naming, on_one_line, raw_stream, visible, visible_json, visible_stream
from ...cosim.writing import finite
from .wrapping import GAP, is_narrow, wrapped, wrapped_below

_UNBOUNDED = 10_000  # columns of a file: a line of a table is a line of the file
_NARROW = 24  # a text is not wrapped to fewer columns
_REFRESH = 0.1  # s

Show = Callable[[float], None]
"""Called with the simulated time reached [s]."""


def print_json(data: Any) -> None:
    """Print JSON; a number that is not finite becomes null."""
    print(visible_json(json.dumps(finite(data), indent=2, ensure_ascii=False, allow_nan=False)))


def print_table(headers: Sequence[str], rows: Sequence[Sequence[str]], right: Sequence[str] = ()) -> None:
    """Print rows below headers; the columns named in `right` are right-aligned, empty ones are left out.

    Where the terminal is too narrow, each cell is wrapped inside its column. No text is cut off.
    `cosim.writing` has the tables of pages.
    """
    texts = [[on_one_line(text) for text in row[:-1]] + [flowing(row[-1])] for row in rows]
    shown = [i for i in range(len(headers)) if any(row[i] for row in texts)] or [len(headers) - 1]
    table = [[row[i] for i in shown] for row in (headers, *texts)]
    lay = wrapped_below if is_narrow(table, _width(), _NARROW) else wrapped
    _print_rows(lay(table, _width(), right))


def print_wrapped(headers: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print rows of texts below headers, each cell wrapped inside its column in a narrow terminal.

    Rows of which one is wrapped stand apart, with an empty line between them.
    """
    lines = wrapped([list(headers), *([flowing(text) for text in row] for row in rows)], _width())
    apart = any(len(some) > 1 for some in lines)
    _print_rows([lines[0], *([[""] * apart + some for some in lines[1:]])])


def _print_rows(rows: Sequence[Sequence[str]]) -> None:
    """Print the lines of each row of a table, the first of them in bold."""
    for i, lines in enumerate(rows):
        for line in lines:
            (print if i else _print_bold)(line)


def print_paragraph(text: str) -> None:
    """Print a text, wrapped to the width of the terminal."""
    print(_wrapped("", flowing(text), 0))


def print_fields(fields: Sequence[tuple[str, str]], indent: int = 0) -> None:
    """Print names and values side by side, the values wrapped."""
    fields = [(on_one_line(name), flowing(value)) for name, value in fields]
    width = max((len(name) for name, _ in fields), default=0)
    for name, value in fields:
        head = " " * indent + name.ljust(width) + GAP
        print(_wrapped(head, value, len(head)))


def print_next(commands: Sequence[str]) -> None:
    """Print commands that go on from here, after an empty line; not wrapped, so that they can be copied."""
    print()
    for i, command in enumerate(commands):
        print(f"{'' if i else 'next':4}{GAP}{on_one_line(command)}")


def print_title(text: str, first: bool = False) -> None:
    """Print a heading, after an empty line unless it is the first thing printed."""
    if not first:
        print()
    _print_bold(_wrapped("", on_one_line(text), 0))


def _wrapped(head: str, text: str, indent: int) -> str:
    """Return `head`, then `text` wrapped to the width with `indent` spaces before its other lines."""
    lines = textwrap.wrap(
        text, max(_width() - indent, _NARROW), break_on_hyphens=False, break_long_words=False
    ) or [""]
    return ("\n" + " " * indent).join([head + lines[0], *lines[1:]]).rstrip()


def _width() -> int:
    """Return the columns of the terminal, or of a file."""
    bounded = sys.stdout.isatty() or "COLUMNS" in os.environ
    return shutil.get_terminal_size().columns if bounded else _UNBOUNDED


def _print_bold(text: str) -> None:
    stream = raw_stream(sys.stdout)
    with naming(stream):
        typer.secho(visible(text), file=stream, bold=True, color=is_bold(stream.isatty()))


def is_bold(terminal: bool, environment: Mapping[str, str] = os.environ) -> bool:
    """Return True where headings are bold: on a terminal, unless the environment says otherwise.

    NO_COLOR counts most, then FORCE_COLOR and CLICOLOR_FORCE, then TERM=dumb and CLICOLOR=0.
    """

    def says(name: str) -> bool:
        return environment.get(name, "") not in ("", "0")

    if environment.get("NO_COLOR"):
        return False
    if says("FORCE_COLOR") or says("CLICOLOR_FORCE"):
        return True
    return terminal and environment.get("TERM") != "dumb" and environment.get("CLICOLOR") != "0"


def number(value: float) -> str:
    """Return a number with six digits."""
    return f"{value:.6g}"


@contextlib.contextmanager
def progress_bar(text: str, start: float, stop: float, wanted: bool) -> Iterator[Show]:
    """Show a bar over the simulated time [s] on stderr, if that is a terminal and a bar is wanted."""
    if not (wanted and sys.stderr.isatty()):
        yield lambda reached: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeRemainingColumn(),
    )
    # refreshed from here: a thread of its own would take the interpreter away from the units
    console = Console(file=raw_stream(sys.stderr), no_color=not is_bold(True))
    with Progress(*columns, console=console, transient=True, auto_refresh=False) as progress:
        # rich has streams of its own now, which print above the bar
        sys.stdout, sys.stderr = map(visible_stream, (sys.stdout, sys.stderr))
        task = progress.add_task(on_one_line(text), total=stop - start)
        last = time.perf_counter()

        def show(reached: float) -> None:
            nonlocal last
            now = time.perf_counter()
            if now - last >= _REFRESH:
                last = now
                progress.update(task, completed=reached - start)
                progress.refresh()

        yield show
