"""Fidelity `averaged` where the input torque is given: mean speeds of both shafts.

A step is cut into parts. In each omega1 changes linearly, as in :mod:`.average`, by just so much that the
mean of M1 is the torque given: with (1) M1 = omega1^2 F sigma + d(epsilon omega1^2 / 2)/dt / omega1 that is
an implicit step of order 2 for omega1, the output shaft within being as accurate as ever.
"""

from .accumulate import add, wrap_input_angle
from .average import run_averaged, torque_on_input
from .average_legs import choose_leg, header_at
from .limits import MAX_EVALUATIONS
from .slots import *

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
    torque = x[X_DRIVE_TORQUE]
    load = x[X_LOAD_TORQUE]
    omega1 = x[X_OMEGA1]
    alpha1 = x[X_ALPHA1]
    inertia = d[D_J1]
    for _ in range(LEG_ROUNDS):
        header = header_at(omega1, alpha1 if alpha1 != 0.0 else torque)
        leg = choose_leg(d, x, header, omega1, alpha1, load)
        at_rest = torque_on_input(d, x, header, leg, omega1, 0.0, load)
        # in one leg M1 is linear in alpha1
        inertia = torque_on_input(d, x, header, leg, omega1, 1.0, load) - at_rest
        x[X_STEP_EVALUATIONS] += 1.0
        found = (torque - at_rest) / inertia
        if found == alpha1:
            break
        alpha1 = found
    return alpha1, inertia


def take_back(x, w):
    """The state at the beginning of the part; the work done is not undone."""
    evaluations = x[X_STEP_EVALUATIONS]
    for n in range(X_SIZE):
        x[n] = w[W_PART_STATE + n]
    x[X_STEP_EVALUATIONS] = evaluations


def try_part(d, x, w, h, alpha1, inertia):
    """Advance by h at the acceleration that meets the torque. Returns (status, alpha1, whether it is met)."""
    wanted = x[X_DRIVE_TORQUE] * h
    slope = inertia * h
    # the impulse is a difference of energies and momenta: nothing below their rounding can be met
    moving = inertia * abs(x[X_OMEGA1]) + d[D_J3] * abs(x[X_OMEGA3])
    unmet = MET * (abs(wanted) + abs(slope * alpha1)) + ROUNDING * moving
    last = alpha1
    missed_last = 0.0
    for attempt in range(TRIES):
        if attempt > 0:
            take_back(x, w)
        x[X_ALPHA1] = alpha1
        x[X_INPUT_IMPULSE] = 0.0
        status = run_averaged(d, x, w, h)
        if status != OK:
            return status, alpha1, False
        missed = x[X_INPUT_IMPULSE] - wanted
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
    fastest = max(abs(w[W_PART_STATE + X_OMEGA1]), abs(x[X_OMEGA1]))
    # a shaft that is far faster acts on link 1 by its inertia
    fastest = max(fastest, min(1.0, d[D_J3] / d[D_J1]) * abs(w[W_PART_STATE + X_OMEGA3]))
    return h * (bent + drifted) / (d[D_TOLERANCE] * fastest + 1e-300)


def finish_part(x, w, h, alpha1, begin, end):
    """Angle and work of link 1 in the part; its speed has bent from a line between the accelerations."""
    torque = x[X_DRIVE_TORQUE]
    speed = w[W_PART_STATE + X_OMEGA1]
    turned = h * (speed + 0.5 * alpha1 * h - (end - begin) * h / 12.0)
    add(x, X_THETA1, turned)
    wrap_input_angle(x)
    x[X_ENERGY_IN] = w[W_PART_STATE + X_ENERGY_IN]
    x[X_ENERGY_IN_LOW] = w[W_PART_STATE + X_ENERGY_IN_LOW]
    add(x, X_ENERGY_IN, torque * turned)


def run_driven_averaged(d, x, w, h):
    """Advance the mean motion by h. Returns a status."""
    time = 0.0
    part = h
    begin, inertia = driven_mean(d, x)
    for _ in range(MOST_PARTS):
        for n in range(X_SIZE):
            w[W_PART_STATE + n] = x[n]
        remaining = h - time
        part = min(part, remaining)
        status, alpha1, met = try_part(d, x, w, part, begin, inertia)
        if x[X_STEP_EVALUATIONS] > MAX_EVALUATIONS:
            return TOO_MUCH_WORK
        if status != OK:
            if part <= SHORTEST * h:
                return status
            take_back(x, w)
            part *= SMALLEST_FACTOR
            continue
        x[X_OMEGA1] += alpha1 * part
        end, inertia_end = driven_mean(d, x)
        error = part_error(d, x, w, part, begin, alpha1, end) if met else 1e300
        factor = SMALLEST_FACTOR
        if error < 1e9:
            factor = max(SMALLEST_FACTOR, SAFETY * error ** (-1.0 / 3.0)) if error > 1e-6 else LARGEST_FACTOR
        if error > 1.0 and part > SHORTEST * h:
            take_back(x, w)
            part *= min(factor, 0.5)
            continue
        finish_part(x, w, part, alpha1, begin, end)
        time = h if part >= remaining else time + part
        if time >= h:
            x[X_ALPHA1] = end
            return OK
        begin = end
        inertia = inertia_end
        part *= min(factor, LARGEST_FACTOR)
    return TOO_MUCH_WORK
