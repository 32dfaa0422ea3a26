"""Try public DBC files: does each load, which of its signals can be used, and do values and bits agree.

    .venv/bin/python tests/support/public_databases.py FOLDER     # writes public_databases.csv anew

FOLDER has a folder `OWNER+NAME` for each repository, with a file REVISION (the commit) and the repository's
DBC files at their paths in it; none of them is part of this project, the table is. A signal is usable if a
system of two units runs in which one sends it to the other, with `cycle_time` for the messages that have none
as the only setting beside `rounding = "half_even"`. What arrives, and the bytes of the frames, are compared
with cantools where that reads the file, frames of messages with a flaw aside, which it cannot decode.
"""

from __future__ import annotations

import collections
import csv
import dataclasses
import hashlib
import random
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import cantools.database
import numpy as np

from evcosim.cosim.can.database import Database, Message, Signal
from evcosim.cosim.can.dbc import load_dbc
from evcosim.cosim.can.logs.frames import frames
from evcosim.cosim.can.overlaps import conditions
from evcosim.cosim.can.quantization import decode, quantize
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.plan.plan import Plan
from evcosim.master.engine.initialization import initialize
from evcosim.master.engine.python_engine import PythonEngine
from support.mocks import MockUnit, plan_of, real

TABLE = Path(__file__).with_suffix(".csv")
_ROUNDS = 3
_CYCLE = 1.0  # s: slow enough for all messages of a car, sent by one unit on one bus
_FAR = 1e300
_NAME_OR_NUMBER = re.compile(r"'[^']*'|\b0x[0-9a-f]+\b|-?\b\d[\d.e+-]*|\[[^\]]*\]")


@dataclasses.dataclass
class Outcome:
    """What was found of one file: a row of the table."""

    repository: str
    path: str
    revision: str
    sha256: str
    loads: str = "yes"
    cantools: str = "yes"
    messages: int = 0
    signals: int = 0
    usable: int = 0
    values: int = 0
    different_values: int = 0
    frames: int = 0
    different_frames: int = 0
    reasons: str = ""


def tried(folder: Path) -> Iterator[Outcome]:
    """Yield the outcome of each DBC file below a folder, in the order of their paths."""
    for path in sorted(folder.rglob("*")):
        if path.suffix.lower() != ".dbc":
            continue
        home = folder / path.relative_to(folder).parts[0]
        revision = home / "REVISION"
        yield outcome(
            path,
            Outcome(
                home.name.replace("+", "/"),
                path.relative_to(home).as_posix(),
                revision.read_text().strip() if revision.is_file() else "",
                hashlib.sha256(path.read_bytes()).hexdigest(),
            ),
        )


def outcome(path: Path, found: Outcome) -> Outcome:
    """Return the outcome of one file, written into `found`."""
    try:
        database = load_dbc(path)
    except ConfigError as error:
        found.loads = str(error).removeprefix(f"{path}: ")
        return found
    codec = _codec(path, found)
    reasons: collections.Counter[str] = collections.Counter()
    found.messages = len(database.messages)
    found.signals = sum(len(m.signals) + len(m.unread) for m in database.messages.values())
    for names in _usable(database, reasons).values():
        _run(path, names, codec, found)
    found.reasons = "; ".join(f"{n} x {reason}" for reason, n in sorted(reasons.items()))
    return found


def _codec(path: Path, found: Outcome) -> Any:
    """Return cantools' reading of the file, first the strict one; None, with the reason, for none."""
    text = _text(path)
    for strict in (True, False):
        try:
            codec = cantools.database.load_string(text, "dbc", strict=strict)
        except Exception as error:  # whatever it raises is its outcome
            found.cantools = f"{type(error).__name__}: {' '.join(str(error).split())[:80]}"
        else:
            found.cantools = "yes" if strict else "not strict"
            return codec
    return None


def _text(path: Path) -> str:
    data = path.read_bytes()
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", errors="replace")


_Names = list[tuple[Message, Signal]]


def _usable(database: Database, reasons: collections.Counter[str]) -> dict[int, _Names]:
    """Return the signals that may be used: those that are no multiplexer at -1, the others by their depth.

    A multiplexer is not connected beside what it selects, which may be another one.
    """
    found: dict[int, _Names] = {}
    for message in database.messages.values():
        for name in (*message.signals, *message.unread):
            try:
                signal = message.require(name)
            except ConfigError as error:
                assert re.search(r": line \d+: ", str(error)), error  # each says the line
                reasons[_kind(str(error))] += 1
                continue
            depth = len(list(conditions(message.signals, name))) if signal.is_multiplexer else -1
            found.setdefault(depth, []).append((message, signal))
    return found


def _kind(said: str) -> str:
    """Return a reason without the names and numbers of its file."""
    return _NAME_OR_NUMBER.sub("#", re.split(r": line \d+: (?:[^:]*\.[^:]*: )?", said)[-1])[:70]


def _run(path: Path, names: _Names, codec: Any, found: Outcome) -> None:
    """Run the system that sends all these signals, and count what is equal."""
    a = MockUnit("a", [real(f"y{i}", "output") for i in range(len(names))])
    b = MockUnit("b", [real(f"u{i}", "input") for i in range(len(names))])
    connect = [
        {"from": f"a.y{i}", "to": [f"b.u{i}"], "via": f"c.{m.name}.{s.name}"}
        for i, (m, s) in enumerate(names)
    ]
    bus = {"dbc": str(path), "cycle_time": _CYCLE, "rounding": "half_even"}
    # the file's own may be no multiples of the step
    cycles = {m.name: {"cycle_time": _CYCLE, "start_delay": 0.0} for m, _ in names}
    system = {
        "connect": connect,
        "buses": {"c": bus | {"messages": cycles}},
        "experiment": {"step_size": _CYCLE, "stop_time": 10000 * _CYCLE},
        "record": ["a.y0"],
    }
    plan = plan_of([a, b], system)
    pages = max(message.every for message in plan.messages)
    chance = random.Random(found.sha256)
    codecs = [_codec_signal(codec, message, signal) for message, signal in names]
    flawed = {m.name for m, _ in names if any(s.problem for s in m.signals.values())}
    flawed |= {m.name for m, s in names if s.is_multiplexer and not _ids(m, s)}  # cantools reads a page there
    flawed |= _lost(codec)
    right = [True] * len(names)
    for turn in range(_ROUNDS):
        sent = [_value(message, signal, turn, chance) for message, signal in names]
        got, sent_frames = _received([a, b], plan, sent, pages)
        raws: dict[str, dict[str, float]] = {}
        for i, (message, signal) in enumerate(names):
            raw, value = _expected(codecs[i], signal, sent[i])
            raws.setdefault(message.name, {})[signal.name] = raw
            found.values += 1
            if got[i].hex() != value.hex():
                found.different_values += 1
                right[i] = False
        sent_frames = [frame for frame in sent_frames if frame.message.name not in flawed]
        _compare_frames(codec, raws, sent_frames, found)
    found.usable += sum(right)


def _lost(codec: Any) -> set[str]:
    """Return the messages whose pages cantools loses: it seeks a multiplexer by its short name."""
    lost = set()
    for parsed in codec.messages if codec else ():
        selectors = {s.multiplexer_signal for s in parsed.signals} - {None}
        if not selectors <= {s.name for s in parsed.signals}:
            lost.add(parsed.name)
    return lost


def _ids(message: Message, multiplexer: Signal) -> list[int]:
    """Return raw values of a multiplexer that select signals: such that are no multiplexers themselves."""
    selected = [s for s in message.signals.values() if s.multiplexer == multiplexer.name and not s.problem]
    return [s.multiplexer_ranges[0][0] for s in selected if not s.is_multiplexer]


def _value(message: Message, signal: Signal, turn: int, chance: random.Random) -> float:
    """Return a value that the signal can carry: the least, the greatest, any; of a multiplexer, a page's."""
    if ids := _ids(message, signal):
        return float(sorted(set(ids))[turn % len(set(ids))] * signal.scale + signal.offset)
    low, high = (float(raw * signal.scale + signal.offset) for raw in signal.raw_range)
    low, high = max(min(low, high), -_FAR), min(max(low, high), _FAR)
    low = low if signal.minimum is None else max(low, float(signal.minimum))
    high = high if signal.maximum is None else min(high, float(signal.maximum))
    return (low, high, chance.uniform(low, high))[turn]


def _received(
    units: Sequence[MockUnit], plan: Plan, sent: Sequence[float], steps: int
) -> tuple[list[float], Any]:
    """Return what the second unit has received after all pages, and the frames of the run."""
    units[0].values |= {f"y{i}": value for i, value in enumerate(sent)}
    by_name = {unit.name: unit for unit in units}
    engine = PythonEngine(plan, by_name, log_raw=True)
    initialize(by_name, plan)
    engine.start()
    engine.advance(steps + 1)
    memory = np.asarray(engine.memory)
    got = [float(memory[plan.inputs[f"b.u{i}"].mailbox or 0]) for i in range(len(sent))]
    return got, list(frames([engine.frames.log_of("c")], plan.clock))


def _codec_signal(codec: Any, message: Message, signal: Signal) -> Any:
    """Return cantools' signal; None where it does not read the file, or reads another signal there."""
    for parsed in codec.messages if codec is not None else ():
        if (parsed.frame_id, parsed.is_extended_frame, parsed.name) == (
            message.frame_id, message.extended, message.name,
        ):  # fmt: skip # what tells messages apart
            return next((s for s in parsed.signals if s.name == signal.name), None)
    return None


def _expected(codec: Any, signal: Signal, value: float) -> tuple[float, float]:
    """Return what cantools sends for a value, raw, and what it receives; without it, what its rule is."""
    low, high = signal.raw_range
    if codec is None:
        raw = _single(signal, min(max(quantize(signal, "half_even", value), low), high))
        return raw, decode(signal, raw)
    raw = _single(signal, min(max(codec.conversion.numeric_scaled_to_raw(value), low), high))
    return raw, float(codec.conversion.raw_to_scaled(raw, decode_choices=False))


def _single(signal: Signal, raw: float) -> float:
    """Return a raw value as the bits of the signal hold it: rounded where they are a 32-bit float."""
    return float(np.float32(raw)) if signal.is_float and signal.length == 32 else raw


def _compare_frames(
    codec: Any, raws: dict[str, dict[str, float]], sent: Sequence[Any], found: Outcome
) -> None:
    """Count the frames, and those that cantools does not decode to the raw values and encode to the bytes."""
    of_id = {(m.frame_id, m.is_extended_frame): m for m in codec.messages} if codec else {}
    for frame in sent:
        parsed = of_id.get((frame.message.frame_id, frame.message.extended))
        if parsed is None:
            continue
        found.frames += 1
        try:
            decoded = parsed.decode(frame.data, scaling=False, decode_choices=False, allow_excess=True)
            again = parsed.encode(decoded, scaling=False, strict=False)
        except Exception as error:  # whatever it raises makes the frame a different one
            decoded, again = {}, str(error).encode()
        wanted = {n: r for n, r in raws[frame.message.name].items() if n in frame.message.signals}
        same = all(decoded.get(name) == raw for name, raw in wanted.items())
        if not same or again != frame.data[: len(again)]:
            found.different_frames += 1


def main(folder: Path, table: Path) -> None:
    """Try the files of a folder, write the table, and print the sums."""
    rows = []
    for found in tried(folder):
        rows.append(dataclasses.asdict(found))
        if found.loads != "yes" or found.different_values or found.different_frames:
            print(found.repository, found.path, found.loads, found.different_values, found.different_frames)
    with table.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    sums = {key: sum(row[key] for row in rows) for key in rows[0] if isinstance(rows[0][key], int)}
    print(f"{len(rows)} files, {sum(row['loads'] == 'yes' for row in rows)} load,", sums)


if __name__ == "__main__":
    main(Path(sys.argv[1]), TABLE)
