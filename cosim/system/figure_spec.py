"""What a figure shows: the specification that stands in system and scenario files."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from .toml import FileModel


class SignalSpec(FileModel):
    """One line: a variable `unit.variable`, its text in the legend, and how it is drawn.

    `step` draws each value held until the next; by default so are inputs and sampled outputs.
    `weight` is the width of the line in points.
    """

    name: str
    label: str | None = None
    style: Literal["solid", "dashed", "dotted", "dashdot"] | None = None
    weight: float | None = Field(default=None, gt=0.0, le=10.0)
    step: bool | None = None


def _from_name(value: Any) -> Any:
    return {"name": value} if isinstance(value, str) else value


class PanelSpec(FileModel):
    """One panel: what its axis says, the unit that all its signals are converted to, and the signals.

    A signal is a table or a variable's name alone. `limits` are the ends of the axis, in `unit`.
    """

    label: str = ""
    unit: str = ""
    signals: list[Annotated[SignalSpec, BeforeValidator(_from_name)]] = Field(min_length=1)
    limits: tuple[float, float] | None = None

    @model_validator(mode="after")
    def _limits_rise(self) -> PanelSpec:
        if self.limits is not None and not self.limits[0] < self.limits[1]:
            raise ValueError("limits: the first must be below the second")
        return self


class FigureSpec(FileModel):
    """A figure: panels from top to bottom, the enumeration whose states shade them, a title and a note."""

    title: str | None = None
    shade: str | None = None
    panels: list[PanelSpec] = Field(min_length=1)
    note: str | None = None

    def without(self, gone: Callable[[str], bool]) -> FigureSpec | None:
        """The figure without the signals that are `gone`; None when no panel is left."""
        panels = [
            panel.model_copy(update={"signals": [s for s in panel.signals if not gone(s.name)]})
            for panel in self.panels
        ]
        shade = None if self.shade is None or gone(self.shade) else self.shade
        panels = [panel for panel in panels if panel.signals]
        return self.model_copy(update={"panels": panels, "shade": shade}) if panels else None
