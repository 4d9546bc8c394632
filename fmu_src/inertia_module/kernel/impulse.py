"""Impulses on link 2 and the output shaft: complementarity with the end velocities.

A jump of the input speed is the limit of a steep ramp, so a freewheel that closes does so part of the way:
before, link 2 moves freely; after, with what it has met. As ideal contacts close at zero relative speed no
energy is lost; freewheels that have play do not.
"""

from .accumulate import add, add_loss
from .codes import DRIVING, FREE, HELD, HELD_DRIVING
from .equations.losses import FREEWHEEL, SHAFT
from .equations.states import GEARED
from .inertia import reduced_inertia
from .links import inertia_of_link1, inertia_of_link2, is_stiff


def holds_link2(d, x):
    """Tell whether the housing freewheel takes an impulse: no spring, no play left."""
    return d.housing != 0.0 and d.housing_stiffness == 0.0 and x.play_housing == 0.0


def meets_output(d, x):
    """Tell whether the output freewheel takes an impulse."""
    return d.freewheel_stiffness == 0.0 and x.play_output == 0.0


def settle(d, inertia2, free2, inertia3, free3, stops, meets):
    """Solve the complementarity problem on impulses, from the velocities without them.

    Args:
        stops, meets: whether the housing and the output freewheel take one.

    Returns:
        (omega2, omega3, Pc, contact mode) after the impulses.
    """
    # of equals as in equations.choice: link 2 stays held, and a shaft that nothing pulls away touches it
    reduced = inertia2 * inertia3 / (inertia2 + inertia3)
    apart = reduced * (free2 - free3) <= 0.0
    if stops and free2 <= 0.0:
        apart = free3 > 0.0
    if d.output != 0.0 and (apart or not meets):
        if stops and free2 <= 0.0:
            return 0.0, free3, 0.0, HELD
        return free2, free3, 0.0, FREE
    # what goes together goes on so to the bit: at rest it would creep
    together = free2
    if free2 != free3:
        together = (inertia2 * free2 + inertia3 * free3) / (inertia2 + inertia3)
    if not stops or together > 0.0:
        return together, together, reduced * (free2 - free3), DRIVING
    return 0.0, 0.0, -inertia3 * free3, HELD_DRIVING


def push_driven_mass(d, x, change3, stiff):
    """A jump of the hub's speed with an elastic output: the balancer passes beta of it on.

    A shaft that is too stiff for its motion to be followed takes the driven mass along: the jump is a
    ramp that is steep for link 2 and slow for the shaft.
    """
    omega4 = x.omega3 - x.relative
    change4 = change3 if stiff else d.balancer * change3
    balancing = d.balancer * d.J4 * change3
    lost = (d.J4 * change4 - balancing) * (x.relative + 0.5 * (change3 - change4))
    lost -= balancing * (omega4 + 0.5 * change4)
    x.relative, x.relative_low = add(x.relative, x.relative_low, change3 - change4)
    add_loss(x, SHAFT, lost)


def jump_links(d, x, inertia, jump, change2):
    """One linear part of a jump: omega1 by jump, omega2 by change2. Returns impulses of M1 and M2, N m s."""
    i, b, g = inertia
    rate_change = d.k * (jump - change2)
    mesh = d.k * (b * jump + g * rate_change)
    drive = (d.J1 + i) * jump + b * rate_change + mesh
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, drive * (x.omega1 + 0.5 * jump))
    x.omega1 += jump
    x.omega2 += change2
    return drive, mesh


def set_speeds(d, x, end2, end3, stiff):
    """Set the speeds of link 2 and hub after an impulse."""
    x.omega2 = end2
    x.omega2_low = 0.0
    if end3 != x.omega3:
        if d.elastic != 0.0:
            push_driven_mass(d, x, end3 - x.omega3, stiff)
        x.omega3 = end3
        x.omega3_low = 0.0


def shaft_inertia(d, stiff):
    """Inertia that a jump of the hub's speed moves, kg m^2: with a stiff shaft the driven mass, too."""
    return d.J3 + (1.0 - d.balancer) * d.J4 if stiff else d.J3


def jump_input(d, x, jump, stiff):
    """Apply a jump of omega1, rad/s; where link 2 is geared its ratio may have changed, too.

    Args:
        stiff: whether an elastic output takes the jump with the driven mass.

    Returns:
        (P1, Pc): impulse of the input torque and on the output, N m s.
    """
    i, _, b, _, g, _ = reduced_inertia(d, x.q)
    omega2 = x.omega2
    target = x.omega1 + jump
    geared = x.output_state == GEARED
    shaft = shaft_inertia(d, stiff)
    fraction = 1.0
    if geared:
        end2 = end3 = d.kinematic_ratio * target
        change = end2 - omega2
    else:
        carried = shaft if d.output == 0.0 else 0.0
        own = d.J2 + d.k * d.k * g + carried
        change = d.k * (b + d.k * g) * jump / own
        stops, meets = holds_link2(d, x), meets_output(d, x)
        free2 = omega2 + change
        end2, end3, _, mode = settle(d, own, free2, shaft - carried, x.omega3, stops, meets)
        if end2 != omega2 + change and change != 0.0:
            # the rest of the way link 2 goes with what it has met
            fraction = ((x.omega3 if mode == DRIVING else 0.0) - omega2) / change
    part = fraction * jump
    drive, mesh = jump_links(d, x, (i, b, g), part, fraction * change)
    if fraction < 1.0:
        more, more_mesh = jump_links(d, x, (i, b, g), jump - part, end2 - x.omega2)
        drive += more
        mesh += more_mesh
    x.omega1 = target
    output = shaft * (end3 - x.omega3)
    if geared:
        output = mesh - d.J2 * change
        x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, output * (omega2 + 0.5 * change))
    else:
        x.housing_impulse += d.J2 * (end2 - omega2) + output - mesh
    set_speeds(d, x, end2, end3, stiff)
    return drive, output


def close_freewheels(d, x):
    """Plastic impact of freewheels that have turned back through their play: what slips back stops.

    Momentum is kept, link 1 answers where its torque is given. The kinetic energy of the relative motion is
    lost, half the impulse times the slip before; the meshes take their part without loss.
    """
    i, _, b, _, g, _ = reduced_inertia(d, x.q)
    stiff = d.elastic != 0.0 and is_stiff(d, x, x.omega1)
    shaft = shaft_inertia(d, stiff)
    carried = shaft if d.output == 0.0 else 0.0
    omega2, omega3 = x.omega2, x.omega3
    own = inertia_of_link2(d, i, b, g) + carried
    stops, meets = holds_link2(d, x), meets_output(d, x)
    end2, end3, output, _ = settle(d, own, omega2, shaft - carried, omega3, stops, meets)
    if d.output == 0.0:
        output = shaft * (end3 - omega3)
    change = end2 - omega2
    jump = 0.0
    if d.by_torque != 0.0:
        jump = d.k * (b + d.k * g) * change / inertia_of_link1(d, i, b, g)
    drive, mesh = jump_links(d, x, (i, b, g), jump, change)
    housing = d.J2 * change + output - mesh
    add_loss(x, FREEWHEEL, 0.5 * (output * (omega2 - omega3 + end2 - end3) - housing * (omega2 + end2)))
    x.input_impulse += drive
    x.output_impulse += output
    x.housing_impulse += housing
    set_speeds(d, x, end2, end3, stiff)
