"""Accelerations, torques and losses at an instant by the general equations of motion (mechanics.md).

    tau = G q'' + B alpha1 + (G' q'^2 - I' omega1^2) / 2 + bq q' + V_q + sigma (C + S)      M2 = f k tau
    M1 = (J1 + I) alpha1 + B q'' + I' q' omega1 + B' q'^2 + b1 omega1 + V_theta + M2
    J2 omega2' = M2 - b2 omega2 - Tc + Th          q' = k (omega1 - omega2)

- sigma is the sign of the slip omega1 - omega2.
- C and S are the friction torques of the satellite bearings and of the meshes 17-6.
- V_q and V_theta are the torques of gravity and windage.
- f is 1/eta or 1/(2 - eta). The mesh 2-16 then loses (1 - eta) |M2| |omega1 - omega2| in both directions of
  power flow.
"""

from ..fields import OF_MOTION, OF_NOW
from ..inertia import reduced_inertia
from ..layout import imbalance_position
from ..records import Constants, Machine, Now, Position, ReducedInertia, State
from .losses import applied_torques
from .satellites import (
    RESOLVE_SIGNS,
    gravity_potential,
    satellite_friction,
    single_satellite_inertia,
)
from .states import ENGAGED_COMPLIANT, IDEAL, LOCKED, LOSSY, OVERRUNNING, RATIO_PRESCRIBED

MAX_SIGN_ITERATIONS = 50  # Sign patterns of the mesh torques; each one is closer to the solution


def load_state(d: Constants, x: State) -> None:
    """Copy the present motion into ``d.machine``. Both records begin with the fields of fields.MOTION."""
    for n in range(OF_MOTION):
        d.machine.numbers[n] = x.numbers[n]
    if d.backlash != 0.0:
        d.machine.play_housing, d.machine.play_output = x.play_housing, x.play_output


def copy_accelerations(target: Machine | Now, source: Machine | Now) -> None:
    """Copy accelerations, torques and reduced inertia. Both records end with the fields of fields.NOW.

    Args:
        target: Record that is written.
        source: Record that is read.
    """
    first_target, first_source = len(target.numbers) - OF_NOW, len(source.numbers) - OF_NOW
    for n in range(OF_NOW):
        target.numbers[first_target + n] = source.numbers[first_source + n]


def freewheel_torques(d: Constants, x: State, m: Machine, lossy: int) -> None:
    """Write Th and Tc of freewheels that overrun or are engaged through their springs into ``m``, N m.

    The torque of a freewheel that is locked follows from the accelerations; it is 0 here.

    Args:
        d: Constants.
        x: State; the states of the freewheels are read.
        m: Motion (fields.MACHINE).
        lossy: LOSSY or IDEAL, a compile-time constant.
    """
    m.housing = 0.0
    m.output = 0.0
    if not lossy:
        return
    if x.housing_state == ENGAGED_COMPLIANT:
        m.housing = d.housing_stiffness * m.wound_housing - d.housing_damping * m.omega2
    elif x.housing_state == OVERRUNNING and d.housing_freewheel != 0.0:
        m.housing = -d.housing_drag - d.housing_drag_viscous * m.omega2
    if x.output_state == ENGAGED_COMPLIANT:
        m.output = d.freewheel_stiffness * m.wound_output + d.freewheel_damping * (m.omega2 - m.omega3)
    elif x.output_state == OVERRUNNING:
        m.output = -d.output_drag - d.output_drag_viscous * (m.omega3 - m.omega2)


def solve_links(
    d: Constants,
    x: State,
    m: Machine,
    prescribed: float,
    inertia1: float,
    inertia2: float,
    b: float,
    b_s: float,
    g_s: float,
    f_k: float,
    r1: float,
    r: float,
    r2: float,
) -> tuple[float, float, float]:
    """Solve for the accelerations of links 1 and 2 with the signs of all mesh torques fixed.

        [ m11  m12 ] [ alpha1 ]   [ force1 ]
        [ m21  m22 ] [ alpha2 ] = [ force2 ]

        m11 = J1 + I + k B + f k (B_s + k G_s)     m12 = -k (B + f k G_s)     force1 = M1 - R1 - f k R
        m21 = -f k (B_s + k G_s)                   m22 = J2 + f k k G_s       force2 = f k R - R2

    An acceleration that is prescribed, or is 0 because the housing freewheel is locked, removes its row.
    Otherwise Cramer's rule solves both rows.

    Args:
        d: Constants.
        x: State; the states of the freewheels are read.
        m: Motion; alpha2 is read if the speed ratio is prescribed.
        prescribed: Acceleration of link 1, rad/s^2, or its torque M1, N m, if ``d.by_torque``.
        inertia1: J1 + I, kg m^2.
        inertia2: J2 with everything locked to link 2, kg m^2.
        b: B, kg m^2.
        b_s: B with the friction of the meshes 17-6, kg m^2.
        g_s: G with the friction of the meshes 17-6, kg m^2.
        f_k: Torque on link 2 over tau: the ratio k with the loss factor f of the mesh 2-16.
        r1: R1, terms of M1 without accelerations, N m.
        r: R, terms of tau without accelerations, N m.
        r2: R2, torque against link 2, N m.

    Returns:
        (alpha1, alpha2, tau): rad/s^2, rad/s^2 and N m.
    """
    k = d.k
    by_alpha1 = b_s + k * g_s
    m21 = -f_k * by_alpha1
    m22 = inertia2 + f_k * k * g_s
    force2 = f_k * r - r2
    alpha1 = prescribed
    alpha2 = 0.0
    if d.by_torque == 0.0:
        if x.output_state == RATIO_PRESCRIBED:
            alpha2 = m.alpha2
        elif x.housing_state != LOCKED:
            # The division does not depend on the forces, so a processor starts it early
            alpha2 = 1.0 / m22 * (force2 - m21 * alpha1)
    else:
        m11 = inertia1 + k * b - m21
        force1 = prescribed - r1 - f_k * r
        if x.housing_state == LOCKED:
            alpha1 = force1 / m11
        else:
            m12 = -k * (b + f_k * g_s)
            # m11 m22 - m12 m21 without cancellation
            determinant = inertia2 * m11 + f_k * k * (inertia1 * g_s - b * b_s)
            alpha1 = (m22 * force1 - m12 * force2) / determinant
            alpha2 = (m11 * force2 - m21 * force1) / determinant
    return alpha1, alpha2, r + by_alpha1 * alpha1 - k * g_s * alpha2


def solve_mesh_signs(
    d: Constants,
    x: State,
    m: Machine,
    prescribed: float,
    position: Position,
    inertia1: float,
    inertia2: float,
    b: float,
    g: float,
    r1: float,
    r: float,
    r2: float,
    keep_signs: bool,
) -> None:
    """Solve for the accelerations of links that slip, with load-dependent losses.

    The losses depend on the signs of the mesh torques: tau (mesh 2-16), and tau6 of each satellite (meshes
    17-6). The system is linear for each pattern of signs. With ``keep_signs`` the signs in ``x`` are used,
    because inside an integration step a change of sign is an event. Otherwise each iteration takes the signs
    of the last solution. This is Newton's method for a piecewise linear system.

    Args:
        d: Constants.
        x: State; contact mode and signs are read.
        m: Motion; alpha1, alpha2, torques, friction and signs are written.
        prescribed: Acceleration of link 1, rad/s^2, or its torque, N m, if ``d.by_torque``.
        position: Of imbalance 0 (layout.imbalance_position).
        inertia1: J1 + I, kg m^2.
        inertia2: J2 with everything locked to link 2, kg m^2.
        b: B, kg m^2.
        g: G, kg m^2.
        r1: Terms of M1 without accelerations, N m.
        r: Terms of tau without accelerations and friction, N m.
        r2: Torque against link 2, N m.
        keep_signs: True to use the signs in ``x``.
    """
    k = d.k
    sigma = x.slip_sign
    rate_q = k * (m.omega1 - m.omega2)
    alpha1 = prescribed if d.by_torque == 0.0 else 0.0
    alpha2 = m.alpha2 if x.output_state == RATIO_PRESCRIBED else 0.0
    rate2_q = k * (alpha1 - alpha2)
    flow = x.flow_sign if keep_signs else abs(sigma)
    signs = x.tau6_signs if keep_signs else RESOLVE_SIGNS
    # The torque of a single satellite whose sign is fixed is the sum over all satellites
    has_sum = d.satellite_loss != 0.0 and (signs == RESOLVE_SIGNS or d.satellites > 1.0)
    bearings = mesh = by_alpha1 = by_rate2 = 0.0
    if d.journal_friction + d.satellite_loss > 0.0:
        bearings, mesh, by_alpha1, by_rate2 = satellite_friction(
            d, m.q, position, m.omega1, rate_q, alpha1, rate2_q, signs
        )
    for _ in range(MAX_SIGN_ITERATIONS):
        f_k = k / (1.0 - flow * d.mesh_loss)
        b_s = b + sigma * by_alpha1
        g_s = g + sigma * by_rate2
        r_s = r + sigma * (bearings + mesh)
        alpha1, alpha2, tau = solve_links(
            d, x, m, prescribed, inertia1, inertia2, b, b_s, g_s, f_k, r1, r_s, r2
        )
        m.mesh = f_k * tau
        m.flow_torque = tau * sigma
        rate2_q = k * (alpha1 - alpha2)
        m.mesh_friction = mesh + by_alpha1 * alpha1 + by_rate2 * rate2_q
        m.mesh_friction_by[0] = m.mesh_friction
        is_solved = keep_signs or flow * m.flow_torque >= 0.0
        if not is_solved:
            flow = -flow
        if has_sum:
            last_mesh, last_by_alpha1, last_by_rate2 = mesh, by_alpha1, by_rate2
            bearings, mesh, by_alpha1, by_rate2 = satellite_friction(
                d, m.q, position, m.omega1, rate_q, alpha1, rate2_q, signs
            )
            is_same = mesh == last_mesh and by_alpha1 == last_by_alpha1 and by_rate2 == last_by_rate2
            is_solved = is_solved and is_same
        if is_solved:
            break
    m.alpha1 = alpha1
    m.alpha2 = alpha2
    m.flow_sign = flow
    m.journals = bearings


def solve_slipping(
    d: Constants,
    x: State,
    m: Machine,
    prescribed: float,
    inertia: ReducedInertia,
    position: Position,
    inertia2: float,
    r2: float,
    keep_signs: bool,
    lossy: int,
) -> None:
    """Write the accelerations of links 1 and 2 while they slip, and the torques between them, into ``m``.

    Args:
        d: Constants.
        x: State; contact mode and signs are read.
        m: Motion; accelerations and torques are written. alpha2 is read if the speed ratio is prescribed.
        prescribed: Acceleration of link 1, rad/s^2, or its torque, N m, if ``d.by_torque``.
        inertia: (I, I', B, B', G, G') at ``m.q``, kg m^2 and kg m^2/rad.
        position: Of imbalance 0 (layout.imbalance_position).
        inertia2: J2 with everything locked to link 2, kg m^2.
        r2: Torque against link 2, N m.
        keep_signs: True to use the signs of the mesh torques in ``x``.
        lossy: LOSSY or IDEAL, a compile-time constant.
    """
    i, i1, b, b1, g, g1 = inertia
    rate_q = d.k * (m.omega1 - m.omega2)
    inertia1 = d.J1 + i
    r1 = d.b1 * m.omega1 + (i1 * m.omega1 + b1 * rate_q) * rate_q
    r = 0.5 * (g1 * rate_q * rate_q - i1 * m.omega1 * m.omega1) + d.bq * rate_q
    if lossy:
        r1 += m.applied1
        r += m.applied_q
        solve_mesh_signs(d, x, m, prescribed, position, inertia1, inertia2, b, g, r1, r, r2, keep_signs)
    else:
        m.alpha1, m.alpha2, m.flow_torque = solve_links(
            d, x, m, prescribed, inertia1, inertia2, b, b, g, d.k, r1, r, r2
        )
        m.mesh = d.k * m.flow_torque
    m.drive = inertia1 * m.alpha1 + d.k * b * (m.alpha1 - m.alpha2) + r1 + m.mesh


def solve_sticking(
    d: Constants,
    x: State,
    m: Machine,
    prescribed: float,
    inertia: ReducedInertia,
    position: Position,
    inertia2: float,
    r2: float,
) -> None:
    """Write accelerations, torques and the friction reserve of links that stick together into ``m``.

    The links stick while the pinion shafts need no more torque than the friction provides (stiction):

        |M2 / k - (B alpha - I' omega1^2 / 2 + V_q)| <= C + S + (1 - eta) |M2| / k

    ``m.friction_reserve`` is the right side minus the left side, N m.

    Args:
        d: Constants.
        x: State; the states of the freewheels are read.
        m: Motion; accelerations and torques are written.
        prescribed: Acceleration of link 1, rad/s^2, or its torque, N m, if ``d.by_torque``.
        inertia: (I, I', B, B', G, G') at ``m.q``, kg m^2 and kg m^2/rad.
        position: Of imbalance 0 (layout.imbalance_position).
        inertia2: J2 with everything locked to link 2, kg m^2.
        r2: Torque against link 2, N m.
    """
    i, i1, b, _, _, _ = inertia
    omega1 = m.omega1
    r1 = d.b1 * omega1 + m.applied1
    is_held = x.housing_state == LOCKED
    alpha = prescribed
    if is_held:
        alpha = 0.0
    elif d.by_torque != 0.0:
        alpha = (prescribed - r1 - r2) / (d.J1 + i + inertia2)
    ideal_tau = b * alpha - 0.5 * i1 * omega1 * omega1 + m.applied_q
    bearings, mesh, by_alpha1, _ = satellite_friction(
        d, m.q, position, omega1, 0.0, alpha, 0.0, RESOLVE_SIGNS
    )
    m.mesh = inertia2 * alpha + r2
    if is_held:
        # At rest a prescribed input torque determines the mesh torque. With a prescribed speed it is not
        # unique; the value that needs the least friction is selected
        m.mesh = min(d.k * ideal_tau, r2 + d.housing_drag)
        if m.play_housing > 0.0:
            m.mesh = max(m.mesh, r2)
        if d.by_torque != 0.0:
            m.mesh = prescribed - r1
    m.journals = bearings
    m.mesh_friction = mesh + by_alpha1 * alpha
    m.flow_sign = 1.0
    m.alpha1 = alpha
    m.alpha2 = alpha
    m.drive = (d.J1 + i) * alpha + r1 + m.mesh
    friction_tau = m.mesh / d.k - ideal_tau
    m.friction_reserve = bearings + m.mesh_friction + d.mesh_loss * abs(m.mesh) / d.k - abs(friction_tau)
    if is_held and d.by_torque == 0.0 and prescribed != 0.0:
        m.friction_reserve = -(d.J2 + d.F_by_alpha1) * abs(
            prescribed
        )  # Link 1 accelerates whatever the friction


def evaluate(d: Constants, x: State, prescribed: float, load: float, keep_signs: bool) -> None:
    """Evaluate the equations of motion at the motion in ``d.machine`` and write the results into it.

    Results are accelerations, torques, powers of windage, and the quantities of the event indicators.

    Args:
        d: Constants; ``d.machine`` is read and written.
        x: State; contact mode and signs are read.
        prescribed: Acceleration or torque of link 1 (links.prescribed_at_input), rad/s^2 or N m.
        load: Load torque, N m.
        keep_signs: True to use the signs of the mesh torques in ``x`` (solve_mesh_signs).
    """
    # One source, compiled twice: the ideal copy contains no loss terms
    if d.losses != 0.0:
        equations_of_motion(d, x, prescribed, load, keep_signs, LOSSY)
    else:
        equations_of_motion(d, x, prescribed, load, keep_signs, IDEAL)


def equations_of_motion(
    d: Constants, x: State, prescribed: float, load: float, keep_signs: bool, lossy: int
) -> None:
    """Solve the equations of motion with or without losses, drag, gravity and wind-up (see evaluate).

    Args:
        d: Constants; ``d.machine`` is read and written.
        x: State; contact mode and signs are read.
        prescribed: Acceleration or torque of link 1, rad/s^2 or N m.
        load: Load torque, N m.
        keep_signs: True to use the signs of the mesh torques in ``x``.
        lossy: LOSSY or IDEAL, a compile-time constant.
    """
    m = d.machine
    position = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    needs_position = lossy and d.journal_friction + d.satellite_loss + d.weight > 0.0
    if needs_position:
        position = imbalance_position(d, m.q, 0.0)
    if needs_position and d.satellites == 1.0 and d.planar + d.gear_inertia == 0.0:
        inertia = single_satellite_inertia(d, position)
    else:
        inertia = reduced_inertia(d, m.q)
    m.i, _, m.b, _, m.g, _ = inertia
    if lossy:
        applied_torques(d, x, m, position)
    freewheel_torques(d, x, m, lossy)
    shaft = load
    if d.elastic != 0.0:
        shaft = d.shaft_stiffness * m.twist + d.shaft_damping * m.relative
    r3 = shaft + d.b3 * m.omega3
    is_locked = x.output_state == LOCKED
    inertia2 = d.J2 + (d.J3 if is_locked else 0.0)
    r2 = d.b2 * m.omega2 - m.housing + (r3 if is_locked else m.output)
    if lossy and x.slip_sign == 0.0 and x.output_state != RATIO_PRESCRIBED:
        solve_sticking(d, x, m, prescribed, inertia, position, inertia2, r2)
    else:
        solve_slipping(d, x, m, prescribed, inertia, position, inertia2, r2, keep_signs, lossy)
    if is_locked:
        m.output = r3 + d.J3 * m.alpha2
        m.alpha3 = m.alpha2
    elif x.output_state == RATIO_PRESCRIBED:
        m.output = m.mesh - r2 - d.J2 * m.alpha2
        m.alpha3 = m.alpha2
    else:
        m.alpha3 = (m.output - r3) / d.J3
    if x.housing_state == LOCKED:
        m.housing = m.output - m.mesh
    m.rate_relative = 0.0
    if d.elastic != 0.0:
        driven = shaft - d.driven_friction * (m.omega3 - m.relative) - load
        m.rate_relative = (1.0 - d.balancer) * m.alpha3 - driven / d.J4


def potential_energy(d: Constants, x: State) -> float:
    """Return the potential energy of gravity and of the freewheel springs, J."""
    potential, _, _ = gravity_potential(d, imbalance_position(d, x.q, 0.0), x.theta1)
    housing = 0.5 * d.housing_stiffness * x.wound_housing * x.wound_housing
    return potential + housing + 0.5 * d.freewheel_stiffness * x.wound_output * x.wound_output
