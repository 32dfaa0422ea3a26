"""A factor and an offset that a file writes beside a connection or a mapping."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field

from ..units.measure import Affine
from .toml import FiniteModel


def _not_zero(factor: float) -> float:
    if factor == 0.0:
        raise ValueError("a factor of 0 leaves nothing of the value")
    return factor


_Factor = Annotated[float, AfterValidator(_not_zero), Field(json_schema_extra={"not": {"const": 0}})]


class Scaling(FiniteModel):
    """A linear map of a value, between two different quantities or beside a unit conversion."""

    factor: _Factor | None = None
    """Factor of the value on its way, between two different quantities (a torque in N.m from a throttle in
    %); where the units of measure convert, only with `convert`."""

    offset: float | None = None
    """Number that is added after the factor, in the unit of measure at the end of the way."""

    convert: bool | None = None
    """Factor and offset where the units of measure convert: after the conversion (true), or in its place
    (false)."""

    @property
    def written(self) -> bool:
        """True where the file says anything of it."""
        return (self.factor, self.offset, self.convert) != (None, None, None)

    @property
    def linear(self) -> Affine:
        """The map x -> factor * x + offset."""
        return Affine(1.0 if self.factor is None else self.factor, self.offset or 0.0)

    @property
    def in_words(self) -> str:
        """The keys as the file has them: "factor = 0.45, convert = false"; "" where there are none."""
        given = {"factor": self.factor, "offset": self.offset}
        words = [f"{key} = {value:g}" for key, value in given.items() if value is not None]
        return ", ".join(words + ([] if self.convert is None else [f"convert = {str(self.convert).lower()}"]))
