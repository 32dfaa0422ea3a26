"""docs/how-to/vehicle.md: its commands, run in order, print what the page says."""

from __future__ import annotations

import os
import re
import shutil
import sys
from pathlib import Path

from support import warm
from support.needs import need_c_compiler

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "how-to" / "vehicle.md"
# What depends on the machine, the compiler and the day.
VARIES = re.compile(r"^(speed +(good|note) .*|file  .*|sha256 .*|platforms .*|validator .*)$", re.MULTILINE)


def test_the_page_shows_what_its_commands_print(tmp_path: Path) -> None:
    need_c_compiler()
    folder = tmp_path / "modelica"
    shutil.copytree(ROOT / "examples" / "modelica", folder)
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    # A width of the terminal that somebody set would break the lines.
    programs = {name: x for name, x in os.environ.items() if name != "COLUMNS"} | {"PATH": path}
    page = PAGE.read_text(encoding="utf-8")
    blocks = re.findall(r"```console\n(.*?)```", page, re.DOTALL)
    assert len(blocks) == 5
    for block in blocks:
        for command, told in re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", block, re.MULTILINE):
            done = warm.run(command, folder, programs)
            printed = "".join(f"{line.rstrip()}\n" for line in done.stdout.splitlines())
            assert done.returncode in (0, 1), done.stderr
            assert VARIES.sub("", printed.strip()) == VARIES.sub("", told.strip()), command
    assert (folder / "swap.toml").read_text() in page
