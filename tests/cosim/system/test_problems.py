"""Broken files: each message names the key as the file spells it, the rule and the value."""

from __future__ import annotations

import tomllib

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.swap.swap_file import SwapFile
from evcosim.cosim.system.problems import spelled
from evcosim.cosim.system.scenario import ScenarioFile
from evcosim.cosim.system.system import SystemFile
from evcosim.cosim.system.toml import validate

HEAD = "name = 'x'\n[units.a]\nfmu = 'A'\n"
FILES = {"system": SystemFile, "scenario": ScenarioFile, "swap": SwapFile}

# kind of file, text, message
BROKEN = [
    ("system", "name = 'x'\n", "units: this key is needed"),
    ("system", "name = 'x'\nunits = {}\n", "units: Table should have at least 1 item after validation, not 0"),
    ("system", "name = 'x'\n[units.a]\n", "units.a.fmu: this key is needed"),
    ("system", "name = 'x'\nunits = 3\n", "units: a table is needed, not 3"),
    ("system", "name = 'x'\n[units.a]\nfmu = 3\n", "units.a.fmu: Input should be a valid string, not 3"),
    ("system", HEAD.replace("'x'", "'my-car'"), "name: a name is made of letters, digits and '_', not 'my-car'"),
    ("system", HEAD.replace(".a]", ".my-car]"), "units.my-car: a name is made of letters, digits and '_', not 'my-car'"),
    ("system", HEAD.replace(".a]", ".'my car']"), "units.'my car': a name is made of letters, digits and '_', not 'my car'"),
    ("system", HEAD + "fnu = 'B'\n", "units.a.fnu: unknown key (did you mean 'fmu'?)"),
    ("system", HEAD + "parameters.mass = [1]\n", "units.a.parameters.mass: a value is a number, true, false or a text, not [1]"),
    ("system", HEAD + "parameters.day = 2011-12-12\n", "units.a.parameters.day: a value is a number, true, false or a text, not 2011-12-12"),
    ("system", HEAD + "parameters = 3\n", "units.a.parameters: a table is needed, not 3"),
    ("system", HEAD + "substeps = 0\n", "units.a.substeps: Input should be greater than or equal to 1, not 0"),
    ("system", HEAD + "isolation = 'proces'\n", "units.a.isolation: Input should be 'process' or 'none', not 'proces' (did you mean 'process'?)"),
    ("system", HEAD + "map.inputs.x = 3\n", "units.a.map.inputs.x: a table or a text is needed, not 3"),
    ("system", HEAD + "map.inputs.x = [true, 1e400]\n", "units.a.map.inputs.x: a table or a text is needed, not [true, inf]"),
    ("system", HEAD + "substeps = [true, false]\n", "units.a.substeps: Input should be a valid integer, not [true, false]"),
    ("system", HEAD + "substeps = { a = 'b', 'c d' = 07:32:00 }\n", "units.a.substeps: Input should be a valid integer, not { a = 'b', 'c d' = 07:32:00 }"),
    ("system", HEAD + "substeps = 2020-01-01T00:00:00Z\n", "units.a.substeps: Input should be a valid integer, not 2020-01-01T00:00:00+00:00"),
    ("system", HEAD + "substeps = \"it's\"\n", "units.a.substeps: Input should be a valid integer, not \"it's\""),
    ("system", HEAD + "map.inputs.x.unit = 'm'\n", "units.a.map.inputs.x.variable: this key is needed"),
    ("system", HEAD + "map.inputs.'x y'.variable = 3\n", "units.a.map.inputs.'x y'.variable: Input should be a valid string, not 3"),
    ("system", HEAD + "map.input.x = 'y'\n", "units.a.map.input: unknown key (did you mean 'inputs'?)"),
    ("system", HEAD + "[connect]\nfrom = 'a.b'\n", "connect: a list is needed, not { from = 'a.b' }"),
    ("system", HEAD + "[[connect]]\nto = ['a.b']\n", "connect 1.from: this key is needed"),
    ("system", HEAD + "[[connect]]\nfrom = 'a'\n", "connect 1.from: a variable is written unit.variable, not 'a'"),
    ("system", HEAD + "[[connect]]\nfrom = 'a.b'\nto = 'a.c'\n", "connect 1.to: a list is needed, as in to = ['a.c'], not 'a.c'"),
    ("system", HEAD + "[[connect]]\nfrom = 'a.b'\n[[connect]]\nfrom = 'a.b'\nto = ['a.c', 'd']\n", "connect 2.to 2: a variable is written unit.variable, not 'd'"),
    ("system", HEAD + "[[connect]]\nfrom = 'a.b'\nvia = 'can0.M'\n", "connect 1.via: a signal is written bus.message.signal, not 'can0.M'"),
    ("system", HEAD + "[[connect]]\nfrom = 'a.b'\ninitial = 1\n", "connect 1: 'initial' is what is there before the first message: it needs a 'via'"),
    ("system", HEAD + "[buses.can0]\ndbc = 'x'\ncycle = 0\n", "buses.can0.cycle: Input should be greater than or equal to 1, not 0"),
    ("system", HEAD + "[buses.can0]\ndbc = 'x'\nresolution = 'fine'\n", "buses.can0.resolution: a resolution is a factor from 1 to 1e9, or \"ideal\", not 'fine'"),
    ("system", HEAD + "[experiment]\nstep_size = '10 ms'\n", "experiment.step_size: Input should be a valid number, not '10 ms'"),
    ("system", HEAD + "[experiment]\nstep_size = '0.5'\nstop_time = true\nstart_time = [1]\n", "experiment.start_time: Input should be a valid number, not [1]\nexperiment.stop_time: Input should be a valid number, not true\nexperiment.step_size: Input should be a valid number, not '0.5'"),
    ("system", HEAD + "strict = 'no'\n", "units.a.strict: Input should be a valid boolean, not 'no'"),
    ("system", HEAD + "strict = 1\n", "units.a.strict: Input should be a valid boolean, not 1"),
    ("system", HEAD + "substeps = true\n", "units.a.substeps: Input should be a valid integer, not true"),
    ("system", HEAD + "substeps = 2.0\n", "units.a.substeps: Input should be a valid integer, not 2.0"),
    ("system", HEAD + "map.inputs.x = { variable = 'y', invert = 0 }\n", "units.a.map.inputs.x.invert: Input should be a valid boolean, not 0"),
    ("system", HEAD + "[buses.can0]\ndbc = 'x'\nbitrate = '500000'\n", "buses.can0.bitrate: Input should be a valid integer, not '500000'"),
    ("system", HEAD + f"[experiment]\nstop_time = 1{'0' * 400}\n", f"experiment.stop_time: a number may be 1.8e+308 at most, not 1{'0' * 76}..."),
    ("system", HEAD + f"[experiment]\nstop_time = 0x{'f' * 5000}\n", f"experiment.stop_time: a number may be 1.8e+308 at most, not 0x{'f' * 75}..."),
    ("system", HEAD + f"fnu = 0x{'f' * 5000}\n", "units.a.fnu: unknown key (did you mean 'fmu'?)"),
    ("system", HEAD + "[experiment]\nalgorithm = false\n", "experiment.algorithm: Input should be 'gauss_seidel' or 'jacobi', not false"),
    ("system", HEAD + "[[figure.panels]]\nsignals = [{ name = 'a.b', style = 'dash' }]\n", "figure.panels 1.signals 1.style: Input should be 'solid', 'dashed', 'dotted' or 'dashdot', not 'dash' (did you mean 'dashed'?)"),
    ("system", HEAD + "[[figure.panels]]\nsignals = [3]\n", "figure.panels 1.signals 1: a table or a text is needed, not 3"),
    ("system", HEAD + "[[figure.panels]]\nsignals = ['a.b']\nlimits = [1]\n", "figure.panels 1.limits 2: this value is needed"),
    ("system", HEAD + "[[metrics]]\nname = 'signal'\n", "metrics 1.signal: this key is needed"),
    ("system", HEAD + "[[metrics]]\nname = 'm'\nsignal = 'a.b'\nper.signall = 'a.c'\n", "metrics 1.per.signal: this key is needed\nmetrics 1.per.signall: unknown key (did you mean 'signal'?)"),
    ("system", HEAD + "[buses.c]\ndbc = 'x'\n[buses.c.messages.M]\nsend_type = 'on_chnage'\n", "buses.c.messages.M.send_type: Input should be 'cyclic', 'on_change', 'cyclic_and_on_change', 'if_active' or 'on_write', not 'on_chnage' (did you mean 'on_change'?)"),
    ("scenario", "[[stimuli]]\nto = 'a.b'\nconstant = 1\n", "stimuli: unknown key (did you mean 'stimulus'?)"),
    ("scenario", "[[stimulus]]\nto = 'a.b'\n", "stimulus 1: a stimulus has exactly one of constant, table, csv, sine, ramp; this one has none"),
    ("scenario", "[[stimulus]]\nto = 'a.b'\nconstant = 1\ntable = [[0, 1]]\n", "stimulus 1: a stimulus has exactly one of constant, table, csv, sine, ramp; this one has constant and table"),
    ("scenario", "[[stimulus]]\nto = 'a.b'\ntable = [[0, 1], [1]]\n", "stimulus 1.table 2 2: this value is needed"),
    ("scenario", "[[stimulus]]\nto = 'a.b'\nsine = { amplitude = 1, period = 0 }\n", "stimulus 1.sine.period: Input should be greater than 0, not 0"),
    ("scenario", "[[event]]\ntime = 1\naction = 'bias'\nvariable = 'a.b'\n", "event 1.value: this key is needed with action = \"bias\""),
    ("scenario", "[[event]]\ntime = '1'\naction = 'bias'\nvariable = 'a.b'\nvalue = 1\n", "event 1.time: Input should be a valid number, not '1'"),
    ("scenario", "[[stimulus]]\nto = 'a.b'\ntable = [[0, []], ['1', 0]]\n", "stimulus 1.table 1 2: a value is a number, true, false or a text, not []\nstimulus 1.table 2 1: Input should be a valid number, not '1'"),
    ("scenario", "[parameters]\nmass = 1\n", "parameters.mass: a table is needed, not 1"),
    ("scenario", "[parameters.vehicle]\nmass = {}\n", "parameters.vehicle.mass: a value is a number, true, false or a text"),
    ("scenario", "[start]\n'my car'.x = []\n", "start.'my car'.x: a value is a number, true, false or a text, not []"),
    ("scenario", "[identification]\noutput = 'a.b'\namplitude = 1\n", "identification.input: this key is needed"),
    ("scenario", "[identification]\ninput = 'a.b'\noutput = 'a.c'\namplitude = -1\nrepeats = 0\nduration = -5\n", "identification.amplitude: Input should be greater than 0, not -1\nidentification.duration: Input should be greater than 0, not -5\nidentification.repeats: Input should be greater than or equal to 1, not 0"),
    ("scenario", "[identification]\ninput = 'a.b'\noutput = 'a.c'\namplitude = inf\nsweep = [0, 1]\nband = [1, -1]\n", "identification.amplitude: Input should be a finite number, not inf\nidentification.sweep 1: Input should be greater than 0, not 0\nidentification.band 2: Input should be greater than 0, not -1"),
    ("swap", "replaces = 'a.b'\n", "fmu: this key is needed"),
    ("swap", "fmu = 'F'\n[map.output]\n", "map.output: unknown key (did you mean 'outputs'?)"),
    ("swap", "fmu = 'F'\n[map.outputs]\nv = { variabel = 'x' }\n", "map.outputs.v.variable: this key is needed\nmap.outputs.v.variabel: unknown key (did you mean 'variable'?)"),
    ("swap", "fmu = 'F'\n[units.vehicle]\nfmu = 'F'\n", "units: unknown key"),
    ("system", HEAD + "[unit.vehicle]\nfmu = 'F'\n", "unit: unknown key (did you mean 'units'?)"),
    ("system", HEAD + "[experiment]\ntitel = 'x'\n", "experiment.titel: unknown key"),
    ("system", HEAD + "[experiment]\nstep_siz = 1\n", "experiment.step_siz: unknown key (did you mean 'step_size'?)"),
    ("system", HEAD + "[[figure.panels]]\nsignals = [{ name = 'a.b', lable = 'x' }]\n", "figure.panels 1.signals 1.lable: unknown key (did you mean 'label'?)"),
    ("system", HEAD + "[[connect]]\nform = 'a.b'\n", "connect 1.from: this key is needed\nconnect 1.form: unknown key (did you mean 'from'?)"),
    ("scenario", "[[stimulus]]\nto = 'a.b'\nsine = { amplitude = 1, period = 1, dealy = 1 }\n", "stimulus 1.sine.dealy: unknown key (did you mean 'delay'?)"),
    ("scenario", "[[event]]\ntime = 1\naction = 'reset'\nvariable = 'a.b'\nvalu = 1\n", "event 1.valu: unknown key with action = \"reset\""),
]  # fmt: skip # one file a line


@pytest.mark.parametrize(("kind", "text", "said"), BROKEN)
def test_each_problem_is_named_with_its_key(kind: str, text: str, said: str) -> None:
    with pytest.raises(ConfigError) as caught:
        validate(tomllib.loads(text), FILES[kind], "f.toml")
    assert str(caught.value).splitlines() == [f"f.toml: {line}" for line in said.splitlines()]


def test_a_long_value_is_cut() -> None:
    with pytest.raises(ConfigError) as caught:
        validate({"name": "x", "units": "y" * 1000}, SystemFile, "f.toml")
    assert str(caught.value) == f"f.toml: units: a table is needed, not '{'y' * 76}..."


@given(st.lists(st.text(max_size=5) | st.integers(0, 50), min_size=1, max_size=5))
def test_a_place_is_spelled_as_a_file_spells_it(place: list[str | int]) -> None:
    """Keys alone are a dotted key of TOML."""
    keys = [part for part in place if isinstance(part, str) and part.isprintable() and "'" not in part]
    assume(keys)
    found: object = tomllib.loads(f"{spelled(keys)} = 1")
    for key in keys:
        assert isinstance(found, dict)
        found = found[key]
    assert found == 1


def test_entries_are_counted_from_1() -> None:
    assert spelled(["connect", 1, "to", 0]) == "connect 2.to 1"
    assert spelled([]) == ""
