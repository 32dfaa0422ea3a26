"""The JSON schemas of what is known of a bus before a run and counted in one."""

from __future__ import annotations

from .json_parts import FILES, by_name, flag, listed, number, or_null, record, text, whole

BUS_LOAD = record(
    "The load of a bus by its messages.",
    {
        "bus": text("Its name."),
        "bitrate": whole("Bits a second."),
        "least": number("Part of the time that it is busy if no frame has a stuff bit."),
        "most": number("Part of the time that it is busy if each frame is the longest of its kind."),
        "messages": listed(
            "Its messages in the order of arbitration.",
            record(
                "A message.",
                {
                    "name": text("Its name in the database."),
                    "identifier": whole("Its identifier."),
                    "extended": flag("Whether that has 29 bits."),
                    "length": whole("Bytes in the database."),
                    "cycle": number("Least time from one to the next [s]."),
                    "least": number("Part of the time of frames without stuff bits."),
                    "most": number("Part of the time of the longest frames."),
                    "longest": number("Time of the longest frame with the space after it [s]."),
                    "response": or_null(
                        number("Longest time from sampling to the end of the frame [s]; null: no bound.")
                    ),
                    "send_type": text('"cyclic" or how else it is sent.'),
                    "bounded": flag("False where no minimum interval bounds how often it is sent."),
                },
            ),
        ),
    },
)

UNFILLED = record(
    "A signal that neither a connection nor a protection fills.",
    {
        "name": text("Its name."),
        "raw": number("The raw value that is sent."),
        "sent": text('What that is: "not available", "start value", or "zero" without both.'),
    },
)

PROTECTION = record(
    "What guards its frames; null: nothing.",
    {
        "profile": or_null(text("AUTOSAR's E2E profile; null: none.")),
        "function": or_null(text("A maker's own checksum as module:function; null: none.")),
        "checksum": or_null(text("The signal of the checksum; null: none.")),
        "counter": or_null(text("The signal of the counter; null: none.")),
        "timeout": or_null(whole("Cycles without a frame that is taken; null: none.")),
        "on_timeout": text('What receivers have then: "hold", "initial" or "sna".'),
        "status": listed("The inputs that receive the status of the last frame, unit.input."),
    },
)

REPLAY = record(
    "A CAN log that a scenario replays.",
    {
        "bus": text("Its bus."),
        "file": text("Its file."),
        "channel": text("The channel whose frames are replayed."),
        "offset": number("Time of the log at which the run's clock shows 0 s [s]."),
        "first": number("Time of the run at which its channel begins [s]."),
        "last": number("Time of the run at which it ends [s]."),
        "resolution": number("What its times are rounded to [s]."),
        "messages": by_name("Frames within the run by message.", whole("Their number.")),
        "before": whole("Frames before the start."),
        "after": whole("Frames from the stop time on."),
    },
)

_TIMES = record(
    "Times [s].", {"min": number("The least."), "mean": number("The mean."), "max": number("The greatest.")}
)
_OF_FAULTS = ("lost", "silenced", "delayed", "held", "unheard")
_OF_ACTIONS = {
    "duration": number("How long [s]; without it to the end."),
    "count": whole("Greatest number of frames that are hit."),
    "every": whole("Every how many-th frame is hit."),
    "probability": number("Probability with which each of these is hit."),
    "seed": whole("Seed of the draws."),
    "byte": whole("The byte that is corrupted."),
    "mask": whole("The bits of it."),
    "counter": text('"runs" or "frozen".'),
    "by": number("How much later frames arrive [s]."),
    "id": whole("The identifier that babbles."),
    "extended": flag("Whether it has 29 bits."),
    "length": whole("Bytes of its frames."),
    "period": number("Time from one of them to the next [s]; without it back to back."),
}
FAULT = record(
    "A fault on a bus, with the keys of its action.",
    {
        "action": text("What happens."),
        "on": text("The message, node or bus."),
        "frames": whole("The number of frames that it hit."),
        "time": number("When [s]."),
        **_OF_ACTIONS,
    },
    optional=tuple(_OF_ACTIONS),
)
_JUDGED = {
    "timeouts": whole("How often no frame came in time."),
    "rejected": whole("Frames that the check of their protection did not take."),
    "statuses": by_name("Frames by the status of their check.", whole("Their number.")),
}
FRAMES = record(
    "What was counted of the frames on a bus in a run.",
    {
        "load": number("Part of the time that it was busy."),
        "messages": by_name(
            "By message.",
            record(
                "A message.",
                {
                    "load": number("Part of the time that its frames took."),
                    "sent": whole("Frames that were sampled."),
                    "replaced": whole("Frames that a newer one replaced while they waited."),
                    "carried": whole("Frames that the bus carried."),
                    "errors": whole("Frames that wire errors ended."),
                    "arrived": whole("Frames that receivers got."),
                    "latency": or_null(_TIMES | {"description": "From sampling to the end of the frame."}),
                    "seen": or_null(_TIMES | {"description": "From sampling to when receivers saw it."}),
                    "lost": whole("Frames that a fault took from receivers."),
                    "silenced": whole("Frames that a fault did not let be sent."),
                    "delayed": whole("Frames that a fault made late."),
                    "held": whole("Frames that were sampled while their node was off the bus."),
                    "unheard": whole("Frames that arrived while a receiver was off the bus."),
                    "replayed": whole("Frames that came from a log."),
                    **_JUDGED,
                    "receivers": by_name(
                        "Where nodes were off the bus and saw other frames than the rest: by node.",
                        record("A receiver.", _JUDGED, optional=tuple(_JUDGED)),
                    ),
                },
                optional=(*_OF_FAULTS, "replayed", *_JUDGED, "receivers"),
            ),
        ),
        "nodes": by_name(
            "By node.",
            record(
                "A node.",
                {
                    "tec": whole("Its error counter as a sender."),
                    "rec": whole("Its error counter as a receiver."),
                    "bus_off": whole("How often it was off the bus."),
                },
            ),
        ),
    },
)
BUS_TIMES = record(
    "Load and latencies of the buses of a system.",
    {
        "buses": listed(
            "The buses that carry messages.",
            record(
                "A bus.",
                {
                    **BUS_LOAD["properties"],
                    "counted": FRAMES,
                    "effective_delays": by_name(
                        "From the sampling of a value to the step of its receiver that uses it, by message.",
                        by_name(
                            "By receiving unit.",
                            or_null(_TIMES | {"description": "Times [s]; null: it has used no value."}),
                        ),
                    ),
                    "period": listed(
                        "The frames of the busy period of the longest wait.",
                        record(
                            "A frame.",
                            {
                                "name": text("Its message."),
                                "sampled": number("Time of its sampling [s]."),
                                "start": number("Time of its start [s]."),
                                "end": number("Time of its end [s]."),
                            },
                        ),
                    ),
                },
            ),
        ),
        **FILES,
    },
)
