"""Constants derived once from the parameters: ratios, lengths, periods, bounds (docs/mechanics.md).

And warnings of what is computed all the same, but cannot be built: room is said of the pitch circles (planar)
and the pitch cones (bevel) of one module, and no body has an inertia above the sum of the other two.
"""

import math

from .codes import (
    AVERAGED,
    BAD_START_HOUSING,
    BAD_START_OUTPUT,
    BAD_START_RIGID,
    BEVEL_OUTSIDE,
    BEVEL_OVERLAP,
    DRIVE_TORQUE,
    ELASTIC,
    GEAR_TOO_FLAT,
    KINEMATIC,
    NO_INPUT_INERTIA,
    NO_RECTIFIER,
    NO_WINDAGE,
    OK,
    PLANAR_OUTSIDE,
    PLANAR_OVERLAP,
    PRESCRIBED,
    SINGULAR,
    TIMESTEPPING,
    WIND_UP_STEPPED,
)

TWO_PI = 6.283185307179586
TWO_PI_LOW = 2.4492935982947064e-16
# the leading 30 bits of 2 pi: a whole number below 2**23 times this is exact
TWO_PI_LEADING = 6.283185303211212
SINGULAR_RATIO = 1e-12
# parts that touch do not overlap
ROUNDING = 1e-12


def greatest_common_divisor(m, n):
    """Greatest common divisor of two whole numbers held as doubles."""
    while n > 0.0:
        m, n = n, m % n
    return m


def derive_period(turns, d):
    """Period of the motion in q, 2 pi times whole turns of the drive, in two doubles."""
    period = turns * TWO_PI
    rest = turns * (TWO_PI - TWO_PI_LEADING) + turns * TWO_PI_LOW
    d.period = period
    d.period_low = (turns * TWO_PI_LEADING - period) + rest
    d.period_turns = turns


def derive_bevel(p, d):
    """Karetin's standard layout: the lengths of figure 1 from teeth, shaft angle and a, b, c."""
    s = p.z17 / p.z6
    shaft_angle = p.shaft_angle
    sine = math.sin(shaft_angle)
    cosine = math.cos(shaft_angle)
    # half angle of the satellite's pitch cone: rolling without slip makes s = sin psi / sin phi
    phi = math.atan2(sine, s + cosine)
    pitch = p.wheel_radius / (s * math.sin(phi))
    arm = p.a * pitch * math.sin(phi)  # AD
    satellite_axis = p.b * pitch * math.cos(phi)  # QA
    d.k = p.z2 / p.z16
    d.s = s
    d.phase_a = p.gamma
    d.phase_b = p.epsilon
    d.radial = satellite_axis * sine
    d.radial_cos = arm * cosine
    d.arm = arm
    # OQ - QA cos Sigma with OQ = c L cos psi, written out so that nothing cancels for small Sigma
    d.axial = pitch * ((p.c - p.b) * math.cos(phi) * cosine + p.c * math.sin(phi) * sine)
    d.axial_cos = arm * sine
    # |r'|^2 = spin sin^2 B + (pole_offset + pole_arm (1 - cos B))^2: exact also where it vanishes
    d.pole_offset = (p.b - p.a) * pitch * sine * math.cos(phi)
    d.pole_arm = p.a * pitch * sine * math.cos(phi)
    d.spin = arm * arm * (1.0 + 2.0 * s * cosine + s * s)
    derive_period(p.z6 / greatest_common_divisor(p.z17, p.z6), d)
    reach = abs(d.radial) + abs(d.axial) + 2.0 * arm
    rate = reach + 2.0 * s * arm
    d.F_by_slip = s * (d.spin + 2.0 * d.pole_arm * (abs(d.pole_offset) + 2.0 * d.pole_arm))
    # three satellites or more even out what does not turn with the satellite itself
    d.F_by_speed = 2.0 * reach * (rate if p.satellites <= 2.0 else 2.0 * s * arm)
    d.F_by_alpha1 = d.k * rate * rate + reach * rate
    # the highest harmonic of q in the reduced inertia
    d.harmonic = 2.0 * d.s
    if p.satellites <= 2.0:
        d.harmonic = 2.0 + 2.0 * d.s


def derive_planar(p, d):
    """Lysenko's layout: link 1 is the carrier, link 2 the sun wheel the satellites roll on."""
    arm = p.eccentricity
    centre = p.sun_radius + p.satellite_radius
    d.k = p.sun_radius / p.satellite_radius
    d.s = 1.0
    d.phase_a = 0.0
    d.phase_b = 0.0
    d.radial = arm
    d.radial_cos = 0.0
    d.arm = 0.0
    d.axial = centre
    d.axial_cos = 0.0
    d.pole_offset = arm
    d.pole_arm = 0.0
    d.spin = 0.0
    derive_period(1.0, d)
    d.harmonic = 1.0
    d.F_by_slip = 0.0
    d.F_by_speed = 2.0 * arm * centre
    d.F_by_alpha1 = d.k * arm * arm + arm * (arm + centre)


def derive_general(p, d):
    """Derive the constants of the general equations of motion (kernel.equations)."""
    d.mesh_loss = 1.0 - p.mesh_efficiency
    d.satellite_loss = 0.0 if d.planar != 0.0 else 1.0 - p.satellite_mesh_efficiency
    d.journal = p.journal_friction
    d.number = p.satellites
    # of modules that stand evenly about the axis the weights balance
    d.weight = d.mass * p.gravity if p.modules == 1.0 else 0.0
    d.windage = p.windage * p.modules * p.satellites
    d.turn_across = -d.s * math.sin(p.shaft_angle)
    d.turn_along = 1.0 + 2.0 * d.s * math.cos(p.shaft_angle) + d.s * d.s
    # what is not there, a freewheel or the spring in it, takes nothing
    d.housing_drag = p.housing_freewheel * p.housing_drag
    d.housing_drag_viscous = p.housing_freewheel * p.housing_drag_viscous
    d.output_drag = p.output_freewheel * p.output_drag
    d.output_drag_viscous = p.output_freewheel * p.output_drag_viscous
    d.housing_stiffness = d.elastic * p.housing_freewheel * p.housing_stiffness
    d.freewheel_stiffness = d.elastic * p.output_freewheel * p.freewheel_stiffness
    d.housing_damping = p.housing_damping if d.housing_stiffness > 0.0 else 0.0
    d.freewheel_damping = p.freewheel_damping if d.freewheel_stiffness > 0.0 else 0.0
    by_load = d.mesh_loss + d.satellite_loss + d.journal + d.weight + d.windage
    drag = d.housing_drag + d.housing_drag_viscous + d.output_drag + d.output_drag_viscous
    d.losses = 1.0 if by_load + drag + d.housing_stiffness + d.freewheel_stiffness > 0.0 else 0.0
    d.averaged = 1.0 if p.fidelity == AVERAGED else 0.0
    d.lossy = 0.0
    if d.averaged != 0.0:
        # its own equations; the weights' mean over turns of link 1 is nothing
        d.lossy = 1.0 if d.viscous + by_load - d.weight + drag > 0.0 else 0.0
        d.weight = 0.0


def add_bodies(p, d):
    """Set what the turning satellite gears add to J1, J16, I, B and the bounds of |F|; d is there but for it.

    Their inertia is Ja about their own axes, Jt across (docs/mechanics.md, Bodies). Of the energy of a gear's
    rotation what is the same at every angle is added to J1 and J16: only what goes with the azimuth A of its
    axis is left to the reduced inertia.
    T = Jt |w|^2 / 2 + (Ja - Jt) (w e)^2 / 2 with w = omega1 x + q' (z + s e), e the axis of the gear. In the
    planar layout it is parallel to the central one.
    """
    d.bodies = 0.0
    d.body_i = 0.0
    d.body_b = 0.0
    number = p.modules * p.satellites
    own = number * p.satellite_inertia
    across = number * p.satellite_transverse_inertia
    if d.planar != 0.0:
        across = 0.0
    if own + across == 0.0:
        return
    if d.planar == 0.0:
        d.bodies = 1.0
        sine = math.sin(p.shaft_angle)
        cosine = math.cos(p.shaft_angle)
        spin = d.s + cosine
        d.J1 += across
        # the sum of cos^2 A in I is half their number for three or more, that of cos A in B 0 for two or more
        if d.paired != 0.0:
            d.body_i = (own - across) * sine * sine
        else:
            d.J1 += 0.5 * (own - across) * sine * sine
        if d.single != 0.0:
            d.body_b = sine * (across * cosine - own * spin)
        own = own * spin * spin + across * sine * sine
    d.J16 += own
    d.F_by_speed += d.k * abs(d.body_i)
    d.F_by_alpha1 += d.k * (abs(d.body_b) + (1.0 + d.k) * own)


def lightest_link2(d):
    """Least inertia behind link 2, J2 + k^2 G, over its largest, in a turn.

    G is least where B = 0: there |r'| is pole_offset, zero where a = b (docs/mechanics.md). Without
    the output freewheel link 2 always carries the output shaft.
    """
    offset = d.pole_offset
    far = offset + 2.0 * d.pole_arm
    fixed = d.J2 + d.k * d.k * d.J16
    if d.output == 0.0:
        fixed += d.J3
    moving = d.k * d.k * d.mass
    largest = fixed + moving * (far * far + d.spin)
    return (fixed + moving * offset * offset) / largest if largest > 0.0 else 0.0


def check_start(p):
    """Status of the starting speeds against the freewheels that are there."""
    omega2 = p.omega2_start
    omega_out = p.omega_out_start
    if p.housing_freewheel != 0.0 and omega2 < 0.0:
        return BAD_START_HOUSING
    if p.output_freewheel == 0.0:
        if omega2 != omega_out:
            return BAD_START_RIGID
    elif omega_out < omega2:
        return BAD_START_OUTPUT
    return OK


def derive(p, d):
    """Fill d from p and check what only shows in combination.

    Args:
        p: parameters, each already within the range of the table of variables.
        d: derived constants, written.

    Returns:
        Status: OK, WIND_UP_STEPPED, NO_WINDAGE, PRESCRIBED, NO_INPUT_INERTIA, NO_RECTIFIER, SINGULAR or
        a BAD_START code.
    """
    d.planar = p.layout
    if p.layout != 0.0:
        derive_planar(p, d)
    else:
        derive_bevel(p, d)
    d.single = 1.0 if p.satellites == 1.0 else 0.0
    d.paired = 1.0 if p.satellites <= 2.0 else 0.0
    d.mass = p.imbalance_mass * p.modules * p.satellites
    d.J1 = p.input_inertia
    d.J2 = p.link2_inertia
    d.J3 = p.output_inertia
    d.J16 = p.drive_inertia
    d.by_torque = 1.0 if p.drive == DRIVE_TORQUE else 0.0
    d.elastic = 1.0 if p.fidelity == ELASTIC else 0.0
    d.J4 = p.driven_inertia
    d.stiffness = p.shaft_stiffness
    d.damping = p.shaft_damping
    d.friction = p.driven_friction
    d.balancer = p.balancer
    d.b1 = p.input_friction
    d.bq = p.drive_friction
    d.b2 = p.link2_friction
    d.b3 = p.output_friction if p.fidelity != KINEMATIC else 0.0
    d.ratio = p.kinematic_ratio
    d.viscous = 1.0 if d.b1 + d.bq + d.b2 + d.b3 > 0.0 else 0.0
    derive_general(p, d)
    d.housing = p.housing_freewheel
    d.output = p.output_freewheel
    # a tenth for each step, so that the error of the whole run is about the tolerance asked for
    d.tolerance = max(0.1 * p.tolerance, 1e-14)
    d.max_step = p.max_step if p.max_step > 0.0 else 1e300
    scale = d.mass * d.k
    d.F_by_slip *= scale
    d.F_by_speed *= scale
    d.F_by_alpha1 = scale * d.F_by_alpha1 + d.k * (1.0 + d.k) * d.J16
    reach = 1.0 + d.s
    d.F_by_slip += 4.0 * d.k * d.windage * reach * reach * reach
    d.F_by_speed += 4.0 * d.k * d.windage * reach
    add_bodies(p, d)
    d.lightest = lightest_link2(d)
    singular = not d.lightest > SINGULAR_RATIO
    if d.by_torque != 0.0:
        d.lightest = min(d.lightest, d.J1 / (d.J1 + d.F_by_alpha1)) if d.J1 > 0.0 else 0.0
        if p.fidelity == KINEMATIC:
            return PRESCRIBED
        if not p.input_inertia > SINGULAR_RATIO * d.F_by_alpha1:
            return NO_INPUT_INERTIA
    if p.fidelity == KINEMATIC:
        return OK
    if p.method == TIMESTEPPING and d.housing_stiffness + d.freewheel_stiffness > 0.0:
        return WIND_UP_STEPPED
    if (p.method == TIMESTEPPING or p.fidelity == AVERAGED) and d.windage > 0.0:
        return NO_WINDAGE
    if p.fidelity == AVERAGED and (d.housing == 0.0 or d.output == 0.0):
        return NO_RECTIFIER
    if singular:
        return SINGULAR
    return check_start(p)


def satellites_overlap(p, reach):
    """Tell whether neighbouring satellites overlap.

    Planar: circles of radius r, their centres R0 + r from the axis and 2 (R0 + r) sin(pi/n) apart.
    Bevel: cones of half angle phi with one apex, their axes inclined by Sigma and delta apart:
    sin(delta/2) = sin(Sigma) sin(pi/n) against sin(phi) = sin(Sigma) / sqrt(1 + 2 s cos(Sigma) + s^2).
    An internal satellite (phi > pi/2) leaves no room for a second one; its root is below 1.

    Args:
        p: parameters. reach: (R0 + r) / r, or that root.
    """
    return p.satellites > 1.0 and reach * math.sin(math.pi / p.satellites) < 1.0 - ROUNDING


def warnings(p):
    """Sum of the warnings that hold for parameters that are each within their range."""
    found = 0
    if p.layout != 0.0:
        if satellites_overlap(p, 1.0 + p.sun_radius / p.satellite_radius):
            found += PLANAR_OVERLAP
        if p.eccentricity > p.satellite_radius * (1.0 + ROUNDING):
            found += PLANAR_OUTSIDE
        return found
    s = p.z17 / p.z6
    cosine = math.cos(p.shaft_angle)
    # never negative but by rounding
    if satellites_overlap(p, math.sqrt(max(0.0, 1.0 + 2.0 * s * cosine + s * s))):
        found += BEVEL_OVERLAP
    # the rim of an internal satellite is outside its pitch cone
    if s + cosine > 0.0 and p.a > min(1.0, p.b) * (1.0 + ROUNDING):
        found += BEVEL_OUTSIDE
    if p.satellite_inertia > 2.0 * p.satellite_transverse_inertia * (1.0 + ROUNDING):
        found += GEAR_TOO_FLAT
    return found
