"""Twist and speed of DrivenShaft over a step, and the sums over them that the torques and energies need.

Each is written in two or three forms that are equal but for rounding: by the change over the step, anew
from what drives it, or, for the driven mass, from the hub less the slip. The form whose terms are
smallest is taken, so that short steps add up, long ones forget what has faded, and a stiff shaft keeps
its small twist and slip to the last digit.
"""

from ..accumulate import add


def slip(x):
    """Speed of the hub over the driven mass, rad/s: no digit is lost where the two nearly agree."""
    return ((x.hub_speed - x.omega4) - x.omega4_low) + x.hub_speed_low


def speed_rate(p, x):
    """omega4' from the torques of this instant, rad/s^2."""
    shaft = p.shaft_stiffness * x.twist + p.shaft_damping * slip(x)
    torque = shaft - p.driven_friction * x.omega4 - x.load_torque
    return torque / p.driven_inertia + p.balancer * x.hub_slope


def describe_motion(p, d, x, w):
    """Write into the workspace what drives slip and speed over the coming step."""
    inertia = p.driven_inertia
    slope = x.hub_slope
    turned = p.driven_friction / inertia
    w.slip = slip(x)
    # what pulls the twist at the beginning, the spring apart
    w.twist_push = turned * x.hub_speed + x.load_torque / inertia + (1.0 - p.balancer) * slope
    w.slip_pull = w.twist_push - d.square * x.twist
    w.slip_ramp = turned * slope
    w.omega4 = x.omega4
    w.speed_rate = speed_rate(p, x)
    w.speed_pull = d.square * w.slip + p.shaft_damping / inertia * slope
    w.speed_ramp = d.square * slope
    # the same without what the driven mass itself does
    torque = p.shaft_stiffness * x.twist + p.shaft_damping * x.hub_speed - x.load_torque
    w.fresh_rate = torque / inertia + p.balancer * slope
    w.fresh_pull = d.square * x.hub_speed + p.shaft_damping / inertia * slope


def move_twist(x, w, step, impulse, one, two):
    """Twist at the end of the step: by its change or anew, whichever rounds off less."""
    given = w.slip * impulse
    ramped = w.slip_ramp * two
    changed = w.slip_pull * one
    kept = step * x.twist
    pushed = w.twist_push * one
    if abs(kept) + abs(pushed) < abs(changed):
        x.twist = given + kept + pushed + ramped
        x.twist_low = 0.0
    else:
        x.twist, x.twist_low = add(x.twist, x.twist_low, given + changed + ramped)


def move_speed(x, w, slope, impulse, one, two):
    """Speed of the driven mass at the end: by its change, from the slip or anew, whichever rounds off
    least.

    Returns:
        Sum of the magnitudes of the terms used, rad/s.
    """
    by_rate = w.speed_rate * impulse
    by_pull = w.speed_pull * one
    by_ramp = w.speed_ramp * two
    kept = w.slip * slope
    pulled = w.slip_pull * impulse
    ramped = w.slip_ramp * one
    by_slip = abs(kept) + abs(pulled) + abs(ramped)
    by_change = abs(by_rate) + abs(by_pull) + abs(by_ramp)
    held = w.omega4 * slope
    fresh = w.fresh_rate * impulse
    drawn = w.fresh_pull * one
    anew = abs(held) + abs(fresh) + abs(drawn) + abs(by_ramp)
    if by_change <= by_slip and by_change <= anew:
        x.omega4, x.omega4_low = add(x.omega4, x.omega4_low, by_rate + by_pull + by_ramp)
        return by_change
    if by_slip <= anew:
        x.omega4 = x.hub_speed
        x.omega4_low = 0.0
        x.omega4_low = x.hub_speed_low
        x.omega4, x.omega4_low = add(x.omega4, x.omega4_low, -(kept + pulled + ramped))
        return by_slip
    x.omega4 = held + fresh + drawn + by_ramp
    x.omega4_low = 0.0
    return anew


def move_acceleration(p, x, w, slope, impulse, one):
    """omega4' at the end: carried on or from the torques, whichever rounds off less."""
    carried = w.speed_rate * slope
    pulled = w.speed_pull * impulse
    ramped = w.speed_ramp * one
    torques = (
        abs(p.shaft_stiffness * x.twist)
        + abs(p.shaft_damping * slip(x))
        + abs(p.driven_friction * x.omega4)
        + abs(x.load_torque)
    )
    if abs(carried) + abs(pulled) + abs(ramped) < torques / p.driven_inertia:
        x.acceleration = carried + pulled + ramped
    else:
        x.acceleration = speed_rate(p, x)


def turn_of_mass(x, w, impulse, one, two, three, h):
    """Angle the driven mass turns through: by its speed, that anew, or by the hub less the twist.

    Returns:
        (angle, bound): of the three that which rounds off least, and the sum of its terms' magnitudes.
    """
    steady = w.omega4 * h
    by_rate = w.speed_rate * one
    by_pull = w.speed_pull * two
    by_ramp = w.speed_ramp * three
    angle = steady + (by_rate + by_pull + by_ramp)
    bound = abs(steady) + abs(by_rate) + abs(by_pull) + abs(by_ramp)
    held = w.omega4 * impulse
    fresh = w.fresh_rate * one
    drawn = w.fresh_pull * two
    anew = abs(held) + abs(fresh) + abs(drawn) + abs(by_ramp)
    if anew < bound:
        angle = held + fresh + drawn + by_ramp
        bound = anew
    hub = x.hub_speed * h
    ramped = 0.5 * x.hub_slope * h * h
    given = w.slip * impulse
    pulled = w.slip_pull * one
    drifted = w.slip_ramp * two
    by_hub = abs(hub) + abs(ramped) + abs(given) + abs(pulled) + abs(drifted)
    if by_hub < bound:
        angle = (hub + ramped) - (given + pulled + drifted)
        bound = by_hub
    return angle, bound


def twist_sum(w, one, two, three):
    """Integral of the change of the twist, and the sum of its terms' magnitudes."""
    given = w.slip * one
    pulled = w.slip_pull * two
    ramped = w.slip_ramp * three
    return given + pulled + ramped, abs(given) + abs(pulled) + abs(ramped)


def torque_sums(p, x, w, impulse, one, two, three, four, h):
    """Integral of the shaft torque, and the integral of that: from the twist.

    Returns:
        (momentum, its size, moment, its size): a size is the sum of the terms' magnitudes.
    """
    c = p.shaft_stiffness
    damping = p.shaft_damping
    steady = x.twist * h
    change, size = twist_sum(w, impulse, one, two)
    sum1, size1 = twist_sum(w, one, two, three)
    sum2, size2 = twist_sum(w, two, three, four)
    return (
        c * (steady + sum1) + damping * change,
        c * (abs(steady) + size1) + damping * size,
        c * (0.5 * h * steady + sum2) + damping * sum1,
        c * (0.5 * h * abs(steady) + size2) + damping * size1,
    )


def torque_from_mass(p, ramp, load, change, change_size, angle, angle_size, h):
    """Integral of the shaft torque from the momentum of the driven mass, and its terms' magnitudes.

    With change, angle, ramp and load integrated once more it is the integral of that.
    """
    inertia = p.driven_inertia
    pushed = p.balancer * ramp * h
    passed = inertia * (change - pushed) + p.driven_friction * angle + load * h
    return passed, inertia * (change_size + abs(pushed)) + p.driven_friction * angle_size + abs(load) * h
