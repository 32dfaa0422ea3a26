"""TwoMotorVehicle: a car with two independently driven rear wheels, on a slope and in a curve.

Source: B. Gasbaoui, A. Nasri, "A Novel Multi-Drive Electric Vehicle System Control Based on Multi-Input
Multi-Output PID Controller", Serbian Journal of Electrical Engineering 9(2), 2012. Index 1 is the left wheel.

    T_aero = 1/2 rho A C_x R^3 w^2                             air [N.m]                           (2)
    T_slope = M g R sin(a)                                     slope [N.m]                         (3)
    T_tire = M g R f_v cos(a)                                  rolling [N.m]                       (4)
    T_res  = T_aero + T_slope + T_tire                         resistance at the wheels [N.m]      (5)
    J_e dw_i/dt = T_i - R F_i                                  wheels, w in rad/s                 (V1)
    F_i  = F_z mu(s_i),   F_z = M g cos(a)/4                   force of a tire [N]                (V2)
    mu(s) = th_1 (1 - exp(-th_2 s)) - th_3 s for s >= 0        odd in s; see `road_friction` [1]  (V3)
    s_i  = (w_i R - v_i)/max(|v_i|, |w_i R|, 0.5 m/s)          slip [1]                           (V4)
    v_1,2 = v (1 -+ (d_w/2) tan(d)/L)                          `turn_geometry` [m/s]              (V5)
    M dv/dt = F_1 + F_2 - T_res/R                              car [N]                            (V6)

Deviations: (3) and (4) are printed without R; cos(a) in (4) is ours. The paper has one wheel without slip,
(1) T_in = J_v dw_v/dt; (V1)-(V6) replace it, so that the two drives can disagree. Table 1 of the paper swaps
the labels of L and d_w. f_e = 0.001, which the paper lists without an equation, is not used.

published: M = 3904 kg, J_e = 7.07 kg.m2, R = 0.36 m, A = 3.48 m2, C_x = K_d = 0.46, f_v = 0.01, L = 2.5 m,
d_w = 1.5 m.
chosen: rho = 1.2 kg/m3, (V1)-(V6), a quarter of the weight on each rear wheel, dry asphalt (th_1 = 1.2801,
th_2 = 23.99, th_3 = 0.52), g = 9.81 m/s2, the stop of the steering, 45 deg. The paper's 93.2 N.m of air at
60 km/h would need rho = 1.164 kg/m3.

At the edges: below 0.1 m/s rolling resistance is in proportion to the speed, so that it stops the car and
does not push it backward; on a slope the car rolls back. Angles of the steering beyond its stop count as the
stop. Beyond a slip of 100 % a tire has the friction of 100 %.

Step: Heun's rule, order 2, with torques held over the step and inner steps h as short as the rate of the
slip needs, h lambda <= 0.6: 6 of them for 10 ms at 60 km/h, 177 at a standstill ("Derivations" in
docs/systems/multi_drive.md).
"""

from __future__ import annotations

from functools import cached_property
from math import ceil, cos, exp, expm1, pi, sin

from .base import Model, record, var
from .constants import AIR_DENSITY, GRAVITY
from .road_friction import FRICTION, Road
from .turn_geometry import check_steering, wheel_ratios

ASPHALT = FRICTION[Road.DRY]
SLIP_SPEED = 0.5  # m/s: slip is measured against at least this speed
ROLLING_SPEED = 0.1  # m/s, from which on rolling resistance is complete
RATE_STEP = 0.6  # largest inner step times the wheel's rate
RATE_PERIOD = 0.01  # s, after which the rate is computed anew
EQUILIBRIUM_ITERATIONS = 30


class TwoMotorVehicle(Model):
    """Torques at two rear wheels, steering and slope in; motion of the car and of the wheels out."""

    @record
    class Parameters:
        """The car; the module's docstring marks what is published."""

        mass: float = var(3904.0, "kg", "Mass of the car (M)", min=1.0)
        wheel_inertia: float = var(7.07, "kg.m2", "Inertia of a wheel with its motor (J_e)", min=1e-3)
        wheel_radius: float = var(0.36, "m", "Radius of the wheels (R)", min=0.01)
        wheelbase: float = var(2.5, "m", "Distance between the axles (L)", min=0.1)
        track: float = var(1.5, "m", "Distance between the rear wheels (d_w)", min=0.1)
        steering_limit: float = var(pi / 4.0, "rad", "Stop of the steering", min=0.0, max=1.57)
        air_density: float = var(AIR_DENSITY, "kg/m3", "Density of the air (rho)", min=0.0)
        frontal_area: float = var(3.48, "m2", "Frontal area (A)", min=0.0)
        drag_coefficient: float = var(0.46, "1", "Drag coefficient (C_x)", min=0.0)
        rolling_coefficient: float = var(0.01, "1", "Rolling resistance (f_v)", min=0.0)
        friction_peak: float = var(ASPHALT.peak, "1", "First number of (V3) (th_1)", min=0.0)
        friction_rise: float = var(ASPHALT.steepness, "1", "Second number of (V3) (th_2)", min=0.0)
        friction_fall: float = var(ASPHALT.fall, "1", "Third number of (V3) (th_3)", min=0.0)
        initial_speed: float = var(0.0, "m/s", "Speed at the start, on a level straight road")

        @cached_property
        def drag(self) -> float:
            """1/2 rho A C_x [kg/m]."""
            return 0.5 * self.air_density * self.frontal_area * self.drag_coefficient

        @cached_property
        def stiffness(self) -> float:
            """R^2 F_z mu'(0)/J_e on a level road [m/s2]: by |v|, the rate [1/s] at which slip settles."""
            load = 0.25 * self.mass * GRAVITY
            slope = self.friction_peak * self.friction_rise - self.friction_fall
            return self.wheel_radius**2 * load * slope / self.wheel_inertia

    @record
    class Inputs:
        """The torques of the drives, the steering and the slope of the road."""

        left_torque: float = var(0.0, "N.m", "Torque at the left wheel (T_1)", nominal=1000.0)
        right_torque: float = var(0.0, "N.m", "Torque at the right wheel (T_2)", nominal=1000.0)
        steering_angle: float = var(0.0, "rad", "Angle of the front wheels (d), positive to the left")
        road_grade: float = var(0.0, "rad", "Angle of the road (a), positive uphill", min=-1.5, max=1.5)

    @record
    class State:
        """The motion of car and wheels."""

        left_wheel_speed: float = var(0.0, "rad/s", "Speed of the left wheel (w_1)")
        right_wheel_speed: float = var(0.0, "rad/s", "Speed of the right wheel (w_2)")
        speed: float = var(0.0, "m/s", "Speed of the car (v)")
        distance: float = var(0.0, "m", "Distance travelled")

    @record
    class Outputs:
        """The quantities that the sensors of the car and of the bench measure."""

        left_wheel_speed: float = var(0.0, "rad/s", "Speed of the left wheel (w_1)", nominal=10.0)
        right_wheel_speed: float = var(0.0, "rad/s", "Speed of the right wheel (w_2)", nominal=10.0)
        speed: float = var(0.0, "m/s", "Speed of the car (v)", nominal=10.0)
        distance: float = var(0.0, "m", "Distance travelled", nominal=100.0)
        acceleration: float = var(
            0.0, "m/s2", "Acceleration of the car", depends=("steering_angle", "road_grade")
        )
        left_slip: float = var(0.0, "1", "Slip of the left wheel (s_1)", depends=("steering_angle",))
        right_slip: float = var(0.0, "1", "Slip of the right wheel (s_2)", depends=("steering_angle",))
        left_force: float = var(
            0.0,
            "N",
            "Force of the left wheel on the road (F_1)",
            nominal=1000.0,
            depends=("steering_angle", "road_grade"),
        )
        right_force: float = var(
            0.0,
            "N",
            "Force of the right wheel on the road (F_2)",
            nominal=1000.0,
            depends=("steering_angle", "road_grade"),
        )
        aerodynamic_torque: float = var(0.0, "N.m", "Torque of the air at the wheels (2)", nominal=100.0)
        slope_torque: float = var(
            0.0, "N.m", "Torque of the slope at the wheels (3)", nominal=1000.0, depends=("road_grade",)
        )
        rolling_torque: float = var(
            0.0, "N.m", "Torque of rolling at the wheels (4)", nominal=100.0, depends=("road_grade",)
        )

    @staticmethod
    def initial(p: TwoMotorVehicle.Parameters, u: TwoMotorVehicle.Inputs) -> TwoMotorVehicle.State:
        """Return the equilibrium at `initial_speed` on a level straight road: the wheels slip as that takes.

        Raises ValueError for a geometry that cannot turn as far as the steering does, and for a speed at
        which the tires cannot overcome the resistance.
        """
        check_steering(p.wheelbase, p.track, p.steering_limit)
        wheel = _equilibrium_wheel_speed(p, p.initial_speed)
        return TwoMotorVehicle.State(wheel, wheel, p.initial_speed, 0.0)

    @staticmethod
    def step(
        p: TwoMotorVehicle.Parameters, x: TwoMotorVehicle.State, u: TwoMotorVehicle.Inputs, dt: float
    ) -> TwoMotorVehicle.State:
        """Return the state after `dt` [s] of held inputs."""
        parts = max(1, ceil(dt / RATE_PERIOD - 1e-9))
        for _ in range(parts):
            x = _advance(p, x, u, dt / parts)
        return x

    @staticmethod
    def outputs(
        p: TwoMotorVehicle.Parameters, x: TwoMotorVehicle.State, u: TwoMotorVehicle.Inputs
    ) -> TwoMotorVehicle.Outputs:
        """Return the quantities measured at this instant; steering and slope act at once."""
        v, r = x.speed, p.wheel_radius
        c_1, c_2 = wheel_ratios(p.wheelbase, p.track, p.steering_limit, u.steering_angle)  # (V5)
        s_1, s_2 = slip(x.left_wheel_speed * r, v * c_1), slip(x.right_wheel_speed * r, v * c_2)
        load = 0.25 * p.mass * GRAVITY * cos(u.road_grade)
        f_1, f_2 = load * friction(p, s_1), load * friction(p, s_2)  # (V2)
        aero, slope, rolling = resistance_torques(p, v, u.road_grade)
        a = (f_1 + f_2 - (aero + slope + rolling) / r) / p.mass  # (V6)
        return TwoMotorVehicle.Outputs(
            x.left_wheel_speed,
            x.right_wheel_speed,
            v,
            x.distance,
            a,
            s_1,
            s_2,
            f_1,
            f_2,
            aero,
            slope,
            rolling,
        )


def resistance_torques(p: TwoMotorVehicle.Parameters, v: float, grade: float) -> tuple[float, float, float]:
    """Return the torques [N.m] of air, slope and rolling at speed v [m/s] on a slope [rad]."""
    r, weight = p.wheel_radius, p.mass * GRAVITY
    share = min(1.0, max(-1.0, v / ROLLING_SPEED))
    aero = p.drag * v * abs(v) * r  # (2)
    slope = weight * r * sin(grade)  # (3)
    return aero, slope, weight * r * p.rolling_coefficient * cos(grade) * share  # (4)


def slip(rim: float, ground: float) -> float:
    """Return the slip of a wheel whose rim has the speed `rim` over a ground of speed `ground` [m/s]."""
    return (rim - ground) / max(abs(ground), abs(rim), SLIP_SPEED)  # (V4)


def friction(p: TwoMotorVehicle.Parameters, s: float) -> float:
    """Return the friction coefficient [1] at a slip, any number."""
    size = min(1.0, abs(s))
    mu = -p.friction_peak * expm1(-p.friction_rise * size) - p.friction_fall * size  # (V3)
    return mu if s >= 0.0 else -mu


def _advance(
    p: TwoMotorVehicle.Parameters, x: TwoMotorVehicle.State, u: TwoMotorVehicle.Inputs, dt: float
) -> TwoMotorVehicle.State:
    """Return the state after `dt` [s] of Heun's rule, in as many inner steps as the slip's rate needs."""
    w_1, w_2, v, d = x.left_wheel_speed, x.right_wheel_speed, x.speed, x.distance
    r = p.wheel_radius
    c_1, c_2 = wheel_ratios(p.wheelbase, p.track, p.steering_limit, u.steering_angle)  # (V5)
    weight = p.mass * GRAVITY * cos(u.road_grade)
    load, rolling, climb = 0.25 * weight, p.rolling_coefficient * weight, p.mass * GRAVITY * sin(u.road_grade)
    t_1, t_2, drag, m, j = u.left_torque, u.right_torque, p.drag, p.mass, p.wheel_inertia
    th_1, th_2, th_3 = p.friction_peak, p.friction_rise, p.friction_fall

    def force(rim: float, ground: float) -> float:
        # slip() and friction() in one: this is most of what a step costs
        size = abs(rim)
        other = abs(ground)
        if other > size:
            size = other
        if size < SLIP_SPEED:
            size = SLIP_SPEED
        s = (rim - ground) / size  # (V4)
        if s < 0.0:
            s = 1.0 if s < -1.0 else -s
            return load * (th_3 * s + th_1 * expm1(-th_2 * s))  # (V2), (V3)
        if s > 1.0:
            s = 1.0
        return load * (-th_1 * expm1(-th_2 * s) - th_3 * s)

    def resistance(v: float) -> float:
        share = v / ROLLING_SPEED
        share = 1.0 if share > 1.0 else -1.0 if share < -1.0 else share
        return climb + rolling * share + drag * v * abs(v)  # (5)

    slowest = max(SLIP_SPEED, min(max(abs(v * c_1), abs(w_1 * r)), max(abs(v * c_2), abs(w_2 * r))))
    n = max(1, ceil(dt * p.stiffness / (RATE_STEP * slowest)))
    h = dt / n
    half = 0.5 * h
    for _ in range(n):
        f_1, f_2 = force(w_1 * r, v * c_1), force(w_2 * r, v * c_2)
        a_1, a_2, a = (t_1 - r * f_1) / j, (t_2 - r * f_2) / j, (f_1 + f_2 - resistance(v)) / m  # (V1), (V6)
        w_1p, w_2p, vp = w_1 + h * a_1, w_2 + h * a_2, v + h * a
        f_1, f_2 = force(w_1p * r, vp * c_1), force(w_2p * r, vp * c_2)
        w_1 += half * (a_1 + (t_1 - r * f_1) / j)
        w_2 += half * (a_2 + (t_2 - r * f_2) / j)
        d += half * v
        v += half * (a + (f_1 + f_2 - resistance(vp)) / m)
        d += half * v
    return TwoMotorVehicle.State(w_1, w_2, v, d)


def _equilibrium_wheel_speed(p: TwoMotorVehicle.Parameters, v: float) -> float:
    """Return the speed [rad/s] of two wheels that hold v [m/s] on a level straight road, by (V2)-(V6)."""
    if v == 0.0:
        return 0.0
    aero, _, rolling = resistance_torques(p, v, 0.0)
    wanted = abs(aero + rolling) / p.wheel_radius / (0.5 * p.mass * GRAVITY)
    s = 0.0
    for _ in range(EQUILIBRIUM_ITERATIONS):  # Newton; mu is concave, so it comes from below
        fall = p.friction_peak * p.friction_rise * exp(-p.friction_rise * s) - p.friction_fall
        if fall <= 0.0 or s >= 1.0:
            raise ValueError(
                f"initial_speed = {v} m/s needs a friction of {wanted:.4g}, more than the tires give"
            )
        s += (wanted - friction(p, s)) / fall
    if abs(v) < SLIP_SPEED * (1.0 - s):
        return (v + (SLIP_SPEED * s if v > 0.0 else -SLIP_SPEED * s)) / p.wheel_radius
    return v / (1.0 - s) / p.wheel_radius  # the rim is the faster one: s = (w R - v)/(w R)
