"""Cells are read once as long as nothing else may have written them."""

from __future__ import annotations

from evcosim.cosim.can.wire import tables as T
from evcosim.master.engine.compiled.known_frames import Frames
from evcosim.master.engine.compiled.llvm_text import WORD, Function
from evcosim.master.engine.compiled.straight_cells import Cells
from evcosim.master.engine.compiled.straight_numbers import Arithmetic, Number

FRAMES = Frames(
    {"messages": {T.LENGTH: 8}},
    {"messages": (2, T.MESSAGE), "frame": (64,), "double": (1,), "single": (1,)},
    "",
)
X, PLACE = Number("%x", WORD), Number("%place", WORD, 0, 7)


def cells() -> tuple[Cells, Function]:
    """Cells of a frame and a message, and the function that is written."""
    f = Function("f", ["wire", "x", "place"], opaque=True)
    return Cells(Arithmetic(f), FRAMES, "%wire"), f


def test_what_is_known_needs_no_instruction() -> None:
    found, f = cells()
    assert found.read("messages", (0, T.LENGTH)) == 8
    found.write("frame", (3,), X)
    loads = f.text().count("load")
    assert found.read("frame", (3,)) == X
    assert f.text().count("load") == loads
    first = found.read("messages", (1, T.LENGTH))
    assert found.read("messages", (1, T.LENGTH)) == first


def test_a_place_that_is_not_known_may_be_any() -> None:
    found, _ = cells()
    found.write("frame", (3,), X)
    other = found.read("messages", (1, T.LENGTH))
    found.write("frame", (PLACE,), 7)
    assert found.read("frame", (3,)) not in (X, 7)
    assert found.read("messages", (1, T.LENGTH)) == other


def test_tables_that_are_others_too_are_read_each_time() -> None:
    found, f = cells()
    found.write("double", (0,), 1.5)
    found.write("single", (0,), 2.5)
    assert "store float" in f.text() and "store double" in f.text()
    assert found.read("double", (0,)) != found.read("double", (0,))
