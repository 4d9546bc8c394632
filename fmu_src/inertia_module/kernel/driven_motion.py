"""Twist and speed of DrivenShaft over a step, and the sums over them that the torques and energies need.

Each is written in two or three forms that are equal but for rounding: by the change over the step, anew
from what drives it, or, for the driven mass, from the hub less the slip. The form whose terms are
smallest is taken, so that short steps add up, long ones forget what has faded, and a stiff shaft keeps
its small twist and slip to the last digit.
"""

from .accumulate import add, assign
from .driven_shaft_slots import *


def slip(x):
    """Speed of the hub over the driven mass, rad/s: no digit is lost where the two nearly agree."""
    return ((x[X_HUB_SPEED] - x[X_OMEGA4]) - x[X_OMEGA4_LOW]) + x[X_HUB_SPEED_LOW]


def speed_rate(p, x):
    """omega4' from the torques of this instant, rad/s^2."""
    shaft = p[P_STIFFNESS] * x[X_TWIST] + p[P_DAMPING] * slip(x)
    torque = shaft - p[P_FRICTION] * x[X_OMEGA4] - x[X_LOAD_TORQUE]
    return torque / p[P_DRIVEN_INERTIA] + p[P_BALANCER] * x[X_HUB_SLOPE]


def describe_motion(p, d, x, w):
    """Write into the workspace what drives slip and speed over the coming step."""
    inertia = p[P_DRIVEN_INERTIA]
    slope = x[X_HUB_SLOPE]
    turned = p[P_FRICTION] / inertia
    w[W_SLIP] = slip(x)
    # what pulls the twist at the beginning, the spring apart
    w[W_TWIST_PUSH] = turned * x[X_HUB_SPEED] + x[X_LOAD_TORQUE] / inertia + (1.0 - p[P_BALANCER]) * slope
    w[W_SLIP_PULL] = w[W_TWIST_PUSH] - d[D_SQUARE] * x[X_TWIST]
    w[W_SLIP_RAMP] = turned * slope
    w[W_OMEGA4] = x[X_OMEGA4]
    w[W_SPEED_RATE] = speed_rate(p, x)
    w[W_SPEED_PULL] = d[D_SQUARE] * w[W_SLIP] + p[P_DAMPING] / inertia * slope
    w[W_SPEED_RAMP] = d[D_SQUARE] * slope
    # the same without what the driven mass itself does
    torque = p[P_STIFFNESS] * x[X_TWIST] + p[P_DAMPING] * x[X_HUB_SPEED] - x[X_LOAD_TORQUE]
    w[W_FRESH_RATE] = torque / inertia + p[P_BALANCER] * slope
    w[W_FRESH_PULL] = d[D_SQUARE] * x[X_HUB_SPEED] + p[P_DAMPING] / inertia * slope


def move_twist(x, w, step, impulse, one, two):
    """Twist at the end of the step: by its change or anew, whichever rounds off less."""
    given = w[W_SLIP] * impulse
    ramped = w[W_SLIP_RAMP] * two
    changed = w[W_SLIP_PULL] * one
    kept = step * x[X_TWIST]
    pushed = w[W_TWIST_PUSH] * one
    if abs(kept) + abs(pushed) < abs(changed):
        assign(x, X_TWIST, given + kept + pushed + ramped)
    else:
        add(x, X_TWIST, given + changed + ramped)


def move_speed(x, w, slope, impulse, one, two):
    """Speed of the driven mass at the end: by its change, from the slip or anew, whichever rounds off
    least.

    Returns:
        Sum of the magnitudes of the terms used, rad/s.
    """
    by_rate = w[W_SPEED_RATE] * impulse
    by_pull = w[W_SPEED_PULL] * one
    by_ramp = w[W_SPEED_RAMP] * two
    kept = w[W_SLIP] * slope
    pulled = w[W_SLIP_PULL] * impulse
    ramped = w[W_SLIP_RAMP] * one
    by_slip = abs(kept) + abs(pulled) + abs(ramped)
    by_change = abs(by_rate) + abs(by_pull) + abs(by_ramp)
    held = w[W_OMEGA4] * slope
    fresh = w[W_FRESH_RATE] * impulse
    drawn = w[W_FRESH_PULL] * one
    anew = abs(held) + abs(fresh) + abs(drawn) + abs(by_ramp)
    if by_change <= by_slip and by_change <= anew:
        add(x, X_OMEGA4, by_rate + by_pull + by_ramp)
        return by_change
    if by_slip <= anew:
        assign(x, X_OMEGA4, x[X_HUB_SPEED])
        x[X_OMEGA4_LOW] = x[X_HUB_SPEED_LOW]
        add(x, X_OMEGA4, -(kept + pulled + ramped))
        return by_slip
    assign(x, X_OMEGA4, held + fresh + drawn + by_ramp)
    return anew


def move_acceleration(p, x, w, slope, impulse, one):
    """omega4' at the end: carried on or from the torques, whichever rounds off less."""
    carried = w[W_SPEED_RATE] * slope
    pulled = w[W_SPEED_PULL] * impulse
    ramped = w[W_SPEED_RAMP] * one
    torques = (
        abs(p[P_STIFFNESS] * x[X_TWIST])
        + abs(p[P_DAMPING] * slip(x))
        + abs(p[P_FRICTION] * x[X_OMEGA4])
        + abs(x[X_LOAD_TORQUE])
    )
    if abs(carried) + abs(pulled) + abs(ramped) < torques / p[P_DRIVEN_INERTIA]:
        x[X_ACCELERATION] = carried + pulled + ramped
    else:
        x[X_ACCELERATION] = speed_rate(p, x)


def turn_of_mass(x, w, impulse, one, two, three, h):
    """Angle the driven mass turns through: by its speed, that anew, or by the hub less the twist.

    Returns:
        (angle, bound): of the three that which rounds off least, and the sum of its terms' magnitudes.
    """
    steady = w[W_OMEGA4] * h
    by_rate = w[W_SPEED_RATE] * one
    by_pull = w[W_SPEED_PULL] * two
    by_ramp = w[W_SPEED_RAMP] * three
    angle = steady + (by_rate + by_pull + by_ramp)
    bound = abs(steady) + abs(by_rate) + abs(by_pull) + abs(by_ramp)
    held = w[W_OMEGA4] * impulse
    fresh = w[W_FRESH_RATE] * one
    drawn = w[W_FRESH_PULL] * two
    anew = abs(held) + abs(fresh) + abs(drawn) + abs(by_ramp)
    if anew < bound:
        angle = held + fresh + drawn + by_ramp
        bound = anew
    hub = x[X_HUB_SPEED] * h
    ramped = 0.5 * x[X_HUB_SLOPE] * h * h
    given = w[W_SLIP] * impulse
    pulled = w[W_SLIP_PULL] * one
    drifted = w[W_SLIP_RAMP] * two
    by_hub = abs(hub) + abs(ramped) + abs(given) + abs(pulled) + abs(drifted)
    if by_hub < bound:
        angle = (hub + ramped) - (given + pulled + drifted)
        bound = by_hub
    return angle, bound


def twist_sum(w, one, two, three):
    """Integral of the change of the twist, and the sum of its terms' magnitudes."""
    given = w[W_SLIP] * one
    pulled = w[W_SLIP_PULL] * two
    ramped = w[W_SLIP_RAMP] * three
    return given + pulled + ramped, abs(given) + abs(pulled) + abs(ramped)


def torque_sums(p, x, w, impulse, one, two, three, four, h):
    """Integral of the shaft torque, and the integral of that: from the twist.

    Returns:
        (momentum, its size, moment, its size): a size is the sum of the terms' magnitudes.
    """
    c = p[P_STIFFNESS]
    damping = p[P_DAMPING]
    steady = x[X_TWIST] * h
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
    inertia = p[P_DRIVEN_INERTIA]
    pushed = p[P_BALANCER] * ramp * h
    passed = inertia * (change - pushed) + p[P_FRICTION] * angle + load * h
    return passed, inertia * (change_size + abs(pushed)) + p[P_FRICTION] * angle_size + abs(load) * h
