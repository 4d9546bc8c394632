"""A jump of the input speed acts impulsively: complementarity on impulses and end velocities.

The jump is the limit of a steep ramp, so a freewheel that closes does so part of the way: before,
link 2 moves freely; after, with what it has met. The end velocities are those of the 2 x 2 problem
of docs/mechanics.md, and as ideal contacts close at zero relative speed no energy is lost.
"""

from .accumulate import add, add_loss
from .codes import ELASTIC, SHAFT
from .inertia import reduced_inertia


def apply_part(d, x, i, b, g, jump, change2):
    """One linear part of the jump: omega1 by jump, link 2 by change2. Returns the input impulse."""
    rate_change = d.k * (jump - change2)
    impulse = (d.J1 + i) * jump + b * rate_change + d.k * (b * jump + g * rate_change)
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, impulse * (x.omega1 + 0.5 * jump))
    x.omega1 += jump
    return impulse


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


def jump_input(p, d, x, jump, stiff):
    """Apply a jump of omega1, N m s.

    Args:
        stiff: whether an elastic output takes the jump with the driven mass.

    Returns:
        (P1, Pc): impulse of the input torque and of the output freewheel, N m s.
    """
    i, _, _, b, _, g, _, _ = reduced_inertia(d, x.q)
    k = d.k
    shaft = d.J3 + (1.0 - d.balancer) * d.J4 if stiff else d.J3
    push = k * (b + k * g) * jump
    inertia = d.J2 + k * k * g
    omega2 = x.omega2
    omega3 = x.omega3
    target = x.omega1 + jump
    # freewheels that wind up take no impulse
    stops = d.housing != 0.0 and d.housing_stiffness == 0.0
    meets = d.freewheel_stiffness == 0.0
    joined = d.output == 0.0 or (meets and omega3 == omega2 and push > 0.0)
    if joined:
        inertia += shaft
    change = push / inertia if push != 0.0 else 0.0
    fraction = 1.0
    output_impulse = 0.0
    end2 = omega2 + change
    if stops and end2 < 0.0:
        fraction = omega2 / -change  # the rest of the way link 2 is held
        end2 = 0.0
    elif meets and not joined and end2 > omega3:
        fraction = (omega3 - omega2) / change  # the rest of the way it drives the shaft
        end2 = omega3 + (1.0 - fraction) * push / (inertia + shaft)
    part = fraction * jump
    impulse = apply_part(d, x, i, b, g, part, fraction * change)
    if fraction < 1.0:
        impulse += apply_part(d, x, i, b, g, jump - part, end2 - (omega2 + fraction * change))
    x.omega1 = target
    x.omega2 = end2
    x.omega2_low = 0.0
    if (meets and end2 > omega3) or d.output == 0.0:
        output_impulse = shaft * (end2 - omega3)
        if p.fidelity == ELASTIC:
            push_driven_mass(d, x, end2 - omega3, stiff)
        x.omega3 = end2
        x.omega3_low = 0.0
    return impulse, output_impulse


def jump_kinematic(d, x, jump, ratio):
    """Impulse where omega2 = ratio omega1 is prescribed; the ratio may have changed too.

    Returns:
        (P1, Pc): impulses at the input and at the output that keeps the ratio, N m s.
    """
    change2 = ratio * (x.omega1 + jump) - x.omega2
    if jump == 0.0 and change2 == 0.0:
        return 0.0, 0.0
    i, _, _, b, _, g, _, _ = reduced_inertia(d, x.q)
    output_impulse = d.k * (b * jump + g * d.k * (jump - change2)) - d.J2 * change2
    mean2 = x.omega2 + 0.5 * change2
    impulse = apply_part(d, x, i, b, g, jump, change2)
    x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, output_impulse * mean2)
    return impulse, output_impulse
