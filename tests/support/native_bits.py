"""Native FMUs beside Python, bit for bit, in many random steps, and the time of a step of both.

    .venv/bin/python tests/support/native_bits.py                    # 100,000 steps of each built-in model
    .venv/bin/python tests/support/native_bits.py --steps 1000 Rider
    .venv/bin/python tests/support/native_bits.py --seconds 60       # of each model, no more than so long
    .venv/bin/python tests/support/native_bits.py --write  # put the table into docs/how-to/native.md

Parameters, inputs, start times and step sizes are random, and states are saved and restored
(evcosim.fmus.native.check). Steps are taken in parts, each with a seed of its own, in another process; a part
that takes too long is ended and left out, which the table says. Each is a line of --results as soon as it is
done, so that a run which was ended goes on where it was. A step is set, step and get, called by a loop in C
(python -m benchmarks.slaves). The exit code is 1 where a bit differs.
"""

from __future__ import annotations

import argparse
import dataclasses
import hashlib
import json
import multiprocessing
import sys
import tempfile
import time
from collections.abc import Iterator
from importlib import import_module
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT)]  # for benchmarks

from benchmarks import machine, page  # noqa: E402 - they are found from here on
from benchmarks.slaves import measured_files  # noqa: E402 - the same
from evcosim.fmus.build import built, names  # noqa: E402 - the same
from evcosim.fmus.catalog import CATALOG  # noqa: E402 - the same
from evcosim.fmus.native.basis import mathematical_library  # noqa: E402 - the same
from evcosim.fmus.native.build import extracted_library, native_built  # noqa: E402 - the same
from evcosim.fmus.native.check import Counts, first_difference  # noqa: E402 - the same

PAGE = ROOT / "docs" / "how-to" / "native.md"
RESULTS = ROOT / "results" / "native_bits.jsonl"
PART = 500  # steps with one seed
ENDED = 20  # parts of a model that may take too long
HEADER = (
    "model",
    "steps",
    "values",
    "different bits",
    "refusals",
    "states restored",
    "native [us]",
    "Python [us]",
)


@dataclasses.dataclass
class Part:
    """Some steps with one seed; `said` is the first difference, `ended` means that they took too long."""

    model: str
    basis: str
    seed: int
    steps: int = 0
    values: int = 0
    refusals: int = 0
    restored: int = 0
    said: str = ""
    ended: bool = False


def basis_of(name: str) -> str:
    """Return a digest of what the comparison depends on: the model's file, Python, mathematical library."""
    content = native_built(name).read_bytes()
    about = (hashlib.sha256(content).hexdigest(), sys.version, *mathematical_library())
    return hashlib.sha256(repr(about).encode()).hexdigest()[:16]


def work(pipe: Connection, name: str) -> None:
    """Compare a built-in model with itself in Python, with each seed and number of steps that comes."""
    import fmpy

    path = native_built(name)
    token = fmpy.read_model_description(path).guid
    model = getattr(import_module(f"evcosim.models.{CATALOG[name].module}"), name)
    with tempfile.TemporaryDirectory() as folder:
        library = extracted_library(path, Path(folder))
        while (task := pipe.recv()) is not None:
            counts = Counts()
            said = first_difference(model, library, token, task[1], task[0], counts)
            pipe.send((counts, said))


class Worker:
    """The process that compares a model; a new one is made where the last one had to be ended."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.process: Any = None

    def compared(self, seed: int, steps: int, seconds: float) -> tuple[Counts, str] | None:
        """Return what was compared and the first difference, None where it takes more than so long."""
        if self.process is None:
            context = multiprocessing.get_context("spawn")
            self.pipe, other = context.Pipe()
            self.process = context.Process(target=work, args=(other, self.name), daemon=True)
            self.process.start()
            other.close()
        self.pipe.send((seed, steps))
        if self.pipe.poll(seconds):
            found: tuple[Counts, str] = self.pipe.recv()
            return found
        self.process.kill()
        self.process.join()
        self.process = None
        return None

    def end(self) -> None:
        """End the process."""
        if self.process is not None:
            self.pipe.send(None)
            self.process.join()


def kept_parts(results: Path, basis: str) -> Iterator[Part]:
    """Return the parts of an earlier run on the same basis, in the order of their seeds."""
    lines = results.read_text().splitlines() if results.is_file() else []
    found = {part.seed: part for part in (Part(**json.loads(line)) for line in lines) if part.basis == basis}
    yield from (found[seed] for seed in sorted(found))


def compared(name: str, given: argparse.Namespace) -> list[Part]:
    """Compare a built-in model in as many steps and as long as asked, and return its parts."""
    basis, worker = basis_of(name), Worker(name)
    parts = list(kept_parts(given.results, basis))
    end = time.monotonic() + given.seconds
    given.results.parent.mkdir(parents=True, exist_ok=True)
    with given.results.open("a") as file:
        for seed in range(parts[-1].seed + 1 if parts else 0, sys.maxsize):
            missing, left = given.steps - sum(part.steps for part in parts), end - time.monotonic()
            ended = sum(part.ended for part in parts)
            if missing <= 0 or left <= 0 or ended == ENDED or any(part.said for part in parts):
                break
            found = worker.compared(seed, min(PART, missing), min(given.part_seconds, left))
            if found is None and left < given.part_seconds:  # the time is over, not that of the part
                break
            counts, said = found or (Counts(), "")
            parts.append(
                Part(name, basis, seed, **dataclasses.asdict(counts), said=said, ended=found is None)
            )
            print(json.dumps(dataclasses.asdict(parts[-1])), file=file, flush=True)
    worker.end()
    return parts


def row(name: str, parts: list[Part], rounds: int) -> list[str]:
    """Return a line of the table."""
    seconds = measured_files(name, {"native": native_built(name), "python": built(name)}, rounds, 200)
    said = next((f"seed {part.seed}: {part.said}" for part in parts if part.said), "0")
    total = {
        key: sum(getattr(part, key) for part in parts) for key in ("steps", "values", "refusals", "restored")
    }
    counted = [f"{total[key]:,}" for key in ("refusals", "restored")]
    times = (f"{1e6 * seconds[kind]:.3g}" for kind in ("native", "python"))
    return [name, f"{total['steps']:,}", f"{total['values']:,}", said, *counted, *times]


def left_out(found: dict[str, list[Part]], part_seconds: float) -> str:
    """Return a sentence on the parts that took too long, or ""."""
    ended = {name: sum(part.ended for part in parts) for name, parts in found.items()}
    said = ", ".join(f"{count} of {name}" for name, count in ended.items() if count)
    start = f"Left out, because {PART} steps in Python took longer than {part_seconds:g} s"
    return f"\n\n{start}: {said}." if said else ""


def main() -> int:
    """Compare, print the table, and return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="built-in models; default: all")
    parser.add_argument("--steps", type=int, default=100_000, help="random steps of each (default: 100000)")
    parser.add_argument(
        "--seconds", type=float, default=float("inf"), help="of each model at most (default: all steps)"
    )
    parser.add_argument("--part-seconds", type=float, default=60.0, help="of a part at most (default: 60)")
    parser.add_argument("--results", type=Path, default=RESULTS, help=f"default: {RESULTS.relative_to(ROOT)}")
    parser.add_argument("--rounds", type=int, default=20, help="of the measurement of a step (default: 20)")
    parser.add_argument("--write", action="store_true", help="put the table into docs/how-to/native.md")
    given = parser.parse_args()
    found, rows = {}, []
    for name in given.names or names():
        found[name] = compared(name, given)
        rows.append(row(name, found[name], given.rounds))
        print("  ".join(rows[-1]), file=sys.stderr, flush=True)
    text = f"Measured on: {machine.about()}; {' '.join(mathematical_library()[:2])}.\n\n"
    text += page.table(list(HEADER), rows) + left_out(found, given.part_seconds)
    print(text)
    if given.write:
        page.put(PAGE, "native", text)
    return int(any(part.said for parts in found.values() for part in parts))


if __name__ == "__main__":
    raise SystemExit(main())
