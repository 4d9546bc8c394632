"""Impacts on link 2 and the output shaft: a complementarity problem of impulses and end velocities.

- A jump of the input speed is the limit of a steep ramp. Link 2 moves freely until a freewheel closes, and
  then together with its contact partner. Contacts close at zero relative speed, so no energy is lost.
- A freewheel that reaches the end of its engagement angle with a relative speed undergoes a plastic impact.
"""

from .accumulate import add_loss
from .codes import DRIVING, FREE, HELD, HELD_DRIVING
from .equations.losses import FREEWHEEL, SHAFT
from .equations.states import RATIO_PRESCRIBED
from .inertia import reduced_inertia
from .links import inertia_of_link1, inertia_of_link2
from .records import Constants, State


def has_rigid_housing_contact(d: Constants, x: State) -> bool:
    """Return True if the housing freewheel can transmit an impulse: it is rigid and without backlash now."""
    return d.housing_freewheel != 0.0 and d.housing_stiffness == 0.0 and x.play_housing == 0.0


def has_rigid_output_contact(d: Constants, x: State) -> bool:
    """Return True if the output freewheel can transmit an impulse: it is rigid and without backlash now."""
    return d.freewheel_stiffness == 0.0 and x.play_output == 0.0


def solve_impact(
    d: Constants,
    inertia2: float,
    free2: float,
    inertia3: float,
    free3: float,
    housing_contact: bool,
    output_contact: bool,
) -> tuple[float, float, float, int]:
    """Solve for the velocities after an impact (Newton's law with the restitution 0, by cases).

        0 <= omega2          _|_ housing impulse >= 0
        0 <= omega3 - omega2 _|_ output impulse  >= 0

    Ties are broken as in equations.choice.set_mode: link 2 stays held, and the output shaft then in contact.

    Args:
        d: Constants.
        inertia2: Inertia of link 2, kg m^2.
        free2: Speed of link 2 without the impact, rad/s.
        inertia3: Inertia of the output shaft, kg m^2.
        free3: Speed of the output shaft without the impact, rad/s.
        housing_contact: True if the housing freewheel can transmit an impulse.
        output_contact: True if the output freewheel can transmit an impulse.

    Returns:
        (omega2, omega3, impulse, mode): speeds, rad/s; impulse of link 2 on the output shaft, N m s;
        contact mode.
    """
    reduced_mass = inertia2 * inertia3 / (inertia2 + inertia3)
    is_separating = reduced_mass * (free2 - free3) <= 0.0
    if housing_contact and free2 <= 0.0:
        is_separating = free3 > 0.0
    if d.output_freewheel != 0.0 and (is_separating or not output_contact):
        if housing_contact and free2 <= 0.0:
            return 0.0, free3, 0.0, HELD
        return free2, free3, 0.0, FREE
    # Equal speeds stay bitwise identical, otherwise a mechanism at rest would creep
    common = free2
    if free2 != free3:
        common = (inertia2 * free2 + inertia3 * free3) / (inertia2 + inertia3)
    if not housing_contact or common > 0.0:
        return common, common, reduced_mass * (free2 - free3), DRIVING
    return 0.0, 0.0, -inertia3 * free3, HELD_DRIVING


def jump_driven_mass(d: Constants, x: State, change3: float) -> None:
    """Apply a jump of the hub speed to the elastic output.

    The balancer passes the fraction beta of the jump to the driven mass.

    Args:
        d: Constants.
        x: State; the slip of the shaft and the loss in the shaft are written.
        change3: Jump of the hub speed, rad/s.
    """
    omega4 = x.omega3 - x.relative
    change4 = d.balancer * change3
    balancer_impulse = d.balancer * d.J4 * change3
    loss = (d.J4 * change4 - balancer_impulse) * (x.relative + 0.5 * (change3 - change4))
    loss -= balancer_impulse * (omega4 + 0.5 * change4)
    x.relative += change3 - change4
    add_loss(x, SHAFT, loss)


def apply_speed_step(
    d: Constants, x: State, inertia: tuple[float, float, float], change1: float, change2: float
) -> tuple[float, float]:
    """Apply a jump in which the speeds of links 1 and 2 change in proportion.

    Args:
        d: Constants.
        x: State; both speeds and the input work are written.
        inertia: (I, B, G), kg m^2.
        change1: Change of omega1, rad/s.
        change2: Change of omega2, rad/s.

    Returns:
        (P1, P2): impulses of M1 and M2, N m s.
    """
    i, b, g = inertia
    rate_change = d.k * (change1 - change2)
    mesh = d.k * (b * change1 + g * rate_change)
    drive = (d.J1 + i) * change1 + b * rate_change + mesh
    x.energy_in += drive * (x.omega1 + 0.5 * change1)
    x.omega1 += change1
    x.omega2 += change2
    return drive, mesh


def set_speeds(d: Constants, x: State, end2: float, end3: float) -> None:
    """Set the speeds of link 2 and the hub after an impact.

    Args:
        d: Constants.
        x: State; the speeds are written.
        end2: Speed of link 2, rad/s.
        end3: Speed of the hub, rad/s.
    """
    x.omega2 = end2
    if end3 != x.omega3:
        if d.elastic != 0.0:
            jump_driven_mass(d, x, end3 - x.omega3)
        elif d.rigid_shaft != 0.0:
            add_loss(x, SHAFT, -0.5 * d.balancer * d.J4 * (end3 - x.omega3) * (end3 + x.omega3))
        x.omega3 = end3


def jump_input(d: Constants, x: State, jump: float) -> tuple[float, float]:
    """Apply a jump of omega1. If the speed ratio is prescribed, the ratio may have changed, too.

    Args:
        d: Constants.
        x: State; speeds, input work and impulses are written.
        jump: Change of omega1, rad/s.

    Returns:
        (P1, Pc): impulses of the input torque and on the output, N m s.
    """
    i, _, b, _, g, _ = reduced_inertia(d, x.q)
    omega2 = x.omega2
    target = x.omega1 + jump
    is_prescribed = x.output_state == RATIO_PRESCRIBED
    inertia3 = d.J3
    fraction = 1.0
    if is_prescribed:
        end2 = end3 = d.kinematic_ratio * target
        change = end2 - omega2
    else:
        locked3 = inertia3 if d.output_freewheel == 0.0 else 0.0
        inertia2 = d.J2 + d.k * d.k * g + locked3
        change = d.k * (b + d.k * g) * jump / inertia2
        housing_contact, output_contact = has_rigid_housing_contact(d, x), has_rigid_output_contact(d, x)
        free2 = omega2 + change
        end2, end3, _, mode = solve_impact(
            d, inertia2, free2, inertia3 - locked3, x.omega3, housing_contact, output_contact
        )
        if end2 != omega2 + change and change != 0.0:
            # First part of the jump: link 2 is free until it meets its contact partner
            fraction = ((x.omega3 if mode == DRIVING else 0.0) - omega2) / change
    part = fraction * jump
    drive, mesh = apply_speed_step(d, x, (i, b, g), part, fraction * change)
    if fraction < 1.0:
        more_drive, more_mesh = apply_speed_step(d, x, (i, b, g), jump - part, end2 - x.omega2)
        drive += more_drive
        mesh += more_mesh
    x.omega1 = target
    output = inertia3 * (end3 - x.omega3)
    if is_prescribed:
        output = mesh - d.J2 * change
        x.energy_out += output * (omega2 + 0.5 * change)
    else:
        x.housing_impulse += d.J2 * (end2 - omega2) + output - mesh
    set_speeds(d, x, end2, end3)
    return drive, output


def apply_plastic_impact(d: Constants, x: State) -> None:
    """Apply the plastic impact of freewheels that have reached the end of their engagement angle.

    A relative speed that would close the contact becomes 0. Momentum is conserved. With a prescribed input
    torque the speed of link 1 changes, too. The kinetic energy of the relative motion is lost. It is half the
    impulse times the relative speed before. The meshes transmit their impulses without loss.

    Args:
        d: Constants.
        x: State; speeds, impulses, input work and the loss in the freewheels are written.
    """
    i, _, b, _, g, _ = reduced_inertia(d, x.q)
    inertia3 = d.J3
    locked3 = inertia3 if d.output_freewheel == 0.0 else 0.0
    omega2, omega3 = x.omega2, x.omega3
    inertia2 = inertia_of_link2(d, i, b, g) + locked3
    housing_contact, output_contact = has_rigid_housing_contact(d, x), has_rigid_output_contact(d, x)
    end2, end3, output, _ = solve_impact(
        d, inertia2, omega2, inertia3 - locked3, omega3, housing_contact, output_contact
    )
    if d.output_freewheel == 0.0:
        output = inertia3 * (end3 - omega3)
    change2 = end2 - omega2
    change1 = 0.0
    if d.by_torque != 0.0:
        change1 = d.k * (b + d.k * g) * change2 / inertia_of_link1(d, i, b, g)
    drive, mesh = apply_speed_step(d, x, (i, b, g), change1, change2)
    housing = d.J2 * change2 + output - mesh
    loss = output * (omega2 - omega3 + end2 - end3) - housing * (omega2 + end2)
    add_loss(x, FREEWHEEL, 0.5 * loss)
    x.input_impulse += drive
    x.output_impulse += output
    x.housing_impulse += housing
    set_speeds(d, x, end2, end3)
