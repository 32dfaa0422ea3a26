"""Annotations behind a unit: those that change nothing, and those that no factor converts."""

from __future__ import annotations

import pytest

from evcosim.cosim.units.annotations import annotated, objection
from evcosim.cosim.units.conversion import between
from evcosim.cosim.units.definition import by_text, defined
from evcosim.cosim.units.measure import UnknownUnitError

CLOSED = {
    "V": ("VDC", "Vdc", "V DC", "V dc", "V_dc", "V(DC)", "V [DC]", "Volts DC"),
    "kV": ("kVDC", "kV dc"),
    "A": ("A DC", "Adc", "Amps DC"),
    "psi": ("psia", "PSIA", "psi abs", "psi(a)"),
    "bar": ("bara", "bar abs", "bar(a)", "BARA", "bar_a", "bar absolute"),
    "kPa": ("kPaa", "kPa(a)", "kPa abs"),
    "%": ("%RH", "%rH", "% RH", "%SOC", "%SoC", "% soc", "%(SOH)", "% DoD", "%PWM", "% duty"),
}
OPEN = {
    "above that of the air": ("psig", "PSIG", "psi(g)", "psi gauge", "barg", "bar g", "bar(g)", "bar rel",
                              "barü", "kPag", "kPa gauge", "mbarg", "MPag"),
    "difference of two pressures": ("psid", "bard", "kPa diff"),
    "an amplitude": ("VAC", "Vac", "V AC", "Vrms", "V rms", "Arms", "A eff", "Vpp", "Vp-p", "Vpk", "kVAC",
                     "A(rms)", "Volts AC"),
    "full scale": ("%FS", "% fs", "%FSO", "% full scale"),
    "share of volume, mass or amount": ("vol%", "Vol.-%", "% vol", "%v/v", "wt%", "wt %", "mol%", "% m/m"),
}  # fmt: skip # a table


@pytest.mark.parametrize(("unit", "text"), [(unit, text) for unit, texts in CLOSED.items() for text in texts])
def test_an_annotation_that_changes_nothing_is_left_out(unit, text):
    assert between(text, unit).identity and between(unit, text).identity
    assert objection(text) == ""
    if text.isidentifier():
        assert between(f"{text}/s", f"{unit}/s").identity


@pytest.mark.parametrize(("why", "text"), [(why, text) for why, texts in OPEN.items() for text in texts])
def test_an_annotation_that_no_factor_converts_makes_no_unit_and_says_why(why, text):
    assert by_text(text) is None
    with pytest.raises(
        UnknownUnitError, match=r"is not known: .* is .*where the number is to be taken"
    ) as caught:
        defined(text)
    assert why in str(caught.value)


@pytest.mark.parametrize(
    "text",
    ["V", "VA", "kVA", "bar", "Pa", "Pa.s", "%", "psi", "Vs", "A", "dVolt", "%x", "as", "Arm", ""],
)
def test_what_has_no_annotation(text):
    assert annotated(text) is None


def test_a_converter_s_counts_are_no_direct_current():
    with pytest.raises(UnknownUnitError, match="ADC may be a direct current or counts of a converter"):
        defined("ADC")
