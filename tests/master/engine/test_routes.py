"""The inputs of a unit are written from their routes."""

from __future__ import annotations

from evcosim.cosim.plan.unit_plan import Route
from evcosim.cosim.units.measure import Affine
from evcosim.master.engine.routes import compile_routes


def test_each_input_is_written_from_its_route() -> None:
    memory = memoryview(bytearray(32)).cast("d")
    memory[0] = 36.0
    routes = [Route(source=0, sink=2, map=Affine(1)), Route(source=0, sink=3, map=Affine(0.5, -1.0))]
    compile_routes(routes, memory)(7)
    assert memory.tolist() == [36.0, 0.0, 36.0, 17.0]
    compile_routes([], memory)(7)
    assert memory.tolist() == [36.0, 0.0, 36.0, 17.0]
