"""Constants derived from the parameters: ratios, lengths, periods, inertias, bounds (mechanics.md).

The record d begins with the fields of p. Units are SI. The bevel layout has the lengths of figure 1 of
Karetin (2020), the planar layout follows Lysenko et al.
"""

import math

from . import codes
from .accumulate import TWO_PI, TWO_PI_LOW
from .equations.losses import add_loss_bounds, general_loss_coefficient
from .links import slowest_rate
from .records import Constants, Parameters

TWO_PI_HI = 6.283185303211212  # Leading 30 bits of 2 pi: its product with an integer below 2**23 is exact
STEP_TOLERANCE_FACTOR = 0.1  # Tolerance of an internal step over the parameter tolerance
# This ratio with an elastic shaft and without a housing freewheel: phase errors add up, because link 2 never
# comes to rest
FREE_SHAFT_TOLERANCE_FACTOR = 0.01
MIN_TOLERANCE = 1e-14
RIGID_RATE = 1e6  # rad/s, natural frequency above which a shaft is rigid: far above the pulses of any engine
UNLIMITED_STEP = 1e300  # s


def greatest_common_divisor(m: float, n: float) -> float:
    """Return the greatest common divisor by Euclid's algorithm.

    Args:
        m: First positive integer, as a double.
        n: Second positive integer, as a double.
    """
    while n > 0.0:
        rest = m % n
        m = n
        n = rest
    return m


def derive_period(turns: float, d: Constants) -> None:
    """Set the period of the motion in q, in two doubles.

    Args:
        turns: Revolutions of the pinion shaft in a period.
        d: Constants; period fields are written.
    """
    period = turns * TWO_PI
    rest = turns * (TWO_PI - TWO_PI_HI) + turns * TWO_PI_LOW
    d.period = period
    d.period_low = (turns * TWO_PI_HI - period) + rest
    d.period_turns = turns


def derive_bevel(d: Constants) -> None:
    """Set ratios, lengths, period and bounds of the bevel layout from teeth, shaft angle and a, b, c.

    Args:
        d: Constants; parameters are read. The bounds F_by_... are written without the factor mass k.
    """
    s = d.z17 / d.z6
    shaft_angle = d.shaft_angle
    sine = math.sin(shaft_angle)
    cosine = math.cos(shaft_angle)
    # Phi: half angle of the pitch cone of the satellite. Rolling without slip requires s = sin psi / sin phi
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
    # OQ - QA cos Sigma with OQ = c L cos psi, expanded to avoid cancellation for small Sigma
    d.axial = pitch * ((d.c - d.b) * math.cos(phi) * cosine + d.c * math.sin(phi) * sine)
    d.axial_cos = arm * sine
    # |r'|^2 = spin sin^2 B + (pole_offset + pole_arm (1 - cos B))^2, accurate also near 0
    d.pole_offset = (d.b - d.a) * pitch * sine * math.cos(phi)
    d.pole_arm = d.a * pitch * sine * math.cos(phi)
    d.spin_square = arm * arm * (1.0 + 2.0 * s * cosine + s * s)
    derive_period(d.z6 / greatest_common_divisor(d.z17, d.z6), d)
    # Upper bounds of |r| and |r'|
    reach = abs(d.radial) + abs(d.axial) + 2.0 * arm
    rate = reach + 2.0 * s * arm
    d.F_by_slip = s * (d.spin_square + 2.0 * d.pole_arm * (abs(d.pole_offset) + 2.0 * d.pole_arm))
    # With three or more satellites only the terms with the satellite's own rotation remain
    d.F_by_speed = 2.0 * reach * (rate if d.satellites <= 2.0 else 2.0 * s * arm)
    d.F_by_alpha1 = d.k * rate * rate + reach * rate
    d.harmonic = 2.0 * d.s
    if d.satellites <= 2.0:
        d.harmonic = 2.0 + 2.0 * d.s


def derive_planar(d: Constants) -> None:
    """Set ratios, lengths, period and bounds of the planar layout.

    Link 1 is the carrier, link 2 the sun gear on which the satellites roll.

    Args:
        d: Constants; parameters are read. The bounds F_by_... are written without the factor mass k.
    """
    arm = d.eccentricity
    centre = d.sun_radius + d.satellite_radius
    d.k = d.sun_radius / d.satellite_radius
    d.s = 1.0
    d.radial = d.pole_offset = arm
    d.axial = centre
    # Plane motion: the satellite rotates with its pinion shaft, and these terms of the bevel layout are 0
    d.phase_a = d.phase_b = d.radial_cos = d.arm = d.axial_cos = d.pole_arm = d.spin_square = d.F_by_slip = (
        0.0
    )
    derive_period(1.0, d)
    d.harmonic = 1.0
    d.F_by_speed = 2.0 * arm * centre
    d.F_by_alpha1 = d.k * arm * arm + arm * (arm + centre)


def derive_inertias(d: Constants) -> None:
    """Set masses, inertias and viscous friction under their symbols of mechanics.md.

    Args:
        d: Constants; parameters are read.
    """
    d.mass = d.imbalance_mass * d.modules * d.satellites
    d.J1 = d.input_inertia
    d.J2 = d.link2_inertia
    d.J3 = d.output_inertia
    d.J4 = d.driven_inertia
    d.J16 = d.drive_inertia
    d.b1 = d.input_friction
    d.bq = d.drive_friction
    d.b2 = d.link2_friction
    # The prescribed motion of fidelity kinematic ends at the output freewheel, upstream of J3
    d.b3 = d.output_friction if d.fidelity != codes.KINEMATIC else 0.0


def derive_shaft(d: Constants) -> None:
    """Set the flags of an elastic shaft, which is integrated or rigid, and of viscous friction.

    The shaft is rigid if its slowest natural frequency with a locked hub exceeds RIGID_RATE. Pulses with
    the frequency p excite it to (p / RIGID_RATE)^2 of their energy. J3 and b3 then include the driven mass,
    and the twist is the shaft torque over the stiffness (outputs.shaft_twist).

    Args:
        d: Constants; the fields of derive_inertias are read, J3 and b3 are written.
    """
    d.elastic = 1.0 if d.fidelity == codes.ELASTIC else 0.0
    d.rigid_shaft = 0.0
    if d.elastic != 0.0 and slowest_rate(d, 0.0) > RIGID_RATE:
        d.elastic = 0.0
        d.rigid_shaft = 1.0
        d.J3 += (1.0 - d.balancer) * d.J4
        d.b3 += d.driven_friction
    d.viscous = 1.0 if d.b1 + d.bq + d.b2 + d.b3 > 0.0 else 0.0


def derive_freewheels(d: Constants) -> None:
    """Set the parameters of absent freewheels and of absent springs to 0.

    Args:
        d: Constants; parameters are read.
    """
    d.housing_drag *= d.housing_freewheel
    d.housing_drag_viscous *= d.housing_freewheel
    d.output_drag *= d.output_freewheel
    d.output_drag_viscous *= d.output_freewheel
    elastic = 1.0 if d.fidelity == codes.ELASTIC else 0.0
    d.housing_stiffness *= elastic * d.housing_freewheel
    d.freewheel_stiffness *= elastic * d.output_freewheel
    d.housing_engagement_angle *= d.housing_freewheel
    d.output_engagement_angle *= d.output_freewheel
    if d.housing_stiffness == 0.0:
        d.housing_damping = 0.0
    if d.freewheel_stiffness == 0.0:
        d.freewheel_damping = 0.0
    d.backlash = 1.0 if d.housing_engagement_angle + d.output_engagement_angle > 0.0 else 0.0
    d.freewheel_angles = 1.0 if d.backlash + d.housing_stiffness + d.freewheel_stiffness > 0.0 else 0.0


def derive_losses(d: Constants) -> None:
    """Set loss coefficients and weight, and the flags that select the general equations of motion.

    Args:
        d: Constants; the fields of derive_freewheels and derive_inertias are read.
    """
    d.mesh_loss = 1.0 - d.mesh_efficiency
    d.satellite_loss = 0.0 if d.planar != 0.0 else 1.0 - d.satellite_mesh_efficiency
    # Weights of several modules, which are evenly spaced around the axis, balance
    d.weight = d.mass * d.gravity if d.modules == 1.0 else 0.0
    # Rotation of a satellite per q is z + s e: its product with axis x over cos A, and its square
    d.turn_across = -d.s * math.sin(d.shaft_angle)
    d.turn_along = 1.0 + 2.0 * d.s * math.cos(d.shaft_angle) + d.s * d.s
    drag = d.housing_drag + d.housing_drag_viscous + d.output_drag + d.output_drag_viscous
    d.losses = 1.0 if general_loss_coefficient(d) + drag + d.freewheel_angles > 0.0 else 0.0
    d.averaged = 1.0 if d.fidelity == codes.AVERAGED else 0.0
    d.averaged_losses = 0.0
    if d.averaged != 0.0:
        # Averaged motion has its own equations, and weights have no mean over a revolution of link 1
        d.averaged_losses = (
            1.0 if d.viscous + general_loss_coefficient(d) - d.weight + drag + d.backlash > 0.0 else 0.0
        )
        d.weight = 0.0


def add_gear_inertia(d: Constants) -> None:
    """Add the rotation of the satellite gears to J1, J16, I, B and the bounds of |F| (mechanics.md).

    The part of their kinetic energy that is the same at every angle becomes part of J1 and J16. The part that
    depends on the azimuth A of the gear's axis becomes gear_i (in I) and gear_b (in B).

    Args:
        d: Constants, complete except for the fields above.
    """
    d.gear_inertia = 0.0
    d.gear_i = 0.0
    d.gear_b = 0.0
    number = d.modules * d.satellites
    axial = number * d.satellite_inertia
    transverse = 0.0 if d.planar != 0.0 else number * d.satellite_transverse_inertia
    if axial + transverse == 0.0:
        return
    if d.planar == 0.0:
        d.gear_inertia = 1.0
        sine = math.sin(d.shaft_angle)
        cosine = math.cos(d.shaft_angle)
        turn = d.s + cosine  # Rotation of a gear about its own axis per q
        d.J1 += transverse
        # Over n satellites sum cos^2 A = n / 2 for n > 2, and sum cos A = 0 for n > 1
        if d.satellites <= 2.0:
            d.gear_i = (axial - transverse) * sine * sine
        else:
            d.J1 += 0.5 * (axial - transverse) * sine * sine
        if d.satellites == 1.0:
            d.gear_b = sine * (transverse * cosine - axial * turn)
        axial = axial * turn * turn + transverse * sine * sine
    d.J16 += axial
    d.F_by_speed += d.k * abs(d.gear_i)
    d.F_by_alpha1 += d.k * (abs(d.gear_b) + (1.0 + d.k) * axial)


def min_inertia_ratio(d: Constants) -> float:
    """Return the minimum over the maximum of the inertia J2 + k^2 G at link 2, in a period.

    G is minimal where B = 0. There |r'| is pole_offset, which is 0 if a = b (mechanics.md).
    Without an output freewheel link 2 always moves with the output shaft.

    Args:
        d: Constants.
    """
    offset = d.pole_offset
    max_offset = offset + 2.0 * d.pole_arm
    fixed = d.J2 + d.k * d.k * d.J16
    if d.output_freewheel == 0.0:
        fixed += d.J3
    moving = d.k * d.k * d.mass
    maximum = fixed + moving * (max_offset * max_offset + d.spin_square)
    return (fixed + moving * offset * offset) / maximum if maximum > 0.0 else 0.0


def derive_bounds(d: Constants) -> None:
    """Set bounds of the mesh torque |F|.

    |F| <= F_by_slip slip^2 + F_by_speed omega1^2 + F_by_alpha1 |alpha1|, with slip = omega1 - omega2.

    Args:
        d: Constants; the fields of the layout, of derive_inertias and derive_losses are read.
    """
    scale = d.mass * d.k
    d.F_by_slip *= scale
    d.F_by_speed *= scale
    d.F_by_alpha1 = scale * d.F_by_alpha1 + d.k * (1.0 + d.k) * d.J16
    add_loss_bounds(d)
    add_gear_inertia(d)


def derive_constants(p: Parameters, d: Constants) -> None:
    """Fill d from p.

    Args:
        p: Parameters, each within its range of the table of variables.
        d: Constants, written.
    """
    for n in range(len(p.numbers)):
        d.numbers[n] = p.numbers[n]
    d.planar = d.layout
    d.by_torque = 1.0 if d.drive == codes.DRIVE_TORQUE else 0.0
    if d.max_step == 0.0:
        d.max_step = UNLIMITED_STEP
    if d.planar != 0.0:
        derive_planar(d)
    else:
        derive_bevel(d)
    derive_inertias(d)
    derive_shaft(d)
    derive_freewheels(d)
    derive_losses(d)
    derive_bounds(d)
    is_free_shaft = d.elastic != 0.0 and d.housing_freewheel == 0.0
    factor = FREE_SHAFT_TOLERANCE_FACTOR if is_free_shaft else STEP_TOLERANCE_FACTOR
    d.tolerance = max(factor * d.tolerance, MIN_TOLERANCE)
