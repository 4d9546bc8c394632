"""Equations of motion with the input torque given: both accelerations (DESIGN section 3).

    Phi alpha1 - N omega2' = M1 - R1            Phi = J1 + I + 2 k B + k^2 G
    (J2 + k^2 G) omega2' - N alpha1 = R2 - Tc + Th         N = k (B + k G)

R1 and R2 are what the speeds demand: R2 = k (G' q'^2 - I' omega1^2) / 2, R1 = I' q' omega1 + B' q'^2 + R2.
With link 2 held omega2' = 0. Seen from link 2 all is as with a given speed of link 1, with the torque
R2 + N (M1 - R1) / Phi in the place of F and J2 + k^2 G - N^2 / Phi in that of its inertia.
"""

from .dynamics import torque_scale
from .inertia import coupling_bend, reduced_inertia
from .slots import *


def acceleration(d, q, omega1, omega2, torque, held, shaft_inertia, shaft_torque):
    """Accelerations of links 1 and 2.

    Args:
        torque: M1, N m. held: whether the housing freewheel holds link 2.
        shaft_inertia, shaft_torque: what link 2 carries while it moves, as in dynamics.motion.

    Returns:
        (alpha1, omega2'), rad/s^2.
    """
    i, i1, _, b, b1, g, g1, _ = reduced_inertia(d, q)
    k = d[D_K]
    rate_q = k * (omega1 - omega2)
    demand2 = 0.5 * k * (g1 * rate_q * rate_q - i1 * omega1 * omega1)
    drive = torque - (i1 * omega1 + b1 * rate_q) * rate_q - demand2
    link1 = d[D_J1] + i
    phi = link1 + k * (2.0 * b + k * g)
    if held:
        return drive / phi, 0.0
    coupling = k * (b + k * g)
    own = d[D_J2] + shaft_inertia
    push = demand2 - shaft_torque
    # Phi (own + k^2 G) - N^2 without its cancellation: I G >= B^2
    determinant = own * phi + k * k * (link1 * g - b * b)
    alpha1 = ((own + k * k * g) * drive + coupling * push) / determinant
    return alpha1, (phi * push + coupling * drive) / determinant


def acceleration_and_jerk(d, q, omega1, omega2, torque, held, shaft_inertia, shaft_torque, shaft_rate):
    """The same with rates, the input torque constant.

    Args:
        shaft_rate: rate of shaft_torque, N m/s.

    Returns:
        (alpha1, omega2', omega2'', F, F'): F is the mesh torque while link 2 is held, N m, else 0.
    """
    i, i1, i2, b, b1, g, g1, g2 = reduced_inertia(d, q)
    k = d[D_K]
    rate_q = k * (omega1 - omega2)
    demand2 = 0.5 * k * (g1 * rate_q * rate_q - i1 * omega1 * omega1)
    drive = torque - (i1 * omega1 + b1 * rate_q) * rate_q - demand2
    link1 = d[D_J1] + i
    phi = link1 + k * (2.0 * b + k * g)
    coupling = k * (b + k * g)
    own = d[D_J2] + shaft_inertia
    determinant = own * phi + k * k * (link1 * g - b * b)
    alpha1 = drive / phi
    alpha2 = 0.0
    if not held:
        push = demand2 - shaft_torque
        alpha1 = ((own + k * k * g) * drive + coupling * push) / determinant
        alpha2 = (phi * push + coupling * drive) / determinant
    # the time derivative of both equations
    bend_q = k * (alpha1 - alpha2)
    demand2_rate = k * (
        0.5 * g2 * rate_q * rate_q * rate_q
        + g1 * rate_q * bend_q
        - 0.5 * i2 * rate_q * omega1 * omega1
        - i1 * omega1 * alpha1
    )
    demand1_rate = (
        i2 * rate_q * rate_q * omega1
        + i1 * (bend_q * omega1 + rate_q * alpha1)
        + coupling_bend(d, q) * rate_q * rate_q * rate_q
        + 2.0 * b1 * rate_q * bend_q
        + demand2_rate
    )
    phi_rate = (i1 + k * (2.0 * b1 + k * g1)) * rate_q
    coupling_rate = k * (b1 + k * g1) * rate_q
    drive_rate = coupling_rate * alpha2 - phi_rate * alpha1 - demand1_rate
    push_rate = demand2_rate + coupling_rate * alpha1
    if held:
        jerk1 = drive_rate / phi
        return alpha1, 0.0, 0.0, demand2 + coupling * alpha1, push_rate + coupling * jerk1
    push_rate -= k * k * g1 * rate_q * alpha2 + shaft_rate
    return alpha1, alpha2, (phi * push_rate + coupling * drive_rate) / determinant, 0.0, 0.0


def seen_inertia(d, q):
    """J2 + k^2 G - N^2 / Phi: inertia of link 2 while link 1 is free under its torque, kg m^2."""
    i, _, _, b, _, g, _, _ = reduced_inertia(d, q)
    k = d[D_K]
    link1 = d[D_J1] + i
    return d[D_J2] + k * k * (link1 * g - b * b) / (link1 + k * (2.0 * b + k * g))


def driven_torque_scale(d, omega1, alpha1, rate_q, torque):
    """Upper bound of F at these speeds: what a torque is to be called zero against."""
    reach = d[D_ALPHA_SLOPE]
    pushed = abs(torque) * reach / (reach + d[D_J1]) if reach > 0.0 else 0.0
    return torque_scale(d, omega1, alpha1, rate_q) + pushed
