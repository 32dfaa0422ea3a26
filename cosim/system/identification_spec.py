"""What an identification does: the table `[identification]` of a scenario file, or options of the user."""

from __future__ import annotations

from pydantic import Field

from .toml import FileModel


class IdentificationSpec(FileModel):
    """A sweep of `input` around each working point, and what is fitted to the response of `output`.

    `at` are working points of the output, in `unit` (default: the output's own unit); with `at_input` they
    are the input's instead; with neither the input stays where it is. `sweep` and `band` in Hz, `duration`
    in s; the fit is done in `band` (default: from 1.5 times the lowest frequency to half the highest).
    """

    input: str
    output: str
    amplitude: float
    unit: str | None = None
    at: list[float] = []
    at_input: list[float] = []
    sweep: tuple[float, float] = (0.008, 0.6)
    duration: float = Field(default=900.0)
    repeats: int = 1
    band: tuple[float, float] | None = None

    @property
    def fit_band(self) -> tuple[float, float]:
        """The band of the fit [Hz]."""
        return self.band or (1.5 * self.sweep[0], 0.5 * self.sweep[1])
