"""The frame path in machine code; it is compared with Python's in tests/master/engine/test_frame_path.py."""

from __future__ import annotations

import inspect
from types import FunctionType

from evcosim.cosim.can.wire import tables
from evcosim.master.engine.compiled import addresses, frames, wire_types
from evcosim.master.engine.compiled.cache import WIRE


def test_every_module_that_is_compiled_is_among_the_sources():
    """Else a change of it would find machine code of an earlier one in the cache."""
    known = set(WIRE.sources)
    assert {module.__name__ for module in (*frames.MODULES, frames, wire_types, addresses, tables)} <= known
    for module in frames.MODULES:
        assert {f.__module__ for _, f in inspect.getmembers(module, inspect.isfunction)} <= known


def test_names_of_functions_are_used_once():
    names = [
        name
        for module in frames.MODULES
        for name, value in vars(module).items()
        if isinstance(value, FunctionType) and value.__module__ == module.__name__
    ]
    assert len(names) == len(set(names))
