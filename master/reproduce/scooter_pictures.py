"""The figures of the scooter's paper, redrawn, and beyond it the observer's use and both bounds' ranges."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...cosim.figures import draw as figures
from . import scooter_bounds
from .page import Picture
from .scooter_identification import ScooterIdentification

_CAPTIONS = {
    "fig2": "Fig. 2: frequency response from throttle to measured speed, and the fitted model",
    "fig3": "Fig. 3: gain and pole over speed",
    "fig4": "Fig. 4: the identified and the non-linear model beside the scooter, and ESR(t)",
}


def pictures(found: Mapping[str, Any], identified: ScooterIdentification) -> tuple[Picture, ...]:
    """Return all pictures of the runs."""
    return (
        *(Picture(stem, _CAPTIONS[stem], draw) for stem, draw in identified.drawings().items()),
        *(
            Picture.over_time(stem, caption, run)
            for stem, caption, run in (
                ("fig8", "Fig. 8: fixed bounds, 30 km/h and 1 m/s²", found["fig8 bus"]),
                ("fig9", "Fig. 9: bounds that depend on estimated speed and on time", found["fig9 bus"]),
            )
        ),
        Picture(
            "raw",
            "Beyond the paper: the throttle without the observer, and with it",
            lambda: _without_observer(found),
        ),
        Picture(
            "bounds",
            "Beyond the paper: the pull of Fig. 8 over both bounds; the drive has its own limit at 50 km/h",
            lambda: scooter_bounds.figure(found),
        ),
    )


def _without_observer(found: Mapping[str, Any]) -> Any:
    with figures.canvas(2, height=2.4, title="scooter: what the observer is for", share_x=True) as (
        figure,
        axes,
    ):
        for row, (name, label) in enumerate((("fig8 raw", "of raw v_m"), ("fig8 bus", "with observer"))):
            results = found[name]
            axes[row, 0].plot(
                results.time, results["ecu.throttle"], drawstyle="steps-post", label="applied",
                **figures.look(0),
            )  # fmt: skip # one line
            axes[row, 0].set_ylabel(f"throttle {label}\n[%]")
            axes[row, 0].set_ylim(-5.0, 105.0)
        axes[1, 0].set_xlabel("time [s]")
        axes[1, 0].set_xlim(0.0, np.max(results.time))
    return figure
