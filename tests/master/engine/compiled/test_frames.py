"""The frame path in machine code; it is compared with Python's in tests/master/engine/test_frame_path.py."""

from __future__ import annotations

import inspect
from types import FunctionType

import numpy as np

from evcosim.cosim.can.wire import tables
from evcosim.cosim.can.wire.tables import Wire
from evcosim.master.engine.compiled import frames, wire_types
from evcosim.master.engine.wire_tables import wire_arrays


def test_every_module_that_is_called_is_among_the_sources():
    """Else a change of it would find machine code of an earlier one in the cache."""
    known = {module.__name__ for module in frames.SOURCES}
    for module in frames.MODULES:
        assert {f.__module__ for _, f in inspect.getmembers(module, inspect.isfunction)} <= known


def test_modules_know_all_sources_of_their_tables():
    """The types of numba are made of them too."""
    assert {wire_types, tables} <= set(frames.SOURCES)


def test_names_of_functions_are_used_once():
    names = [
        name
        for module in frames.MODULES
        for name, value in vars(module).items()
        if isinstance(value, FunctionType) and value.__module__ == module.__name__
    ]
    assert len(names) == len(set(names))


def test_a_table_has_addresses_and_shapes_in_order():
    arrays = wire_arrays([], np.zeros(7), 0.01, logs=False)
    table = frames.wire_table(arrays, 77)
    assert table[Wire._fields.index("memory")].tolist() == [arrays["memory"].ctypes.data, 7, 0]
    assert table[Wire._fields.index("rings")].tolist() == [arrays["rings"].ctypes.data, 1, 4]
    assert table[Wire._fields.index("helper")].tolist() == [77, 0, 0]
