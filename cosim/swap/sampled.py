"""Sampled outputs: computed at t_k from the inputs at t_k, they hold from t_k on.

All others belong, after the step to t_{k+1}, to t_{k+1}, whatever their variability. An FMU tells which
of its outputs are sampled, or the system file does (`sampled`); an FMU that is put into the place of another
one, and does not tell, has those of that place.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Collection

from ..errors import ConfigError
from ..interface import UnitInterface

_SHOWN = 4


def sampled_in(interface: UnitInterface) -> tuple[str, ...]:
    """Return the names of the sampled outputs, in declared order."""
    return tuple(v.name for v in interface.variables.values() if v.sampled)


def discrete_in(interface: UnitInterface) -> list[str]:
    """Return the names of the outputs that are declared discrete, in declared order."""
    return [v.name for v in interface.of_causality("output") if v.variability != "continuous"]


def told(interface: UnitInterface, unit: str, wanted: bool | list[str], keys: str) -> UnitInterface:
    """Return the interface with the sampled outputs that the unit's key `sampled` says.

    `keys` is the beginning of the unit's keys in messages. Raises ConfigError for a name that is no output,
    and for `true` where no output is discrete.
    """
    if not isinstance(wanted, bool):
        for name in wanted:
            interface.require(unit, name, ("output", "local"), f"{keys}sampled")
        return _with(interface, wanted)
    if not wanted:
        return _with(interface, ())
    discrete = discrete_in(interface)
    if not discrete:
        raise ConfigError(
            f"{keys}sampled = true: no output of {interface.place} is declared discrete; list those that the "
            'unit computes from the inputs of the same time: sampled = ["..."]'
        )
    return _with(interface, discrete)


def inherited(interface: UnitInterface, unit: str, place: Collection[str]) -> tuple[UnitInterface, list[str]]:
    """Return the interface of an FMU that takes the place of one with the sampled outputs `place`.

    Beside it stands the sentence that says so, where there is anything to say.
    """
    names = [v.name for v in interface.of_causality("output", "local") if v.name in place]
    if interface.tells_sampled or not names:
        return interface, []
    return _with(interface, names), [
        f"unit '{unit}': {_listed(names)} of {interface.place} {_are(names)} taken as sampled, as in the "
        "unit whose place it takes: held from the time of its inputs on; `sampled = false` in a swap file "
        "says otherwise"
    ]


def unknown(unit: str, interface: UnitInterface) -> list[str]:
    """Return the warning of an FMU that takes the place of one that cannot be read.

    [] where no output is discrete.
    """
    discrete = discrete_in(interface)
    if not discrete:
        return []
    return [
        f"unit '{unit}': the FMU whose place {interface.place} takes cannot be read, so that its sampled "
        f"outputs are unknown: {_listed(discrete)} {_are(discrete)} not taken as sampled; `sampled` of the "
        "unit says which are"
    ]


def untold(unit: str, interface: UnitInterface) -> list[str]:
    """Return the warning of an FMU of an earlier evcosim, which does not tell; [] for any other."""
    discrete = discrete_in(interface)
    if interface.tells_sampled or not interface.ours or not discrete:
        return []
    return [
        f"unit '{unit}': {interface.place} was built by an earlier evcosim and does not tell which outputs "
        f"are sampled: {_listed(discrete)} {_are(discrete)} not, and a step later than before; build it "
        "anew, or set sampled = true"
    ]


def _with(interface: UnitInterface, names: Collection[str]) -> UnitInterface:
    variables = {
        name: dataclasses.replace(v, sampled=name in names) if v.sampled != (name in names) else v
        for name, v in interface.variables.items()
    }
    return dataclasses.replace(interface, variables=variables)


def _listed(names: list[str]) -> str:
    more = len(names) - _SHOWN
    return ", ".join(names[:_SHOWN]) + (f" and {more} more" if more > 0 else "")


def _are(names: list[str]) -> str:
    return "is" if len(names) == 1 else "are"
