"""Results of a scooter under a speed bound, in outline, and a figure of them: made by hand, without a run."""

from __future__ import annotations

import numpy as np

from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.system.figure_spec import FigureSpec

STATES = ((0, "driver"), (1, "acceleration"), (2, "velocity"))


def scooter(n: int = 401, step: float = 0.1) -> Results:
    """The signals of a scooter under a speed bound, in outline."""
    t = np.arange(n) * step
    rider = np.where(t < 30.0, np.clip(200.0 * (t - 1.0), 0.0, 100.0), 0.0)
    state = np.select([t < 1.5, t < 10.0, t < 30.0], [0, 1, 2], 0)
    speed = np.where(t < 30.0, np.clip(t - 1.5, 0.0, 30.0 / 3.6), 30.0 / 3.6 * np.exp(-(t - 30.0) / 5.0))
    throttle = np.where(state == 0, rider, 40.0 + np.sin(t))
    columns = {
        ResultVariable("rider.throttle", "%"): rider,
        ResultVariable("ecu.time", "s", causality="input"): t,
        ResultVariable("ecu.throttle_request", "%", causality="input"): np.round(rider / 0.4) * 0.4,
        ResultVariable("ecu.speed_measured", "km/h", causality="input"): np.round(3.6 * speed),
        ResultVariable("ecu.speed_bound", "km/h", causality="input"): np.full(n, 30.0),
        ResultVariable("ecu.throttle", "%", variability="discrete"): throttle,
        ResultVariable("ecu.state", type="Enumeration", variability="discrete", items=STATES): state,
        ResultVariable("ecu.speed_estimate", "km/h", variability="discrete"): 3.6 * speed + 0.2 * np.sin(t),
        ResultVariable("vehicle.road_grade", "rad", causality="input"): np.zeros(n),
        ResultVariable("vehicle.speed", "m/s"): speed,
        ResultVariable("vehicle.mass", "kg", causality="parameter"): np.full(n, 200.0),
    }
    manifest = {"system": "scooter", "scenario": "fig8"}
    return Results(t, np.column_stack(list(columns.values())), list(columns), manifest)


SPEC = FigureSpec.model_validate(
    {
        "title": "The bounds",
        "shade": "ecu.state",
        "panels": [
            {"label": "throttle", "unit": "%", "signals": ["rider.throttle", "ecu.throttle"]},
            {
                "label": "speed",
                "unit": "km/h",
                "limits": [0.0, 40.0],
                "signals": [
                    {"name": "vehicle.speed", "label": "true", "style": "dashed", "weight": 3.0},
                    {"name": "ecu.speed_measured", "label": "measured", "step": False},
                    "ecu.speed_bound",
                ],
            },
        ],
    }
)
