"""The figure of a file: its keys, and the figure without signals that are gone."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.figure_spec import FigureSpec, SignalSpec
from evcosim.cosim.system.toml import validate

NAMES = ("a.x", "a.y", "b.x", "b.y")


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"panels": []}, "panels: List should have at least 1 item"),
        ({"panels": [{"signals": []}]}, "panels 1.signals: List should have at least 1 item"),
        ({"panels": [{"signals": ["x"], "limits": [2, 1]}]}, "limits: the first must be below the second"),
        (
            {"panels": [{"signals": [{"name": "x", "sytle": "dashed"}]}]},
            r"unknown key \(did you mean 'style'",
        ),
        ({"panels": [{"signals": [{"name": "x", "style": "wavy"}]}]}, "Input should be 'solid', 'dashed'"),
    ],
)
def test_a_wrong_key_of_a_figure_is_named(keys: dict, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        validate(keys, FigureSpec, "scooter.toml")


def test_the_name_of_a_signal_stands_for_a_table() -> None:
    panels = [{"signals": ["a.x", {"name": "a.x"}]}]
    short, long = FigureSpec.model_validate({"panels": panels}).panels[0].signals
    assert short == long == SignalSpec(name="a.x")


figures = st.builds(
    lambda panels, shade: FigureSpec.model_validate(
        {"panels": [{"signals": names} for names in panels], "shade": shade}
    ),
    st.lists(st.lists(st.sampled_from(NAMES), min_size=1), min_size=1),
    st.none() | st.sampled_from(NAMES),
)


def names_in(spec: FigureSpec | None) -> list[str]:
    return [signal.name for panel in spec.panels for signal in panel.signals] if spec else []


@given(figures, st.sets(st.sampled_from(NAMES)))
def test_without_leaves_the_rest_in_its_order(spec: FigureSpec, gone: set[str]) -> None:
    left = spec.without(gone.__contains__)
    assert names_in(left) == [name for name in names_in(spec) if name not in gone]
    assert (left is None) == (not names_in(left))
    assert left is None or left.shade == (None if spec.shade in gone else spec.shade)
    assert left is None or left.without(gone.__contains__) == left


@given(figures)
def test_without_nothing_is_the_figure_itself(spec: FigureSpec) -> None:
    assert spec.without(lambda name: False) == spec
    assert spec.without(lambda name: True) is None
