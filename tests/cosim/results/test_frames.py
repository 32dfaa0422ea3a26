"""Results as a DataFrame and a Dataset: the same numbers, with their units of measure."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.results.text_table import TextTable
from support.needs import need_module

pandas, xarray = need_module("pandas"), need_module("xarray")

STATES = ((0, "driver"), (1, "acceleration bound"), (5, "off"))
VARIABLES = [
    ResultVariable("vehicle.speed", "m/s", description="Speed"),
    ResultVariable("ecu.state", type="Enumeration", items=STATES),
    ResultVariable("ecu.count", type="Integer"),
    ResultVariable("ecu.on", type="Boolean"),
]
TEXTS = TextTable([ResultVariable("ecu.message", type="String")], [(0, ("",)), (2, ("too fast",))])
DATA = np.array([[0.0, 0, 7, 1], [0.5, 5, 8, 0], [1.0, 1, 9, 0], [1.25, 1, 9, 1]])
MANIFEST = {"system": "scooter", "scenario": "fig8", "steps": 4}


@pytest.fixture
def results() -> Results:
    return Results([0.0, 0.01, 0.02, 0.03], DATA.copy(), VARIABLES, MANIFEST, texts=TEXTS)


def test_a_dataframe_has_the_values_over_time_with_their_units(results):
    frame = results.to_dataframe()
    assert frame.index.name == "time"
    assert list(frame.columns) == [*results.names, *results.texts]
    assert np.array_equal(frame.index, results.time)
    for name in ("vehicle.speed", "ecu.count", "ecu.on"):
        assert frame[name].dtype == results[name].dtype
        assert np.array_equal(frame[name], results[name])
    assert list(frame["ecu.message"]) == ["", "", "too fast", "too fast"]
    assert frame.attrs["units"] == {"time": "s", "ecu.message": ""} | results.units
    assert frame.attrs["descriptions"] == {"vehicle.speed": "Speed"}


def test_the_states_of_an_enumeration_are_categories(results):
    state = results.to_dataframe()["ecu.state"]
    assert list(state) == ["driver", "off", "acceleration bound", "acceleration bound"]
    assert list(state.cat.categories) == ["driver", "acceleration bound", "off"]
    assert dict(state.value_counts()) == {"acceleration bound": 2, "off": 1, "driver": 1}


@given(st.lists(st.tuples(st.integers(-3, 3), st.sampled_from("ab")), unique_by=lambda p: p[0], min_size=1))
def test_each_number_of_an_enumeration_has_one_name(items):
    """Also where two states have one name, and for numbers that no state has."""
    values = np.arange(-4.0, 5.0)
    found = Results(values, values[:, None], [ResultVariable("a.b", type="Enumeration", items=tuple(items))])
    names = list(found.to_dataframe()["a.b"])
    assert len(set(names)) == len(values)
    for value, name in zip(values, names, strict=True):
        assert name.startswith(dict(items).get(int(value), f"{value:g}"))


def test_a_dataset_has_the_attributes_that_others_read(results):
    found = results.to_xarray()
    assert set(found.data_vars) == {*results.names, *results.texts}
    assert found["time"].attrs["units"] == "s"
    assert found.attrs == {"system": "scooter", "scenario": "fig8"}
    assert found["vehicle.speed"].attrs == {"units": "m/s", "long_name": "Speed"}
    assert "units" not in found["ecu.count"].attrs
    assert found["ecu.state"].attrs["flag_values"].tolist() == [0, 1, 5]
    assert found["ecu.state"].attrs["flag_meanings"] == "driver acceleration_bound off"
    for name in (*results.names, *results.texts):
        assert np.array_equal(found[name], results[name])
        assert found[name].dtype == results[name].dtype
    assert found["vehicle.speed"].sel(time=0.02) == 1.0
    assert found.to_dataframe().shape == (4, 5)


@pytest.mark.parametrize("method", ["to_dataframe", "to_xarray"])
def test_some_variables_in_the_order_that_is_asked_for(results, method):
    made = getattr(results, method)(["ecu.message", "vehicle.speed", "ecu.message"])
    assert [name for name in made if name != "time"] == ["ecu.message", "vehicle.speed"]
    with pytest.raises(ConfigError, match=r"no variable 'vehicle\.sped' \(did you mean 'vehicle\.speed'\?\)"):
        getattr(results, method)(["vehicle.sped"])
    with pytest.raises(ConfigError, match=r"^names = 'vehicle\.speed': a list of names is needed$"):
        getattr(results, method)("vehicle.speed")


def test_what_is_done_with_the_table_leaves_the_results_as_they_are(results):
    frame = results.to_dataframe()
    frame.loc[:, "vehicle.speed"] = -1.0
    results.to_xarray()["vehicle.speed"][:] = -1.0
    assert np.array_equal(results.data, DATA)


def test_no_row_and_no_variable_are_tables_too():
    empty = Results(np.empty(0), np.empty((0, 4)), VARIABLES)
    assert empty.to_dataframe().shape == (0, 4)
    assert empty.to_xarray().sizes == {"time": 0}
    bare = Results([0.0, 1.0], np.empty((2, 0)), [])
    assert bare.to_dataframe().shape == (2, 0)
    assert bare.to_xarray().sizes == {"time": 2}


@pytest.mark.parametrize(("method", "library"), [("to_dataframe", "pandas"), ("to_xarray", "xarray")])
def test_a_library_that_is_missing_is_named_with_the_extra(results, method, library, monkeypatch):
    monkeypatch.setitem(sys.modules, library, None)  # as Python marks what it cannot import
    with pytest.raises(ConfigError, match=rf"{method} needs {library}.*pip install {library}"):
        getattr(results, method)()


def test_an_integer_beyond_an_int64_stays_a_number():
    found = Results([0.0], [[2.0**64]], [ResultVariable("a.n", type="Integer")])
    assert found.to_dataframe()["a.n"].iloc[0] == 2.0**64
    assert found.to_xarray()["a.n"][0] == 2.0**64
