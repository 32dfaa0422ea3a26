"""A first-order model that was swept: its input and output in continuous time, and its response."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from evcosim.cosim.analysis.first_order import FirstOrder
from evcosim.cosim.analysis.frequency_response import FrequencyResponse, averaged, midpoints
from evcosim.cosim.analysis.sweep import Sweep
from evcosim.cosim.row_store import Array

SWEEP = Sweep(0.008, 0.6, 900.0, 20.0)
RATE = 5.0  # Hz
BAND = (0.012, 0.3)
GAINS = st.floats(1e-3, 1e3) | st.floats(-1e3, -1e-3)
POLES = st.floats(0.003, 1.0)


def exact(model: FirstOrder, frequency: Array) -> FrequencyResponse:
    """Return the response of a model at frequencies [Hz], shape (n,)."""
    return FrequencyResponse(frequency, model.response(frequency), np.ones_like(frequency))


def swept(model: FirstOrder, sweep: Sweep = SWEEP) -> tuple[Array, Array]:
    """Return input and output of a model in continuous time, as averages over 0.2 s, shapes (n,)."""
    u = sweep(np.arange(int(sweep.length * 100)) * 0.01)
    y = model.simulated(u, 0.01)
    return averaged(u, 20), averaged(midpoints(y), 20)
