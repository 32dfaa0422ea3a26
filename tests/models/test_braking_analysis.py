"""The reduced form and both propositions: consistent with the plant's own equations, numbers of the paper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from evcosim.models import braking_analysis as analysis
from evcosim.models.braking_analysis import Gains
from evcosim.models.road_friction import Road
from evcosim.models.two_wheeler_braking import TwoWheelerBraking

P = TwoWheelerBraking.Parameters(drag_area=0.0)
STARTS = analysis.random_starts(30)
K_BAR = analysis.k_bar(P)
every_road = pytest.mark.parametrize("road", list(Road), ids=lambda road: road.name.lower())


def on(road: Road) -> TwoWheelerBraking.Parameters:
    return replace(P, road=road)


def times(factor: float, gains: Gains, target: float = 1.0) -> Gains:
    return Gains(factor * gains.front / target, factor * gains.rear / target)


@every_road
def test_psi_is_the_torque_that_keeps_the_slips(road: Road) -> None:
    """The plant under Psi_f, Psi_r loses speed and keeps both slips: (6) is its own equations."""
    p = on(road)
    for slips in ((0.05, 0.05), (0.22, 0.22), (0.6, 0.1), (0.0, 0.9)):
        at = analysis.reduced(p, *(np.array(x) for x in slips))
        v = 20.0
        x = TwoWheelerBraking.State(v, v * (1.0 - slips[0]), v * (1.0 - slips[1]), 0.0, 0.0, 0.0)
        u = TwoWheelerBraking.Inputs(float(at.psi_front), float(at.psi_rear))
        dt = 1e-5
        y = TwoWheelerBraking.outputs(p, TwoWheelerBraking.step(p, x, u, dt))
        assert (y.front_slip, y.rear_slip) == pytest.approx(slips, abs=1e-8)
        assert (v - y.speed) / dt == pytest.approx(-float(at.acceleration), rel=1e-6)


@every_road
def test_slopes_are_the_derivatives(road: Road) -> None:
    p, e = on(road), 1e-6
    f, r = np.meshgrid(np.linspace(0.02, 0.98, 13), np.linspace(0.02, 0.98, 13))
    at = analysis.reduced(p, f, r)
    front = (analysis.psi_front(p, f + e, r) - analysis.psi_front(p, f - e, r)) / (2.0 * e)
    rear = (analysis.psi_rear(p, f, r + e) - analysis.psi_rear(p, f, r - e)) / (2.0 * e)
    assert at.slope_front == pytest.approx(front, rel=1e-6, abs=1e-4)
    assert at.slope_rear == pytest.approx(rear, rel=1e-6, abs=1e-4)


def test_critical_gains() -> None:
    assert K_BAR.front == pytest.approx(324.5, abs=0.05)
    assert K_BAR.rear == pytest.approx(135.2, abs=0.05)


def test_no_secant_of_psi_falls_more_steeply_than_the_critical_gain() -> None:
    """(14), (15) are written with secants: of random ones none is steeper."""
    draw = np.random.default_rng(1)
    for road in Road:
        p, (f, r, other) = on(road), draw.random((3, 2000))
        front = (analysis.psi_front(p, f, r) - analysis.psi_front(p, other, r)) / (f - other)
        rear = (analysis.psi_rear(p, f, r) - analysis.psi_rear(p, f, other)) / (r - other)
        assert -front.min() <= K_BAR.front
        assert -rear.min() <= K_BAR.rear


def test_critical_gains_are_the_highest_of_all_roads() -> None:
    each = [analysis.k_bar(P, [road]) for road in Road]
    assert max(k.front for k in each) == each[Road.DRY].front == K_BAR.front
    assert max(k.rear for k in each) == each[Road.COBBLE].rear == K_BAR.rear


def test_maxima_are_those_of_a_fine_grid() -> None:
    f, r = np.meshgrid(np.linspace(0.0, 1.0, 801), np.linspace(0.0, 1.0, 801))
    fine = analysis.reduced(P, f, r)
    highest = analysis.highest_psi(P)
    assert float(fine.psi_front.max()) == pytest.approx(highest.front, rel=1e-5)
    assert float(fine.psi_rear.max()) == pytest.approx(highest.rear, rel=1e-5)
    assert float(-fine.slope_front.min()) == pytest.approx(analysis.k_bar(P, [Road.DRY]).front, rel=1e-5)


@every_road
@pytest.mark.parametrize("factor", [1.05, 10.0])
def test_proposition_3_1(road: Road, factor: float) -> None:
    """k > k-bar: every random start ends at one point, and it is the one equilibrium there is."""
    p, gains = on(road), times(factor, K_BAR)
    ends = analysis.end_points(p, gains, STARTS)
    assert analysis.spread(ends) <= 1e-6
    (only,) = analysis.equilibria(p, gains)
    assert tuple(ends[0]) == pytest.approx(tuple(only), abs=1e-6)
    assert 0.0 < only.front < 0.22
    assert 0.0 < only.rear < 0.22


@pytest.mark.parametrize("target", [(0.1, 0.25), (0.6, 0.3), (0.9, 0.9), (0.05, 0.9)], ids=str)
def test_proposition_3_1_at_other_set_points(target: tuple[float, float]) -> None:
    """It says: for all set points. On the roads that set the two critical gains, at gains just above them."""
    gains, wanted = times(1.05, K_BAR), analysis.SetPoint(*target)
    for road in (Road.DRY, Road.COBBLE):
        ends = analysis.end_points(on(road), gains, STARTS[:10], wanted)
        assert analysis.spread(ends) <= 1e-6
        (only,) = analysis.equilibria(on(road), gains, wanted)
        assert tuple(ends[0]) == pytest.approx(tuple(only), abs=1e-6)
        assert 0.0 < only.front < wanted.front
        assert 0.0 < only.rear < wanted.rear


def test_at_little_more_than_the_critical_gain_the_slip_is_extremely_low() -> None:
    """Remark 3.3: a gain below the highest Psi leaves a slip that is of no use for braking."""
    gains = times(1.05, analysis.k_bar(analysis.Parameters()))
    highest = analysis.highest_psi(analysis.Parameters())
    assert gains.front < highest.front
    assert gains.rear < highest.rear
    (only,) = analysis.equilibria(analysis.Parameters(), gains)
    assert tuple(only) == pytest.approx((0.011, 0.003), abs=5e-4)


@every_road
def test_proposition_3_2(road: Road) -> None:
    """k lambda* = 1.5 max Psi and the fastest wheel's speed: every random start ends locked."""
    p = on(road)
    gains = times(1.5, analysis.highest_psi(p), analysis.TARGET_SLIP)
    assert int(analysis.locks(p, gains, STARTS).sum()) == 30


def test_a_low_gain_does_not_lock() -> None:
    gains = times(0.3, analysis.highest_psi(P), analysis.TARGET_SLIP)
    assert not analysis.locks(P, gains, STARTS).any()


def test_the_fastest_wheel_believes_in_no_slip() -> None:
    torques = analysis.proportional_by_fastest_wheel(Gains(100.0, 100.0))
    front, rear = torques(np.array([0.5, 0.9, 1.0, 1.0]), np.array([0.5, 0.5, 0.5, 1.0]))
    assert front == pytest.approx([22.0, 0.0, 0.0, 22.0])  # slips 0, 0.8, 1, and 0/0
    assert rear == pytest.approx([22.0] * 4)


def test_random_starts_are_the_same_for_the_same_seed() -> None:
    assert np.array_equal(analysis.random_starts(5, 3), analysis.random_starts(5, 3))
    assert STARTS.shape == (30, 2)
    assert STARTS.min() >= 0.0
    assert STARTS.max() <= 1.0


def test_an_end_that_is_none_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(analysis, "END_TIME", 1e-3)
    with pytest.raises(RuntimeError, match=r"braking on snow: not at rest after s = 0\.001"):
        analysis.end_points(on(Road.SNOW), times(1.05, K_BAR), STARTS)
