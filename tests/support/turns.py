"""Two sides that hand turns over to each other, of which one answers in a thread."""

from __future__ import annotations

import threading
from typing import Any


def hand_over(first: Any, second: Any, turns: int) -> None:
    """Let one side post so many numbers, and assert that the other had each before it answered."""
    seen = []

    def answer() -> None:
        for number in range(1, turns + 1):
            if not second.comes(float(number)):
                second.sleep_until(float(number), 100)
            seen.append(number)
            second.post(float(number))

    thread = threading.Thread(target=answer)
    thread.start()
    for number in range(1, turns + 1):
        first.post(float(number))
        if not first.comes(float(number)):
            assert first.sleep_until(float(number), 100) == b""
        assert seen[-1] == number
    thread.join()
    assert len(seen) == turns
