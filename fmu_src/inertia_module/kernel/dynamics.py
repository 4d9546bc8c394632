"""Equations of motion (DESIGN section 3): torques and accelerations at one instant."""

from .inertia import reduced_inertia
from .slots import *


def free_torque(d, omega1, alpha1, rate_q, i1, b, g, g1):
    """Mesh torque, link 2 unaccelerated: F = k (k G alpha1 + G' q'^2 / 2 + B alpha1 - I' omega1^2 / 2)."""
    k = d[D_K]
    return k * ((k * g + b) * alpha1 + 0.5 * g1 * rate_q * rate_q - 0.5 * i1 * omega1 * omega1)


def free_torque_rate(d, omega1, alpha1, rate_q, rate2_q, i1, i2, b1, g1, g2):
    """dF/dt with alpha1 constant."""
    k = d[D_K]
    return k * (
        (k * g1 + b1) * rate_q * alpha1
        + 0.5 * g2 * rate_q * rate_q * rate_q
        + g1 * rate_q * rate2_q
        - 0.5 * i2 * rate_q * omega1 * omega1
        - i1 * omega1 * alpha1
    )


def torque_scale(d, omega1, alpha1, rate_q):
    """Upper bound of |F| at these speeds: what a torque is to be called zero against."""
    return 0.5 * (d[D_G_SLOPE] * rate_q * rate_q + d[D_I_SLOPE] * omega1 * omega1) + d[D_ALPHA_SLOPE] * abs(
        alpha1
    )


def motion(d, q, omega1, alpha1, omega2, shaft_inertia, shaft_torque):
    """Acceleration of link 2 and the torques, link 2 carrying shaft_inertia against shaft_torque.

    Args:
        shaft_inertia: J3 while the output freewheel is engaged, else 0, kg m^2.
        shaft_torque: the load torque while it is engaged, else 0, N m.

    Returns:
        (omega2', M1, Tc, M2): rad/s^2 and N m.
    """
    i, i1, _, b, b1, g, g1, _ = reduced_inertia(d, q)
    k = d[D_K]
    rate_q = k * (omega1 - omega2)
    free = free_torque(d, omega1, alpha1, rate_q, i1, b, g, g1)
    alpha2 = (free - shaft_torque) / (d[D_J2] + k * k * g + shaft_inertia)
    mesh = free - k * k * g * alpha2
    rate2_q = k * (alpha1 - alpha2)
    drive = (d[D_J1] + i) * alpha1 + i1 * rate_q * omega1 + b * rate2_q + b1 * rate_q * rate_q + mesh
    return alpha2, drive, shaft_torque + shaft_inertia * alpha2, mesh


def stage_rates(d, q, omega1, alpha1, omega2, shaft_inertia, shaft_torque):
    """The same without omega2'', for the inner stages of the integrator. Returns (omega2', P)."""
    i, i1, _, b, _, g, g1, _ = reduced_inertia(d, q)
    k = d[D_K]
    rate_q = k * (omega1 - omega2)
    free = free_torque(d, omega1, alpha1, rate_q, i1, b, g, g1)
    momentum = (d[D_J1] + i) * omega1 + b * rate_q + d[D_J2] * omega2
    return (free - shaft_torque) / (d[D_J2] + k * k * g + shaft_inertia), momentum


def prescribed_torques(d, q, omega1, alpha1, omega2, alpha2):
    """Inverse dynamics: (M1, M2) for a prescribed motion of links 1 and 2."""
    i, i1, _, b, b1, g, g1, _ = reduced_inertia(d, q)
    k = d[D_K]
    rate_q = k * (omega1 - omega2)
    rate2_q = k * (alpha1 - alpha2)
    mesh = k * (g * rate2_q + 0.5 * g1 * rate_q * rate_q + b * alpha1 - 0.5 * i1 * omega1 * omega1)
    drive = (d[D_J1] + i) * alpha1 + i1 * rate_q * omega1 + b * rate2_q + b1 * rate_q * rate_q + mesh
    return drive, mesh


def motion_rates(d, q, omega1, alpha1, omega2, shaft_inertia, shaft_torque):
    """Acceleration of link 2, its time derivative and the angular momentum P (arguments as in motion).

    Returns:
        (omega2', omega2'', P), P = (J1 + I) omega1 + B q' + J2 omega2: rad/s^2, rad/s^3, N m s.
    """
    i, i1, i2, b, b1, g, g1, g2 = reduced_inertia(d, q)
    k = d[D_K]
    rate_q = k * (omega1 - omega2)
    inertia = d[D_J2] + k * k * g + shaft_inertia
    alpha2 = (free_torque(d, omega1, alpha1, rate_q, i1, b, g, g1) - shaft_torque) / inertia
    rate = free_torque_rate(d, omega1, alpha1, rate_q, k * (alpha1 - alpha2), i1, i2, b1, g1, g2)
    momentum = (d[D_J1] + i) * omega1 + b * rate_q + d[D_J2] * omega2
    return alpha2, (rate - alpha2 * k * k * g1 * rate_q) / inertia, momentum


def angular_momentum(d, q, omega1, omega2):
    """P = (J1 + I) omega1 + B q' + J2 omega2 of links 1, 2 and the imbalances, N m s."""
    i, _, _, b, _, _, _, _ = reduced_inertia(d, q)
    return (d[D_J1] + i) * omega1 + b * d[D_K] * (omega1 - omega2) + d[D_J2] * omega2


def held_torque(d, q, omega1, alpha1):
    """Torque F with link 2 held, and its time derivative, N m and N m/s."""
    _, i1, i2, b, b1, g, g1, g2 = reduced_inertia(d, q)
    rate_q = d[D_K] * omega1
    return (
        free_torque(d, omega1, alpha1, rate_q, i1, b, g, g1),
        free_torque_rate(d, omega1, alpha1, rate_q, d[D_K] * alpha1, i1, i2, b1, g1, g2),
    )


def held_inertia(d, q):
    """J1 + I + 2 k B + k^2 G: what the input shaft turns while link 2 is held, kg m^2."""
    i, _, _, b, _, g, _, _ = reduced_inertia(d, q)
    k = d[D_K]
    return d[D_J1] + i + 2.0 * k * b + k * k * g


def kinetic_energy(d, q, omega1, omega2, omega3):
    """T of DESIGN section 3, J."""
    i, _, _, b, _, g, _, _ = reduced_inertia(d, q)
    rate_q = d[D_K] * (omega1 - omega2)
    return (
        0.5 * (d[D_J1] + i) * omega1 * omega1
        + b * omega1 * rate_q
        + 0.5 * g * rate_q * rate_q
        + 0.5 * d[D_J2] * omega2 * omega2
        + 0.5 * d[D_J3] * omega3 * omega3
    )
