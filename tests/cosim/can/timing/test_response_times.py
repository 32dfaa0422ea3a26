"""The response-time analysis: published examples, and what must hold between analyses."""

from __future__ import annotations

import random

from evcosim.cosim.can.timing.response_times import Sent, response_times

MS = 10**9  # ps


def test_the_example_of_davis_2007() -> None:
    """Three messages of 1 ms: the second instance of C, not the first, has the longest response, 3.5 ms."""
    messages = [
        Sent("A", 1, MS, 5 * MS // 2),
        Sent("B", 2, MS, 7 * MS // 2),
        Sent("C", 3, MS, 7 * MS // 2),
    ]
    found = response_times(messages, bit=1)
    assert found == {"A": 2 * MS, "B": 3 * MS, "C": 7 * MS // 2}


def test_a_message_alone_takes_its_own_time() -> None:
    assert response_times([Sent("A", 1, 270, 1000)], bit=2, interframe=6) == {"A": 264}


def test_a_full_bus_has_no_bound_for_low_priorities() -> None:
    messages = [Sent("A", 1, 60, 100), Sent("B", 2, 30, 100), Sent("C", 3, 20, 100)]
    found = response_times(messages, bit=1)
    assert found["A"] is not None and found["B"] is not None and found["C"] is None
    assert response_times([*messages[:1], Sent("B", 2, 40, 100)], bit=1)["B"] is None  # exactly full


def test_jitter_and_more_messages_never_shorten_a_response() -> None:
    draw = random.Random(5)
    for _ in range(200):
        messages = [
            Sent(f"m{i}", i, draw.randrange(50, 140), draw.choice([1000, 2000, 5000]), draw.randrange(0, 300))
            for i in range(6)
        ]
        found = response_times(messages, bit=1)
        fewer = response_times(messages[:2] + messages[3:], bit=1)
        longer = response_times(
            [Sent(m.name, m.key, m.time, m.cycle, m.jitter + 50) for m in messages], bit=1
        )
        for name, time in fewer.items():
            all_of_them, late = found[name], longer[name]
            assert all_of_them is None or (time is not None and time <= all_of_them)
            assert late is None or (all_of_them is not None and all_of_them <= late)


def _simulated(messages: list[Sent], draw: random.Random, span: int) -> dict[str, int]:
    """Return the longest response times of a run with random phases and jitters: event after event."""
    queued: list[tuple[int, int, Sent]] = []
    for m in messages:
        time = draw.randrange(m.cycle) if draw.random() < 0.7 else 0
        while time < span:
            queued.append((time + (draw.randrange(m.jitter + 1) if m.jitter else 0), time, m))
            time += m.cycle
    queued.sort(key=lambda item: item[0])
    free, longest = 0, {m.name: 0 for m in messages}
    while queued:
        start = max(free, queued[0][0])
        ready = [item for item in queued if item[0] <= start]
        sent = min(ready, key=lambda item: (item[2].key, item[0]))
        queued.remove(sent)
        free = start + sent[2].time
        longest[sent[2].name] = max(longest[sent[2].name], free - sent[1])
    return longest


def test_no_run_takes_longer_and_some_run_comes_near() -> None:
    draw = random.Random(8)
    messages = [Sent(f"m{i}", i, draw.randrange(60, 130), 1000, 20 * (i % 3)) for i in range(8)]
    bound = response_times(messages, bit=1)
    longest = {m.name: 0 for m in messages}
    for _ in range(60):
        for name, time in _simulated(messages, draw, 10_000).items():
            longest[name] = max(longest[name], time)
    for name, limit in bound.items():
        assert limit is not None
        assert longest[name] <= limit
        assert longest[name] >= 0.8 * limit
