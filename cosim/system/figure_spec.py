"""The figure of a run: the table `[figure]` of system and scenario files."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Literal

from pydantic import Field, model_validator

from .toml import FileModel, FiniteModel, OrText, text_as

_FARTHEST, _FINEST = 1e100, 1e-9  # ends of an axis, and its length as a share of them


class SignalSpec(FiniteModel):
    """One line of a panel: a variable and how it is drawn. The variable's name alone stands for a table."""

    name: str = Field(examples=["vehicle.speed"])
    """The variable, written `unit.variable`."""

    label: str | None = None
    """The text in the legend; without it the variable's name."""

    style: Literal["solid", "dashed", "dotted", "dashdot"] | None = None
    """The dash pattern; without it one that no other line of the panel has."""

    weight: float | None = Field(default=None, gt=0.0, le=10.0)
    """Width of the line in points; without it the first line is the widest."""

    step: bool | None = None
    """Draw each value held until the next; without it so are inputs and sampled outputs."""

    optional: bool = False
    """Leave the line out, with a warning, where the variable is not recorded: an FMU in the place of a unit
    does not have it, or `record` leaves it out."""


class PanelSpec(FiniteModel):
    """One panel of the figure, with an axis of its own."""

    label: str = ""
    """The text at the axis, before the unit."""

    unit: str = ""
    """The unit of measure of the axis, to which all signals are converted; "" for states and counts."""

    signals: list[Annotated[SignalSpec, text_as("name"), OrText()]] = Field(min_length=1)
    """The lines: names of variables, or tables of a name and how it is drawn."""

    limits: tuple[float, float] | None = Field(default=None, strict=False)
    """Lower and upper end of the axis, in `unit`; without them the axis fits the data."""

    @model_validator(mode="after")
    def _limits_rise(self) -> PanelSpec:
        if self.limits is None:
            return self
        low, high = self.limits
        if not low < high:
            raise ValueError("limits: the first must be below the second")
        if max(-low, high) > _FARTHEST or high - low < max(_FINEST * max(-low, high), 1.0 / _FARTHEST):
            raise ValueError(f"limits: no axis can be drawn from {low:g} to {high:g}")
        return self


class EndSpec(FiniteModel):
    """End of the time axis: the last time before a signal first is at or below a value."""

    signal: str = Field(examples=["vehicle.speed"])
    """The variable, written `unit.variable`."""

    below: float
    """The value, in `unit`."""

    unit: str | None = None
    """The unit of measure of the value; without it the variable's own."""


class FigureSpec(FileModel):
    """The figure that `evcosim run` draws: panels from top to bottom over a common time axis."""

    title: str | None = None
    """The text above the figure; without it the names of system and scenario."""

    shade: str | None = None
    """An enumeration, written `unit.variable`, whose states shade the background of all panels."""

    panels: list[PanelSpec] = Field(min_length=1)
    """The panels, from top to bottom."""

    until: EndSpec | None = None
    """The end of the time axis, where the run goes on beyond what the figure is about; without it that of the
    run."""

    note: str | None = None
    """A line of text below the figure."""

    def optional(self) -> set[str]:
        """Return the variables that only lines which are `optional` need."""
        lines = [s for panel in self.panels for s in panel.signals]
        needed = {s.name for s in lines if not s.optional} | {self.shade}
        return {s.name for s in lines} - needed - ({self.until.signal} if self.until else set())

    def without(self, gone: Callable[[str], bool]) -> FigureSpec | None:
        """Return the figure without the signals that are `gone`; None when no panel is left."""
        panels = [
            panel.model_copy(update={"signals": [s for s in panel.signals if not gone(s.name)]})
            for panel in self.panels
        ]
        shade = None if self.shade is None or gone(self.shade) else self.shade
        until = None if self.until is None or gone(self.until.signal) else self.until
        panels = [panel for panel in panels if panel.signals]
        return self.model_copy(update={"panels": panels, "shade": shade, "until": until}) if panels else None
