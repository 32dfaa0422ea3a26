"""The routes of a unit's inputs as one compiled function."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, cast

from ...cosim.plan.unit_plan import Route

Act = Callable[[int], None]
"""A function of k that does an action in step k."""


def compile_routes(routes: Sequence[Route], memory: memoryview[float]) -> Act:
    """Return a function that writes all inputs of a unit from their routes: one assignment for each."""
    lines = [f"    m[{r.sink}] = {r.map.expression(f'm[{r.source}]')}" for r in routes] or ["    pass"]
    scope: dict[str, Any] = {"memory": memory}
    exec("def take(k, m=memory):\n" + "\n".join(lines), scope)
    return cast(Act, scope["take"])
