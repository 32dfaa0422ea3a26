"""A figure that a notebook shows by itself: matplotlib shows those of pyplot alone."""

from __future__ import annotations

import io
import warnings

from matplotlib.figure import Figure

from .style import style

_DPI = 100  # the figures are 10 inches wide: as wide as a notebook's page


class ShownFigure(Figure):
    """A matplotlib figure with a picture for notebooks."""

    def _repr_png_(self) -> bytes:
        """Return the figure as PNG, 1000 pixels wide; equal figures give equal bytes."""
        file = io.BytesIO()
        with style(), warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # as `saving.write` does
            self.savefig(file, format="png", dpi=_DPI, metadata={"Software": None})
        return file.getvalue()
