"""Every command of a how-to page runs as it is written, in its order, with the files that the page shows."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from evcosim.master.builtin import fmu_file
from support import warm

ROOT = Path(__file__).parents[2]
HOW_TO = ROOT / "docs" / "how-to"
BLOCK = re.compile(r"(?:<!-- (write|append): (\S+) -->\n)?^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
ELSEWHERE = {"vehicle.md"}  # tests/foreign/test_how_to_vehicle.py compares what its commands print too
GIVEN = {"MyScooter.fmu": "Scooter", "MyMotor.fmu": "InductionMotorDrive", "MyVehicle.fmu": "Scooter"}
PAGES = sorted(path.name for path in HOW_TO.glob("*.md") if path.name not in ELSEWHERE)


def fresh(line: str, folder: Path, environment: Mapping[str, str]) -> subprocess.CompletedProcess[str]:
    """Run a line by a shell."""
    return subprocess.run(line, shell=True, cwd=folder, env=environment, capture_output=True, text=True)


@pytest.mark.parametrize("name", PAGES)
def test_the_commands_run_in_their_order(tmp_path: Path, name: str) -> None:
    for file, model in GIVEN.items():
        shutil.copyfile(fmu_file(model), tmp_path / file)
    (tmp_path / "ride.csv").write_text("time,throttle\n0,0\n5,40\n", encoding="utf-8")
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    programs = os.environ | {"PATH": path, "COLUMNS": "100"}
    folder, ran = tmp_path, 0
    for action, file, language, text in BLOCK.findall((HOW_TO / name).read_text(encoding="utf-8")):
        if action:
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            with (folder / file).open("w" if action == "write" else "a", encoding="utf-8") as stream:
                stream.write(text)
        if language == "console":
            check_shown(text, folder, programs)
            ran += 1
        for command in text.splitlines() if language == "sh" else ():
            if command.startswith("cd "):
                folder /= command.split()[1]
                continue
            first = name == PAGES[0] and not ran  # by the installed program
            done = (fresh if first else warm.run)(command, folder, programs)
            assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
            ran += 1
    assert ran


def check_shown(text: str, folder: Path, programs: dict[str, str]) -> None:
    """Run the command of a block that shows its output: line by line the same words, to the digits shown."""
    command, _, shown = text.removeprefix("$ ").partition("\n")
    done = warm.run(command, folder, programs)
    assert done.returncode in (0, 1), f"{command}\n{done.stdout}{done.stderr}"
    said, expected = (part.splitlines() for part in (done.stdout, shown))
    assert [len(line.split()) for line in said] == [len(line.split()) for line in expected], done.stdout
    for word, other in zip(" ".join(said).split(), " ".join(expected).split(), strict=True):
        try:
            assert float(word) == pytest.approx(float(other), rel=0.01), done.stdout
        except ValueError:  # no number
            assert word == other, done.stdout
