"""Who is told of machine code that is compiled."""

from __future__ import annotations

from evcosim.master.engine.progress import announce, reporting


def test_the_innermost_block_is_told_and_nobody_outside():
    outer, inner = [], []
    announce("before")
    with reporting(outer.append):
        announce("a")
        with reporting(inner.append):
            announce("b")
        with reporting(None):
            announce("c")
        announce("d")
    announce("after")
    assert (outer, inner) == (["a", "d"], ["b"])
