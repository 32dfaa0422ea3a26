"""Battery: an open-circuit voltage behind a resistance, discharged by a power.

Source: chosen. Dardanelli et al. (IEEE CDC-ECC 2011) measure charge, current and voltage and give no model.

    U   = U_0 + U_1 xi                                  open-circuit voltage [V]                  (B1)
    P_d = min(max(P, 0), U^2/(4 R_0))                   power that the terminals can deliver [W]  (B2)
    i   = (U - sqrt(U^2 - 4 R_0 P_d))/(2 R_0)           current of P_d = (U - R_0 i) i [A]        (B3)
    xi' = -i/(3600 Q)                                   state of charge [1], Q in A.h             (B4)
    E'  = P_d/3600                                      energy delivered at the terminals [Wh]    (B5)
    L'  = R_0 i^2/3600                                  energy lost in the resistance [Wh]        (B6)

The energy drawn from the cells is E + L; a vehicle's consumption is counted with it. Current and voltage
follow the power at the same instant (direct feedthrough). The code computes (B3) as i = 2 P_d/(U +
sqrt(...)), the same root without the difference of two near numbers.

published: nothing.
chosen: U_0 = 46 V, U_1 = 8 V, R_0 = 0.06 ohm, Q = 40 A.h.

At the edges: a negative power draws nothing (no regeneration). A power above U^2/(4 R_0) counts as that. An
empty battery (xi = 0) delivers nothing: i = 0, and E and L stay as they are.

Step: explicit Euler, order 1 in dt, with the current of the start of the step held over it. In 10 ms at full
power xi falls by 1e-5, which changes the current by 2e-6 of itself.
"""

from __future__ import annotations

from math import sqrt

from .base import Model, record, var
from .constants import HOUR


class Battery(Model):
    """State of charge, current and voltage of a battery that delivers `power` at its terminals."""

    @record
    class Parameters:
        """Cell data, all chosen."""

        empty_voltage: float = var(46.0, "V", "Open-circuit voltage at state of charge 0", min=1.0)
        voltage_rise: float = var(8.0, "V", "Rise of the open-circuit voltage from empty to full", min=0.0)
        resistance: float = var(0.06, "ohm", "Internal resistance", min=1e-6)
        capacity: float = var(40.0, "A.h", "Charge from full to empty", min=1e-3)
        initial_state_of_charge: float = var(1.0, "1", "State of charge at the start", min=0.0, max=1.0)

    @record
    class Inputs:
        """The power that the vehicle draws."""

        power: float = var(0.0, "W", "Electrical power drawn at the terminals", nominal=1000.0)

    @record
    class State:
        """The charge that is left, and the energy delivered and lost."""

        state_of_charge: float = var(1.0, "1", "State of charge", min=0.0, max=1.0)
        energy: float = var(0.0, "Wh", "Energy delivered at the terminals", min=0.0)
        loss: float = var(0.0, "Wh", "Energy lost in the internal resistance", min=0.0)

    @record
    class Outputs:
        """The values that a battery management system reports."""

        state_of_charge: float = var(1.0, "1", "State of charge", min=0.0, max=1.0)
        current: float = var(0.0, "A", "Discharge current", min=0.0, nominal=50.0, depends=("power",))
        voltage: float = var(54.0, "V", "Voltage at the terminals", min=0.0, nominal=50.0, depends=("power",))
        energy: float = var(0.0, "Wh", "Energy delivered at the terminals", min=0.0, nominal=100.0)
        energy_drawn: float = var(0.0, "Wh", "Energy drawn from the cells", min=0.0, nominal=100.0)

    @staticmethod
    def initial(p: Battery.Parameters, u: Battery.Inputs) -> Battery.State:
        """Return a battery charged to `initial_state_of_charge` that has delivered nothing."""
        return Battery.State(p.initial_state_of_charge, 0.0, 0.0)

    @staticmethod
    def step(p: Battery.Parameters, x: Battery.State, u: Battery.Inputs, dt: float) -> Battery.State:
        """Return the state after `dt` [s] of the held power."""
        _, i, power = _draw(p, x, u)
        xi = max(0.0, x.state_of_charge - dt * i / (HOUR * p.capacity))  # (B4)
        energy = x.energy + dt * power / HOUR  # (B5)
        return Battery.State(xi, energy, x.loss + dt * p.resistance * i * i / HOUR)  # (B6)

    @staticmethod
    def outputs(p: Battery.Parameters, x: Battery.State, u: Battery.Inputs) -> Battery.Outputs:
        """Return current and voltage at the power of this instant."""
        ocv, i, _ = _draw(p, x, u)
        voltage = ocv - p.resistance * i
        return Battery.Outputs(x.state_of_charge, i, voltage, x.energy, x.energy + x.loss)


def _draw(p: Battery.Parameters, x: Battery.State, u: Battery.Inputs) -> tuple[float, float, float]:
    """Return open-circuit voltage [V], current [A] and delivered power [W]."""
    ocv = p.empty_voltage + p.voltage_rise * x.state_of_charge  # (B1)
    if u.power <= 0.0 or x.state_of_charge <= 0.0:
        return ocv, 0.0, 0.0
    power = min(u.power, ocv * ocv / (4.0 * p.resistance))  # (B2)
    # At the limit of (B2) the radicand is zero up to rounding, which must not make it negative.
    root = sqrt(max(0.0, ocv * ocv - 4.0 * p.resistance * power))
    return ocv, 2.0 * power / (ocv + root), power  # (B3)
