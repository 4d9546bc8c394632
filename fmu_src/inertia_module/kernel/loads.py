"""Forces of the imbalances: on the bearing of a satellite, with its peak over the step, and on the mount.

The solvers see moments of the step in hand: where they begin, where a contact mode does, and in between.
The last few are kept and only looked at when the peak is asked for: a short communication step pays next to
nothing for it. Of a long one, with its many pulses, only a share is seen from some number on.
"""

import math

from .accumulate import TWO_PI
from .layout import acceleration, imbalance, imbalance_in_fixed_frame, to_fixed_frame

# phase of the highest harmonic in an internal step from which on its inside is seen, rad
INSIDE_PHASE = 1.0
# moments that are all seen, and the share 1 / EVERY of those that follow
MANY = 64.0
EVERY = 5.0


def square_at(d, moment):
    """|a|^2 of imbalance 0 at a moment (fields.MOMENT), (m/s^2)^2."""
    rate_q = d.k * (moment.omega1 - moment.omega2)
    rate2_q = d.k * (moment.alpha1 - moment.alpha2)
    place = imbalance(d, moment.q, 0.0)
    ax, ay, az = acceleration(place, moment.omega1, moment.alpha1, rate_q, rate2_q)
    return ax * ax + ay * ay + az * az


def largest_square(d, x):
    """Largest |a|^2 of imbalance 0 in the moments seen in the step, (m/s^2)^2."""
    largest = x.largest_square
    for n in range(int(min(x.seen, len(x.moments)))):
        largest = max(largest, square_at(d, x.moments[n]))
    return largest


def see_load(d, x, q, omega1, omega2, alpha1, alpha2):
    """Include the moment before an event in the largest |a|^2 at once; no later moment replaces it."""
    ax, ay, az = acceleration(
        imbalance(d, q, 0.0), omega1, alpha1, d.k * (omega1 - omega2), d.k * (alpha1 - alpha2)
    )
    x.largest_square = max(x.largest_square, ax * ax + ay * ay + az * az)


def sample_load(d, x, q, omega1, omega2, alpha1, alpha2):
    """See a moment: drive angle, speeds and accelerations of links 1 and 2. It takes the place of another."""
    number = x.seen
    if number >= MANY:
        number /= EVERY
    x.seen += 1.0
    if number != math.floor(number):
        return
    moment = x.moments[int(number) % len(x.moments)]
    if number >= len(x.moments):
        x.largest_square = max(x.largest_square, square_at(d, moment))
    moment.q = q
    moment.omega1 = omega1
    moment.omega2 = omega2
    moment.alpha1 = alpha1
    moment.alpha2 = alpha2


def momentum_rate(d, omega1, alpha1, rate_q, rate2_q, azimuth):
    """Rate of the angular momentum of one gear's rotation in the frame of link 1, N m (bevel).

    L = Jt v + h e with v = omega1 x + q' z of the drive, h = Jt s q' + (Ja - Jt) (w e) and e' = v x e; e is
    its axis, of the azimuth A, rad.
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


def write_loads(d, x, y, alpha2):
    """Motion of imbalance 0 of module 0, its force, and the forces of all on the mount, in the fixed frame.

    Modules stand evenly about Ox, so two or more leave of a vector what is along it. The sums over the
    satellites of one hold no harmonic above the second: three stand for any larger number.
    """
    k = d.k
    rate_q = k * (x.omega1 - x.omega2)
    rate2_q = k * (x.alpha1 - alpha2)
    number = min(d.satellites, 3.0)
    mass = d.mass / number
    # the drives turn about Oz of link 1, or about an axis parallel to Ox
    drives = d.drive_inertia
    mx, my, mz = to_fixed_frame(x.theta1, 0.0, drives * x.omega1 * rate_q, -drives * rate2_q)
    if d.planar != 0.0:
        mx, my, mz = -d.J16 * (x.alpha1 + rate2_q), 0.0, 0.0
    fx, fy, fz = 0.0, 0.0, 0.0
    gears = d.modules * d.satellites / number
    for n in range(int(number)):
        px, py, pz, vx, vy, vz, ax, ay, az = imbalance_in_fixed_frame(
            d, x.q, x.theta1, x.omega1, x.alpha1, rate_q, rate2_q, TWO_PI * n / number
        )
        fx -= mass * ax
        fy -= mass * ay
        fz -= mass * az
        mx -= mass * (py * az - pz * ay)
        my -= mass * (pz * ax - px * az)
        mz -= mass * (px * ay - py * ax)
        if d.bodies != 0.0:
            azimuth = x.q + d.phase_a + TWO_PI * n / number
            lx, ly, lz = momentum_rate(d, x.omega1, x.alpha1, rate_q, rate2_q, azimuth)
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
            y.satellite_force_peak = d.imbalance_mass * math.sqrt(max(square, largest_square(d, x)))
    one = d.modules == 1.0
    y.shaking_force_x = fx
    y.shaking_force_y = fy if one else 0.0
    y.shaking_force_z = fz if one else 0.0
    y.shaking_moment_x = mx
    y.shaking_moment_y = my if one else 0.0
    y.shaking_moment_z = mz if one else 0.0
