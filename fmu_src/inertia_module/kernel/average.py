"""Fidelity averaged: the mean motion of the output shaft over the pulses (DESIGN section 5).

J3 omega3' = omega1^2 F(omega3 / |omega1|) - load, with the map F of average_map. A step is cut into
legs: the shaft rests (the load is more than the stall torque), is locked to link 1, coasts beyond the
end of the map, or is driven. Only the last takes an integration. The kinetic energy of the mechanism
is its mean E = omega1^2 epsilon / 2, so M1 omega1 = T omega3 + E'.
"""

import math

from .accumulate import add, assign, wrap_drive_angle
from .average_drive import drive
from .average_legs import COASTING, DRIVEN, LOCKED, RESTING, choose_leg, header_at
from .average_rates import driving_rates, energy_at, mean_input_torque
from .average_step import W_NEXT, W_TURNED2, W_TURNED3, W_WORK
from .average_table import ROW_OMEGA2, ROW_TORQUE, first_row
from .slots import *

# legs and internal steps before a communication step is given up
MOST_STEPS = 20000
# a change of omega1 up to this fraction of it is small
SMALL_CHANGE = 0.2
# speed of a shaft that is just pulled away, rad/s
STARTING = 1e-300


def rest(d, header, omega1, alpha1, load, remaining):
    """Time the shaft stays at rest: until the stall torque is up to the load."""
    speed = abs(omega1)
    growing = alpha1 if header == D_MAP_FORWARD else -alpha1
    stall = d[first_row(header) + ROW_TORQUE]
    if growing <= 0.0 or stall * (speed + growing * remaining) ** 2 <= load or stall <= 0.0:
        return remaining
    return min(max((math.sqrt(load / stall) - speed) / growing, 0.0), remaining)


def lock(d, omega1, alpha1, load, remaining):
    """Time lock-up holds while omega1 falls."""
    torque = load + d[D_J3] * alpha1
    if alpha1 >= 0.0 or torque <= 0.0 or d[D_MAP_LOCK] * (omega1 + alpha1 * remaining) ** 2 >= torque:
        return remaining
    return min(max((omega1 - math.sqrt(torque / d[D_MAP_LOCK])) / -alpha1, 0.0), remaining)


def coast(d, x, header, omega1, alpha1, load, remaining):
    """Time the shaft coasts: until it comes down to where the map ends."""
    end = d[header + 1]
    growing = alpha1 if header == D_MAP_FORWARD else -alpha1
    gap = x[X_OMEGA3] - end * abs(omega1)
    closing = load / d[D_J3] + end * growing
    if closing <= 0.0 or gap >= closing * remaining:
        return remaining, False
    return gap / closing, True


def input_impulse(passed, omega1, alpha1, work, torque0, torque1):
    """Integral of M1 over a part with its work, by the values at both ends where omega1 changes."""
    middle = omega1 + 0.5 * alpha1 * passed
    if alpha1 == 0.0:
        return work / omega1 if omega1 != 0.0 else 0.0
    share = alpha1 * passed / middle if middle != 0.0 else 2.0
    if abs(share) > SMALL_CHANGE:
        centre = work / (middle * passed) if abs(share) < 1.9 else 0.5 * (torque0 + torque1)
        return passed * (torque0 + 4.0 * centre + torque1) / 6.0
    # power is work / passed and a slope: 1 / omega1 by its series
    end = omega1 + alpha1 * passed
    slope = torque1 * end - torque0 * omega1
    return (work * (1.0 + share * share / 12.0) - slope * passed * share / 12.0) / middle


def advance_leg(d, x, w, header, leg, omega1, alpha1, load, remaining):
    """Advance the output shaft and all sums by one leg or internal step. Returns the time passed or -1."""
    omega3 = x[X_OMEGA3]
    growing = alpha1 if header == D_MAP_FORWARD else -alpha1
    event = False
    energy0, share, _ = energy_at(d, x, header, omega1, omega3)
    if leg == DRIVEN:
        torque0 = 0.0
        if alpha1 != 0.0:
            torque0 = torque_on_input(d, x, header, leg, omega1, alpha1, load)
        h, stop = drive(d, x, w, header, omega1, alpha1, load, remaining)
        if h < 0.0:
            return -1.0
        end = omega1 + alpha1 * h
        turned3 = w[W_TURNED3]
        turned2 = w[W_TURNED2]
        work = w[W_WORK]
        torque = d[D_J3] * (w[W_NEXT] - omega3) + load * h
        add(x, X_OMEGA3, w[W_NEXT] - omega3)
        if stop == 1 or x[X_OMEGA3] < 0.0:
            assign(x, X_OMEGA3, 0.0)
        elif stop == 2 or x[X_OMEGA3] > d[header + 1] * abs(end):
            assign(x, X_OMEGA3, d[header + 1] * abs(end))
        energy1, _, _ = energy_at(d, x, header, end, x[X_OMEGA3])
        work_in = work + energy1 - energy0
        torque1 = torque_on_input(d, x, header, leg, end, alpha1, load) if alpha1 != 0.0 else 0.0
        x[X_INPUT_IMPULSE] += input_impulse(h, omega1, alpha1, work_in, torque0, torque1)
    else:
        h = remaining
        torque = 0.0
        if leg == RESTING:
            h = rest(d, header, omega1, alpha1, load, remaining)
            torque = load * h
            turned3 = 0.0
            turned2 = 0.0
            work = 0.0
        elif leg == LOCKED:
            h = lock(d, omega1, alpha1, load, remaining)
            torque = (load + d[D_J3] * alpha1) * h
            turned3 = h * (omega1 + 0.5 * alpha1 * h)
            turned2 = turned3
            work = (load + d[D_J3] * alpha1) * turned3
            assign(x, X_OMEGA3, omega1 + alpha1 * h)
        else:
            h, event = coast(d, x, header, omega1, alpha1, load, remaining)
            change = -load * h / d[D_J3]
            turned3 = h * (omega3 + 0.5 * change)
            part = d[first_row(header) + (int(d[header]) - 1) * MAP_ROW + ROW_OMEGA2]
            turned2 = part * h * (abs(omega1) + 0.5 * growing * h)
            work = 0.0
            add(x, X_OMEGA3, change)
            if event or x[X_OMEGA3] < 0.0:
                assign(x, X_OMEGA3, d[header + 1] * abs(omega1 + alpha1 * h))
        end = omega1 + alpha1 * h
        energy1, _, _ = energy_at(d, x, header, end, x[X_OMEGA3])
        work_in = work + energy1 - energy0
        x[X_INPUT_IMPULSE] += share * (end - omega1) + (torque if leg == LOCKED else 0.0)
    x[X_OUTPUT_IMPULSE] += torque
    add(x, X_ENERGY_IN, work_in)
    add(x, X_ENERGY_OUT, load * turned3)
    add(x, X_Q, d[D_K] * (h * (omega1 + 0.5 * alpha1 * h) - turned2))
    return h


def show_mode(x, leg):
    """Contact mode a leg is shown as; another than before counts as a switch."""
    mode = DRIVING
    if leg == RESTING:
        mode = HELD_DRIVING
    elif leg == COASTING:
        mode = FREE
    if mode != x[X_MODE]:
        x[X_MODE] = mode
        x[X_STEP_SWITCHES] += 1.0


def run_averaged(d, x, w, h):
    """Advance the mean motion by h. Returns a status."""
    alpha1 = x[X_ALPHA1]
    load = x[X_LOAD_TORQUE]
    time = 0.0
    speed = x[X_OMEGA1]
    for _ in range(MOST_STEPS):
        remaining = h - time
        # a leg ends where omega1 passes zero: the map is another there
        to_zero = -speed / alpha1 if speed * alpha1 < 0.0 else remaining
        cut = to_zero < remaining
        if cut:
            remaining = to_zero
        header = header_at(speed, alpha1)
        leg = choose_leg(d, x, header, speed, alpha1, load)
        show_mode(x, leg)
        passed = advance_leg(d, x, w, header, leg, speed, alpha1, load, remaining)
        if passed < 0.0:
            return STEP_TOO_SMALL
        time += passed
        speed += alpha1 * passed
        if passed >= remaining:
            if not cut:
                wrap_drive_angle(d, x)
                set_link2(d, x, leg, speed, h)
                return OK
            speed = 0.0
    return TOO_MUCH_WORK


def set_link2(d, x, leg, speed, h):
    """Mean speed of link 2 at the end of the step, where omega1 is X_OMEGA1 + alpha1 h."""
    alpha1 = x[X_ALPHA1]
    end = x[X_OMEGA1] + alpha1 * h
    # a shaft locked to link 1, or just come up with it, is exactly as fast
    if leg == LOCKED or (x[X_OMEGA3] == speed and speed > 0.0):
        assign(x, X_OMEGA3, end)
    if leg == LOCKED:
        assign(x, X_OMEGA2, end)
    header = header_at(end, alpha1)
    leg = choose_leg(d, x, header, end, alpha1, x[X_LOAD_TORQUE])
    show_mode(x, leg)
    if leg == LOCKED:
        assign(x, X_OMEGA2, end)
    elif leg == RESTING:
        assign(x, X_OMEGA2, 0.0)
    else:
        rates = driving_rates(d, x, header, abs(end), 0.0, x[X_OMEGA3])
        assign(x, X_OMEGA2, rates[3])


def leg_speed(x, leg):
    """omega3 to look up in the map: a coasting shaft is beyond it, though both shafts may yet be at rest."""
    return max(x[X_OMEGA3], STARTING) if leg == COASTING else x[X_OMEGA3]


def torque_at(d, x, header, leg, omega1, alpha1, load):
    """Mean output torque now, the acceleration of the output shaft and that of link 2."""
    if leg == RESTING:
        return load, 0.0, 0.0
    if leg == LOCKED:
        return load + d[D_J3] * alpha1, alpha1, alpha1
    growing = alpha1 if header == D_MAP_FORWARD else -alpha1
    torque, _, _, _, part, partial = driving_rates(d, x, header, abs(omega1), growing, leg_speed(x, leg))
    if leg == COASTING:
        torque = 0.0
    alpha3 = (torque - load) / d[D_J3]
    return torque, alpha3, partial + part * alpha3


def torque_on_input(d, x, header, leg, omega1, alpha1, load):
    """Mean input torque now."""
    torque, alpha3, _ = torque_at(d, x, header, leg, omega1, alpha1, load)
    return mean_input_torque(d, x, header, omega1, alpha1, leg_speed(x, leg), alpha3, torque)
