"""Systems of units that nothing is known of but their connections, for the tests of pictures of systems."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from evcosim.cosim.system.system import SystemFile

UNITS = "abcde"
BUSES = ("can0", "can1")


def system_of(
    links: Iterable[tuple[str, str, str | None, str]],
    units: Sequence[str] = UNITS,
    buses: Sequence[str] = BUSES,
) -> SystemFile:
    """Return a system of some units, with connections (source, sink, bus or None, name of the variable)."""
    connect = []
    for i, (source, sink, bus, name) in enumerate(links):
        way = {"via": f"{bus}.M.{name}{i}"} if bus else {}
        connect.append({"from": f"{source}.{name}{i}", "to": [f"{sink}.u{i}"], **way})
    return SystemFile.model_validate(
        {
            "name": "s",
            "units": {unit: {"fmu": "models/SomeModel.fmu"} for unit in units},
            "buses": {bus: {"dbc": "a_long_name_of_a_database.dbc"} for bus in buses},
            "connect": connect,
        }
    )
