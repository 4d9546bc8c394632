"""Fidelity averaged: the mean motion of the output shaft over the pulses (DESIGN section 5).

J3 omega3' = omega1^2 F(omega3 / |omega1|) - load, with the map F of average_map. A step is cut into
legs: the shaft rests (the load is more than the stall torque), is locked to link 1, coasts beyond the
end of the map, or is driven. Only the last takes an integration. The kinetic energy of the mechanism
is its mean E = omega1^2 epsilon / 2, so M1 omega1 = T omega3 + E'.
"""

from .accumulate import add, assign, wrap_drive_angle
from .average_rates import (
    driving_rates,
    energy_at,
    mean_input_torque,
    ratio,
)
from .average_step import (
    GENTLE,
    W_ERROR,
    W_NEXT,
    W_TURNED2,
    W_TURNED3,
    W_WORK,
    gentle_step,
    stiff_step,
)
from .average_table import ROW_OMEGA2, ROW_TORQUE, first_row
from .held import GAUSS_NODE_1, GAUSS_NODE_2, GAUSS_WEIGHT_1, GAUSS_WEIGHT_2, GAUSS_WEIGHT_3
from .slots import *

# a torque or speed within this fraction of another is at it
ROUNDING = 1e-12
# legs and internal steps before a communication step is given up
MOST_STEPS = 20000
# a jump up to this fraction of omega1 changes next to nothing in the inertia on its way
SMALL_JUMP = 1e-3
# a change of omega1 up to this fraction of it is small
SMALL_CHANGE = 0.2

RESTING = 0
LOCKED = 1
COASTING = 2
DRIVEN = 3


def can_lock(d, x, header, omega1, alpha1, omega3, load):
    """Whether the shaft turns with link 1 and the drive, at rest in it, can hold the torque it takes."""
    if omega1 <= 0.0 or omega3 != omega1 or header != D_MAP_FORWARD:
        return False
    if d[header + 2] == 0.0 and x[X_OMEGA2] != omega1:
        return False  # the mean motion never comes up to link 1
    torque = load + d[D_J3] * alpha1
    most = d[D_MAP_LOCK] * omega1 * omega1
    if alpha1 < 0.0 and torque >= most * (1.0 - ROUNDING):
        return False  # it is just being lost
    return 0.0 <= torque <= most * (1.0 + ROUNDING)


def choose_leg(d, x, header, omega1, alpha1, load):
    """What the output shaft does from now on, and the contact mode it is shown as."""
    omega3 = x[X_OMEGA3]
    speed = abs(omega1)
    growing = alpha1 if header == D_MAP_FORWARD else -alpha1
    if can_lock(d, x, header, omega1, alpha1, omega3, load):
        return LOCKED
    if omega3 == 0.0 and load >= 0.0:
        stall = d[first_row(header) + ROW_TORQUE]
        torque = stall * speed * speed
        if torque < load * (1.0 - ROUNDING) or stall == 0.0:
            return RESTING
        if torque <= load * (1.0 + ROUNDING) and growing <= 0.0:
            return RESTING
        return DRIVEN
    gap = omega3 - d[header + 1] * speed
    closing = load / d[D_J3] + d[header + 1] * growing
    if gap > 0.0 or (gap == 0.0 and closing <= 0.0):
        return COASTING
    return DRIVEN


def rest(d, header, omega1, alpha1, load, remaining):
    """Time the shaft stays at rest: until the stall torque is up to the load."""
    speed = abs(omega1)
    growing = alpha1 if header == D_MAP_FORWARD else -alpha1
    stall = d[first_row(header) + ROW_TORQUE]
    if growing <= 0.0 or stall * (speed + growing * remaining) ** 2 <= load or stall <= 0.0:
        return remaining
    return min(max(((load / stall) ** 0.5 - speed) / growing, 0.0), remaining)


def lock(d, omega1, alpha1, load, remaining):
    """Time lock-up holds while omega1 falls."""
    torque = load + d[D_J3] * alpha1
    if alpha1 >= 0.0 or torque <= 0.0 or d[D_MAP_LOCK] * (omega1 + alpha1 * remaining) ** 2 >= torque:
        return remaining
    return min(max((omega1 - (torque / d[D_MAP_LOCK]) ** 0.5) / -alpha1, 0.0), remaining)


def coast(d, x, header, omega1, alpha1, load, remaining):
    """Time the shaft coasts: until it comes down to where the map ends."""
    end = d[header + 1]
    growing = alpha1 if header == D_MAP_FORWARD else -alpha1
    gap = x[X_OMEGA3] - end * abs(omega1)
    closing = load / d[D_J3] + end * growing
    if closing <= 0.0 or gap >= closing * remaining:
        return remaining, False
    return gap / closing, True


def one_step(d, x, w, header, speed, speed_rate, load, h, first, allowed):
    """One step of the driven shaft into the workspace, explicit if it can be. Whether it is accurate."""
    omega3 = x[X_OMEGA3]
    if h * abs(first[1]) <= GENTLE * d[D_J3]:
        gentle_step(d, x, w, header, speed, speed_rate, omega3, load, h, first, allowed)
    else:
        stiff_step(d, x, w, header, speed, speed_rate, omega3, load, h, first, allowed)
    x[X_STEP_EVALUATIONS] += 1.0
    return w[W_ERROR] <= 1.0


def overshoot(d, x, w, header, speed, speed_rate, h):
    """How far the step in the workspace went past rest (negative speed) or the end of the map, 1/s."""
    found = w[W_NEXT]
    past_end = found - d[header + 1] * (speed + speed_rate * h)
    return max(past_end, -found)


def drive(d, x, w, header, omega1, alpha1, load, remaining):
    """Advance the driven shaft by one accurate step, stopped exactly where it rests or the map ends.

    Returns:
        (time passed or -1, event): event 0 none, 1 at rest, 2 at the end of the map.
    """
    speed = abs(omega1)
    speed_rate = alpha1 if header == D_MAP_FORWARD else -alpha1
    omega3 = x[X_OMEGA3]
    first = driving_rates(d, x, header, speed, speed_rate, omega3)
    x[X_STEP_EVALUATIONS] += 1.0
    h = min(remaining, d[D_MAX_STEP])
    if x[X_STEP_SIZE] > 0.0:
        h = min(h, x[X_STEP_SIZE])
    fastest = max(omega3, max(speed, speed + speed_rate * h))
    allowed = d[D_TOLERANCE] * fastest + 1e-300
    wanted = h
    good = False
    for _ in range(80):
        good = one_step(d, x, w, header, speed, speed_rate, load, h, first, allowed)
        if good:
            break
        h *= max(0.1, 0.8 * w[W_ERROR] ** -0.25) if w[W_ERROR] < 1e4 else 0.1
    if not good:
        return -1.0, 0
    error = w[W_ERROR]
    factor = min(5.0, 0.8 * error**-0.25) if error > 1e-4 else 5.0
    # a step cut short by the end of the communication step says little about longer ones
    x[X_STEP_SIZE] = max(factor * h, x[X_STEP_SIZE]) if h == wanted else factor * h
    past = overshoot(d, x, w, header, speed, speed_rate, h)
    if past <= ROUNDING * fastest:
        return h, 0
    low = 0.0
    low_past = max(-omega3, omega3 - d[header + 1] * speed)
    high = h
    high_past = past
    # Illinois: a secant that never leaves the bracket
    for _ in range(60):
        h = high - high_past * (high - low) / (high_past - low_past)
        if not low < h < high:
            h = 0.5 * (low + high)
        if not low < h < high:
            h = high
            break
        one_step(d, x, w, header, speed, speed_rate, load, h, first, allowed)
        past = overshoot(d, x, w, header, speed, speed_rate, h)
        if abs(past) <= ROUNDING * fastest:
            break
        if past > 0.0:
            high = h
            high_past = past
            low_past *= 0.5
        else:
            low = h
            low_past = past
            high_past *= 0.5
    return h, 1 if -w[W_NEXT] > w[W_NEXT] - d[header + 1] * (speed + speed_rate * h) else 2


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


def torque_at(d, x, header, leg, omega1, alpha1, load):
    """Mean output torque now, the acceleration of the output shaft and that of link 2."""
    if leg == RESTING:
        return load, 0.0, 0.0
    if leg == LOCKED:
        return load + d[D_J3] * alpha1, alpha1, alpha1
    growing = alpha1 if header == D_MAP_FORWARD else -alpha1
    torque, _, _, _, part, partial = driving_rates(d, x, header, abs(omega1), growing, x[X_OMEGA3])
    if leg == COASTING:
        torque = 0.0
    alpha3 = (torque - load) / d[D_J3]
    return torque, alpha3, partial + part * alpha3


def torque_on_input(d, x, header, leg, omega1, alpha1, load):
    """Mean input torque now."""
    torque, alpha3, _ = torque_at(d, x, header, leg, omega1, alpha1, load)
    return mean_input_torque(d, x, header, omega1, alpha1, x[X_OMEGA3], alpha3, torque)


def takes_up_jump(d, x, jump, h):
    """Whether a shaft locked to link 1 can follow a jump of omega1 within the step: then it is a ramp."""
    load = x[X_LOAD_TORQUE]
    omega1 = x[X_OMEGA1]
    ramp = x[X_ALPHA1] + jump / h
    if not can_lock(d, x, D_MAP_FORWARD, omega1, 0.0, x[X_OMEGA3], max(load, 0.0)):
        return False
    lowest = min(omega1, omega1 + ramp * h)
    return lowest > 0.0 and 0.0 <= load + d[D_J3] * ramp <= d[D_MAP_LOCK] * lowest * lowest


def part_of_jump(d, x, header, start, jump):
    """Impulse of the input torque through a jump that keeps the sign of omega1, omega3 as it is."""
    if abs(jump) <= SMALL_JUMP * abs(start):
        return jump * input_inertia(d, x, header, start + 0.5 * jump)
    near = input_inertia(d, x, header, start + GAUSS_NODE_1 * jump)
    near += input_inertia(d, x, header, start + (1.0 - GAUSS_NODE_1) * jump)
    middle = input_inertia(d, x, header, start + GAUSS_NODE_2 * jump)
    middle += input_inertia(d, x, header, start + (1.0 - GAUSS_NODE_2) * jump)
    centre = input_inertia(d, x, header, start + 0.5 * jump)
    return jump * (GAUSS_WEIGHT_1 * near + GAUSS_WEIGHT_2 * middle + GAUSS_WEIGHT_3 * centre)


def input_inertia(d, x, header, omega1):
    """dP1/domega1 at constant omega3: epsilon - sigma epsilon' / 2, kg m^2."""
    _, share, share1 = energy_at(d, x, header, omega1, x[X_OMEGA3])
    sigma = ratio(x[X_OMEGA3], abs(omega1))
    return share - 0.5 * sigma * share1 if sigma < d[header + 1] else share


def jump_averaged(d, x, jump):
    """Apply a jump of omega1: the shaft keeps its speed, the mechanism takes up its mean energy.

    Returns:
        Impulse of the input torque, N m s.
    """
    start = x[X_OMEGA1]
    end = start + jump
    header0 = header_at(start, jump)
    header1 = header_at(end, -jump)
    before, _, _ = energy_at(d, x, header0, start, x[X_OMEGA3])
    after, _, _ = energy_at(d, x, header1, end, x[X_OMEGA3])
    add(x, X_ENERGY_IN, after - before)
    x[X_OMEGA1] = end
    if header0 == header1:
        return part_of_jump(d, x, header0, start, jump)
    return part_of_jump(d, x, header0, start, -start) + part_of_jump(d, x, header1, 0.0, end)


def header_at(omega1, trend):
    """Header of the map for omega1, or where it is zero for where it goes."""
    direction = omega1 if omega1 != 0.0 else trend
    return D_MAP_FORWARD if direction >= 0.0 else D_MAP_BACKWARD
