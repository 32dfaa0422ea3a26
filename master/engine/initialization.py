"""Initialization: outputs reach inputs along the declared dependencies, before the first step.

An input or output of a unit is a node; a direct connection leads from an output to an input, and a
declared initial dependency from an input to an output of the same unit. Without a loop there is an order
in which every value is final when it is passed on. A loop is an algebraic loop: it is refused by name, or
iterated until no value changes by more than a tolerance. Connections over a bus take no part: before the
first message a receiver sees its initial value.

What is known before any output is stands in every unit before it enters its initialization mode, since some
FMUs solve their initial equations there: parameters, start values, the values of stimuli at the start time
and the initial ones of buses. The inputs among them are set again within it. A unit with an offset is
told that it starts later, and has the same values: none is of a time after the start of the run.
"""

from __future__ import annotations

import graphlib
import math
from collections.abc import Iterable, Mapping

from ...cosim.errors import ConfigError
from ...cosim.interface import UnitInterface, Value, VariableInfo
from ...cosim.plan.plan import Link, Plan
from ...cosim.plan.unit_plan import UnitPlan
from ...cosim.texts import Texts
from ...cosim.visible import on_one_line
from ..unit import Unit, UnitError

_ITERATIONS = 200
_Node = tuple[str, str]


def ordered_links(plan: Plan) -> tuple[tuple[Link, ...], bool]:
    """Return the direct connections, ordered so that each source is final when it is passed on, and False.

    With a loop: in written order, to be iterated, and True. Raises ConfigError naming the loop if the
    experiment refuses loops.
    """
    interfaces = {unit.name: unit.interface for unit in plan.units}
    loop, order = _order(plan.links, interfaces)
    if loop and plan.experiment.algebraic_loops == "refuse":
        path = " -> ".join(".".join(node) for node in loop)
        raise ConfigError(
            f"system '{plan.system}': algebraic loop: {path}; break it with a bus or a unit without direct "
            f'feedthrough, or set algebraic_loops = "iterate" in [experiment]'
        )
    rank = {node: i for i, node in enumerate(order)}
    return tuple(sorted(plan.links, key=lambda link: rank.get(link.source, 0))), bool(loop)


def _order(links: Iterable[Link], interfaces: Mapping[str, UnitInterface]) -> tuple[list[_Node], list[_Node]]:
    """Return (the nodes of a loop, []), or ([], all nodes in order)."""
    links = tuple(links)
    graph: dict[_Node, set[_Node]] = {}
    for link in links:
        graph.setdefault(link.sink, set()).add(link.source)
    for unit, name in {link.source for link in links}:
        output = interfaces[unit].variables[name]
        inputs = {v.name for v in interfaces[unit].of_causality("input")}
        needs = [output.depends, output.depends_initially]
        known = inputs if None in needs else inputs & set[str]().union(*(n or () for n in needs))
        graph.setdefault((unit, name), set()).update((unit, i) for i in known)
    try:
        return [], list(graphlib.TopologicalSorter(graph).static_order())
    except graphlib.CycleError as error:
        return list(error.args[1]), []


def initialize(units: Mapping[str, Unit], plan: Plan) -> tuple[str, ...]:
    """Bring every unit from instantiated to ready for its first step; return what the user should know.

    Raises UnitError if a unit refuses a call, an output is NaN or infinite, or a loop does not converge.
    """
    links, looped = ordered_links(plan)
    experiment = plan.experiment
    # parameters, start values and the inputs that no output reaches, then initialization mode
    notices = [
        units[p.name].enter_initialization(
            plan.clock.at(p.first),
            plan.clock.told_stop,
            p.parameters | _initial_states(p),
            _first_inputs(plan, p),
        )
        for p in plan.units
    ]
    # inputs: start values where no output is connected directly, then outputs along the connections
    _set_free_inputs(units, plan)
    if looped:
        _iterate(units, links, experiment.loop_tolerance, plan.texts)
    else:
        for link in links:
            _pass_on(units, link, plan.texts)
    # parameters are fixed from now on
    for unit in units.values():
        unit.exit_initialization()
    return tuple(notice for notice in notices if notice)


def _initial_states(unit: UnitPlan) -> dict[str, Value]:
    """Return the start values that are given to local variables and outputs."""
    known = unit.interface.variables
    return {name: value for name, value in unit.start.items() if known[name].causality != "input"}


def _first_inputs(plan: Plan, unit: UnitPlan) -> dict[str, Value]:
    """Return the first values of a unit's inputs that are driven other than directly, or given in a file.

    The others keep the FMU's own start value until outputs are known.
    """
    linked = {link.sink for link in plan.links}
    found: dict[str, Value] = {}
    for variable in unit.interface.of_causality("input"):
        receiver = plan.inputs.get(f"{unit.name}.{variable.name}")
        if variable.name in unit.start:
            found[variable.name] = unit.start[variable.name]
        if receiver is not None and receiver.driver and (unit.name, variable.name) not in linked:
            found[variable.name] = typed(variable, plan.initial[receiver.slot], plan.texts)
    return found


def _set_free_inputs(units: Mapping[str, Unit], plan: Plan) -> None:
    """Set the inputs that no output reaches directly to their first value.

    One that nothing drives keeps the FMU's own, unless a file gives it a start. A text that is the FMU's own
    start is not set: some read a file when they get a name.
    """
    left = {".".join(link.sink) for link in plan.links}
    left |= {f"{p.name}.{name}" for p in plan.units for name in p.free - p.start.keys()}
    for name, receiver in plan.inputs.items():
        if name in left:
            continue
        unit, _, of_unit = name.partition(".")
        variable = units[unit].interface.variables[of_unit]
        value = typed(variable, plan.initial[receiver.slot], plan.texts)
        if not (variable.type == "String" and value == variable.default):
            units[unit].set(of_unit, value)


def typed(variable: VariableInfo, value: float, texts: Texts) -> Value:
    """Return a number of the memory as a value of the variable's type; one that it has not, as it is.

    A unit refuses that one.
    """
    if variable.type == "String":
        return texts.text(value)
    if variable.type == "Boolean" and value in (0.0, 1.0):
        return bool(value)
    whole = math.isfinite(value) and value == int(value)
    return int(value) if variable.type != "Real" and whole else value


def _pass_on(units: Mapping[str, Unit], link: Link, texts: Texts) -> float | str:
    """Copy an output to the input that it is connected to; return the value in the input's unit."""
    unit, name = link.source
    receiver, sink = link.sink
    found = units[unit].get(name)
    if isinstance(found, str):
        units[receiver].set(sink, found)
        return found
    value = float(found)
    if not math.isfinite(value):
        shown = on_one_line(f"{unit}.{name}")
        raise UnitError(f"{shown} = {value} in the initialization: an output must be finite")
    value = link.map(value)
    units[receiver].set(sink, typed(units[receiver].interface.variables[sink], value, texts))
    return value


def _change(before: float | str, now: float | str) -> float:
    if isinstance(before, str) or isinstance(now, str):
        return 0.0 if before == now else math.inf
    return abs(now - before)


def _iterate(units: Mapping[str, Unit], links: tuple[Link, ...], tolerance: float, texts: Texts) -> None:
    """Pass all outputs on until no value changes by more than `tolerance`, and no text at all.

    Raises UnitError if some do.
    """
    before = [_pass_on(units, link, texts) for link in links]
    for _ in range(_ITERATIONS):
        now = [_pass_on(units, link, texts) for link in links]
        changes = list(map(_change, before, now))
        if max(changes) <= tolerance:
            return
        before = now
    worst = links[changes.index(max(changes))]
    raise UnitError(
        f"the algebraic loop through {'.'.join(worst.source)} -> {'.'.join(worst.sink)} does not converge: "
        f"it still changes by {max(changes):.3g} after {_ITERATIONS} iterations (tolerance {tolerance:g})"
    )
