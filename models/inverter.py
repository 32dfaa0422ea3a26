"""Inverter: the loss between a battery and two motors.

Source: chosen. Gasbaoui and Nasri (SJEE 9(2), 2012) draw batteries and inverters in their Fig. 2 and give no
model. A bridge of transistors for each motor i = 1, 2 (left, right), I_i its effective phase current [A]:

    P_l = sum of (P_0 + k_1 I_i + R_i I_i^2)          loss: gates, switching, resistance [W]          (I1)
    P   = P_1 + P_2 + P_l                             power of the battery [W]                        (I2)
    eta = (P_1 + P_2)/P,  P/(P_1 + P_2) where P < 0   efficiency, whichever way the power flows [1]   (I3)
    E_m' = (P_1 + P_2)/3600,   L' = P_l/3600          energies of motors and loss [Wh]                (I4)

P_i is the electrical power of a motor, negative where it brakes; P is then what comes back. By (I2) what the
battery delivers is E_m + L.

published: nothing.
chosen: P_0 = 60 W, k_1 = 3.5 W/A, R_i = 4.5 mohm: 2 % of 114 kW at 419 A.

At the edges: a motor that takes less than its bridge loses has no efficiency (0), neither way.

Step: explicit Euler with the powers of the start of the step, which in `gauss_seidel` are the means over the
step that the drives have just made.
"""

from __future__ import annotations

from .base import Model, record, var
from .constants import HOUR


class Inverter(Model):
    """Power and current of two motors in, power of the battery out."""

    @record
    class Parameters:
        """Loss of one bridge; all chosen."""

        idle_loss: float = var(60.0, "W", "Loss without current (P_0)", min=0.0)
        current_loss: float = var(3.5, "W/A", "Loss by effective current (k_1)", min=0.0)
        resistance: float = var(0.0045, "ohm", "Loss by its square (R_i)", min=0.0)

    @record
    class Inputs:
        """The motors."""

        left_power: float = var(0.0, "W", "Electrical power of the left motor (P_1)", nominal=10000.0)
        right_power: float = var(0.0, "W", "Electrical power of the right motor (P_2)", nominal=10000.0)
        left_current: float = var(0.0, "A", "Effective phase current of the left motor (I_1)", nominal=100.0)
        right_current: float = var(
            0.0, "A", "Effective phase current of the right motor (I_2)", nominal=100.0
        )

    @record
    class State:
        """The energies."""

        motor_energy: float = var(0.0, "Wh", "Energy of the motors (E_m)")
        loss_energy: float = var(0.0, "Wh", "Energy lost (L)", min=0.0)

    @record
    class Outputs:
        """Power, loss and energies."""

        power: float = var(
            120.0,
            "W",
            "Power drawn from the battery (P); negative charges it",
            nominal=10000.0,
            depends=("left_power", "right_power", "left_current", "right_current"),
        )
        loss: float = var(
            120.0, "W", "Loss (P_l)", min=0.0, nominal=1000.0, depends=("left_current", "right_current")
        )
        efficiency: float = var(
            0.0,
            "1",
            "Efficiency (eta), whichever way the power flows",
            min=0.0,
            max=1.0,
            depends=("left_power", "right_power", "left_current", "right_current"),
        )
        motor_energy: float = var(0.0, "Wh", "Energy of the motors (E_m)", nominal=100.0)
        loss_energy: float = var(0.0, "Wh", "Energy lost (L)", min=0.0, nominal=10.0)

    @staticmethod
    def initial(p: Inverter.Parameters, u: Inverter.Inputs) -> Inverter.State:
        """Return empty energies."""
        return Inverter.State()

    @staticmethod
    def step(p: Inverter.Parameters, x: Inverter.State, u: Inverter.Inputs, dt: float) -> Inverter.State:
        """Return the energies after `dt` [s] of the held powers."""
        hours = dt / HOUR
        return Inverter.State(
            x.motor_energy + hours * (u.left_power + u.right_power), x.loss_energy + hours * loss(p, u)
        )  # (I4)

    @staticmethod
    def outputs(p: Inverter.Parameters, x: Inverter.State, u: Inverter.Inputs) -> Inverter.Outputs:
        """Return the power at this instant, and the energies."""
        lost, motors = loss(p, u), u.left_power + u.right_power
        power = motors + lost  # (I2)
        efficiency = 0.0
        if motors > 0.0:
            efficiency = motors / power  # (I3)
        elif power < 0.0:
            efficiency = power / motors
        return Inverter.Outputs(power, lost, efficiency, x.motor_energy, x.loss_energy)


def loss(p: Inverter.Parameters, u: Inverter.Inputs) -> float:
    """Return P_l [W]."""
    return _bridge_loss(p, abs(u.left_current)) + _bridge_loss(p, abs(u.right_current))  # (I1)


def _bridge_loss(p: Inverter.Parameters, i: float) -> float:
    """Return the loss [W] of one bridge at an effective phase current i >= 0 [A]."""
    return p.idle_loss + p.current_loss * i + p.resistance * i * i
