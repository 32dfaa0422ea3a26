"""The JSON schema of what each verb prints with `--json`; docs/json.md has the same as tables.

Numbers that are not finite are null in JSON, so that a measured number may be null.
"""

from __future__ import annotations

from .json_bus import BUS_TIMES, FAULT
from .json_info import INFO_DATABASE, INFO_FMU, INFO_SYSTEM, LIST
from .json_parts import FILES, VALUE, Schema, by_name, flag, listed, number, of, or_null, record, text, whole

_MEASURED = {"value": or_null(number("The number.")), "unit": text("Its unit of measure.")}
_BUS = record(
    "The variation of the buses.",
    {
        "delay_steps": whole("Communication steps by which messages arrive later."),
        "resolution": of(["number", "string"], 'Factor of the resolution, or "ideal".'),
        "cycle": whole("Factor by which messages are sent less often."),
        "timing": or_null(text('"instant" or "frame"; null: as the files say.')),
        "jitter": number("Time that is added to the jitter of every message [s]."),
        "loss": number("Probability with which each frame is lost."),
        "seed": whole("Number that is added to the seeds."),
    },
)

_RUN = record(
    "What happened in a run.",
    {
        "system": text("The name of the system, or of the FMU."),
        "scenario": text('The name of the scenario; "" for none.'),
        "status": text('"done", "failed" or "interrupted".'),
        "order": listed("The units, in the order in which they step."),
        "ideal": flag("Whether the buses were left out."),
        "steps": whole("Communication steps done."),
        "saturations": by_name(
            "Bus signals that were saturated, by bus.message.signal.",
            record(
                "A signal.",
                {"count": number("How often."), "first_time": number("Time of the first [s].")},
            ),
        ),
        "faults": listed("The faults on buses.", FAULT),
        "loop_seconds": number("Time that the steps took [s]."),
        "algorithm": text('"gauss_seidel" or "jacobi".'),
        "error": or_null(text("Why the run failed; null: it did not.")),
        "ended": or_null(text("Which unit asked to end the run, and when; null: none.")),
        "simulated_seconds": number("Simulated time [s]."),
        "real_time_factor": number("Simulated time by the time of the steps."),
        "warnings": listed("Sentences on all that is suspicious."),
        "isolation": by_name('"process" or "none", by unit.', text("The process of a unit.")),
        "outside": listed("Sentences on files that stand elsewhere than the one that names them."),
        "profile": listed(
            "With --profile, the parts of a step.",
            record(
                "A part.",
                {
                    "name": text("Unit, bus or part of the engine."),
                    "what": text("What it does."),
                    "seconds": number("Time in all [s]."),
                    "microseconds_per_step": number("Time of a step [us]."),
                    "share": number("Share of the whole."),
                },
            ),
        ),
        "metrics": by_name("The metrics, by name.", record("A metric.", _MEASURED)),
        "final": by_name("The last value of each recorded variable, by unit.variable.", VALUE),
        **FILES,
    },
)

_CHECK = record(
    "The fit of an FMU in a place.",
    {
        "fmu": text("The FMU."),
        "place": text("SYSTEM.UNIT."),
        "fits": flag("Whether nothing is missing or left to choose."),
        "sampled": listed("Outputs that are taken as sampled, as those of the place are."),
        "warnings": listed("Defects, and declarations that the steps of the place do not respect."),
        "rows": listed(
            "A row for each need of the system, and for each unused variable.",
            record(
                "A row.",
                {
                    "need": of(["string", "null"], "The name that the system uses; null or empty: none."),
                    "role": text('"input", "output" or "parameter".'),
                    "variable": of(["string", "null"], "The FMU's variable; null or empty: none."),
                    "verdict": text("As the table says."),
                    "reason": text("Why."),
                    "needed": listed("What needs it."),
                    "candidates": listed("Variables that it may be, the likeliest first."),
                    "unit": of(["string", "null"], "The unit of measure that the mapping gives."),
                    "invert": flag("Whether the value is taken with the other sign."),
                    "factor": or_null(number("Factor of the mapping.")),
                    "offset": or_null(number("Offset of the mapping.")),
                    "convert": or_null(flag("Whether factor and offset stand beside a conversion.")),
                    "likeness": or_null(number("Likeness of a guess, from 0 to 1.")),
                },
            ),
        ),
        "trial": record(
            "With --try, the trial.",
            {
                "duration": number("Its time [s]."),
                "passed": flag("Whether it found no problem."),
                "findings": listed(
                    "What was seen.",
                    record(
                        "A finding.",
                        {
                            "what": text("What was examined."),
                            "verdict": text('"good", "note" or "problem".'),
                            "text": text("A sentence."),
                        },
                    ),
                ),
                "proposed": record(
                    "What a swap file should say.",
                    {
                        "substeps": whole("FMU steps in a communication step."),
                        "invert": listed("Variables whose sign differs."),
                    },
                ),
            },
        ),
    },
    optional=("trial",),
)

_COMPARE = record(
    "The comparison of two results.",
    {
        "rows": listed(
            "A row for each common variable.",
            record(
                "A variable.",
                {
                    "name": text("unit.variable."),
                    "unit": text("Its unit of measure."),
                    "difference": or_null(number("Largest difference.")),
                    "time": or_null(number("Where it is [s].")),
                    "rms": or_null(number("Root mean square of the difference.")),
                    "range": or_null(number("Range of the values in A.")),
                    "equal": flag("Whether it is within the tolerance."),
                    "remark": text("What else there is to say."),
                },
            ),
        ),
        "only_a": listed("Variables that A alone has."),
        "only_b": listed("Variables that B alone has."),
        "points": whole("Times at which they are compared: those of both, where both run."),
        "only_times_a": whole("Of these, times that A alone has: B is interpolated there."),
        "only_times_b": whole("Of these, times that B alone has: A is interpolated there."),
        "not_compared": listed(
            "The points of one run before or after the other.",
            record(
                "A stretch.",
                {
                    "side": text('"first" (A) or "second" (B).'),
                    "points": whole("Points that are not compared."),
                    "begin": number("The time of the first of them [s]."),
                    "end": number("The time of the last of them [s]."),
                },
            ),
        ),
        "same_span": flag("Whether both begin and end at the same times."),
        "tolerance": number("The difference allowed."),
        "relative": number("The difference allowed beside it, as a share of the range."),
        "remarks": listed("What else there is to say."),
        "equal": flag("Whether they are equal within the tolerance."),
        "same_rows": flag("Whether both have as many rows."),
        "common": flag("Whether variables of one side alone are no difference."),
        "metrics": listed(
            "A row for each metric that both runs have; none with --signals.",
            record(
                "A metric.",
                {
                    "name": text("Its name."),
                    "a": or_null(number("Its value in A.")),
                    "a_unit": text("Its unit of measure there."),
                    "b": or_null(number("Its value in B.")),
                    "b_unit": text("Its unit of measure there."),
                    "equal": flag("Whether value and unit are the same."),
                },
            ),
        ),
    },
)

_SIGNAL = {
    "name": text("Its name."),
    "unit": text("Its unit of measure."),
    "value": number("Working point."),
}
_ESTIMATE = {
    "value": number("The estimate."),
    "low": number("Lower end of its confidence interval."),
    "high": number("Upper end."),
    "unit": text("Its unit of measure."),
}
_IDENTIFY = listed(
    "An entry for each working point.",
    record(
        "What was identified.",
        {
            "target": text("The system or FMU."),
            "scenario": text("The scenario."),
            "ideal": flag("Whether the buses were left out."),
            "input": record("The swept input.", _SIGNAL),
            "output": record("The output.", _SIGNAL),
            "sweep": record(
                "The sweep.",
                {
                    "start": number("Lowest frequency [Hz]."),
                    "stop": number("Highest frequency [Hz]."),
                    "duration": number("Duration [s]."),
                    "amplitude": number("Amplitude, in the input's unit."),
                    "repeats": whole("How often."),
                },
            ),
            "band": listed("Ends of the band of the fit [Hz].", {"type": "number"}),
            "points": whole("Frequencies in it."),
            "confidence": number("Confidence of the intervals, 0.95."),
            "gain": record("The gain.", _ESTIMATE),
            "pole": record("The pole.", _ESTIMATE),
            "gain_times_pole": record("Their product.", _ESTIMATE),
            "time_constant": record("The time constant.", _MEASURED),
            "correlation": number("Correlation of gain and pole."),
            "separable": flag("Whether the data separate them."),
            "residual": number("Relative rms error of the fit."),
            "coherence": number("Mean coherence in the band."),
            "mean_esr": record("Error-to-signal ratio of the prediction, mean.", _MEASURED),
            "warnings": listed("Sentences on all that is suspicious."),
            "switched_off": listed("Events that were left out, stimuli that were held."),
            "response": record(
                "The frequency response.",
                {
                    "frequency": listed("Frequencies [Hz].", {"type": "number"}),
                    "real": listed("Real parts.", {"type": "number"}),
                    "imaginary": listed("Imaginary parts.", {"type": "number"}),
                    "coherence": listed("Coherences.", {"type": ["number", "null"]}),
                },
            ),
            **FILES,
        },
    ),
)

_BUDGET = record(
    "The bus budget of a system.",
    {
        "system": text("The system."),
        "scenario": text("The scenario."),
        "metric": text("The metric that judges."),
        "unit": text("Its unit of measure."),
        "limit": number("The limit."),
        "kind": text('"max": broken above it; "min": broken below it.'),
        "series": listed(
            "Delay, resolution and cycle; with --seeds timing and jitter, and lost frames too.",
            record(
                "A series.",
                {
                    "name": text("What is varied."),
                    "summary": text("A sentence."),
                    "first_broken": or_null(text("The first point that is broken; null: none.")),
                    "points": listed(
                        "The points, from little to much.",
                        record(
                            "A point.",
                            {
                                "label": text("Its name."),
                                "nominal": flag("Whether it is the system as it is."),
                                "bus": _BUS,
                                "value": or_null(number("The metric, the worst of all seeds; null: none.")),
                                "seeds": listed("The metric of each seed, where there are several."),
                                "quantile": or_null(number("That of 80 % of the seeds; null: one run.")),
                                "broken": flag("Whether the limit is passed, or there is no value."),
                                "failed": flag("Whether the run failed."),
                                "reason": text("Why there is no value."),
                            },
                        ),
                    ),
                },
            ),
        ),
        **FILES,
    },
)

_ROW = record(
    "A row, all in words.",
    {
        "place": text("Its place in the paper."),
        "what": text("What it is about."),
        "printed": text("What the paper prints."),
        "reach": text("What should be reached."),
        "obtained": text("What comes out."),
        "verdict": text("The verdict."),
        "reason": text("Why."),
        "picture": text("The picture that redraws a figure."),
    },
)
_REPRODUCE = by_name(
    "The papers by the names of their systems.",
    record(
        "A paper.",
        {
            "title": text("Its title here."),
            "source": text("The paper."),
            "counts": by_name("Rows by verdict.", {"type": "integer"}),
            "rows": listed("What the paper prints.", _ROW),
            "own": listed("Numbers of our own.", _ROW),
            "missed": whole("Rows that should be reached and are not."),
        },
    ),
)

SCHEMAS: dict[str, Schema] = {
    "run": _RUN,
    "list": LIST,
    "info": {
        "description": "A system, an FMU or a CAN database.",
        "oneOf": [INFO_SYSTEM, INFO_FMU, INFO_DATABASE],
    },
    "check": _CHECK,
    "compare": _COMPARE,
    "identify": _IDENTIFY,
    "budget": _BUDGET,
    "bus": BUS_TIMES,
    "reproduce": _REPRODUCE,
}
"""The schemas by verb."""


def schema_of(verb: str) -> Schema:
    """Return the JSON schema of what a verb prints with `--json`. Raises KeyError for one without it."""
    draft = "https://json-schema.org/draft/2020-12/schema"
    return {"$schema": draft, "title": f"evcosim {verb} --json", **SCHEMAS[verb]}
