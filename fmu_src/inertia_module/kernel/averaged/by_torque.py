"""Fidelity `averaged` where the input torque is given: mean speeds of both shafts.

A step is cut into parts. In each omega1 changes linearly, as in :mod:`.average`, by just so much that the
mean of M1 is the torque given: with (1) M1 = omega1^2 F sigma + d(epsilon omega1^2 / 2)/dt / omega1 that is
an implicit step of order 2 for omega1, the output shaft within being as accurate as ever.
"""

from ..accumulate import add, copy, wrap_input_angle
from ..codes import OK, TOO_MUCH_WORK
from ..limits import MAX_EVALUATIONS
from .legs import choose_leg
from .rates import side_at
from .run import input_torque_at, run_averaged

# rounds in which the leg and the acceleration it leads to agree
LEG_ROUNDS = 4
# tries to meet the torque in a part, and what is met of it
TRIES = 12
MET = 1e-13
ROUNDING = 2e-15
SAFETY = 0.9
SMALLEST_FACTOR = 0.1
LARGEST_FACTOR = 5.0
MOST_PARTS = 200000
# a part as short as this fraction of the step is taken as it is: a torque may jump within it
SHORTEST = 1e-7


def driven_mean(d, x):
    """Mean acceleration of link 1 now, and the mean inertia that its torque works against.

    Returns:
        (alpha1, dM1/dalpha1): rad/s^2 and kg m^2.
    """
    torque = x.drive_torque
    omega1 = x.omega1
    alpha1 = x.alpha1
    inertia = d.J1
    for _ in range(LEG_ROUNDS):
        side = side_at(d, omega1, alpha1 if alpha1 != 0.0 else torque)
        leg = choose_leg(d, side, x, omega1, alpha1)
        # in one leg M1 is linear in alpha1
        steady = input_torque_at(d, side, x, leg, omega1, 0.0)
        inertia = input_torque_at(d, side, x, leg, omega1, 1.0) - steady
        x.step_evaluations += 1.0
        found = (torque - steady) / inertia
        if found == alpha1:
            break
        alpha1 = found
    return alpha1, inertia


def restart_part(x, w):
    """Take the state at the beginning of the part again; the work done still counts."""
    evaluations = x.step_evaluations
    copy(x.numbers, w.part.numbers)
    x.step_evaluations = evaluations


def try_part(d, x, w, h, alpha1, inertia):
    """Advance by h at the acceleration that meets the torque. Returns (status, alpha1, whether it is met)."""
    wanted = x.drive_torque * h
    slope = inertia * h
    # the impulse is a difference of energies and momenta: nothing below their rounding can be met
    moving = inertia * abs(x.omega1) + d.J3 * abs(x.omega3)
    unmet = MET * (abs(wanted) + abs(slope * alpha1)) + ROUNDING * moving
    last = alpha1
    missed_last = 0.0
    for attempt in range(TRIES):
        if attempt > 0:
            restart_part(x, w)
        x.alpha1 = alpha1
        x.input_impulse = 0.0
        status = run_averaged(d, x, w, h)
        if status != OK:
            return status, alpha1, False
        missed = x.input_impulse - wanted
        if abs(missed) <= unmet:
            return OK, alpha1, True
        if attempt > 0 and alpha1 != last:
            secant = (missed - missed_last) / (alpha1 - last)
            # the torque rises with the acceleration: a secant that says otherwise spans a change of leg
            if secant > 0.1 * inertia * h:
                slope = secant
        last = alpha1
        missed_last = missed
        alpha1 -= missed / slope
    return OK, last, False


def part_error(d, x, w, h, begin, mean, end):
    """Estimated error of omega1 over the allowed one, by the accelerations at the beginning, mean and end."""
    bent = abs(0.5 * (begin + end) - mean) / 3.0
    size = abs(begin) + abs(end)
    drifted = (end - begin) * (end - begin) / (12.0 * size) if size > 0.0 else 0.0
    fastest = max(abs(w.part.omega1), abs(x.omega1))
    # a shaft that is far faster acts on link 1 by its inertia
    fastest = max(fastest, min(1.0, d.J3 / d.J1) * abs(w.part.omega3))
    return h * (bent + drifted) / (d.tolerance * fastest + 1e-300)


def finish_part(x, w, h, alpha1, begin, end):
    """Angle and work of link 1 in the part; its speed has bent from a line between the accelerations."""
    turned = h * (w.part.omega1 + 0.5 * alpha1 * h - (end - begin) * h / 12.0)
    x.theta1, x.theta1_low = add(x.theta1, x.theta1_low, turned)
    wrap_input_angle(x)
    x.energy_in, x.energy_in_low = add(w.part.energy_in, w.part.energy_in_low, x.drive_torque * turned)


def run_driven_averaged(d, x, w, h):
    """Advance the mean motion by h. Returns a status."""
    time = 0.0
    part = h
    begin, inertia = driven_mean(d, x)
    for _ in range(MOST_PARTS):
        copy(w.part.numbers, x.numbers)
        remaining = h - time
        part = min(part, remaining)
        status, alpha1, met = try_part(d, x, w, part, begin, inertia)
        if x.step_evaluations > MAX_EVALUATIONS:
            return TOO_MUCH_WORK
        if status != OK:
            if part <= SHORTEST * h:
                return status
            restart_part(x, w)
            part *= SMALLEST_FACTOR
            continue
        x.omega1 += alpha1 * part
        end, inertia_end = driven_mean(d, x)
        error = part_error(d, x, w, part, begin, alpha1, end) if met else 1e300
        factor = SMALLEST_FACTOR
        if error < 1e9:
            factor = max(SMALLEST_FACTOR, SAFETY * error ** (-1.0 / 3.0)) if error > 1e-6 else LARGEST_FACTOR
        if error > 1.0 and part > SHORTEST * h:
            restart_part(x, w)
            part *= min(factor, 0.5)
            continue
        finish_part(x, w, part, alpha1, begin, end)
        time = h if part >= remaining else time + part
        if time >= h:
            x.alpha1 = end
            return OK
        begin = end
        inertia = inertia_end
        part *= min(factor, LARGEST_FACTOR)
    return TOO_MUCH_WORK
