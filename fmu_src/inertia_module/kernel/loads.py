"""Reaction forces of the unbalanced masses: bearing force of a satellite, its peak, forces on the mounting.

The peak of the bearing force is the maximum of samples (mechanics.md, Loads on the mounting and the
satellite bearings). The solvers store a sample at the beginning of each internal step, inside long internal
steps and before each event. The last samples stay in a ring buffer, `x.moments`, and are evaluated when the
peak is read. A short communication step therefore pays almost nothing for it. In a long communication step
only every fifth sample counts after the first 64.
"""

import math

from .accumulate import TWO_PI
from .layout import imbalance_acceleration, imbalance_motion, imbalance_position, to_fixed_frame
from .records import Constants, Moment, Outputs, State

MIDSTEP_SAMPLE_PHASE = 1.0  # rad of the highest harmonic; a longer internal step has samples inside
MAX_FULL_SAMPLES = 64.0  # Samples of a communication step that are all evaluated
SAMPLE_DECIMATION = 5.0  # After these, one sample in SAMPLE_DECIMATION is evaluated
MAX_SATELLITE_TERMS = 3.0  # Satellites that represent any larger number in sums up to the second harmonic


def squared_acceleration(d: Constants, moment: Moment) -> float:
    """Return |a|^2 of imbalance 0 of module 0 at a sample, (m/s^2)^2.

    Args:
        d: Constants.
        moment: Sample (fields.MOMENT).
    """
    rate_q = d.k * (moment.omega1 - moment.omega2)
    rate2_q = d.k * (moment.alpha1 - moment.alpha2)
    place = imbalance_position(d, moment.q, 0.0)
    ax, ay, az = imbalance_acceleration(place, moment.omega1, moment.alpha1, rate_q, rate2_q)
    return ax * ax + ay * ay + az * az


def max_squared_acceleration(d: Constants, x: State) -> float:
    """Return the maximum of |a|^2 of imbalance 0 over the samples of the step, (m/s^2)^2.

    Args:
        d: Constants.
        x: State with the samples.
    """
    maximum = x.largest_square
    for n in range(int(min(x.seen, len(x.moments)))):
        maximum = max(maximum, squared_acceleration(d, x.moments[n]))
    return maximum


def include_load(
    d: Constants, x: State, q: float, omega1: float, omega2: float, alpha1: float, alpha2: float
) -> None:
    """Include the instant before an event in the maximum of |a|^2, independently of the ring buffer.

    Args:
        d: Constants.
        x: State; largest_square is updated.
        q: Drive angle, rad.
        omega1: Speed of link 1, rad/s.
        omega2: Speed of link 2, rad/s.
        alpha1: Acceleration of link 1, rad/s^2.
        alpha2: Acceleration of link 2, rad/s^2.
    """
    ax, ay, az = imbalance_acceleration(
        imbalance_position(d, q, 0.0), omega1, alpha1, d.k * (omega1 - omega2), d.k * (alpha1 - alpha2)
    )
    x.largest_square = max(x.largest_square, ax * ax + ay * ay + az * az)


def sample_load(
    d: Constants, x: State, q: float, omega1: float, omega2: float, alpha1: float, alpha2: float
) -> None:
    """Store a sample in the ring buffer; the maximum of |a|^2 keeps the sample that it replaces.

    Args:
        d: Constants.
        x: State; the ring buffer, the number of samples and largest_square are updated.
        q: Drive angle, rad.
        omega1: Speed of link 1, rad/s.
        omega2: Speed of link 2, rad/s.
        alpha1: Acceleration of link 1, rad/s^2.
        alpha2: Acceleration of link 2, rad/s^2.
    """
    number = x.seen
    if number >= MAX_FULL_SAMPLES:
        number /= SAMPLE_DECIMATION
    x.seen += 1.0
    if number != math.floor(number):
        return
    moment = x.moments[int(number) % len(x.moments)]
    if number >= len(x.moments):
        x.largest_square = max(x.largest_square, squared_acceleration(d, moment))
    moment.q = q
    moment.omega1 = omega1
    moment.omega2 = omega2
    moment.alpha1 = alpha1
    moment.alpha2 = alpha2


def gear_momentum_rate(
    d: Constants, omega1: float, alpha1: float, rate_q: float, rate2_q: float, azimuth: float
) -> tuple[float, float, float]:
    """Return the rate of the angular momentum of a satellite gear about its centre, N m (bevel layout).

        L = Jt v + h e      h = Ja s q' + (Ja - Jt) v e      v = omega1 x + q' z

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
        if d.bodies != 0.0:
            azimuth = x.q + d.phase_a + TWO_PI * n / terms
            lx, ly, lz = gear_momentum_rate(d, x.omega1, x.alpha1, rate_q, rate2_q, azimuth)
            lx, ly, lz = to_fixed_frame(x.theta1, lx, ly, lz)
            mx -= gears * lx
            my -= gears * ly
            mz -= gears * lz
        if n == 0:
            square = ax * ax + ay * ay + az * az
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
            y.satellite_force_peak = d.imbalance_mass * math.sqrt(max(square, max_squared_acceleration(d, x)))
    is_single = d.modules == 1.0
    y.shaking_force_x = fx
    y.shaking_force_y = fy if is_single else 0.0
    y.shaking_force_z = fz if is_single else 0.0
    y.shaking_moment_x = mx
    y.shaking_moment_y = my if is_single else 0.0
    y.shaking_moment_z = mz if is_single else 0.0
