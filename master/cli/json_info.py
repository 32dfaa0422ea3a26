"""The JSON schemas of `evcosim list --json` and `evcosim info --json`."""

from __future__ import annotations

from .json_bus import BUS_LOAD, PROTECTION, REPLAY, UNFILLED
from .json_parts import VALUE, by_name, flag, listed, number, or_null, record, text, whole

LIST = record(
    "What is built in.",
    {
        "systems": listed(
            "The systems.",
            record(
                "A system.",
                {
                    "name": text("Its name."),
                    "title": text("A line about it."),
                    "default": or_null(text("The scenario that runs without --scenario.")),
                    "scenarios": by_name("The scenarios by name.", text("A line about it.")),
                },
            ),
        ),
        "fmus": by_name("The FMUs by name.", text("A line about it.")),
    },
)

INFO_SYSTEM = record(
    "A system.",
    {
        "file": text("Its file."),
        "name": text("Its name."),
        "title": text("A line about it."),
        "source": text("Its source."),
        "step_size": number("Communication step [s]."),
        "stop_time": number("Stop time [s]."),
        "algorithm": text('"gauss_seidel" or "jacobi".'),
        "units": listed(
            "The units, in the order in which they step.",
            record(
                "A unit.",
                {
                    "name": text("Its name."),
                    "fmu": text("Its FMU, as the file names it."),
                    "period": number("Time from one step to the next [s]."),
                    "offset": number("Time from the start to its first step [s]."),
                    "substeps": whole("FMU steps in a period."),
                    "parameters": by_name("Parameters that are set, by name.", VALUE),
                    "scaled": by_name("Mapped variables with a factor or an offset.", text("Its keys.")),
                    "isolation": text('"process" or "none".'),
                    "needs_trust": flag("Whether it runs in evcosim's process with --trust alone."),
                },
            ),
        ),
        "connections": listed(
            "An entry for each connection and receiver.",
            record(
                "A connection.",
                {
                    "from": text("The source, unit.variable."),
                    "from_unit": text("Its unit of measure."),
                    "via": text('The bus signal, bus.message.signal; "": direct.'),
                    "bus_unit": text("The signal's unit of measure."),
                    "to_bus": text('The conversion at the sender; "": none.'),
                    "written": text("Factor and offset that the file gives."),
                    "to": text('The receiver, unit.variable; "": none.'),
                    "to_unit": text("Its unit of measure."),
                    "to_receiver": text('The conversion at the receiver; "": none.'),
                },
            ),
        ),
        "buses": listed("The load of the buses that carry messages, known before a run.", BUS_LOAD),
        "messages": listed(
            "The messages that are sent.",
            record(
                "A message.",
                {
                    "bus": text("Its bus."),
                    "name": text("Its name in the DBC."),
                    "id": whole("Its identifier."),
                    "cycle_time": number("Time from one to the next, or from one look to the next [s]."),
                    "send_type": text('"cyclic" or how else it is sent.'),
                    "min_interval": number("Least time between two that are not cyclic [s]; 0: none."),
                    "delay": number("Time from sending to receiving [s]."),
                    "page": by_name(
                        "The multiplexers' values; a multiplexed message has an entry for each page.",
                        whole("Its raw value."),
                    ),
                    "signals": listed(
                        "Its signals that are connected.",
                        record(
                            "A signal.",
                            {
                                "name": text("Its name."),
                                "bits": whole("Its length."),
                                "scale": number("Physical value of a step."),
                                "offset": number("Physical value of raw 0."),
                                "minimum": or_null(number("Least value; null: none.")),
                                "maximum": or_null(number("Greatest value; null: none.")),
                                "unit": text("Its unit of measure."),
                                "float": flag("Whether it is sent as a floating-point number."),
                                "sender": text("The variable that is sent."),
                            },
                        ),
                    ),
                    "unfilled": listed("Its signals that nothing fills.", UNFILLED),
                    "protection": or_null(PROTECTION),
                },
            ),
        ),
        "replays": listed("The CAN logs of the scenario that is named.", REPLAY),
        "default_scenario": or_null(text("The scenario that runs without --scenario.")),
        "scenarios": by_name("The scenarios by name.", text("A line about it.")),
        "warnings": listed("Sentences on all that is suspicious."),
        "outside": listed("Sentences on files that stand elsewhere than the one that names them."),
    },
)

_DATABASE_SIGNAL = record(
    "A signal.",
    {
        "name": text("Its name."),
        "start": whole("Its start bit, as a DBC counts."),
        "length": whole("Its bits."),
        "little_endian": flag("Whether it is in Intel's byte order."),
        "signed": flag("Whether its raw values are signed."),
        "float": flag("Whether it is sent as a floating-point number."),
        "scale": or_null(number("Physical value of a step.")),
        "offset": or_null(number("Physical value of raw 0.")),
        "minimum": or_null(number("Least value; null: none.")),
        "maximum": or_null(number("Greatest value; null: none.")),
        "unit": text("Its unit of measure."),
        "unit_known": flag("Whether evcosim knows that."),
        "choices": by_name("Descriptions by raw value.", text("A description.")),
        "not_available": or_null(whole('The raw code of "not available".')),
        "is_multiplexer": flag("Whether it selects others."),
        "multiplexer": text('What selects it; "": it is in every frame.'),
        "multiplexer_ranges": listed(
            "The raw values that do.", listed("The first and the last of a range.", whole("A raw value."))
        ),
        "receivers": listed("The nodes that receive it."),
        "comment": text("Its comment."),
        "note": text("What its user should know."),
        "refused": text('Why no connection can use it; "": one can.'),
    },
)

_ABILITY = record(
    "An entry.", {"what": text("What the FMU declares."), "here": text("What that means here.")}
)
INFO_FMU = record(
    "An FMU.",
    {
        "file": text("Its file."),
        "size": whole("Bytes of it."),
        "sha256": text("Its digest."),
        "name": text("The name of the model."),
        "description": text("A line about it."),
        "fmi_version": text('"1.0", "2.0" or "3.0".'),
        "kinds": listed('"Co-Simulation", "Model Exchange", "Scheduled Execution".'),
        "tool": text("The tool that made it."),
        "version": text("The version of the model."),
        "license": text("Its license."),
        "platforms": listed("The platforms that it has libraries for."),
        "binary_for_this_machine": flag("Whether it runs here as it is."),
        "library": text('Of a native FMU built here: "shipped with evcosim", or which compiler; else "".'),
        "sources": listed("Its source files."),
        "unpacked_size": whole("Bytes of its files."),
        "python": flag("Whether it runs Python code."),
        "capabilities": by_name("Capabilities by kind.", listed("Of a kind.", _ABILITY)),
        "limits": listed("What it needs or cannot do.", _ABILITY),
        "defects": listed("What is wrong with its description and was mended."),
        "validator": listed("What FMPy's validator says."),
        "default_experiment": by_name(
            "start_time, stop_time, step_size [s] and tolerance, as far as given.", number("A number.")
        ),
        "units_of_measure": listed("The units of measure that it defines."),
        "number_of_variables": whole("Its variables in all."),
        "variables": listed(
            "Its variables, those that were asked for.",
            record(
                "A variable, all as texts.",
                {
                    name: text(f"Its {name}, as in the description.")
                    for name in (
                        *("name", "causality", "variability", "type", "unit", "start", "min", "max"),
                        "description",
                    )
                },
            ),
        ),
    },
)

INFO_DATABASE = record(
    "A CAN database.",
    {
        "file": text("Its file."),
        "nodes": listed("Its nodes."),
        "bitrate": or_null(whole("The bit rate that was given [bit/s].")),
        "data_bitrate": or_null(whole("That of CAN FD payloads, as given [bit/s].")),
        "load": or_null(
            listed(
                "Of all cyclic messages: without and with all stuff bits, 1 a full bus.", number("A part.")
            )
        ),
        "messages": listed(
            "Its messages, or the one that was asked for.",
            record(
                "A message.",
                {
                    "name": text("Its name."),
                    "id": whole("Its identifier."),
                    "extended": flag("Whether that has 29 bits."),
                    "length": whole("Bytes in the database."),
                    "frame_length": whole("Bytes of the frame."),
                    "fd": flag("Whether it is a CAN FD frame."),
                    "j1939": flag("Whether it is a parameter group of J1939."),
                    "cycle_time": or_null(number("Time from one to the next [s]; null: none is given.")),
                    "start_delay": number("Time of the first [s]."),
                    "send_type": text("Its GenMsgSendType."),
                    "sent": text("When it is sent: the send type in the words of a system file."),
                    "min_interval": number("Its GenMsgDelayTime [s]; 0: none."),
                    "senders": listed("Its nodes."),
                    "load": or_null(listed("As that of all.", number("A part."))),
                    "comment": text("Its comment."),
                    "signals": listed("Its signals.", _DATABASE_SIGNAL),
                    "unread": by_name("Signals whose statement is not valid.", text("The reason.")),
                },
            ),
        ),
        "flaws": listed("Sentences on what contradicts itself in it, with the line."),
    },
)
