"""Battery: an open-circuit voltage behind a resistance, discharged by a power.

Source: chosen. Dardanelli et al. (IEEE CDC-ECC 2011) measure charge, current and voltage and give no model.

    U   = U_0 + U_1 xi                                  open-circuit voltage [V]                  (B1)
    A   = min(U^2/(4 R_0), (U - R_0 i_e) i_e)           largest power of the terminals [W]       (B2a)
    P_d = min(max(P, -P_c), A)                          power delivered at the terminals [W]      (B2)
    i   = (U - sqrt(U^2 - 4 R_0 P_d))/(2 R_0)           current of P_d = (U - R_0 i) i [A]        (B3)
    xi' = -i/(3600 Q)                                   state of charge [1], Q in A.h             (B4)
    E'  = P_d/3600                                      energy delivered at the terminals [Wh]    (B5)
    L'  = R_0 i^2/3600                                  energy lost in the resistance [Wh]        (B6)

i_e = 3600 Q xi/dt is the current that uses up the charge in a step as long as the last one; before the first
step, and where i_e > U/(2 R_0), A is U^2/(4 R_0). At xi = 0 it is 0. So a load that keeps to A gets all that
it takes, down to the last step. A depends on the state alone: a vehicle that is connected to it sees, in the
step from t_k on, the A of the charge at t_k, and no loop arises.

P_c is `charge_limit`, the largest power that charges the battery; at 0 there is no regeneration. While it is
charged, P_d, i and E' are negative. The energy drawn from the cells is E + L; a vehicle's consumption is
counted with it. Current and voltage follow the power at the same instant (direct feedthrough). The code
computes (B3) as i = 2 P_d/(U + sqrt(...)), the same root without the difference of two near numbers.

published: nothing.
chosen: U_0 = 46 V, U_1 = 8 V, R_0 = 0.06 ohm, Q = 40 A.h, P_c = 0, xi = 1 at the start.

At the edges: a power above A counts as A, one below -P_c as -P_c. Where the charge does not last for a step,
as for one longer than the last, the current flows for the part of it that it does: the energy that the
charge gives up, U i, is E + L in every step. An empty battery (xi = 0) delivers nothing: i = 0, and E and L
stay as they are. A full one (xi = 1) is charged no more. It says in the log that it is empty, is asked for
more than A, or, where P_c is not 0, is charged with more than it takes.

Step: explicit Euler, order 1 in dt, with the current of the start of the step held over it. In 10 ms at full
power xi falls by 1e-5, which changes the current by 2e-6 of itself.
"""

from __future__ import annotations

from math import sqrt

from .base import Model, record, var
from .constants import HOUR

EMPTY = 1e-12  # of the charge that a step uses up: what is less than that is rounding


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
        charge_limit: float = var(0.0, "W", "Largest power that charges it (P_c)", min=0.0, nominal=1000.0)

    @record
    class Inputs:
        """The power that the vehicle draws."""

        power: float = var(0.0, "W", "Power drawn at the terminals; negative charges", nominal=1000.0)

    @record
    class State:
        """The charge that is left, and the energy delivered and lost."""

        state_of_charge: float = var(1.0, "1", "State of charge", min=0.0, max=1.0)
        energy: float = var(0.0, "Wh", "Energy delivered at the terminals, less what charged it")
        loss: float = var(0.0, "Wh", "Energy lost in the internal resistance", min=0.0)
        step_size: float = var(0.0, "s", "Length of the last step, 0 before the first", min=0.0)

    @record
    class Outputs:
        """The values that a battery management system reports."""

        state_of_charge: float = var(1.0, "1", "State of charge", min=0.0, max=1.0)
        current: float = var(0.0, "A", "Discharge current", nominal=50.0, depends=("power",))
        voltage: float = var(54.0, "V", "Voltage at the terminals", min=0.0, nominal=50.0, depends=("power",))
        energy: float = var(0.0, "Wh", "Energy delivered, less what charged it", nominal=100.0)
        energy_drawn: float = var(0.0, "Wh", "Energy drawn from the cells", nominal=100.0)
        available_power: float = var(
            12150.0, "W", "Largest power that the terminals can deliver", min=0.0, nominal=10000.0
        )

    @staticmethod
    def initial(p: Battery.Parameters, u: Battery.Inputs) -> Battery.State:
        """Return a battery charged to `initial_state_of_charge` that has delivered nothing."""
        return Battery.State(p.initial_state_of_charge, 0.0, 0.0, 0.0)

    @staticmethod
    def step(p: Battery.Parameters, x: Battery.State, u: Battery.Inputs, dt: float) -> Battery.State:
        """Return the state after `dt` [s] of the held power."""
        _, i, power = _draw(p, x, u)
        capacity = HOUR * p.capacity
        xi, flows = x.state_of_charge - dt * i / capacity, dt  # (B4)
        if xi <= EMPTY * x.state_of_charge:  # empty at the end of the step, or before it
            xi, flows = 0.0, min(dt, capacity * x.state_of_charge / i) if i > 0.0 else 0.0
        elif xi > 1.0:  # full before the end of the step
            xi, flows = 1.0, capacity * (1.0 - x.state_of_charge) / -i
        energy = x.energy + flows * power / HOUR  # (B5)
        return Battery.State(xi, energy, x.loss + flows * p.resistance * i * i / HOUR, dt)  # (B6)

    @staticmethod
    def outputs(p: Battery.Parameters, x: Battery.State, u: Battery.Inputs) -> Battery.Outputs:
        """Return current and voltage at the power of this instant."""
        ocv, i, _ = _draw(p, x, u)
        voltage = ocv - p.resistance * i
        available = available_power(p, x)
        return Battery.Outputs(x.state_of_charge, i, voltage, x.energy, x.energy + x.loss, available)

    @staticmethod
    def notice(p: Battery.Parameters, before: Battery.State, after: Battery.State, u: Battery.Inputs) -> str:
        """Return a sentence when the battery is empty, or is asked for more than it can deliver."""
        if p.charge_limit > 0.0 and u.power < 0.0:
            if u.power < -p.charge_limit or after.state_of_charge >= 1.0:
                return "the battery is charged with more power than it takes: the rest is lost"
            return ""
        if after.state_of_charge <= 0.0:
            return "the battery is empty: it delivers nothing any more"
        if u.power > available_power(p, before):
            return "the battery is asked for more power than it can deliver: it delivers the largest"
        return ""


def available_power(p: Battery.Parameters, x: Battery.State) -> float:
    """Return the largest power [W] that the terminals can deliver in a step as long as the last one."""
    if x.state_of_charge <= 0.0:
        return 0.0
    ocv = _open_circuit_voltage(p, x)
    if x.step_size > 0.0:
        i = HOUR * p.capacity * x.state_of_charge / x.step_size
        if 2.0 * p.resistance * i < ocv:
            return (ocv - p.resistance * i) * i  # (B2a)
    return ocv * ocv / (4.0 * p.resistance)


def _open_circuit_voltage(p: Battery.Parameters, x: Battery.State) -> float:
    return p.empty_voltage + p.voltage_rise * x.state_of_charge  # (B1)


def _draw(p: Battery.Parameters, x: Battery.State, u: Battery.Inputs) -> tuple[float, float, float]:
    """Return open-circuit voltage [V], current [A] and delivered power [W]."""
    ocv = _open_circuit_voltage(p, x)
    if u.power <= 0.0:
        power = max(u.power, -p.charge_limit) if x.state_of_charge < 1.0 else 0.0  # (B2)
    else:
        power = min(u.power, available_power(p, x)) if x.state_of_charge > 0.0 else 0.0
    if power == 0.0:
        return ocv, 0.0, 0.0
    # At the limit of (B2) the radicand is zero up to rounding, which must not make it negative.
    root = sqrt(max(0.0, ocv * ocv - 4.0 * p.resistance * power))
    return ocv, 2.0 * power / (ocv + root), power  # (B3)
