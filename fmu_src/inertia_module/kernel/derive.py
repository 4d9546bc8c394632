"""Constants derived once from the parameters: ratios, lengths, periods, bounds (DESIGN section 2)."""

import math

from .collocation import derive_collocation
from .slots import *

TWO_PI = 6.283185307179586
TWO_PI_LOW = 2.4492935982947064e-16
# the leading 30 bits of 2 pi: a whole number below 2**23 times this is exact
TWO_PI_LEADING = 6.283185303211212
SINGULAR_RATIO = 1e-12


def greatest_common_divisor(m, n):
    """Greatest common divisor of two whole numbers held as doubles."""
    while n > 0.0:
        m, n = n, m % n
    return m


def derive_period(turns, d):
    """Period of the motion in q, 2 pi times whole turns of the drive, in two doubles."""
    period = turns * TWO_PI
    rest = turns * (TWO_PI - TWO_PI_LEADING) + turns * TWO_PI_LOW
    d[D_PERIOD] = period
    d[D_PERIOD_LOW] = (turns * TWO_PI_LEADING - period) + rest
    d[D_PERIOD_TURNS] = turns


def derive_bevel(p, d):
    """Karetin's standard layout: the lengths of figure 1 from teeth, shaft angle and a, b, c."""
    s = p[P_Z17] / p[P_Z6]
    shaft_angle = p[P_SHAFT_ANGLE]
    sine = math.sin(shaft_angle)
    cosine = math.cos(shaft_angle)
    # half angle of the satellite's pitch cone: rolling without slip makes s = sin psi / sin phi
    phi = math.atan2(sine, s + cosine)
    pitch = p[P_WHEEL_RADIUS] / (s * math.sin(phi))
    arm = p[P_A] * pitch * math.sin(phi)  # AD
    satellite_axis = p[P_B] * pitch * math.cos(phi)  # QA
    d[D_K] = p[P_Z2] / p[P_Z16]
    d[D_S] = s
    d[D_PHASE_A] = p[P_GAMMA]
    d[D_PHASE_B] = p[P_EPSILON]
    d[D_RADIAL] = satellite_axis * sine
    d[D_RADIAL_COS] = arm * cosine
    d[D_ARM] = arm
    # OQ - QA cos Sigma with OQ = c L cos psi, written out so that nothing cancels for small Sigma
    d[D_AXIAL] = pitch * ((p[P_C] - p[P_B]) * math.cos(phi) * cosine + p[P_C] * math.sin(phi) * sine)
    d[D_AXIAL_COS] = arm * sine
    # |r'|^2 = spin sin^2 B + (pole_offset + pole_arm (1 - cos B))^2: exact also where it vanishes
    d[D_POLE_OFFSET] = (p[P_B] - p[P_A]) * pitch * sine * math.cos(phi)
    d[D_POLE_ARM] = p[P_A] * pitch * sine * math.cos(phi)
    d[D_SPIN] = arm * arm * (1.0 + 2.0 * s * cosine + s * s)
    derive_period(p[P_Z6] / greatest_common_divisor(p[P_Z17], p[P_Z6]), d)
    reach = abs(d[D_RADIAL]) + abs(d[D_AXIAL]) + 2.0 * arm
    rate = reach + 2.0 * s * arm
    d[D_G_SLOPE] = s * (d[D_SPIN] + 2.0 * d[D_POLE_ARM] * (abs(d[D_POLE_OFFSET]) + 2.0 * d[D_POLE_ARM]))
    d[D_I_SLOPE] = 2.0 * reach * rate
    d[D_ALPHA_SLOPE] = d[D_K] * rate * rate + reach * rate


def derive_planar(p, d):
    """Lysenko's layout: link 1 is the carrier, link 2 the sun wheel the satellites roll on."""
    arm = p[P_ECCENTRICITY]
    centre = p[P_SUN_RADIUS] + p[P_SATELLITE_RADIUS]
    d[D_K] = p[P_SUN_RADIUS] / p[P_SATELLITE_RADIUS]
    d[D_S] = 1.0
    d[D_PHASE_A] = 0.0
    d[D_PHASE_B] = 0.0
    d[D_RADIAL] = arm
    d[D_RADIAL_COS] = 0.0
    d[D_ARM] = 0.0
    d[D_AXIAL] = centre
    d[D_AXIAL_COS] = 0.0
    d[D_POLE_OFFSET] = arm
    d[D_POLE_ARM] = 0.0
    d[D_SPIN] = 0.0
    derive_period(1.0, d)
    d[D_G_SLOPE] = 0.0
    d[D_I_SLOPE] = 2.0 * arm * centre
    d[D_ALPHA_SLOPE] = d[D_K] * arm * arm + arm * (arm + centre)


def derive_harmonic(p, d):
    """Highest harmonic of q in the reduced inertia: how finely a guard has to be sampled."""
    if d[D_PLANAR] != 0.0:
        d[D_HARMONIC] = 1.0
    elif p[P_SATELLITES] <= 2.0:
        d[D_HARMONIC] = 2.0 + 2.0 * d[D_S]
    else:
        d[D_HARMONIC] = 2.0 * d[D_S]


def is_singular(d):
    """Whether the inertia behind link 2, J2 + k^2 G, vanishes (next to its largest) at some angle.

    G is least where B = 0: there |r'| is pole_offset, zero where a = b (DESIGN section 2). Without
    the output freewheel link 2 always carries the output shaft.
    """
    offset = d[D_POLE_OFFSET]
    far = offset + 2.0 * d[D_POLE_ARM]
    fixed = d[D_J2] + d[D_K] * d[D_K] * d[D_J16]
    if d[D_OUTPUT] == 0.0:
        fixed += d[D_J3]
    moving = d[D_K] * d[D_K] * d[D_MASS]
    least = fixed + moving * offset * offset
    return not least > SINGULAR_RATIO * (fixed + moving * (far * far + d[D_SPIN]))


def check_start(p):
    """Status of the starting speeds against the freewheels that are there."""
    omega2 = p[P_OMEGA2_START]
    omega_out = p[P_OMEGA_OUT_START]
    if p[P_HOUSING_FREEWHEEL] != 0.0 and omega2 < 0.0:
        return BAD_START_HOUSING
    if p[P_OUTPUT_FREEWHEEL] == 0.0:
        if omega2 != omega_out:
            return BAD_START_RIGID
    elif omega_out < omega2:
        return BAD_START_OUTPUT
    return OK


def derive(p, d):
    """Fill d from p and check what only shows in combination.

    Args:
        p: parameters, P_SIZE doubles, each already within the range of the table of variables.
        d: derived constants, D_SIZE doubles, written.

    Returns:
        Status: OK, PRESCRIBED, NO_INPUT_INERTIA, NO_RECTIFIER, SINGULAR or a BAD_START code.
    """
    d[D_PLANAR] = p[P_LAYOUT]
    if p[P_LAYOUT] != 0.0:
        derive_planar(p, d)
    else:
        derive_bevel(p, d)
    d[D_SINGLE] = 1.0 if p[P_SATELLITES] == 1.0 else 0.0
    d[D_PAIRED] = 1.0 if p[P_SATELLITES] <= 2.0 else 0.0
    d[D_MASS] = p[P_IMBALANCE_MASS] * p[P_MODULES] * p[P_SATELLITES]
    derive_harmonic(p, d)
    d[D_J1] = p[P_J1]
    d[D_J2] = p[P_J2]
    d[D_J3] = p[P_J3]
    d[D_J16] = p[P_J16]
    derive_collocation(d)
    d[D_J4] = p[P_J4]
    d[D_STIFFNESS] = p[P_SHAFT_STIFFNESS]
    d[D_DAMPING] = p[P_SHAFT_DAMPING]
    d[D_FRICTION] = p[P_DRIVEN_FRICTION]
    d[D_BALANCER] = p[P_BALANCER]
    d[D_HOUSING] = p[P_HOUSING_FREEWHEEL]
    d[D_OUTPUT] = p[P_OUTPUT_FREEWHEEL]
    # a tenth for each step, so that the error of the whole run is about the tolerance asked for
    d[D_TOLERANCE] = max(0.1 * p[P_TOLERANCE], 1e-14)
    d[D_FOLLOWED] = 1.0 / d[D_TOLERANCE]
    d[D_MAX_STEP] = p[P_MAX_STEP] if p[P_MAX_STEP] > 0.0 else 1e300
    scale = d[D_MASS] * d[D_K]
    d[D_G_SLOPE] *= scale
    d[D_I_SLOPE] *= scale
    d[D_ALPHA_SLOPE] = scale * d[D_ALPHA_SLOPE] + d[D_K] * (1.0 + d[D_K]) * d[D_J16]
    if p[P_DRIVE] == DRIVE_TORQUE:
        if p[P_FIDELITY] == KINEMATIC:
            return PRESCRIBED
        if not d[D_J1] > SINGULAR_RATIO * d[D_ALPHA_SLOPE]:
            return NO_INPUT_INERTIA
    if p[P_FIDELITY] == KINEMATIC:
        return OK
    if p[P_FIDELITY] == AVERAGED and (d[D_HOUSING] == 0.0 or d[D_OUTPUT] == 0.0):
        return NO_RECTIFIER
    if is_singular(d):
        return SINGULAR
    return check_start(p)
