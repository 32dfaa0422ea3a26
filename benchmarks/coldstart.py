"""How long a command takes from call to end: python -m benchmarks.coldstart, from the project's folder.

Each command runs in a new process, in turn with the others and several rounds over, with all caches filled by
a first round that does not count (built FMUs, compiled engine, Python's bytecode, the list of fonts); the
best round counts. Beside it, which of the large packages the command imports.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from . import machine, page

IMPORT = "import evcosim"
COMMANDS = (
    IMPORT, "--help", "list", "info scooter",
    "run scooter --no-plot --engine python", "run scooter --no-plot", "run scooter",
)  # fmt: skip # one list
LARGE = ("numpy", "pydantic", "fmpy", "cantools", "numba", "scipy", "matplotlib", "pint")


def main() -> None:
    """Measure and print, and keep what was measured in the docs if asked."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.coldstart", description=(__doc__ or "").split("\n\n")[0]
    )
    parser.add_argument("--rounds", type=int, default=7, help="how often each is measured (default: 7)")
    parser.add_argument(
        "--write", type=Path, metavar="PAGE", help="put the table into it: docs/performance.md"
    )
    arguments = parser.parse_args()
    seconds = measured(COMMANDS, arguments.rounds)
    text = report(seconds, {command: imported(command) for command in COMMANDS})
    print(text)
    if arguments.write is not None:
        page.put(arguments.write, "start", text)


def measured(commands: Sequence[str], rounds: int) -> dict[str, float]:
    """The least seconds of each command; "" is a Python that does nothing."""
    best = dict.fromkeys(("", *commands), float("inf"))
    for k in range(rounds + 1):
        for command in best:
            begin = time.perf_counter()
            _called(command)
            if k:
                best[command] = min(best[command], time.perf_counter() - begin)
    return best


def imported(command: str) -> set[str]:
    """Which of the large packages a command imports."""
    told = _called(command, "-X", "importtime").splitlines()
    modules = {line.rpartition("|")[2].strip() for line in told if line.startswith("import time:")}
    return {name for name in LARGE if name in modules}


def _called(command: str, *options: str) -> str:
    """What a command tells on its standard error."""
    alone = command in ("", IMPORT)
    program = ["-c", command or "pass"] if alone else ["-m", "evcosim", *command.split()]
    with tempfile.TemporaryDirectory() as folder:
        output = ["--output", folder] if command.startswith("run") else []
        call = [sys.executable, *options, *program, *output]
        return subprocess.run(call, capture_output=True, text=True, check=True).stderr


def report(seconds: Mapping[str, float], packages: Mapping[str, set[str]]) -> str:
    """The table."""
    rows = [
        [
            _shown(command),
            f"{best:.2f}",
            ", ".join(name for name in LARGE if name in packages.get(command, ())) or "none",
        ]
        for command, best in seconds.items()
    ]
    return f"Measured on: {machine.about()}.\n\n{page.table(['command', 's', 'large packages'], rows)}"


def _shown(command: str) -> str:
    if not command:
        return "Python alone"
    return f"`{command}`" if command == IMPORT else f"`evcosim {command}`"


if __name__ == "__main__":
    main()
