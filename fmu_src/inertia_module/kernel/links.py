"""Equations of motion of links 1 and 2: one solver, the speed or the torque of link 1 given
(docs/mechanics.md).

    Phi alpha1 - N omega2' = M1 - R1                               Phi = J1 + I + 2 k B + k^2 G
    (J2 + k^2 G) omega2' - N alpha1 = R2 - b2 omega2 - Tc + Th     N = k (B + k G)
    R1 = I' q' omega1 + B' q'^2 + b1 omega1 + R2     R2 = k (G' q'^2 - I' omega1^2) / 2 + k bq q'

Of alpha1 and M1 one is given; omega2' = 0 while the housing freewheel holds link 2.
"""

from .inertia import reduced_inertia, second_derivative_of_b


def prescribed_at_input(d, x):
    """Prescribed quantity at link 1: its torque M1, N m, or its acceleration alpha1, rad/s^2."""
    return x.drive_torque if d.by_torque != 0.0 else x.alpha1


def motion(d, q, omega1, omega2, prescribed, held, carried, friction, torque, torque_rate):
    """Accelerations of both links and their rates, what is given being constant.

    Args:
        torque_rate: rate of torque, N m/s. The others as for accelerations.

    Returns:
        (alpha1, omega2', omega2'', F, F', P, T): F is the mesh torque while link 2 is held, N m, else 0;
        T is the kinetic energy of links 1, 2 and the imbalances, J.
    """
    i, i1, i2, b, b1, g, g1, g2 = reduced_inertia(d, q)
    k = d.k
    rate_q = k * (omega1 - omega2)
    link1 = d.J1 + i
    momentum = link1 * omega1 + b * rate_q + d.J2 * omega2
    energy = 0.5 * (link1 * omega1 * omega1 + d.J2 * omega2 * omega2)
    energy += (b * omega1 + 0.5 * g * rate_q) * rate_q
    coupling = k * (b + k * g)
    r2 = 0.5 * k * (g1 * rate_q * rate_q - i1 * omega1 * omega1) + k * d.bq * rate_q
    friction += d.b2
    push = r2 - friction * omega2 - torque
    own = d.J2 + carried
    inertia = own + k * k * g
    alpha1 = prescribed
    alpha2 = 0.0
    phi = 0.0
    determinant = 0.0
    if d.by_torque != 0.0:
        drive = prescribed - (i1 * omega1 + b1 * rate_q) * rate_q - d.b1 * omega1 - r2
        phi = link1 + k * (2.0 * b + k * g)
        determinant = own * phi + k * k * (link1 * g - b * b)
        alpha1 = drive / phi
        if not held:
            alpha1 = (inertia * drive + coupling * push) / determinant
            alpha2 = (phi * push + coupling * drive) / determinant
    elif not held:
        alpha2 = (push + coupling * alpha1) / inertia
    # the time derivative of both equations
    rate2_q = k * (alpha1 - alpha2)
    coupling_rate = k * (b1 + k * g1) * rate_q
    r2_rate = k * (
        0.5 * g2 * rate_q * rate_q * rate_q
        + g1 * rate_q * rate2_q
        - 0.5 * i2 * rate_q * omega1 * omega1
        - i1 * omega1 * alpha1
        + d.bq * rate2_q
    )
    push_rate = r2_rate + coupling_rate * alpha1
    drive_rate = 0.0
    if d.by_torque != 0.0:
        drive_rate = coupling_rate * alpha2 - (i1 + k * (2.0 * b1 + k * g1)) * rate_q * alpha1 - r2_rate
        drive_rate -= d.b1 * alpha1
        drive_rate -= i2 * rate_q * rate_q * omega1 + i1 * (rate2_q * omega1 + rate_q * alpha1)
        drive_rate -= (second_derivative_of_b(d, q) * rate_q * rate_q + 2.0 * b1 * rate2_q) * rate_q
    if held:
        jerk1 = drive_rate / phi if d.by_torque != 0.0 else 0.0
        return alpha1, 0.0, 0.0, r2 + coupling * alpha1, push_rate + coupling * jerk1, momentum, energy
    push_rate -= k * k * g1 * rate_q * alpha2 + friction * alpha2 + torque_rate
    if d.by_torque != 0.0:
        jerk2 = (phi * push_rate + coupling * drive_rate) / determinant
        return alpha1, alpha2, jerk2, 0.0, 0.0, momentum, energy
    return alpha1, alpha2, push_rate / inertia, 0.0, 0.0, momentum, energy


def torques(d, q, omega1, alpha1, omega2, alpha2):
    """Inverse dynamics: the input torque M1 and the mesh torque M2 of a motion of links 1 and 2, N m."""
    i, i1, _, b, b1, g, g1, _ = reduced_inertia(d, q)
    k = d.k
    rate_q = k * (omega1 - omega2)
    rate2_q = k * (alpha1 - alpha2)
    mesh = k * (
        g * rate2_q + 0.5 * g1 * rate_q * rate_q + b * alpha1 - 0.5 * i1 * omega1 * omega1 + d.bq * rate_q
    )
    drive = (
        (d.J1 + i) * alpha1 + d.b1 * omega1 + i1 * rate_q * omega1 + b * rate2_q + b1 * rate_q * rate_q + mesh
    )
    return drive, mesh


def torque_scale(d, omega1, alpha1, rate_q, prescribed):
    """Upper bound of |F| at these speeds, N m: what a torque is to be called zero against."""
    reach = d.F_by_alpha1
    scale = 0.5 * (d.F_by_slip * rate_q * rate_q + d.F_by_speed * omega1 * omega1) + reach * abs(alpha1)
    scale += d.k * d.bq * abs(rate_q)
    if d.by_torque != 0.0 and reach > 0.0:
        scale += abs(prescribed) * reach / (reach + d.J1)
    return scale


def friction_power(d, omega1, omega2, friction):
    """Power of viscous friction at links 1, 2 and drives, W; friction: of link 2 and what it carries."""
    rate_q = d.k * (omega1 - omega2)
    return d.b1 * omega1 * omega1 + d.bq * rate_q * rate_q + friction * omega2 * omega2


def response(d, inertia):
    """How much of its own speed the mechanism can impart to a link of this inertia, 0 to 1.

    The natural measure of an error of its speed: behind a heavy shaft the speed hardly changes, yet its
    small changes are the torque.
    """
    own = d.F_by_alpha1
    return own / (own + inertia) if own > 0.0 else 1.0


def angular_momentum(d, q, omega1, omega2):
    """P = (J1 + I) omega1 + B q' + J2 omega2 of links 1, 2 and the imbalances, N m s."""
    i, _, _, b, _, _, _, _ = reduced_inertia(d, q)
    return (d.J1 + i) * omega1 + b * d.k * (omega1 - omega2) + d.J2 * omega2


def inertia_of_link1(d, i, b, g):
    """Phi = J1 + I + 2 k B + k^2 G: what the input shaft turns while link 2 is held, kg m^2."""
    return d.J1 + i + d.k * (2.0 * b + d.k * g)


def inertia_at_input(d, q):
    """Phi at the drive angle q, kg m^2."""
    i, _, _, b, _, g, _, _ = reduced_inertia(d, q)
    return inertia_of_link1(d, i, b, g)


def inertia_of_link2(d, i, b, g):
    """Inertia of link 2 with what moves behind it, link 1 as it is given, kg m^2.

    J2 + k^2 G where the speed of link 1 is given, J2 + k^2 G - N^2 / Phi where it is free under its torque.
    """
    k = d.k
    if d.by_torque == 0.0:
        return d.J2 + k * k * g
    return d.J2 + k * k * ((d.J1 + i) * g - b * b) / inertia_of_link1(d, i, b, g)


def inertia_at_output(d, q):
    """Effective inertia at the drive angle q, kg m^2."""
    i, _, _, b, _, g, _, _ = reduced_inertia(d, q)
    return inertia_of_link2(d, i, b, g)


def slip_inertia(d, i, b, g, carried):
    """Inertia of links 1 and 2 against their slip rho = omega1 - omega2 (docs/mechanics.md, timestepping).

        T = J omega1^2 / 2 - (J2 - k B) omega1 rho + (J2 + k^2 G) rho^2 / 2 = P^2 / (2 J) + mu rho^2 / 2

    Args:
        carried: inertia that link 2 carries, added to J2, kg m^2.

    Returns:
        (J, kappa, mu): J = J1 + I + J2. With the speed given kappa = J2 - k B and mu = J2 + k^2 G, as in the
        first form; with the torque given kappa = (J2 - k B) / J and mu is that of the second.
    """
    k = d.k
    own = d.J2 + carried
    link1 = d.J1 + i
    total = link1 + own
    coupling = own - k * b
    if d.by_torque == 0.0:
        return total, coupling, own + k * k * g
    determinant = own * inertia_of_link1(d, i, b, g) + k * k * (link1 * g - b * b)
    per_total = 1.0 / total
    return total, coupling * per_total, determinant * per_total


def kinetic_energy(d, q, omega1, omega2, omega3):
    """Kinetic energy T of links 1 and 2, the imbalances and J3, J."""
    i, _, _, b, _, g, _, _ = reduced_inertia(d, q)
    rate_q = d.k * (omega1 - omega2)
    return (
        0.5 * (d.J1 + i) * omega1 * omega1
        + b * omega1 * rate_q
        + 0.5 * g * rate_q * rate_q
        + 0.5 * d.J2 * omega2 * omega2
        + 0.5 * d.J3 * omega3 * omega3
    )
