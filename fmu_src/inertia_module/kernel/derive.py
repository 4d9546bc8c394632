"""Constants derived once from the parameters: ratios, lengths, periods, bounds (docs/mechanics.md).

And warnings of what is computed all the same, but cannot be built: room is said of the pitch circles (planar)
and the pitch cones (bevel) of one module, and no body has an inertia above the sum of the other two. The
deprecated value of `method` has a warning, too.
"""

import math

from . import codes
from .accumulate import TWO_PI, TWO_PI_LOW
from .equations.losses import add_to_bounds, by_load

# the leading 30 bits of 2 pi: a whole number below 2**23 times this is exact
TWO_PI_LEADING = 6.283185303211212
SINGULAR_RATIO = 1e-12
# parts that touch do not overlap
ROUNDING = 1e-12


def greatest_common_divisor(m, n):
    """Greatest common divisor of two whole numbers held as doubles."""
    while n > 0.0:
        rest = m % n
        m = n
        n = rest
    return m


def derive_period(turns, d):
    """Period of the motion in q, 2 pi times whole turns of the drive, in two doubles."""
    period = turns * TWO_PI
    rest = turns * (TWO_PI - TWO_PI_LEADING) + turns * TWO_PI_LOW
    d.period = period
    d.period_low = (turns * TWO_PI_LEADING - period) + rest
    d.period_turns = turns


def derive_bevel(d):
    """Karetin's standard layout: the lengths of figure 1 from teeth, shaft angle and a, b, c."""
    s = d.z17 / d.z6
    shaft_angle = d.shaft_angle
    sine = math.sin(shaft_angle)
    cosine = math.cos(shaft_angle)
    # half angle of the satellite's pitch cone: rolling without slip makes s = sin psi / sin phi
    phi = math.atan2(sine, s + cosine)
    pitch = d.wheel_radius / (s * math.sin(phi))
    arm = d.a * pitch * math.sin(phi)  # AD
    satellite_axis = d.b * pitch * math.cos(phi)  # QA
    d.k = d.z2 / d.z16
    d.s = s
    d.phase_a = d.gamma
    d.phase_b = d.epsilon
    d.radial = satellite_axis * sine
    d.radial_cos = arm * cosine
    d.arm = arm
    # OQ - QA cos Sigma with OQ = c L cos psi, written out so that nothing cancels for small Sigma
    d.axial = pitch * ((d.c - d.b) * math.cos(phi) * cosine + d.c * math.sin(phi) * sine)
    d.axial_cos = arm * sine
    # |r'|^2 = spin sin^2 B + (pole_offset + pole_arm (1 - cos B))^2: exact also where it vanishes
    d.pole_offset = (d.b - d.a) * pitch * sine * math.cos(phi)
    d.pole_arm = d.a * pitch * sine * math.cos(phi)
    d.spin = arm * arm * (1.0 + 2.0 * s * cosine + s * s)
    derive_period(d.z6 / greatest_common_divisor(d.z17, d.z6), d)
    reach = abs(d.radial) + abs(d.axial) + 2.0 * arm
    rate = reach + 2.0 * s * arm
    d.F_by_slip = s * (d.spin + 2.0 * d.pole_arm * (abs(d.pole_offset) + 2.0 * d.pole_arm))
    # three satellites or more even out what does not turn with the satellite itself
    d.F_by_speed = 2.0 * reach * (rate if d.satellites <= 2.0 else 2.0 * s * arm)
    d.F_by_alpha1 = d.k * rate * rate + reach * rate
    # the highest harmonic of q in the reduced inertia
    d.harmonic = 2.0 * d.s
    if d.satellites <= 2.0:
        d.harmonic = 2.0 + 2.0 * d.s


def derive_planar(d):
    """Lysenko's layout: link 1 is the carrier, link 2 the sun wheel the satellites roll on."""
    arm = d.eccentricity
    centre = d.sun_radius + d.satellite_radius
    d.k = d.sun_radius / d.satellite_radius
    d.s = 1.0
    d.radial = d.pole_offset = arm
    d.axial = centre
    # nothing turns out of the plane, or slower or faster than the drive
    d.phase_a = d.phase_b = d.radial_cos = d.arm = d.axial_cos = d.pole_arm = d.spin = d.F_by_slip = 0.0
    derive_period(1.0, d)
    d.harmonic = 1.0
    d.F_by_speed = 2.0 * arm * centre
    d.F_by_alpha1 = d.k * arm * arm + arm * (arm + centre)


def derive_general(d):
    """Derive what freewheels, losses and weights add to the equations of motion (kernel.equations)."""
    d.mesh_loss = 1.0 - d.mesh_efficiency
    d.satellite_loss = 0.0 if d.planar != 0.0 else 1.0 - d.satellite_mesh_efficiency
    # of modules that stand evenly about the axis the weights balance
    d.weight = d.mass * d.gravity if d.modules == 1.0 else 0.0
    d.turn_across = -d.s * math.sin(d.shaft_angle)
    d.turn_along = 1.0 + 2.0 * d.s * math.cos(d.shaft_angle) + d.s * d.s
    # what is not there, a freewheel or the spring in it, takes nothing
    d.housing_drag *= d.housing
    d.housing_drag_viscous *= d.housing
    d.output_drag *= d.output
    d.output_drag_viscous *= d.output
    d.housing_stiffness *= d.elastic * d.housing
    d.freewheel_stiffness *= d.elastic * d.output
    d.housing_engagement_angle *= d.housing
    d.output_engagement_angle *= d.output
    d.plays = 1.0 if d.housing_engagement_angle + d.output_engagement_angle > 0.0 else 0.0
    d.turning = 1.0 if d.plays + d.housing_stiffness + d.freewheel_stiffness > 0.0 else 0.0
    if d.housing_stiffness == 0.0:
        d.housing_damping = 0.0
    if d.freewheel_stiffness == 0.0:
        d.freewheel_damping = 0.0
    drag = d.housing_drag + d.housing_drag_viscous + d.output_drag + d.output_drag_viscous
    d.losses = 1.0 if by_load(d) + drag + d.turning > 0.0 else 0.0
    d.averaged = 1.0 if d.fidelity == codes.AVERAGED else 0.0
    d.lossy = 0.0
    if d.averaged != 0.0:
        # its own equations; the weights' mean over turns of link 1 is nothing
        d.lossy = 1.0 if d.viscous + by_load(d) - d.weight + drag + d.plays > 0.0 else 0.0
        d.weight = 0.0


def add_bodies(d):
    """Set what the turning satellite gears add to J1, J16, I, B and the bounds of |F|; d is there but for it.

    Of the energy of a gear's rotation (docs/mechanics.md, Bodies) what is the same at every angle is added to
    J1 and J16: only what goes with the azimuth A of its axis is left to the reduced inertia.
    """
    d.bodies = 0.0
    d.body_i = 0.0
    d.body_b = 0.0
    number = d.modules * d.satellites
    own = number * d.satellite_inertia
    across = number * d.satellite_transverse_inertia
    if d.planar != 0.0:
        across = 0.0
    if own + across == 0.0:
        return
    if d.planar == 0.0:
        d.bodies = 1.0
        sine = math.sin(d.shaft_angle)
        cosine = math.cos(d.shaft_angle)
        spin = d.s + cosine
        d.J1 += across
        # the sum of cos^2 A in I is half their number for three or more, that of cos A in B 0 for two or more
        if d.satellites <= 2.0:
            d.body_i = (own - across) * sine * sine
        else:
            d.J1 += 0.5 * (own - across) * sine * sine
        if d.satellites == 1.0:
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


def check_start(d):
    """Status of the starting speeds against the freewheels that are there."""
    omega2 = d.omega2_start
    omega_out = d.omega_out_start
    if d.housing_freewheel != 0.0 and omega2 < 0.0:
        return codes.BAD_START_HOUSING
    if d.output_freewheel == 0.0:
        if omega2 != omega_out:
            return codes.BAD_START_RIGID
    elif omega_out < omega2:
        return codes.BAD_START_OUTPUT
    return codes.OK


def derive(p, d):
    """Fill d from p and check what only shows in combination.

    Args:
        p: parameters, each already within the range of the table of variables; d begins with their fields.

    Returns:
        Status: OK, or that of parameters that are refused together.
    """
    for n in range(len(p.numbers)):
        d.numbers[n] = p.numbers[n]
    d.planar = d.layout
    if d.planar != 0.0:
        derive_planar(d)
    else:
        derive_bevel(d)
    d.mass = d.imbalance_mass * d.modules * d.satellites
    d.J1 = d.input_inertia
    d.J2 = d.link2_inertia
    d.J3 = d.output_inertia
    d.J16 = d.drive_inertia
    d.by_torque = 1.0 if d.drive == codes.DRIVE_TORQUE else 0.0
    d.elastic = 1.0 if d.fidelity == codes.ELASTIC else 0.0
    d.J4 = d.driven_inertia
    d.b1 = d.input_friction
    d.bq = d.drive_friction
    d.b2 = d.link2_friction
    d.b3 = d.output_friction if d.fidelity != codes.KINEMATIC else 0.0
    d.viscous = 1.0 if d.b1 + d.bq + d.b2 + d.b3 > 0.0 else 0.0
    d.housing = d.housing_freewheel
    d.output = d.output_freewheel
    derive_general(d)
    # a tenth for each step, so that the error of the whole run is about the tolerance asked for
    d.tolerance = max(0.1 * d.tolerance, 1e-14)
    if d.max_step == 0.0:
        d.max_step = 1e300
    scale = d.mass * d.k
    d.F_by_slip *= scale
    d.F_by_speed *= scale
    d.F_by_alpha1 = scale * d.F_by_alpha1 + d.k * (1.0 + d.k) * d.J16
    add_to_bounds(d)
    add_bodies(d)
    d.lightest = lightest_link2(d)
    singular = not d.lightest > SINGULAR_RATIO
    if d.by_torque != 0.0:
        d.lightest = min(d.lightest, d.J1 / (d.J1 + d.F_by_alpha1)) if d.J1 > 0.0 else 0.0
        if d.fidelity == codes.KINEMATIC:
            return codes.PRESCRIBED
        if not d.input_inertia > SINGULAR_RATIO * d.F_by_alpha1:
            return codes.NO_INPUT_INERTIA
    if d.fidelity == codes.KINEMATIC:
        return codes.NO_PLAY if d.plays != 0.0 else codes.OK
    if d.fidelity == codes.AVERAGED and d.windage > 0.0:
        return codes.NO_WINDAGE
    if d.fidelity == codes.AVERAGED and (d.housing == 0.0 or d.output == 0.0):
        return codes.NO_RECTIFIER
    if singular:
        return codes.SINGULAR
    return check_start(d)


def satellites_overlap(p, reach):
    """Tell whether neighbouring satellites overlap (docs/mechanics.md, Room).

    Args:
        reach: planar (R0 + r) / r, bevel sqrt(1 + 2 s cos Sigma + s^2).
    """
    return p.satellites > 1.0 and reach * math.sin(math.pi / p.satellites) < 1.0 - ROUNDING


def warnings(p):
    """Sum of the warnings that hold for parameters that are each within their range."""
    found = codes.METHOD_DEPRECATED if p.method == codes.TIMESTEPPING else 0
    if p.layout != 0.0:
        if satellites_overlap(p, 1.0 + p.sun_radius / p.satellite_radius):
            found += codes.PLANAR_OVERLAP
        if p.eccentricity > p.satellite_radius * (1.0 + ROUNDING):
            found += codes.PLANAR_OUTSIDE
        return found
    s = p.z17 / p.z6
    cosine = math.cos(p.shaft_angle)
    # never negative but by rounding
    if satellites_overlap(p, math.sqrt(max(0.0, 1.0 + 2.0 * s * cosine + s * s))):
        found += codes.BEVEL_OVERLAP
    # the rim of an internal satellite is outside its pitch cone
    if s + cosine > 0.0 and p.a > min(1.0, p.b) * (1.0 + ROUNDING):
        found += codes.BEVEL_OUTSIDE
    if p.satellite_inertia > 2.0 * p.satellite_transverse_inertia * (1.0 + ROUNDING):
        found += codes.GEAR_TOO_FLAT
    return found
