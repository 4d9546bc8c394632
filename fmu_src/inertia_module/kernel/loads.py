"""Reaction forces of the unbalanced masses: bearing force of a satellite, its peak, forces on the mounting.

The peak of the bearing force is the maximum of |a| at evenly spaced samples of each internal step and of the
parabolas through three of them in a row. The motion inside the step is interpolated between its ends: q by
the quintic and omega1 by the cubic Hermite polynomial. The beginning of the last internal step is stored.
This step is evaluated when the next one begins, at an event, or when the peak is read.

Source: E. Hairer, S. P. Norsett, G. Wanner: Solving Ordinary Differential Equations I (1993), section II.6.
"""

import math

from .accumulate import TWO_PI
from .layout import imbalance_acceleration, imbalance_motion, imbalance_position, to_fixed_frame
from .records import Constants, Outputs, State
from .tableau import parabola_extremum

# Phase of the highest harmonic p, rad, up to which an internal step has samples at its ends only. The maximum
# of sqrt(A + B cos p), B <= A, midway between them is at most p^2/32 = 0.8 % larger.
MAX_ENDS_PHASE = 0.5
MAX_SATELLITE_TERMS = 3.0  # Satellites that represent any larger number in sums up to the second harmonic


def squared_acceleration(
    d: Constants, q: float, omega1: float, alpha1: float, rate_q: float, rate2_q: float
) -> float:
    """Return |a|^2 of imbalance 0 of module 0, (m/s^2)^2.

    Args:
        d: Constants.
        q: Pinion-shaft angle, rad.
        omega1: Speed of link 1, rad/s.
        alpha1: Acceleration of link 1, rad/s^2.
        rate_q: q', rad/s.
        rate2_q: q'', rad/s^2.
    """
    ax, ay, az = imbalance_acceleration(imbalance_position(d, q, 0.0), omega1, alpha1, rate_q, rate2_q)
    return ax * ax + ay * ay + az * az


def square_inside(
    d: Constants, x: State, s: float, omega1: float, alpha1: float, rate_q: float, rate2_q: float
) -> float:
    """Return |a|^2 of imbalance 0 inside the last internal step, (m/s^2)^2.

    Args:
        d: Constants.
        x: State with the beginning of the step.
        s: Fraction of the step.
        omega1: Speed of link 1 at the end of the step, rad/s.
        alpha1: Acceleration of link 1 there, rad/s^2.
        rate_q: q' there, rad/s.
        rate2_q: q'' there, rad/s^2.
    """
    begin, h = x.step_beginning, x.last_step
    per_step = 1.0 / h
    # Derivatives by s: of q at the beginning, and the coefficients of s^3, s^4, s^5
    q1, q2 = h * begin.rate_q, h * h * begin.rate2_q
    change = x.last_turn - q1 - 0.5 * q2
    change1 = h * rate_q - q1 - q2
    change2 = h * h * rate2_q - q2
    q3 = 10.0 * change - 4.0 * change1 + 0.5 * change2
    q4 = 7.0 * change1 - 15.0 * change - change2
    q5 = 6.0 * change - 3.0 * change1 + 0.5 * change2
    # Coefficients of omega1
    w1 = h * begin.alpha1
    gain, gain1 = omega1 - begin.omega1 - w1, h * alpha1 - w1
    w2, w3 = 3.0 * gain - gain1, gain1 - 2.0 * gain
    return squared_acceleration(
        d,
        begin.q + s * (q1 + s * (0.5 * q2 + s * (q3 + s * (q4 + s * q5)))),
        begin.omega1 + s * (w1 + s * (w2 + s * w3)),
        (w1 + s * (2.0 * w2 + s * 3.0 * w3)) * per_step,
        (q1 + s * (q2 + s * (3.0 * q3 + s * (4.0 * q4 + s * 5.0 * q5)))) * per_step,
        (q2 + s * (6.0 * q3 + s * (12.0 * q4 + s * 20.0 * q5))) * per_step * per_step,
    )


def max_squared_acceleration(
    d: Constants, x: State, end: float, omega1: float, alpha1: float, rate_q: float, rate2_q: float
) -> float:
    """Return the maximum of |a|^2 of imbalance 0 since the beginning of the communication step, (m/s^2)^2.

    Args:
        d: Constants.
        x: State with the beginning of the last internal step.
        end: |a|^2 at the end of this step, (m/s^2)^2.
        omega1: Speed of link 1 there, rad/s.
        alpha1: Acceleration of link 1 there, rad/s^2.
        rate_q: q' there, rad/s.
        rate2_q: q'' there, rad/s^2.
    """
    if x.last_step == 0.0:
        return max(x.largest_square, end)
    begin = x.step_beginning
    before = squared_acceleration(d, begin.q, begin.omega1, begin.alpha1, begin.rate_q, begin.rate2_q)
    maximum = max(x.largest_square, before, end)
    phase = d.harmonic * x.last_step * max(abs(begin.rate_q), abs(rate_q))
    parts = 2.0 + math.floor(phase) if phase > MAX_ENDS_PHASE else 1.0
    here = before
    for n in range(1, int(parts) + 1):
        after = square_inside(d, x, n / parts, omega1, alpha1, rate_q, rate2_q) if n < parts else end
        if n > 1:
            maximum = max(maximum, here, parabola_extremum(0.0, 1.0, 2.0, before, here, after, 2.0))
        before, here = here, after
    return maximum


def include_last_step(
    d: Constants, x: State, omega1: float, alpha1: float, rate_q: float, rate2_q: float
) -> None:
    """Include the last internal step, which ends at the present angle, in the maximum of |a|^2.

    Args:
        d: Constants.
        x: State; largest_square and last_step are updated.
        omega1: Speed of link 1 at the end of the step, rad/s.
        alpha1: Acceleration of link 1 there, rad/s^2.
        rate_q: q' there, rad/s.
        rate2_q: q'' there, rad/s^2.
    """
    if x.last_step != 0.0:
        end = squared_acceleration(d, x.q, omega1, alpha1, rate_q, rate2_q)
        x.largest_square = max_squared_acceleration(d, x, end, omega1, alpha1, rate_q, rate2_q)
        x.last_step = 0.0


def store_beginning(
    d: Constants, x: State, omega1: float, alpha1: float, rate_q: float, rate2_q: float
) -> None:
    """Store the beginning of an internal step, after the step before it is included.

    Args:
        d: Constants.
        x: State, written.
        omega1: Speed of link 1, rad/s.
        alpha1: Acceleration of link 1, rad/s^2.
        rate_q: q', rad/s.
        rate2_q: q'', rad/s^2.
    """
    include_last_step(d, x, omega1, alpha1, rate_q, rate2_q)
    begin = x.step_beginning
    begin.q = x.q
    begin.omega1 = omega1
    begin.alpha1 = alpha1
    begin.rate_q = rate_q
    begin.rate2_q = rate2_q


def gear_momentum_rate(
    d: Constants, omega1: float, alpha1: float, rate_q: float, rate2_q: float, azimuth: float
) -> tuple[float, float, float]:
    """Return the rate of the angular momentum of a satellite gear about its centre, N m (bevel layout).

        L = Jt v + h e      h = Ja s q' + (Ja - Jt) v . e      v = omega1 x + q' z

    v is the angular velocity of the pinion shaft, and e is the axis of the gear, with e' = v x e.

    Args:
        d: Constants.
        omega1: Speed of link 1, rad/s.
        alpha1: Acceleration of link 1, rad/s^2.
        rate_q: q', rad/s.
        rate2_q: q'', rad/s^2.
        azimuth: Angle A of the axis of the gear, rad.

    Returns:
        Components along x, y, z of the frame of link 1.
    """
    sine = math.sin(d.shaft_angle)
    axial = math.cos(d.shaft_angle)
    along = -sine * math.cos(azimuth)
    across = -sine * math.sin(azimuth)
    own = d.satellite_inertia
    transverse = d.satellite_transverse_inertia
    spin = own * (d.s + axial) - transverse * axial
    h = spin * rate_q + (own - transverse) * along * omega1
    h_rate = spin * rate2_q + (own - transverse) * (along * alpha1 - across * rate_q * omega1)
    return (
        transverse * alpha1 + h_rate * along - h * rate_q * across,
        -transverse * omega1 * rate_q + h_rate * across + h * (rate_q * along - omega1 * axial),
        transverse * rate2_q + h_rate * axial + h * omega1 * across,
    )


def write_loads(d: Constants, x: State, y: Outputs, alpha2: float) -> None:
    """Write the motion of imbalance 0 of module 0, its bearing force, and the forces on the mounting.

    Vectors are in the fixed frame. Modules are evenly spaced around Ox, so two or more modules leave only
    components along Ox. Sums over the satellites of a module have no harmonic above the second.

    Args:
        d: Constants.
        x: State.
        y: Outputs, written.
        alpha2: Acceleration of link 2, rad/s^2.
    """
    k = d.k
    rate_q = k * (x.omega1 - x.omega2)
    rate2_q = k * (x.alpha1 - alpha2)
    terms = min(d.satellites, MAX_SATELLITE_TERMS)
    mass = d.mass / terms
    # Pinion shafts rotate about Oz of link 1 (bevel) or about an axis parallel to Ox (planar)
    drives = d.drive_inertia
    mx, my, mz = to_fixed_frame(x.theta1, 0.0, drives * x.omega1 * rate_q, -drives * rate2_q)
    if d.planar != 0.0:
        mx, my, mz = -d.J16 * (x.alpha1 + rate2_q), 0.0, 0.0
    fx, fy, fz = 0.0, 0.0, 0.0
    gears = d.modules * d.satellites / terms
    for n in range(int(terms)):
        px, py, pz, vx, vy, vz, ax, ay, az = imbalance_motion(
            d, x.q, x.theta1, x.omega1, x.alpha1, rate_q, rate2_q, TWO_PI * n / terms
        )
        fx -= mass * ax
        fy -= mass * ay
        fz -= mass * az
        mx -= mass * (py * az - pz * ay)
        my -= mass * (pz * ax - px * az)
        mz -= mass * (px * ay - py * ax)
        if d.gear_inertia != 0.0:
            azimuth = x.q + d.phase_a + TWO_PI * n / terms
            lx, ly, lz = gear_momentum_rate(d, x.omega1, x.alpha1, rate_q, rate2_q, azimuth)
            lx, ly, lz = to_fixed_frame(x.theta1, lx, ly, lz)
            mx -= gears * lx
            my -= gears * ly
            mz -= gears * lz
        if n == 0:
            square = ax * ax + ay * ay + az * az
            peak = max_squared_acceleration(d, x, square, x.omega1, x.alpha1, rate_q, rate2_q)
            y.imbalance_x = px
            y.imbalance_y = py
            y.imbalance_z = pz
            y.imbalance_velocity_x = vx
            y.imbalance_velocity_y = vy
            y.imbalance_velocity_z = vz
            y.imbalance_acceleration = math.sqrt(square)
            y.imbalance_acceleration_x = ax
            y.imbalance_acceleration_y = ay
            y.imbalance_acceleration_z = az
            y.satellite_force = d.imbalance_mass * y.imbalance_acceleration
            y.satellite_force_peak = d.imbalance_mass * math.sqrt(peak)
    is_single = d.modules == 1.0
    y.shaking_force_x = fx
    y.shaking_force_y = fy if is_single else 0.0
    y.shaking_force_z = fz if is_single else 0.0
    y.shaking_moment_x = mx
    y.shaking_moment_y = my if is_single else 0.0
    y.shaking_moment_z = mz if is_single else 0.0
