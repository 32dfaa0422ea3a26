"""The springs of the detailed two-wheeler: the frame, the balance of power, the bound of the rates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.models.constants import GRAVITY
from evcosim.models.detailed_two_wheeler import DetailedTwoWheeler
from evcosim.models.two_wheeler_ride import (
    Ride,
    RideRates,
    between,
    fastest_rate,
    frame,
    moved,
    suspension,
    travel,
)

P = DetailedTwoWheeler.Parameters()
REST: Ride = (0.0,) * 8
small = st.floats(-2e-3, 2e-3)  # m, so that the tires stay on the road
rates = st.floats(-0.3, 0.3)
rides = st.tuples(small, small, small, small, rates, rates, rates, rates)


def test_the_frame_and_the_wheels_are_the_whole_vehicle() -> None:
    """Mass, height and distances of the center of mass come back from the parts."""
    k, unsprung = P.frame, P.front_unsprung_mass + P.rear_unsprung_mass
    assert k.mass + unsprung == pytest.approx(P.mass)
    assert k.front + k.rear == pytest.approx(P.wheelbase)
    height = k.mass * (k.above + P.wheel_radius) + unsprung * P.wheel_radius
    assert height == pytest.approx(P.mass * P.center_height)
    rear_of_front_axle = k.mass * k.front + P.rear_unsprung_mass * P.wheelbase
    assert rear_of_front_axle == pytest.approx(P.mass * P.front_distance)


def test_wheels_that_are_all_that_an_axle_carries_are_refused() -> None:
    with pytest.raises(
        ValueError, match=r"masses of 60\.0 and 5\.0 kg leave no sprung mass .* carry 50 and 50"
    ):
        frame(100.0, 0.5, 0.25, 1.3, (50.0, 50.0), (60.0, 5.0))


def test_nothing_moves_at_rest() -> None:
    up, moment, up_f, up_r, load_f, load_r = suspension(P.springs, P.frame)(REST)
    assert up == moment == up_f == up_r == 0.0
    assert (load_f, load_r) == (P.front_weight, P.rear_weight)
    assert travel(P.frame, REST) == (0.0, 0.0)


@given(rides)
def test_springs_store_what_goes_in_and_dampers_only_take(ride: Ride) -> None:
    """(R1)-(R5): what masses, springs and pitch gain, the dampers lose."""
    _, _, z_f, z_r, dz, dphi, dz_f, dz_r = ride
    up, moment, up_f, up_r, _, _ = suspension(P.springs, P.frame)(ride)
    (x_f, x_r), (v_f, v_r) = travel(P.frame, ride), travel(P.frame, (*ride[4:], 0.0, 0.0, 0.0, 0.0))
    inertial = (
        P.frame.mass * dz * up + P.front_unsprung_mass * dz_f * up_f + P.rear_unsprung_mass * dz_r * up_r
    )
    stored = P.front_stiffness * x_f * v_f + P.rear_stiffness * x_r * v_r
    stored += P.tire_stiffness * (z_f * dz_f + z_r * dz_r)
    lost = P.front_damping * v_f**2 + P.rear_damping * v_r**2 + P.tire_damping * (dz_f**2 + dz_r**2)
    assert inertial + moment * dphi + stored == pytest.approx(-lost, abs=1e-9)


def test_a_tire_in_the_air_carries_nothing() -> None:
    lifted: Ride = (0.1, 0.0, 0.1, 0.1, 0.0, 0.0, 0.0, 0.0)
    up, _, up_f, up_r, load_f, load_r = suspension(P.springs, P.frame)(lifted)
    assert load_f == load_r == 0.0
    assert up == 0.0  # the suspension still holds the weight, which pushes the wheels down
    assert P.front_unsprung_mass * up_f == pytest.approx(-P.front_weight)
    assert P.rear_unsprung_mass * up_r == pytest.approx(-P.rear_weight)


@pytest.mark.parametrize(
    "p",
    [P, replace(P, front_stiffness=1e6), replace(P, tire_damping=1e4), replace(P, pitch_inertia=1.0)],
    ids=["nominal", "stiff", "damped", "light"],
)
def test_no_rate_is_above_the_bound(p: DetailedTwoWheeler.Parameters) -> None:
    """The eigenvalues of the linear ride, from its columns."""
    suspend, inertia = suspension(p.springs, p.frame), p.pitch_inertia

    def derivative(ride: Ride) -> np.ndarray:
        up, moment, up_f, up_r, _, _ = suspend(ride)
        return np.array([*ride[4:], up, moment / inertia, up_f, up_r])

    size = 1e-6
    columns = [derivative(tuple(size * row)) / size for row in np.eye(8)]  # type: ignore[arg-type]  # 8 numbers
    fastest = float(np.abs(np.linalg.eigvals(np.array(columns).T)).max())
    bound = fastest_rate(p.springs, p.frame, inertia)
    assert fastest <= bound <= 4.0 * fastest


def test_moved_and_between() -> None:
    ride: Ride = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)
    there = moved(ride, RideRates(1.0, 1.0, 1.0, 2.0), 0.5)
    assert there == (3.5, 5.0, 6.5, 8.0, 5.5, 6.5, 7.5, 9.0)
    assert between(ride, there, 0.0) == ride
    assert between(ride, there, 1.0) == there
    assert between(ride, there, 0.5)[0] == 2.25


def test_the_weight_is_that_of_the_vehicle() -> None:
    assert P.springs.front_weight + P.springs.rear_weight == pytest.approx(P.mass * GRAVITY)
