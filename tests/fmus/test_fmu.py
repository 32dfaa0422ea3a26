"""What holds for every FMU of the catalog: it is its model, no more and no less."""

from __future__ import annotations

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

STEPS = 40


def test_the_description_is_valid_without_a_message(subject):
    assert validate_fmu(str(subject.path)) == []


def test_the_trace_is_the_models_bit_for_bit(subject, load, plain, bits, random_inputs, random_parameters):
    for seed in range(3):
        unit = load(subject.path)
        start = random_parameters(subject.model, seed) | random_inputs(subject.model, 1, seed)[0]
        model = plain(subject.model, start)
        unit.initialize(start)
        assert bits(unit.get()) == bits(model.outputs())
        inputs = random_inputs(subject.model, STEPS, 100 + seed)
        assert bits(unit.run(inputs)) == bits(model.run(inputs))


def test_an_input_set_between_steps_shows_where_it_feeds_through(subject, load, plain, bits, random_inputs):
    unit, model = load(subject.path), plain(subject.model, {})
    unit.initialize()
    inputs = random_inputs(subject.model, 11, 7)
    unit.run(inputs[:10])
    model.run(inputs[:10])
    unit.set(inputs[10])
    model.held |= inputs[10]
    assert bits(unit.get()) == bits(model.outputs())


def test_in_initialization_outputs_answer_for_what_is_set(subject, load, plain, bits, random_inputs):
    unit = load(subject.path)
    unit.fmu.setupExperiment(startTime=3.0)
    unit.fmu.enterInitializationMode()
    held: dict[str, object] = {}
    for values in random_inputs(subject.model, 4, 5):
        held |= values
        unit.set(values)
        assert bits(unit.get()) == bits(plain(subject.model, held, start=3.0).outputs())


def test_variables_can_be_read_in_any_order_and_together(subject, load, random_inputs):
    unit = load(subject.path)
    unit.initialize()
    unit.run(random_inputs(subject.model, 5, 1))
    by_type: dict[str, list[str]] = {}
    for name, v in unit.variables.items():
        by_type.setdefault("Integer" if v.type == "Enumeration" else v.type, []).append(name)
    for kind, names in by_type.items():
        get = getattr(unit.fmu, f"get{kind}")
        one_by_one = [unit.get(name)[name] for name in names]
        references = [unit.variables[name].valueReference for name in names]
        assert get(references) == one_by_one
        assert get(references[::-1] + references) == one_by_one[::-1] + one_by_one


def test_two_instances_do_not_touch_each_other(subject, load, plain, bits, random_inputs):
    units = [load(subject.path), load(subject.path)]
    models = [plain(subject.model, {}), plain(subject.model, {})]
    inputs = [random_inputs(subject.model, STEPS, seed) for seed in (1, 2)]
    for unit in units:
        unit.initialize()
    for k in range(STEPS):  # in turn
        for unit, model, given_inputs in zip(units, models, inputs, strict=True):
            now = given_inputs[k : k + 1]
            assert bits(unit.run(now, start=k)) == bits(model.run(now, start=k))


def test_reset_starts_over(subject, load, bits, random_inputs, random_parameters):
    unit = load(subject.path)
    inputs = random_inputs(subject.model, STEPS, 3)
    unit.initialize()
    first = unit.run(inputs)
    unit.fmu.terminate()
    unit.fmu.reset()
    unit.initialize(random_parameters(subject.model, 9))
    unit.run(inputs)
    unit.fmu.reset()
    unit.initialize()
    assert bits(unit.run(inputs)) == bits(first)


def test_a_restored_state_replays_bit_for_bit(subject, load, bits, random_inputs, random_parameters):
    unit, other = load(subject.path), load(subject.path)
    unit.initialize(random_parameters(subject.model, 4))
    inputs = random_inputs(subject.model, 2 * STEPS, 4)
    unit.run(inputs[:STEPS])
    state = unit.fmu.getFMUstate()
    data = unit.fmu.serializeFMUstate(state)
    rest = unit.run(inputs[STEPS:], start=STEPS)

    unit.fmu.setFMUstate(state)
    assert bits(unit.run(inputs[STEPS:], start=STEPS)) == bits(rest)
    unit.fmu.setFMUstate(state)
    unit.fmu.freeFMUstate(state)
    assert bits(unit.run(inputs[STEPS:], start=STEPS)) == bits(rest)

    carried = other.fmu.deSerializeFMUstate(data)
    other.fmu.setFMUstate(carried)
    assert other.fmu.serializeFMUstate(carried) == data
    other.fmu.freeFMUstate(carried)
    assert bits(other.run(inputs[STEPS:], start=STEPS)) == bits(rest)


def test_a_state_from_initialization_can_be_restored(subject, load, bits, random_inputs):
    unit = load(subject.path)
    unit.fmu.setupExperiment()
    unit.fmu.enterInitializationMode()
    unit.set(random_inputs(subject.model, 1, 8)[0])
    state = unit.fmu.getFMUstate()
    before = unit.get()
    unit.set(random_inputs(subject.model, 1, 9)[0])
    unit.get()
    unit.fmu.setFMUstate(state)
    unit.fmu.freeFMUstate(state)
    assert bits(unit.get()) == bits(before)


def test_it_runs_where_neither_evcosim_nor_pythonfmu_can_be_imported(subject, in_an_importer):
    in_an_importer(f"""
import sys
class Wall:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("evcosim", "pythonfmu", "mixed", "mixed_helper"):
            raise ModuleNotFoundError(f"{{name}} is behind the wall")
assert "evcosim" not in sys.modules and "pythonfmu" not in sys.modules
sys.meta_path.insert(0, Wall())
import fmpy
path = list(sys.path)
result = fmpy.simulate_fmu({str(subject.path)!r}, stop_time=0.5)
assert len(result) > 2, result
assert sys.path == path, "the FMU left something in sys.path"
assert "evcosim" not in sys.modules
""")


def test_the_command_fmpy_simulate_runs_it(subject, in_an_importer, tmp_path):
    output = tmp_path / "result.csv"
    arguments = ["simulate", str(subject.path), "--stop-time", "0.2", "--output-file", str(output)]
    in_an_importer(f"""
import sys
from fmpy.cli import main
sys.argv = ["fmpy", *{arguments!r}]
sys.exit(main())
""")
    assert len(output.read_text().splitlines()) > 2


@pytest.fixture(scope="module")
def mixed(toy):
    return toy("Mixed")


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.lists(
        st.fixed_dictionaries(
            {},
            optional={
                "speed": st.floats(),  # NaN and infinities among them
                "steps": st.integers(-(2**31), 2**31 - 2),
                "on": st.booleans(),
                "lever": st.sampled_from([-1, 0, 2]),
            },
        ),
        max_size=8,
    )
)
def test_any_inputs_give_what_the_model_gives(mixed, plain, bits, shared_unit, inputs):
    gear = type(mixed.model.Parameters().gear)
    model = plain(mixed.model, {})
    shared_unit.fmu.reset()
    shared_unit.initialize()
    typed = [{n: gear(v) if n == "lever" else v for n, v in values.items()} for values in inputs]
    assert bits(shared_unit.run(inputs)) == bits(model.run(typed))
    state = shared_unit.fmu.getFMUstate()
    data = shared_unit.fmu.serializeFMUstate(state)
    shown = shared_unit.get()
    back = shared_unit.fmu.deSerializeFMUstate(data)
    shared_unit.run(inputs)
    shared_unit.fmu.setFMUstate(back)
    assert bits(shared_unit.get()) == bits(shown)
    shared_unit.fmu.freeFMUstate(back)
    shared_unit.fmu.freeFMUstate(state)


@pytest.fixture
def shared_unit(mixed, load):
    return load(mixed.path)


def test_the_independent_variable_is_the_time_of_the_step(mixed, load):
    unit = load(mixed.path)
    unit.initialize(start=2.5)
    assert unit.get("clock") == {"clock": 2.5}
    unit.run([{}], start=7)
    assert unit.get("clock") == {"clock": 7 * 0.01 + 0.01}  # feedthrough shows the end of the step


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("weight", 11.0, "weight = 11.0 kg is above its maximum 10.0 kg"),
        ("weight", -1.0, "weight = -1.0 kg is below its minimum 0.0 kg"),
        ("weight", float("nan"), "weight = nan is not a finite number"),
        ("count", 10, "count = 10 is above its maximum 9"),
    ],
)
def test_a_parameter_out_of_range_is_refused_with_name_rule_and_values(mixed, load, name, value, message):
    unit = load(mixed.path)
    unit.fmu.setupExperiment()
    unit.set({name: value})
    unit.fmu.enterInitializationMode()
    with pytest.raises(FMICallException, match="fatal"):
        unit.fmu.exitInitializationMode()
    assert unit.log[-1][2].endswith(f"fmi2ExitInitializationMode: {message}")


@pytest.mark.parametrize(
    ("act", "message"),
    [
        (lambda u: u.set({"weight": 2.0}), "weight is a fixed parameter: it cannot be set after"),
        (lambda u: u.set({"total": 2.0}), "total is neither parameter nor input"),
        (lambda u: u.set({"clock": 2.0}), "clock is neither parameter nor input"),
        (
            lambda u: u.set({"lever": 1}),
            "lever = 1 is no item of its enumeration (-1 reverse, 0 neutral, 2 f",
        ),
        (lambda u: u.fmu.getReal([1]), "there is no Real variable with value reference 1"),
        (lambda u: u.fmu.getInteger([0, 99]), "there is no Integer variable with value reference 0, 99"),
        (lambda u: u.fmu.setBoolean([77], [True]), "there is no Boolean variable with value reference 77"),
        (lambda u: u.fmu.getReal([2**32 - 1]), "there is no Real variable with value reference -1"),
        (lambda u: u.fmu.getString([0]), "there is no String variable with value reference 0"),
        (lambda u: u.fmu.setString([0], ["x"]), "there is no String variable with value reference 0"),
        (
            lambda u: u.set({"steps": 2**31 - 1}) or u.get(),
            "output steps_seen is 2147483648, which is no Int",
        ),
    ],
)
def test_what_fmi_does_not_allow_is_refused_by_name(mixed, load, act, message):
    unit = load(mixed.path)
    unit.initialize()
    with pytest.raises(FMICallException, match="fatal"):
        act(unit)
    assert message in unit.log[-1][2]


def test_a_state_of_another_version_is_refused(mixed, toy, load):
    unit, other = load(mixed.path), load(toy("Failing").path)
    state = other.fmu.getFMUstate()
    data = other.fmu.serializeFMUstate(state)
    other.fmu.freeFMUstate(state)
    with pytest.raises(FMICallException, match="fatal"):
        unit.fmu.deSerializeFMUstate(data)
    assert "these bytes are a state of 'Failing_" in unit.log[-1][2]
    assert "this FMU is 'Mixed_" in unit.log[-1][2]


def test_a_state_brings_back_its_inputs(subject, load, bits, random_inputs):
    unit = load(subject.path)
    unit.initialize()
    inputs = random_inputs(subject.model, 20, 6)
    unit.run(inputs[:10])
    state = unit.fmu.getFMUstate()
    rest = unit.run([{}] * 3, start=10)  # with the inputs that are held
    unit.run(inputs[10:])
    unit.fmu.setFMUstate(state)
    unit.fmu.freeFMUstate(state)
    assert bits(unit.run([{}] * 3, start=10)) == bits(rest)


def test_the_outputs_of_a_sample_hold(toy, load):
    unit = load(toy("Sampled").path)
    unit.initialize({"offset": 5.0})
    assert unit.get() == {"shown": 5.0}
    assert unit.run([{"offset": 10.0}]) == [{"shown": 11.0}]
    unit.set({"offset": 20.0})
    assert unit.get() == {"shown": 11.0}
    (shown,) = unit.description.outputs
    assert shown.dependencies == []
    (shown,) = unit.description.initialUnknowns
    assert [v.name for v in shown.dependencies] == ["by", "offset"]


@pytest.mark.parametrize(
    ("module", "name"),
    [
        ("os", "system"),
        ("{package}.evcosim.models.base", "inspect.os.system"),
        ("{package}.evcosim.models.base", "variables"),
        ("{package}.evcosim.fmus.slave", "ModelSlave"),
        ("numpy", "save"),
    ],
)
def test_bytes_of_a_state_cannot_make_the_fmu_act(mixed, load, module, name):
    unit = load(mixed.path)
    state = unit.fmu.getFMUstate()
    data = unit.fmu.serializeFMUstate(state)
    unit.fmu.freeFMUstate(state)
    stamp = data.partition(b"\n")[0]
    module = module.format(package=stamp.decode())
    texts = b"".join(b"\x8c" + bytes([len(text)]) + text.encode() for text in (module, name))
    evil = stamp + b"\n\x80\x04" + texts + b"\x93."  # push both texts, look the name up in the module
    with pytest.raises(FMICallException, match="fatal"):
        unit.fmu.deSerializeFMUstate(evil)
    assert f"a state of this FMU does not contain {module}.{name}" in unit.log[-1][2]


def test_a_notice_is_a_warning_in_the_log_once_for_each_sentence(toy, load):
    unit = load(toy("Noticing").path)
    unit.log.clear()
    unit.initialize()
    unit.run([{}] * 10)
    assert unit.log == [
        (1, "logStatusWarning", "first at t = 0.02 s: 100 % of the limit"),
        (1, "logStatusWarning", "first at t = 0.05 s: 200 % of the limit"),
    ]
    silent = load(toy("Noticing").path)
    silent.log.clear()
    silent.initialize()
    silent.run([{"silent": True}] * 10)
    assert silent.log == []
