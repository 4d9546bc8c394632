"""Friction of the satellites in their bearings and in the meshes 17-6, gravity, and self-locking meshes.

With large losses and light links the equations of motion have no solution or two. The meshes are then
self-locking.
"""

import math

from ..accumulate import TWO_PI
from ..inertia import reduced_inertia
from ..layout import imbalance_acceleration, imbalance_position
from ..records import Constants, Position, ReducedInertia
from ..sine import sine_cosine

# Angles checked for self-locking per cycle of the highest harmonic of q.
# At most this number of revolutions of the pinion shaft is checked, too.
ANGLES_PER_CYCLE = 64
RESOLVE_SIGNS = -1.0  # In the argument ``signs``: take the signs from the torques
DOMINANT_ACCELERATION = 1e150  # rad/s^2, makes all other terms of tau6 negligible


def single_satellite_inertia(d: Constants, position: Position) -> ReducedInertia:
    """Return the reduced inertia of a single bevel satellite without gear inertia from its position.

    It is equal to inertia.reduced_inertia in this case, without a second evaluation of the geometry.

    Args:
        d: Constants.
        position: Of the imbalance (layout.imbalance_position), m and m/rad^n.

    Returns:
        (I, I', B, B', G, G'): kg m^2 and kg m^2/rad.
    """
    _, y, z, x1, y1, z1, x2, y2, z2 = position
    mass = d.mass
    return (
        mass * (y * y + z * z),
        2.0 * mass * (y * y1 + z * z1),
        mass * (y * z1 - z * y1),
        mass * (y * z2 - z * y2),
        mass * (x1 * x1 + y1 * y1 + z1 * z1) + d.J16,
        2.0 * mass * (x1 * x2 + y1 * y2 + z1 * z2),
    )


def satellite_friction(
    d: Constants,
    q: float,
    first: Position,
    omega1: float,
    rate_q: float,
    alpha1: float,
    rate2_q: float,
    signs: float,
) -> tuple[float, float, float, float]:
    """Return the friction torque of all satellites against q (losses.md, "Load-dependent losses").

        C = mu r s sum m |a|                      bearings; a without the terms of alpha1 and q''
        S = (1 - eta6) s sum |tau6|               meshes 17-6; tau6 = m a . dr/dB

    S is linear in the accelerations for fixed signs of tau6. The signs are written to
    ``d.machine.tau6_signs``, and the term of each satellite, N m, to ``d.machine.mesh_friction_by``.

    Args:
        d: Constants; ``d.machine`` is written.
        q: Pinion-shaft angle, rad.
        first: Position of imbalance 0 (layout.imbalance_position), m and m/rad^n.
        omega1: Speed of link 1, rad/s.
        rate_q: q', rad/s.
        alpha1: Acceleration of link 1, rad/s^2.
        rate2_q: q'', rad/s^2.
        signs: Bits of the signs of tau6, or RESOLVE_SIGNS to take them from tau6 at these accelerations.

    Returns:
        (C, S0, S1, S2): S = S0 + S1 alpha1 + S2 q''; N m, N m, kg m^2, kg m^2.
    """
    bearings = 0.0
    mesh = 0.0
    by_alpha1 = 0.0
    by_rate2 = 0.0
    unread_bits = signs
    sign_bits = 0.0
    bit = 1.0
    n_satellites = 1.0 if d.planar != 0.0 else d.satellites
    mass = d.mass / n_satellites
    loss_mass = mass * d.satellite_loss
    for n in range(int(n_satellites)):
        position = imbalance_position(d, q, TWO_PI * n / n_satellites) if n > 0 else first
        px, y, z, x1, y1, z1, _, _, _ = position
        ax, ay, az = imbalance_acceleration(position, omega1, 0.0, rate_q, 0.0)
        bearings += math.sqrt(ax * ax + ay * ay + az * az)
        # s dr/dB = r' - dr/dA
        spin_x = x1 + y
        spin_y = y1 - px
        own = ax * spin_x + ay * spin_y + az * z1
        own_by_alpha1 = y * z1 - z * spin_y
        own_by_rate2 = x1 * spin_x + y1 * spin_y + z1 * z1
        torque = own + own_by_alpha1 * alpha1 + own_by_rate2 * rate2_q
        is_negative = torque < 0.0
        if signs != RESOLVE_SIGNS:
            half = math.floor(0.5 * unread_bits)
            is_negative = unread_bits != 2.0 * half
            unread_bits = half
        sign = -1.0 if is_negative else 1.0
        sign_bits += bit if is_negative else 0.0
        bit *= 2.0
        d.machine.mesh_friction_by[n] = loss_mass * sign * torque
        mesh += sign * own
        by_alpha1 += sign * own_by_alpha1
        by_rate2 += sign * own_by_rate2
    d.machine.tau6_signs = sign_bits
    return (
        d.journal_friction * d.s * mass * bearings,
        loss_mass * mesh,
        loss_mass * by_alpha1,
        loss_mass * by_rate2,
    )


def toggle_bit(signs: float, n: int) -> float:
    """Return ``signs`` with the sign of satellite ``n`` reversed.

    Args:
        signs: Bits of the signs of tau6, a whole number.
        n: Number of the satellite, from 0.
    """
    # Not 2.0**n, because the compiled power needs one more function of the C library
    bit = 1.0
    for _ in range(n):
        bit += bit
    return signs + (bit if math.floor(signs / bit) % 2.0 == 0.0 else -bit)


def gravity_potential(
    d: Constants,
    position: Position,
    theta1: float,
) -> tuple[float, float, float]:
    """Return the potential energy of the imbalances and its derivatives (gravity along -Oz).

        V = m g sum (y sin theta1 + z cos theta1)

    Args:
        d: Constants.
        position: Of imbalance 0 (layout.imbalance_position), m and m/rad^n.
        theta1: Angle of link 1, rad.

    Returns:
        (V, V_theta, V_q): J, N m, N m.
    """
    _, y, z, _, y1, z1, _, _, _ = position
    if d.satellites > 1.0:
        # Terms that rotate with the pinion shafts cancel; in the planar layout these are all terms
        y = y1 = 0.0
        if d.planar != 0.0:
            z = z1 = 0.0
    sine, cosine = sine_cosine(theta1)
    return (
        d.weight * (y * sine + z * cosine),
        d.weight * (y * cosine - z * sine),
        d.weight * (y1 * sine + z1 * cosine),
    )


def is_self_locking(d: Constants) -> bool:
    """Return True if the equations of motion have no unique solution at some angle and for some mesh signs.

    If the speed is prescribed, only the loss of the meshes 17-6 can cause self-locking. It then depends only
    on the angle B of the satellite. One revolution of B contains two cycles of the highest harmonic.
    """
    if d.satellite_loss == 0.0 and (d.by_torque == 0.0 or d.mesh_loss == 0.0):
        return False
    if d.by_torque == 0.0:
        return is_self_locking_within(d, TWO_PI / d.s, 2.0 * ANGLES_PER_CYCLE)
    n_turns = min(d.period_turns, ANGLES_PER_CYCLE)
    return is_self_locking_within(d, d.period, ANGLES_PER_CYCLE * d.harmonic * n_turns)


def is_self_locking_within(d: Constants, length: float, count: float) -> bool:
    """Return True if the meshes are self-locking at one of ``count`` evenly spaced angles.

    Args:
        d: Constants.
        length: Range of the pinion-shaft angle from 0, rad.
        count: Number of angles.
    """
    for n in range(int(count)):
        q = length * n / count
        i, _, b, _, g, _ = reduced_inertia(d, q)
        by_alpha1 = by_rate2 = 0.0
        if d.satellite_loss != 0.0:
            # The signs at a large q'' maximise by_rate2
            position = imbalance_position(d, q, 0.0)
            _, _, by_alpha1, by_rate2 = satellite_friction(
                d, q, position, 0.0, 0.0, 0.0, DOMINANT_ACCELERATION, RESOLVE_SIGNS
            )
        for pattern in range(4):
            flow = -1.0 if pattern < 2 else 1.0
            sigma = -1.0 if pattern % 2 == 0 else 1.0
            f_k = d.k / (1.0 - flow * d.mesh_loss)
            if is_self_locking_at(d, i, b, b + sigma * by_alpha1, g + sigma * by_rate2, f_k):
                return True
    return False


def is_self_locking_at(d: Constants, i: float, b: float, b_s: float, g_s: float, f_k: float) -> bool:
    """Return True if the mass matrix of motion.solve_links is not positive for one angle and sign pattern.

    Args:
        d: Constants.
        i: I, kg m^2.
        b: B, kg m^2.
        b_s: B with the friction of the meshes 17-6, kg m^2.
        g_s: G with the friction of the meshes 17-6, kg m^2.
        f_k: Torque on link 2 over tau.
    """
    k = d.k
    inertia2 = d.J2 + (0.0 if d.output_freewheel != 0.0 else d.J3)
    if not inertia2 + f_k * k * g_s > 0.0:
        return True
    if d.by_torque == 0.0:
        return False
    inertia1 = d.J1 + i
    m11 = inertia1 + k * b + f_k * (b_s + k * g_s)
    return not (m11 > 0.0 and inertia2 * m11 + f_k * k * (inertia1 * g_s - b * b_s) > 0.0)
