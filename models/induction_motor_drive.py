"""InductionMotorDrive: a wheel's induction motor with field-oriented control, inverter and gear.

Source: B. Gasbaoui, A. Nasri, "A Novel Multi-Drive Electric Vehicle System Control Based on Multi-Input
Multi-Output PID Controller", Serbian Journal of Electrical Engineering 9(2), 2012, which prints the motor's
data and no controller.

    sigma L_s di/dt = u - R_e i - j w sigma L_s i + k_r (1/T_r - j w) psi       stator current [A]   (M1)
    dpsi/dt = L_m/T_r i - psi/T_r                                               rotor flux [Wb]      (M2)
    T = 3/2 p_p k_r Im(conj(psi) i) - f_c W                                     shaft torque [N.m]   (M3)
    L_s = L_m + L_ls,  L_r = L_m + L_lr,  sigma = 1 - L_m^2/(L_s L_r),  k_r = L_m/L_r,  T_r = L_r/R_r,
    R_e = R_s + k_r^2 R_r

Complex numbers are vectors in the frame of the rotor, real along its flux at the start of each step;
amplitudes are peak values. W is the speed of the shaft and w = p_p W its electrical speed [rad/s].

Control, each `inner step`, in the frame of the flux (i_d along psi, i_q across):

    i_d* constant;  i_q* = T*/(3/2 p_p k_r |psi|), limited to sqrt(I_max^2 - i_d*^2)                 (F1)
    u = K (i* - i) + x + j w_s sigma L_s i - k_r (1/T_r - j w) |psi|, limited in amplitude to U_max  (F2)
    x' = (R_e/tau) ((i* - i) + (u_limited - u)/K),   K = sigma L_s/tau                               (F3)
    w_s = w + L_m i_q/(T_r |psi|)                                                                    (F4)

(F2)-(F3) cancel the motor's own dynamics, so that the current follows like 1/(1 + s tau): the one number
`tau` is the bandwidth of both forms. With `ideal` the motor is the lag (I1). The gear is (G1): its losses are
taken from the power whichever way that flows. T* is limited to -+247 N.m.

    tau dT/dt = T* - T,   i_d = i_d*,  i_q from (F1),  u in steady state                             (I1)
    T* = (request at the wheel)/g,  wheel torque = g T,  g = N eta driving, N/eta braking            (G1)

Deviations: f_c is printed as 0.0014, without a unit, and 0 here. Gear and efficiency are part of the drive.

published: 247 N.m, R_r = 0.003, R_s = 0.0044 ohm, L_ls = 16.1, L_m = 482, L_lr = 12.9 uH, 4 poles, gear 10,
efficiency 93 %.
inferred: 2 pairs of poles.
chosen: everything of the control: i_d* = 419 A, I_max = 650 A, U_max = 400 V, tau = 3 ms; the reasons, and
that of f_c = 0: "Derivations" in docs/systems/multi_drive.md.

At the edges: at the start the motor is magnetized and gives the torque of the first `torque_request`.
I_max <= i_d* is refused at the start. With too little voltage the current falls short, without windup; there
is no field weakening. The control knows the flux as (M2) gives it. Phase currents are not shown: at 60 km/h
they have 147 Hz, which no record of 100 Hz can show.

Step: the wheel speed is held, so (M1)-(M2) are linear with constant coefficients in the rotor's frame, and
each inner step of 0.1 ms (or less, a whole number of them in a step) is their exact solution for the held
voltage. Torque, currents and flux are those at the end of the step; `power` is the mean over the step.
"""

from __future__ import annotations

from cmath import cosh, sinh
from cmath import exp as complex_exp
from cmath import sqrt as complex_sqrt
from functools import cached_property
from math import ceil, exp, sqrt

from .base import Model, record, var

INNER_STEP = 1e-4  # s
MAGNETIZING_CURRENT = 419.0  # A
MAGNETIZING_INDUCTANCE = 482e-6  # H, published
STATOR_RESISTANCE = 0.0044  # ohm, published
SMALLEST_FLUX = 1e-3  # Wb: (F1) and (F4) divide by at least this

# Complex numbers meet complex numbers only: what Python makes of `complex * float` depends on its version.
ONE, HALF, QUARTER = complex(1.0, 0.0), complex(0.5, 0.0), complex(0.25, 0.0)


class InductionMotorDrive(Model):
    """Torque request at a wheel and its speed in, torque at the wheel, currents and power out."""

    initial_inputs = ("torque_request", "wheel_speed")

    @record
    class Parameters:
        """Motor, gear and control; the module's docstring marks what is published."""

        ideal: bool = var(False, "", "Whether the motor is the lag (I1); if not, the machine (M1)-(F4)")
        time_constant: float = var(0.003, "s", "Time constant of the torque (tau)", min=2e-4)
        maximum_torque: float = var(247.0, "N.m", "Largest torque at the shaft", min=0.0)
        gear_ratio: float = var(10.0, "1", "Motor speed by wheel speed (N)", min=0.1)
        gear_efficiency: float = var(0.93, "1", "Efficiency of the gear (eta)", min=0.01, max=1.0)
        stator_resistance: float = var(STATOR_RESISTANCE, "ohm", "R_s", min=1e-6)
        rotor_resistance: float = var(0.003, "ohm", "R_r", min=1e-6)
        stator_leakage: float = var(16.1e-6, "H", "Leakage inductance of the stator (L_ls)", min=1e-9)
        rotor_leakage: float = var(12.9e-6, "H", "Leakage inductance of the rotor (L_lr)", min=1e-9)
        magnetizing_inductance: float = var(MAGNETIZING_INDUCTANCE, "H", "L_m", min=1e-7)
        pole_pairs: int = var(2, "", "Pairs of poles (p_p)", min=1, max=100)
        friction: float = var(0.0, "N.m.s/rad", "Viscous friction of the motor (f_c)", min=0.0)
        magnetizing_current: float = var(MAGNETIZING_CURRENT, "A", "Current along the flux (i_d*)", min=1.0)
        current_limit: float = var(650.0, "A", "Largest amplitude of the current (I_max)", min=1.0)
        voltage_limit: float = var(400.0, "V", "Largest amplitude of the voltage (U_max)", min=1.0)

        @cached_property
        def machine(self) -> Machine:
            """Numbers that (M1)-(F4) compute from these parameters."""
            return Machine(self)

    @record
    class Inputs:
        """The torque request and the speed of the shaft."""

        torque_request: float = var(0.0, "N.m", "Torque asked for at the wheel", nominal=1000.0)
        wheel_speed: float = var(0.0, "rad/s", "Speed of the wheel", nominal=10.0)

    @record
    class State:
        """Currents and flux in the frame of the flux, integrals of the control, results of the step."""

        current_d: float = var(0.0, "A", "Current along the flux (i_d)")
        current_q: float = var(0.0, "A", "Current across the flux (i_q)")
        flux: float = var(0.0, "Wb", "Rotor flux (|psi|)")
        integral_d: float = var(0.0, "V", "Integral of the control along the flux (x)")
        integral_q: float = var(0.0, "V", "Integral of the control across the flux (x)")
        motor_torque: float = var(0.0, "N.m", "Torque at the shaft (T)")
        torque: float = var(0.0, "N.m", "Torque at the wheel")
        power: float = var(0.0, "W", "Mean electrical power over the step")
        voltage: float = var(0.0, "V", "Amplitude of the voltage")

    @record
    class Outputs:
        """The torque, the electrical quantities and the power of the drive."""

        torque: float = var(0.0, "N.m", "Torque at the wheel", nominal=1000.0)
        motor_torque: float = var(0.0, "N.m", "Torque at the shaft (T)", nominal=100.0)
        current_d: float = var(MAGNETIZING_CURRENT, "A", "Current along the flux (i_d)", nominal=100.0)
        current_q: float = var(0.0, "A", "Current across the flux (i_q)", nominal=100.0)
        current: float = var(
            MAGNETIZING_CURRENT * sqrt(0.5), "A", "Effective value of a phase current", nominal=100.0, min=0.0
        )
        flux: float = var(MAGNETIZING_INDUCTANCE * MAGNETIZING_CURRENT, "Wb", "Rotor flux (|psi|)", min=0.0)
        voltage: float = var(
            STATOR_RESISTANCE * MAGNETIZING_CURRENT,
            "V",
            "Amplitude of the voltage",
            nominal=100.0,
            min=0.0,
        )
        power: float = var(
            1.5 * (STATOR_RESISTANCE * MAGNETIZING_CURRENT) * MAGNETIZING_CURRENT,
            "W",
            "Electrical power of the motor, mean over the last step",
            nominal=10000.0,
        )

    @staticmethod
    def initial(
        p: InductionMotorDrive.Parameters, u: InductionMotorDrive.Inputs
    ) -> InductionMotorDrive.State:
        """Return a magnetized motor with the requested torque. Raises ValueError for contradicting limits."""
        if p.current_limit <= p.magnetizing_current:
            raise ValueError(
                f"current_limit = {p.current_limit} A leaves no current for a torque: it must be above "
                f"magnetizing_current = {p.magnetizing_current} A"
            )
        return _steady(p, _motor_request(p, u), u.wheel_speed)

    @staticmethod
    def step(
        p: InductionMotorDrive.Parameters,
        x: InductionMotorDrive.State,
        u: InductionMotorDrive.Inputs,
        dt: float,
    ) -> InductionMotorDrive.State:
        """Return the state after `dt` [s] of held inputs."""
        if p.ideal:
            wanted = _motor_request(p, u)
            torque = wanted + (x.motor_torque - wanted) * exp(-dt / p.time_constant)  # (I1)
            return _steady(p, torque, u.wheel_speed)
        return _machine_step(p, x, u, dt)

    @staticmethod
    def outputs(
        p: InductionMotorDrive.Parameters, x: InductionMotorDrive.State
    ) -> InductionMotorDrive.Outputs:
        """Return the results of the last step."""
        current = sqrt(0.5 * (x.current_d * x.current_d + x.current_q * x.current_q))
        return InductionMotorDrive.Outputs(
            x.torque, x.motor_torque, x.current_d, x.current_q, current, x.flux, x.voltage, x.power
        )


class Machine:
    """Numbers that (M1)-(F4) need, computed from the parameters."""

    def __init__(self, p: InductionMotorDrive.Parameters) -> None:
        l_m = p.magnetizing_inductance
        l_s, l_r = l_m + p.stator_leakage, l_m + p.rotor_leakage
        self.leakage = l_s - l_m * l_m / l_r  # sigma L_s [H]
        self.ratio = l_m / l_r  # k_r
        self.rotor_rate = p.rotor_resistance / l_r  # 1/T_r [1/s]
        self.resistance = p.stator_resistance + self.ratio**2 * p.rotor_resistance  # R_e [ohm]
        self.coupling = l_m * self.rotor_rate  # L_m/T_r [ohm]
        self.torque_factor = 1.5 * p.pole_pairs * self.ratio  # [1]: torque by flux and i_q
        self.current_q_limit = sqrt(p.current_limit**2 - p.magnetizing_current**2)
        by_current = self.torque_factor * l_m * p.magnetizing_current * self.current_q_limit
        self.torque_limit = min(p.maximum_torque, by_current)  # [N.m]

    def advance(self, w: float, h: float) -> tuple[complex, complex, complex, complex, complex, complex]:
        """Return the exact solution of (M1)-(M2) over h [s] at the electrical speed w [rad/s].

        It is exp(A h), row by row, and then the response of current and flux to 1 V.
        """
        a_11 = complex(-self.resistance / self.leakage, -w)
        a_12 = complex(self.rotor_rate, -w) * complex(self.ratio / self.leakage, 0.0)
        a_21, a_22 = complex(self.coupling, 0.0), complex(-self.rotor_rate, 0.0)
        mean, difference, step = HALF * (a_11 + a_22), a_11 - a_22, complex(h, 0.0)
        root = complex_sqrt(QUARTER * (difference * difference) + a_12 * a_21)
        decay = complex_exp(mean * step)
        even = decay * cosh(root * step)
        odd = decay * (sinh(root * step) / root if abs(root) > 0.0 else step)
        m_11, m_22 = even + odd * (a_11 - mean), even + odd * (a_22 - mean)
        m_12, m_21 = odd * a_12, odd * a_21
        # inv(A) (exp(A h) - 1) [1/leakage, 0]; det A is not 0, because R_s is not
        determinant = (a_11 * a_22 - a_12 * a_21) * complex(self.leakage, 0.0)
        g_1 = (a_22 * (m_11 - ONE) - a_12 * m_21) / determinant
        g_2 = (a_11 * m_21 - a_21 * (m_11 - ONE)) / determinant
        return m_11, m_12, m_21, m_22, g_1, g_2


def _motor_request(p: InductionMotorDrive.Parameters, u: InductionMotorDrive.Inputs) -> float:
    """Return T* [N.m], the request at the wheel through the gear, within the limits of torque and current."""
    wanted = u.torque_request / _gear(p, u.torque_request, u.wheel_speed)  # (G1)
    limit = p.machine.torque_limit
    return limit if wanted > limit else -limit if wanted < -limit else wanted


def _gear(p: InductionMotorDrive.Parameters, torque: float, speed: float) -> float:
    """Return g of (G1), wheel torque by motor torque [1]: the gear loses power whichever way it flows."""
    return p.gear_ratio * (p.gear_efficiency if torque * speed >= 0.0 else 1.0 / p.gear_efficiency)


def _steady(
    p: InductionMotorDrive.Parameters, torque: float, wheel_speed: float
) -> InductionMotorDrive.State:
    """Return the steady state of (M1)-(F4) with a torque [N.m] at the shaft."""
    k = p.machine
    shaft = wheel_speed * p.gear_ratio
    w = shaft * p.pole_pairs
    i_d = p.magnetizing_current
    flux = p.magnetizing_inductance * i_d
    i_q = (torque + p.friction * shaft) / (k.torque_factor * flux)
    w_s = w + k.coupling * i_q / flux  # (F4)
    i = complex(i_d, i_q)
    linked = complex(k.leakage, 0.0) * i + complex(k.ratio * flux, 0.0)
    u = complex(p.stator_resistance, 0.0) * i + complex(0.0, w_s) * linked
    power = 1.5 * (u.real * i_d + u.imag * i_q)
    at_wheel = _gear(p, torque, wheel_speed) * torque  # (G1)
    return InductionMotorDrive.State(
        i_d, i_q, flux, k.resistance * i_d, k.resistance * i_q, torque, at_wheel, power, abs(u)
    )


def _machine_step(
    p: InductionMotorDrive.Parameters,
    x: InductionMotorDrive.State,
    u: InductionMotorDrive.Inputs,
    dt: float,
) -> InductionMotorDrive.State:
    """Return the state after `dt` [s]: (F1)-(F4), then the exact (M1)-(M2), inner step after inner step."""
    k = p.machine
    n = max(1, ceil(dt / INNER_STEP - 1e-9))
    h = dt / n
    shaft = u.wheel_speed * p.gear_ratio
    w = shaft * p.pole_pairs
    m_11, m_12, m_21, m_22, g_1, g_2 = k.advance(w, h)
    wanted = (_motor_request(p, u) + p.friction * shaft) / k.torque_factor
    gain = complex(k.leakage / p.time_constant, 0.0)
    step_gain = complex(h * k.resistance / p.time_constant, 0.0)
    leakage, coupling, back = k.leakage, k.coupling, complex(-k.ratio, 0.0) * complex(k.rotor_rate, -w)
    i_d, i_q_limit, u_max = p.magnetizing_current, k.current_q_limit, p.voltage_limit

    current, flux = complex(x.current_d, x.current_q), complex(x.flux, 0.0)
    held = complex(x.integral_d, x.integral_q)
    energy = 0.0
    amplitude = x.voltage
    for _ in range(n):
        size = abs(flux)
        if size < SMALLEST_FLUX:
            size = SMALLEST_FLUX
        whole = complex(size, 0.0)
        axis = flux / whole
        i = current * axis.conjugate()
        i_q = wanted / size  # (F1)
        if i_q > i_q_limit:
            i_q = i_q_limit
        elif i_q < -i_q_limit:
            i_q = -i_q_limit
        error = complex(i_d, i_q) - i
        w_s = w + coupling * i.imag / size  # (F4)
        voltage = gain * error + held + complex(0.0, w_s * leakage) * i + back * whole  # (F2)
        amplitude = abs(voltage)
        if amplitude > u_max:
            limited = voltage * complex(u_max / amplitude, 0.0)
            error += (limited - voltage) / gain
            voltage, amplitude = limited, u_max
        held += step_gain * error  # (F3)
        voltage *= axis
        before = current
        current = m_11 * current + m_12 * flux + g_1 * voltage  # (M1)
        flux = m_21 * before + m_22 * flux + g_2 * voltage  # (M2)
        mean = before + current
        energy += voltage.real * mean.real + voltage.imag * mean.imag
    size = abs(flux)
    i = current * flux.conjugate() / complex(size, 0.0) if size > 0.0 else current
    torque = k.torque_factor * size * i.imag - p.friction * shaft  # (M3)
    at_wheel = _gear(p, torque, u.wheel_speed) * torque  # (G1)
    power = 1.5 * 0.5 * energy / n
    return InductionMotorDrive.State(
        i.real, i.imag, size, held.real, held.imag, torque, at_wheel, power, amplitude
    )
