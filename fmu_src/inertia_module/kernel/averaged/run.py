"""Fidelity averaged: the mean motion of the output shaft over the pulses (docs/mechanics.md).

J3 omega3' = omega1^2 F(omega3 / |omega1|) - load, with the map F of average_map. A step is cut into
legs (average_legs): the shaft rests (the load is more than the stall torque), is locked to link 1, coasts
beyond the end of the map, or slips. Only the last takes an integration. The kinetic energy of the mechanism
is its mean E = omega1^2 epsilon / 2, so M1 omega1 = T omega3 + E'.
"""

from ..accumulate import add, wrap_drive_angle
from ..codes import DRIVING, FREE, HELD_DRIVING, OK, STEP_TOO_SMALL, TOO_MUCH_WORK
from .legs import COASTING, LOCKED, RESTING, SLIPPING, choose_leg, coast, rest, turn_locked
from .rates import energy_at, mean_input_torque, mean_rates, side_at
from .step import slip

# legs and internal steps before a communication step is given up
MOST_STEPS = 20000
# a change of omega1 up to this fraction of it is small
SMALL_CHANGE = 0.2
# speed of a shaft that is just pulled away, rad/s
STARTING = 1e-300


def torque_at(d, side, x, leg, omega1, alpha1):
    """Mean output torque now, the acceleration of the output shaft and that of link 2."""
    load = x.load_torque
    if leg == RESTING:
        return load, 0.0, 0.0
    if leg == LOCKED:
        return load + d.J3 * alpha1, alpha1, alpha1
    rates = mean_rates(side, x, abs(omega1), side.direction * alpha1, x.omega3)
    torque = rates[0] if leg == SLIPPING else 0.0
    alpha3 = (torque - load) / d.J3
    return torque, alpha3, rates[5] + rates[4] * alpha3


def leg_speed(x, leg):
    """omega3 to look up in the map: a coasting shaft is beyond it, though both shafts may yet be at rest."""
    return max(x.omega3, STARTING) if leg == COASTING else x.omega3


def input_torque_at(d, side, x, leg, omega1, alpha1):
    """Mean input torque now."""
    omega3 = x.omega3
    x.omega3 = leg_speed(x, leg)
    torque, alpha3, _ = torque_at(d, side, x, leg, omega1, alpha1)
    mean = mean_input_torque(d, side, x, omega1, alpha1, alpha3, torque)
    x.omega3 = omega3
    return mean


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


def advance_leg(d, side, x, w, leg, omega1, alpha1, remaining):
    """Advance the output shaft and all sums by one leg or internal step. Returns the time passed or -1."""
    energy0, share, _ = energy_at(d, side, x, omega1)
    impulse = 0.0
    torque0 = 0.0
    if leg == RESTING:
        h, impulse = rest(side, x, w, omega1, alpha1, remaining)
    elif leg == LOCKED:
        h, impulse = turn_locked(d, x, w, omega1, alpha1, remaining)
    elif leg == COASTING:
        h = coast(d, side, x, w, omega1, alpha1, remaining)
    else:
        if alpha1 != 0.0:
            torque0 = input_torque_at(d, side, x, leg, omega1, alpha1)
        h, impulse = slip(d, side, x, w, omega1, alpha1, remaining)
        if h < 0.0:
            return -1.0
    end = omega1 + alpha1 * h
    energy1, _, _ = energy_at(d, side, x, end)
    work = w.work + energy1 - energy0
    if leg == SLIPPING:
        torque1 = input_torque_at(d, side, x, leg, end, alpha1) if alpha1 != 0.0 else 0.0
        x.input_impulse += input_impulse(h, omega1, alpha1, work, torque0, torque1)
    else:
        x.input_impulse += share * (end - omega1) + (impulse if leg == LOCKED else 0.0)
    x.output_impulse += impulse
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, work)
    x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, x.load_torque * w.turned3)
    turned = h * (omega1 + 0.5 * alpha1 * h) - w.turned2
    x.q, x.q_low = add(x.q, x.q_low, d.k * turned)
    return h


def show_mode(x, leg):
    """Contact mode a leg is shown as; another than before counts as a switch."""
    mode = DRIVING
    if leg == RESTING:
        mode = HELD_DRIVING
    elif leg == COASTING:
        mode = FREE
    if mode != x.mode:
        x.mode = mode
        x.step_switches += 1.0


def run_averaged(d, x, w, h):
    """Advance the mean motion by h. Returns a status."""
    alpha1 = x.alpha1
    time = 0.0
    speed = x.omega1
    for _ in range(MOST_STEPS):
        remaining = h - time
        # a leg ends where omega1 passes zero: the map is another there
        to_zero = -speed / alpha1 if speed * alpha1 < 0.0 else remaining
        cut = to_zero < remaining
        if cut:
            remaining = to_zero
        side = side_at(d, speed, alpha1)
        leg = choose_leg(d, side, x, speed, alpha1)
        show_mode(x, leg)
        passed = advance_leg(d, side, x, w, leg, speed, alpha1, remaining)
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
    """Mean speed of link 2 at the end of a step that ends with this leg, omega1 being x.omega1 + alpha1 h."""
    end = x.omega1 + x.alpha1 * h
    # a shaft locked to link 1, or just come up with it, is exactly as fast
    if leg == LOCKED or (x.omega3 == speed and speed > 0.0):
        x.omega3 = end
        x.omega3_low = 0.0
    if leg == LOCKED:
        x.omega2 = end
    side = side_at(d, end, x.alpha1)
    leg = choose_leg(d, side, x, end, x.alpha1)
    show_mode(x, leg)
    x.omega2_low = 0.0
    if leg == LOCKED:
        x.omega2 = end
    elif leg == RESTING:
        x.omega2 = 0.0
    else:
        x.omega2 = mean_rates(side, x, abs(end), 0.0, x.omega3)[3]
