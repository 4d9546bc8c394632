"""Fidelity averaged: the mean motion of the output shaft over the pulses (docs/mechanics.md).

    J3 omega3' = T - load        E' = M1 omega1 - T omega3

with the mean torque T = v^2 F(omega3 / |v|) of torque_map and the mean energy E of links 1 and 2. The speed
v is omega1, or under its torque that of E = J* v^2 / 2; in the course of a communication step it is x.omega1.
"""

import math

from ..accumulate import add
from ..codes import DRIVING, FREE, HELD_DRIVING, OK, STEP_TOO_SMALL, TOO_MUCH_WORK
from ..events.advance import commit
from ..tableau import GAUSS, GAUSS_NODES, GAUSS_WEIGHTS
from . import rates
from .step import ARRIVED, advance_leg, beyond_rest, most_locked_torque

# contact mode that each leg is shown as
MODES = (HELD_DRIVING, DRIVING, FREE, DRIVING)
# a speed below this share of the speeds is zero where its leg ends
AT_REST = 1e-11
# legs and internal steps before a communication step is given up
MOST_STEPS = 20000
# to find the speed that a mean speed goes with
ROUNDS = 60
# share of the speeds by which they change for a difference
APART = 1e-5
# time after which link 1, at rest, turns if it will, s
JUST_TURNING = 1e-100
# a jump up to this fraction of omega1 changes next to nothing in the inertia on its way
SMALL_JUMP = 1e-3


def turns_with_link1(d, side, x, v):
    """Tell whether the shaft turns with link 1, the drive at rest in it."""
    if v <= 0.0:
        return False
    if d.by_torque != 0.0:
        # (between its slownesses a map that ends at link 1 may end with a torque)
        return (side.locks != 0.0 or side.end == 1.0) and abs(x.omega3 - side.end * v) <= ARRIVED * x.omega3
    # (without losses the mean motion may never come up to link 1)
    return x.omega3 == v and (side.end == 1.0 or x.omega2 == v)


def holds_torque(d, side, x, v, torque):
    """Tell whether the drive, at rest in link 1, can hold the torque of a shaft that turns with it."""
    return -d.output_drag <= torque <= most_locked_torque(d, side, x, v) * (1.0 + ARRIVED)


def stays_locked(d, side, x, v):
    """Tell whether the shaft turns with link 1 from now on."""
    if not turns_with_link1(d, side, x, v):
        return False
    rates.write_mean_rates(d, side, x, rates.LOCKED, v, x.omega3, d.mean)
    torque = d.mean.output
    if d.mean.omega1 < 0.0 and torque >= most_locked_torque(d, side, x, v) * (1.0 - ARRIVED):
        return False  # it is just being lost
    return holds_torque(d, side, x, v, torque)


def choose_leg(d, side, x, v):
    """Choose what the output shaft does from now on."""
    load = x.load_torque
    speed = abs(v)
    if stays_locked(d, side, x, v):
        return rates.LOCKED
    if x.omega3 == 0.0:
        rates.write_mean_rates(d, side, x, rates.RESTING, v, 0.0, d.mean)
        rate = side.direction * d.mean.omega1
        past = beyond_rest(d, side, x, speed if speed > 0.0 else JUST_TURNING * max(rate, 0.0))
        if past < -ARRIVED or (past == load == 0.0 and speed > 0.0):
            return rates.RESTING  # ... also while link 1 turns
        if load >= 0.0 or past < 0.0:
            time = APART * (speed / abs(rate) if speed * rate != 0.0 else 1.0)
            if past <= ARRIVED and beyond_rest(d, side, x, max(speed + rate * time, 0.0)) <= past:
                return rates.RESTING
            return rates.SLIPPING
    gap = x.omega3 - side.end * speed
    if gap == 0.0:
        rates.write_mean_rates(d, side, x, rates.COASTING, v, x.omega3, d.mean)
        gap = d.mean.omega3 - side.end * side.direction * d.mean.omega1
        return rates.COASTING if gap >= 0.0 else rates.SLIPPING
    return rates.COASTING if gap > 0.0 else rates.SLIPPING


def show_mode(x, leg):
    """Show the contact mode of a leg; another than before counts as a switch."""
    mode = MODES[leg]
    if mode != x.mode:
        x.mode = mode
        x.switches += 1.0


def meet_limits(d, side, x, leg, near, change):
    """Set speeds that have met where their leg ends, so near, and those that turn together, there exactly."""
    end = side.end * abs(x.omega1)
    if leg == rates.LOCKED:
        x.omega3 = rates.lock_ratio(d, side) * x.omega1
    elif x.omega3 <= near and change.omega3 <= 0.0:
        x.omega3 = 0.0
    elif abs(x.omega3 - end) <= near or (leg == rates.SLIPPING and x.omega3 > end):
        x.omega3 = end
    else:
        return
    x.omega3_low = 0.0


def run_averaged(d, x, w, h):
    """Advance the mean motion by h. Returns a status."""
    w.prescribed, w.load = x.drive_torque, x.load_torque
    if d.by_torque != 0.0:
        x.omega1 = x.map_speed
        x.omega1_low = 0.0
    start = x.omega1
    w.at_rest = AT_REST * (abs(start) + x.omega3)  # (both may come to rest at once)
    time = 0.0
    for _ in range(MOST_STEPS):
        side = rates.side_at(d, x.omega1, rates.trend(d, x))
        leg = choose_leg(d, side, x, x.omega1)
        show_mode(x, leg)
        remaining = h - time
        # a leg ends where v passes zero: the map is another there
        cut = d.by_torque == 0.0 and -x.omega1 * x.alpha1 > 0.0 and -x.omega1 / x.alpha1 < remaining
        if cut:
            remaining = -x.omega1 / x.alpha1
        found, ends = advance_leg(d, side, x, w, leg, remaining)
        if not found:
            return STEP_TOO_SMALL
        commit(d, x, w)
        near = abs(x.omega1) + abs(w.change.omega1) + x.omega3 + abs(w.change.omega3)
        near = max(AT_REST * near, w.at_rest) if ends else 0.0
        arrived = w.step >= remaining
        done = arrived and not cut
        time = h if done else time + w.step
        if d.by_torque == 0.0:
            x.omega1 = 0.0 if cut and arrived else start + x.alpha1 * time
            x.omega1_low = 0.0
        elif ends and side.direction * x.omega1 <= near:
            x.omega1 = x.omega1_low = 0.0
        meet_limits(d, side, x, leg, near, w.change)
        if done:
            end_step(d, x)
            return OK
    return TOO_MUCH_WORK


def mean_accelerations(d, side, x, leg, v):
    """Mean accelerations of links 1 and 2, rad/s^2, by a parabola from the motion in d.mean on."""
    m = d.mean
    rate, rate3, omega1, omega2 = m.omega1, m.omega3, m.theta1, m.omega2
    if rate == 0.0 and rate3 == 0.0:
        return 0.0, 0.0
    speeds = abs(v) + x.omega3
    time = APART * (speeds / (abs(rate) + abs(rate3)) if speeds > 0.0 else 1.0)
    rates.write_mean_rates(d, side, x, leg, v + rate * time, x.omega3 + rate3 * time, m)
    change1, change2 = m.theta1 - omega1, m.omega2 - omega2
    rates.write_mean_rates(d, side, x, leg, v + 2.0 * rate * time, x.omega3 + 2.0 * rate3 * time, m)
    change1, change2 = 4.0 * change1 - (m.theta1 - omega1), 4.0 * change2 - (m.omega2 - omega2)
    return 0.5 * change1 / time, 0.5 * change2 / time


def end_step(d, x):
    """Set the mean speeds at the end of a step or at the start, v being in x.omega1."""
    v = x.omega1
    side = rates.side_at(d, v, rates.trend(d, x))
    leg = choose_leg(d, side, x, v)
    show_mode(x, leg)
    rates.write_mean_rates(d, side, x, leg, v, x.omega3, d.mean)
    x.omega2, x.omega2_low = d.mean.omega2, 0.0
    if d.by_torque != 0.0:
        x.map_speed = v
        x.omega1, x.omega1_low = d.mean.theta1, 0.0
        x.alpha1, _ = mean_accelerations(d, side, x, leg, v)


def speed_at_start(d, x):
    """Speed v of the start: under its torque the mean omega1 = v g(omega3 / |v|) is looked for in the map."""
    omega1 = abs(x.omega1)
    if d.by_torque == 0.0 or omega1 == 0.0:
        return x.omega1
    side = rates.side_at(d, x.omega1, 0.0)
    v = omega1
    for _ in range(ROUNDS):
        v = omega1 / rates.look_up_input(side, x, rates.ratio(x.omega3, v))[0]
    return math.copysign(v, x.omega1)


def map_speed(d, x):
    """The speed v that the map goes with: omega1, or under its torque that of the energy."""
    return x.map_speed if d.by_torque != 0.0 else x.omega1


def averaged_energy(d, x):
    """Mean kinetic energy of the mechanism and the output shaft, J."""
    v = map_speed(d, x)
    return rates.energy_at(d, rates.side_at(d, v, rates.trend(d, x)), x, v) + 0.5 * d.J3 * x.omega3 * x.omega3


def write_averaged(d, x, y):
    """Mean torques, ripple and peak at the present speeds. Returns the acceleration of link 2.

    Of the mean output torque the mesh has its share, the housing takes the rest.
    """
    v = map_speed(d, x)
    side = rates.side_at(d, v, rates.trend(d, x))
    leg = choose_leg(d, side, x, v)
    m = d.mean
    rates.write_mean_rates(d, side, x, leg, v, x.omega3, m)
    y.input_torque = m.drive
    y.mesh_torque = m.housing
    y.output_torque = m.output
    y.output_acceleration = m.omega3
    y.housing_torque = m.output + d.b2 * x.omega2 - m.housing
    y.torque_ripple, y.torque_peak = 0.0, abs(m.output)
    if leg == rates.COASTING or leg == rates.SLIPPING:
        y.torque_ripple, y.torque_peak = rates.ripple_at(side, x, v)
    return mean_accelerations(d, side, x, leg, v)[1]


def takes_up_jump(d, x, jump, h):
    """Tell whether a shaft locked to link 1 can follow a jump of omega1 within the step as a ramp."""
    omega1, load = x.omega1, x.load_torque
    ramp = x.alpha1 + jump / h
    lowest = min(omega1, omega1 + ramp * h)
    if not lowest > 0.0 or not turns_with_link1(d, d.forward, x, omega1):
        return False
    if not holds_torque(d, d.forward, x, omega1, max(load, 0.0) + d.b3 * omega1):
        return False
    return holds_torque(d, d.forward, x, lowest, load + d.J3 * ramp + d.b3 * lowest)


def input_inertia(d, side, x, omega1):
    """dP1/domega1 at constant omega3: epsilon - sigma epsilon' / 2, kg m^2."""
    s = rates.ratio(x.omega3, abs(omega1))
    share, slope = rates.look_up_input(side, x, s)
    return d.J1 + share - 0.5 * s * slope


def part_of_jump(d, side, x, start, jump):
    """Impulse of the input torque through a jump that keeps the sign of omega1, omega3 as it is."""
    if abs(jump) <= SMALL_JUMP * abs(start):
        return jump * input_inertia(d, side, x, start + 0.5 * jump)
    impulse = 0.0
    for n in range(GAUSS):
        impulse += GAUSS_WEIGHTS[n] * jump * input_inertia(d, side, x, start + GAUSS_NODES[n] * jump)
    return impulse


def jump_averaged(d, x, jump):
    """Apply a jump of omega1: the shaft keeps its speed, the mechanism takes up its mean energy.

    Returns:
        Impulse of the input torque, N m s.
    """
    start = x.omega1
    end = start + jump
    before, after = rates.side_at(d, start, jump), rates.side_at(d, end, -jump)
    gained = rates.energy_at(d, after, x, end) - rates.energy_at(d, before, x, start)
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, gained)
    x.omega1 = end
    if before.direction == after.direction:
        return part_of_jump(d, before, x, start, jump)
    return part_of_jump(d, before, x, start, -start) + part_of_jump(d, after, x, 0.0, end)
