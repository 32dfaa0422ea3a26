"""The task of an identification: the table `[identification]` of a scenario file, or options of the user."""

from __future__ import annotations

from pydantic import Field, PositiveFloat

from .toml import FiniteModel


class IdentificationSpec(FiniteModel):
    """The task of `evcosim identify`: a sweep of an input and a first-order fit to an output's response."""

    input: str
    """The input that is swept, written `unit.variable`."""

    output: str
    """The variable that responds, written `unit.variable`: any recorded Real variable."""

    amplitude: float = Field(gt=0.0, le=1e12)
    """Amplitude of the sweep around the working point, above 0, in the input's unit."""

    unit: str | None = None
    """Unit of measure of the output, for `at` and for the gain; without it the output's own."""

    at: list[float] = []
    """Working points of the output, in `unit`; one identification at each."""

    at_input: list[float] = []
    """Working points of the input, in its own unit; without these and `at` the input stays where it is."""

    sweep: tuple[PositiveFloat, PositiveFloat] = Field(default=(0.008, 0.6), strict=False)
    """Lowest and highest frequency of the sweep in Hz."""

    duration: float = Field(default=900.0, gt=0.0)
    """Duration of one sweep in s: some periods of the lowest frequency."""

    repeats: int = Field(default=1, ge=1)
    """Number of sweeps, from 1 on."""

    band: tuple[PositiveFloat, PositiveFloat] | None = Field(default=None, strict=False)
    """The fit's frequencies in Hz; without it from 1.5 times the lowest to half the highest of `sweep`."""

    @property
    def fit_band(self) -> tuple[float, float]:
        """The band of the fit [Hz]."""
        return self.band or (1.5 * self.sweep[0], 0.5 * self.sweep[1])
