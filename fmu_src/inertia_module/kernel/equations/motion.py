"""Accelerations, torques and losses at an instant by the general equations of motion (docs/mechanics.md).

    tau = G q'' + B alpha1 + (G' q'^2 - I' omega1^2) / 2 + bq q' + V_q + sigma (C + S)      M2 = f k tau
    M1 = (J1 + I) alpha1 + B q'' + I' q' omega1 + B' q'^2 + b1 omega1 + V_theta + M2
    J2 omega2' = M2 - b2 omega2 - Tc + Th

sigma is the sign of the slip, C and S what journals and the mesh 17-6 resist it with, V_q
and V_theta the torques of weights and air; f = 1/eta or
1/(2 - eta) makes the loss of the mesh 2-16 (1 - eta) |M2| |omega1 - omega2| whichever way the power flows.
"""

from ..fields import OF_MOTION, OF_NOW
from ..inertia import reduced_inertia
from ..layout import imbalance
from .losses import outer_torques
from .satellites import AS_THEY_ARE, MANY, inertia_at, spin_torques, weight_torques
from .states import GEARED, IDEAL, LOCKED, LOSSY, OPEN, WOUND

# patterns of signs tried: each step of this Newton's method leaves it only for one closer to the solution
PATTERNS = 50


def take_state(d, x):
    """The present motion into d.machine: both records begin with it (fields.MOTION)."""
    for n in range(OF_MOTION):
        d.machine.numbers[n] = x.numbers[n]
    if d.plays != 0.0:
        d.machine.play_housing, d.machine.play_output = x.play_housing, x.play_output


def recall(target, source):
    """Copy accelerations and torques of an instant, which both records end with (fields.NOW)."""
    first_target, first_source = len(target.numbers) - OF_NOW, len(source.numbers) - OF_NOW
    for n in range(OF_NOW):
        target.numbers[first_target + n] = source.numbers[first_source + n]


def freewheel_torques(d, x, m, lossy):
    """Th and Tc that follow from speeds and wind-up, into m: of freewheels that overrun or are wound up."""
    m.housing = 0.0
    m.output = 0.0
    if not lossy:
        return
    if x.housing_state == WOUND:
        m.housing = d.housing_stiffness * m.wound_housing - d.housing_damping * m.omega2
    elif x.housing_state == OPEN and d.housing != 0.0:
        m.housing = -d.housing_drag - d.housing_drag_viscous * m.omega2
    if x.output_state == WOUND:
        m.output = d.freewheel_stiffness * m.wound_output + d.freewheel_damping * (m.omega2 - m.omega3)
    elif x.output_state == OPEN:
        m.output = -d.output_drag - d.output_drag_viscous * (m.omega3 - m.omega2)


def accelerate_links(d, x, m, prescribed, inertia, place, carried, resisting, fixed, lossy):
    """Accelerations of links that slip and the torques between them, into m.

    The sign of tau gives f, that of tau6 the way its loss acts; both are followed as what the freewheels do,
    and found here by Newton's method where they may have changed.

    Args:
        prescribed: acceleration or torque of link 1. inertia, place: of reduced_inertia and imbalance.
        carried, resisting: inertia that link 2 carries, kg m^2, and torque against it, N m.
            (Where link 2 is geared m.alpha2 is given.)
        fixed: whether the signs in x hold. lossy: whether there are losses by load, a constant.
    """
    i, i1, b, b1, g, g1 = inertia
    k = d.k
    sign = x.slip_sign if lossy else 1.0
    rate_q = k * (m.omega1 - m.omega2)
    own1 = d.J1 + i
    own2 = d.J2 + carried
    rest1 = d.b1 * m.omega1 + (i1 * m.omega1 + b1 * rate_q) * rate_q
    rest = 0.5 * (g1 * rate_q * rate_q - i1 * m.omega1 * m.omega1) + d.bq * rate_q
    if lossy:
        rest1 += m.weight1
        rest += m.weight_q
    alpha1 = prescribed if d.by_torque == 0.0 else 0.0
    geared = x.output_state == GEARED
    alpha2 = m.alpha2 if geared else 0.0
    flow = x.flow_sign if fixed else abs(sign)
    signs = x.spin_signs if fixed and d.satellites <= MANY else AS_THEY_ARE
    # of one satellite the sum says all
    apart = lossy and d.satellite_loss != 0.0 and (signs == AS_THEY_ARE or d.satellites > 1.0)
    journals = mesh = by_alpha1 = by_rate2 = 0.0
    if lossy and d.journal_friction + d.satellite_loss > 0.0:
        journals, mesh, by_alpha1, by_rate2 = spin_torques(
            d, m.q, place, m.omega1, rate_q, alpha1, k * (alpha1 - alpha2), signs
        )
    for _ in range(PATTERNS if lossy else 1):
        passed = k / (1.0 - flow * d.mesh_loss) if lossy else k
        by_q = g
        coupling = b
        demand = rest
        if lossy:
            by_q += sign * by_rate2
            coupling += sign * by_alpha1
            demand += sign * (journals + mesh)
        coupling += k * by_q
        push = passed * demand - resisting
        if d.by_torque == 0.0:
            if x.housing_state != LOCKED and not geared:
                # (divided before the torques are known: a good part of the time of an evaluation)
                mobility = 1.0 / (own2 + passed * k * by_q)
                alpha2 = mobility * (push + passed * coupling * alpha1)
        else:
            drive = prescribed - rest1 - passed * demand
            phi = own1 + k * b + passed * coupling
            if x.housing_state == LOCKED:
                alpha1 = drive / phi
            else:
                back = k * (b + passed * by_q)
                link2 = own2 + passed * k * by_q
                # phi link2 - passed coupling back, without its cancellation
                slipping = b + sign * by_alpha1 if lossy else b
                determinant = own2 * phi + passed * k * (own1 * by_q - b * slipping)
                alpha1 = (link2 * drive + back * push) / determinant
                alpha2 = (phi * push + passed * coupling * drive) / determinant
        m.torque = demand + coupling * alpha1 - k * by_q * alpha2
        m.mesh = passed * m.torque
        if not lossy:
            break
        m.torque *= sign
        rate2_q = k * (alpha1 - alpha2)
        m.spun = mesh + by_alpha1 * alpha1 + by_rate2 * rate2_q
        m.spun_by[0] = m.spun
        agree = fixed or flow * m.torque >= 0.0
        if not agree:
            flow = -flow
        if apart:
            mesh_before = mesh
            by_alpha1_before = by_alpha1
            by_rate2_before = by_rate2
            journals, mesh, by_alpha1, by_rate2 = spin_torques(
                d, m.q, place, m.omega1, rate_q, alpha1, rate2_q, signs
            )
            is_same = mesh == mesh_before and by_alpha1 == by_alpha1_before and by_rate2 == by_rate2_before
            agree = agree and is_same
        if agree:
            break
    m.alpha1 = alpha1
    m.alpha2 = alpha2
    m.drive = own1 * alpha1 + k * b * (alpha1 - alpha2) + rest1 + m.mesh
    if lossy:
        m.flow_sign = flow
        m.journals = journals
        m.margin = sign * (m.omega1 - m.omega2)


def stick_links(d, x, m, prescribed, inertia, place, carried, resisting):
    """Accelerate links that stick together, and find the margin of the friction that holds them, N m."""
    i, i1, b, _, _, _ = inertia
    omega1 = m.omega1
    rest1 = d.b1 * omega1 + m.weight1
    own2 = d.J2 + carried
    held = x.housing_state == LOCKED
    alpha = prescribed
    if held:
        alpha = 0.0
    elif d.by_torque != 0.0:
        alpha = (prescribed - rest1 - resisting) / (d.J1 + i + own2)
    ideal = b * alpha - 0.5 * i1 * omega1 * omega1 + m.weight_q
    journals, mesh, by_alpha1, _ = spin_torques(d, m.q, place, omega1, 0.0, alpha, 0.0, AS_THEY_ARE)
    m.mesh = own2 * alpha + resisting
    if held:
        # at rest: what the drive torque leaves, or with the speed given what friction need not hold
        m.mesh = min(d.k * ideal, resisting + d.housing_drag)
        if m.play_housing > 0.0:
            m.mesh = max(m.mesh, resisting)
        if d.by_torque != 0.0:
            m.mesh = prescribed - rest1
    m.journals = journals
    m.spun = mesh + by_alpha1 * alpha
    m.flow_sign = 1.0
    m.alpha1 = alpha
    m.alpha2 = alpha
    m.drive = (d.J1 + i) * alpha + rest1 + m.mesh
    needed = m.mesh / d.k - ideal
    m.margin = journals + m.spun + d.mesh_loss * abs(m.mesh) / d.k - abs(needed)
    if held and d.by_torque == 0.0 and prescribed != 0.0:
        m.margin = -(d.J2 + d.F_by_alpha1) * abs(prescribed)  # link 1 turns, whatever the friction


def evaluate(d, x, prescribed, load, fixed):
    """Accelerations, torques and what the guards look at, of the motion in d.machine, into it.

    Args:
        x: state, for what the freewheels and the slip do. prescribed: see links.prescribed_at_input.
        load: N m.
        fixed: whether the signs of the loads in x hold (see accelerate_links).
    """
    # one source, compiled twice: what lossy rules out is not there
    if d.losses != 0.0:
        equations(d, x, prescribed, load, fixed, LOSSY)
    else:
        equations(d, x, prescribed, load, fixed, IDEAL)


def equations(d, x, prescribed, load, fixed, lossy):
    """Solve the equations of motion for evaluate, with or without losses by load, drag, weights, wind-up."""
    m = d.machine
    place = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    satellites_loaded = lossy and d.journal_friction + d.satellite_loss + d.weight > 0.0
    if satellites_loaded:
        place = imbalance(d, m.q, 0.0)
    if satellites_loaded and d.satellites == 1.0 and d.planar + d.bodies == 0.0:
        inertia = inertia_at(d, place)
    else:
        inertia = reduced_inertia(d, m.q)
    m.i, _, m.b, _, m.g, _ = inertia
    if lossy:
        outer_torques(d, x, m, place)
    freewheel_torques(d, x, m, lossy)
    shaft = load
    if d.elastic != 0.0:
        shaft = d.shaft_stiffness * m.twist + d.shaft_damping * m.relative
    against3 = shaft + d.b3 * m.omega3
    locked = x.output_state == LOCKED
    carried = d.J3 if locked else 0.0
    resisting = d.b2 * m.omega2 - m.housing + (against3 if locked else m.output)
    if lossy and x.slip_sign == 0.0 and x.output_state != GEARED:
        stick_links(d, x, m, prescribed, inertia, place, carried, resisting)
    else:
        accelerate_links(d, x, m, prescribed, inertia, place, carried, resisting, fixed, lossy)
    if locked:
        m.output = against3 + d.J3 * m.alpha2
        m.alpha3 = m.alpha2
    elif x.output_state == GEARED:
        m.output = m.mesh - resisting - d.J2 * m.alpha2
        m.alpha3 = m.alpha2
    else:
        m.alpha3 = (m.output - against3) / d.J3
    if x.housing_state == LOCKED:
        m.housing = m.output - m.mesh
    m.rate_relative = 0.0
    if d.elastic != 0.0:
        driven = shaft - d.driven_friction * (m.omega3 - m.relative) - load
        m.rate_relative = (1.0 - d.balancer) * m.alpha3 - driven / d.J4


def stored_besides(d, x):
    """Potential energy of the imbalances and of wound up freewheels, J."""
    potential, _, _ = weight_torques(d, imbalance(d, x.q, 0.0), x.theta1)
    housing = 0.5 * d.housing_stiffness * x.wound_housing * x.wound_housing
    return potential + housing + 0.5 * d.freewheel_stiffness * x.wound_output * x.wound_output
