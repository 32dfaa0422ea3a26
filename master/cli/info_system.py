"""The report of `evcosim info` on a system: units, connections with conversions, messages, scenarios."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .console import number, print_fields, print_table, print_title
from .info_frames import name_of, protection_of, show_frames, unfilled_of

if TYPE_CHECKING:
    from ...cosim.plan.plan import MessagePlan, Plan
    from ...cosim.system.system import System
    from ...cosim.units.measure import Affine
    from ..prepare import Prepared


def described(name: str, scenario: str | None = None) -> dict[str, Any]:
    """Return the report on a system, with the logs that a scenario replays.

    Raises ConfigError for everything that is wrong in them.
    """
    from ...cosim.plan.bus_load import bus_loads
    from ...cosim.system.scenario import load_scenario, scenario_names
    from ..isolation.decision import decided, needs_trust
    from ..prepare import prepare

    prepared = _whole(name)
    system, plan = prepared.system, prepared.plan
    driven = prepare(name, scenario, runnable=False).plan if scenario is not None else plan
    scenarios = {s: load_scenario(system, s).file.title for s in scenario_names(system)}
    return {
        "file": str(system.path),
        "name": system.file.name,
        "title": system.file.title,
        "source": system.file.source,
        "step_size": plan.experiment.step_size,
        "stop_time": plan.experiment.stop_time,
        "algorithm": plan.algorithm,
        "units": [
            {"name": u.name, "fmu": u.fmu, "period": plan.clock.length(u.every),
             "offset": plan.clock.length(u.first), "substeps": u.substeps,
             "parameters": u.parameters, "scaled": _scaled(system, u.name),
             "isolation": decided(prepared.fmus[u.name], system.file.units[u.name], None),
             "needs_trust": needs_trust(
                 prepared.fmus[u.name], system.file.units[u.name], system.swaps.get(u.name, system.path)
             )}
            for u in plan.units
        ],
        "connections": _connections(system, plan),
        "buses": [load.as_data() for load in bus_loads(plan.messages, plan.clock.step).values()],
        "messages": [_message(m, plan) for m in plan.messages],
        "replays": [replay.as_data() for replay in driven.replays],
        "default_scenario": system.file.scenario,
        "scenarios": scenarios,
        "warnings": [*driven.warnings, *driven.unreached],
        "outside": list(prepared.outside),
    }  # fmt: skip # one line for each key


def _whole(name: str) -> Prepared:
    """Return the system and its plan as `run` prepares them, no unit left out by a scenario."""
    from ...cosim.system.scenario import Scenario, ScenarioFile
    from ..prepare import prepare

    return prepare(name, Scenario("", None, ScenarioFile()), runnable=False)


def _scaled(system: System, unit: str) -> dict[str, str]:
    """Return the mapped variables that a factor stands at, each with the keys of its entry."""
    tables = system.file.units[unit].map.by_causality.values()
    return {name: entry.in_words for table in tables for name, entry in table.items() if entry.written}


def _connections(system: System, plan: Plan) -> list[dict[str, str]]:
    """Return an entry for each connection and receiver, in the order of the file."""
    units = {f"{u.name}.{v.name}": v.unit for u in plan.units for v in u.interface.variables.values()}
    direct = {(".".join(link.source), ".".join(link.sink)): link.map for link in plan.links}
    over_bus = {f"{m.bus}.{m.message.name}.{r.signal.name}": r for m in plan.messages for r in m.routes}
    found = []
    for connection in system.file.connect:
        source, via = connection.source, connection.via
        base = {"from": source, "from_unit": units[source], "via": via or "", "bus_unit": "", "to_bus": ""}
        base |= {"written": connection.in_words}
        if via is not None:
            route = over_bus[via]
            base |= {"bus_unit": route.signal.unit, "to_bus": in_words(route.to_bus)}
            maps = [map_ for _, map_ in route.sinks]
        else:
            maps = [direct[source, sink] for sink in connection.to]
        for sink, map_ in zip(connection.to, maps, strict=True):
            found.append(base | {"to": sink, "to_unit": units[sink], "to_receiver": in_words(map_)})
        if not connection.to:
            found.append(base | {"to": "", "to_unit": "", "to_receiver": ""})
    return found


def in_words(map_: Affine) -> str:
    """Return a unit conversion as it is computed: "x 3.6", "x 1.8 + 32"; "" if values are not changed."""
    words = f"x {map_.scale:.10g}" if map_.scale != 1.0 else ""
    if map_.offset:
        words += f" {'+' if map_.offset > 0 else '-'} {abs(map_.offset):.10g}"
    return words.strip()


def _message(plan: MessagePlan, whole: Plan) -> dict[str, Any]:
    message = plan.message
    return {
        "bus": plan.bus,
        "name": message.name,
        "id": message.frame_id,
        "cycle_time": whole.clock.length(plan.sending.cycle or plan.every),
        "send_type": plan.sending.kind,
        "min_interval": whole.clock.length(plan.sending.interval),
        "delay": whole.clock.length(plan.delay),
        "page": dict(plan.page),
        "signals": [
            {"name": route.signal.name, "bits": route.signal.length, "scale": route.signal.scale,
             "offset": route.signal.offset, "minimum": route.signal.minimum,
             "maximum": route.signal.maximum, "unit": route.signal.unit,
             "float": route.signal.is_float,
             "sender": plan.senders[route.signal.name]}
            for route in plan.routes
        ],
        "unfilled": unfilled_of(plan),
        "protection": protection_of(plan),
    }  # fmt: skip # one line for each key


def show(about: dict[str, Any]) -> None:
    """Print the report that `described` returned."""
    steps = f"steps of {about['step_size']:g} s to {about['stop_time']:g} s, {about['algorithm']}"
    fields = [("system", about["name"]), ("title", about["title"]), ("source", about["source"])]
    fields += [("file", about["file"]), ("experiment", steps)]
    fields += [("warning", text) for text in about["warnings"]]
    fields += [("reads", text) for text in about["outside"]]
    for unit in about["units"]:
        fields += [("scaled", f"{unit['name']}.{name}: {words}") for name, words in unit["scaled"].items()]
    print_fields([(name, value) for name, value in fields if value])
    print_title("Units, in the order in which they step")
    print_table(("name", "FMU", "every [s]", "process", "parameters"), [_unit_row(u) for u in about["units"]])
    print_title("Connections")
    print_table(("from", "to", "via"), [_connection_row(c) for c in about["connections"]])
    if about["messages"]:
        print_title("Buses")
        of_bus = ("bus", "bit/s", "messages", "load, no to most stuff bits", "longest response [ms]")
        print_table(of_bus, [_bus_row(bus) for bus in about["buses"]], right=("bit/s", "messages"))
        print_title("Messages")
        headers = ("message", "id", "every [s]", "delay [s]", "signal", "bits", "resolution", "range")
        rows = [row for message in about["messages"] for row in _message_rows(message)]
        print_table(headers, rows, right=("bits",))
        show_frames(about["messages"])
    if about["replays"]:
        print_title("CAN logs of the scenario")
        of_log = ("log", "bus", "channel", "from [s]", "to [s]", "exact to [s]", "message", "frames")
        rows = [row for replay in about["replays"] for row in _replay_rows(replay)]
        print_table(of_log, rows, right=("from [s]", "to [s]", "exact to [s]", "frames"))
    if about["scenarios"]:
        print_title("Scenarios (* the default)")
        default = about["default_scenario"]
        print_fields(
            [(f"{name} *" if name == default else name, title) for name, title in about["scenarios"].items()]
        )


def _replay_rows(replay: dict[str, Any]) -> list[tuple[str, ...]]:
    span = (f"{replay['first']:.6g}", f"{replay['last']:.6g}", f"{replay['resolution']:.3g}")
    head = (replay["file"], replay["bus"], replay["channel"], *span)
    rows = [(name, str(count)) for name, count in replay["messages"].items()]
    return [(*(head if i == 0 else [""] * len(head)), *row) for i, row in enumerate(rows)]


def _unit_row(unit: dict[str, Any]) -> tuple[str, ...]:
    period = f"{unit['period']:g}" + (f" in {unit['substeps']} FMU steps" if unit["substeps"] > 1 else "")
    period += f" from {unit['offset']:g} on" if unit["offset"] else ""
    parameters = ", ".join(f"{name} = {value}" for name, value in unit["parameters"].items())
    process = "its own" if unit["isolation"] == "process" else "evcosim's"
    process += " (with --trust)" if unit["needs_trust"] else ""
    return (unit["name"], unit["fmu"], period, process, parameters)


def _connection_row(c: dict[str, str]) -> tuple[str, ...]:
    """Return source, sink and bus signal with their units of measure, and the conversions at their ends."""
    source, bus, sink = (
        " ".join([name, *([f"[{unit}]"] if unit else []), *([f"({map_})"] if map_ else [])]) if name else ""
        for name, unit, map_ in (
            (c["from"], c["from_unit"], ""),
            (c["via"], c["bus_unit"], c["to_bus"]),
            (c["to"], c["to_unit"], c["to_receiver"]),
        )
    )
    written = f" ({c['written']})" if c["written"] else ""
    return (source, (sink or "(on the bus only)") + written, bus)


def _bus_row(bus: dict[str, Any]) -> tuple[str, ...]:
    """Return name, bit rate, number of messages, load, and the longest of the response times."""
    times = [message["response"] for message in bus["messages"]]
    longest = "no bound for some" if None in times else f"{1e3 * max(times):.3g}"
    load = f"{bus['least']:.1%} to {bus['most']:.1%}"
    return (bus["bus"], str(bus["bitrate"]), str(len(times)), load, longest)


def _every(message: dict[str, Any]) -> str:
    """Return the cycle, or the send type with cycle and minimum interval, in s."""
    if message["send_type"] == "cyclic":
        return f"{message['cycle_time']:g}"
    cycle = "" if message["send_type"] in ("on_change", "on_write") else f" {message['cycle_time']:g}"
    least = f", >= {message['min_interval']:g}" if message["min_interval"] else ""
    return f"{message['send_type']}{cycle}{least}"


def _message_rows(message: dict[str, Any]) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for i, signal in enumerate(message["signals"]):
        delay = f"{message['delay']:g}" if message["delay"] else ""
        head = (name_of(message), f"0x{message['id']:X}", _every(message), delay)
        unit = f" {signal['unit']}" if signal["unit"] else ""
        ends = [
            ("-inf", "inf")[j] if signal[key] is None else number(signal[key])
            for j, key in enumerate(("minimum", "maximum"))
        ]
        resolution = "float" if signal["float"] else f"{number(signal['scale'])}{unit}"
        rows.append(
            (*(head if i == 0 else [""] * len(head)), signal["name"], str(signal["bits"]), resolution,
             f"[{', '.join(ends)}]{unit}")
        )  # fmt: skip # one line for each half of the row
    return rows
