"""The tables of the frame path by address and shape."""

from __future__ import annotations

import numpy as np

from evcosim.cosim.can.wire.tables import Wire
from evcosim.master.engine.compiled.addresses import wire_table
from evcosim.master.engine.wire_tables import wire_arrays


def test_a_table_has_addresses_and_shapes_in_order():
    arrays = wire_arrays([], np.zeros(7), 0.01, logs=False)
    table = wire_table(arrays, 77)
    assert table[Wire._fields.index("memory")].tolist() == [arrays["memory"].ctypes.data, 7, 0]
    assert table[Wire._fields.index("rings")].tolist() == [arrays["rings"].ctypes.data, 1, 4]
    assert table[Wire._fields.index("helper")].tolist() == [77, 0, 0]
