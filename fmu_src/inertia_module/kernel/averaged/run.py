"""Fidelity averaged: the mean motion of the output shaft over the pulses (docs/mechanics.md).

    J3 omega3' = T - load        E' = M1 omega1 - T omega3

with the mean torque T = v^2 F(omega3 / |v|) of torque_map and the mean energy E of links 1 and 2. The speed v
is omega1, or under its torque that of E = J* v^2 / 2. A step is cut into legs: the shaft rests (the load is
more than the stall torque), is locked to link 1, coasts beyond the end of the map, or slips. Only the last
takes an integration.
"""

import math

from ..accumulate import add, add_loss, turn_against, wrap_drive_angle, wrap_input_angle
from ..codes import DRIVING, FREE, FREEWHEEL, HELD_DRIVING, OK, STEP_TOO_SMALL, TOO_MUCH_WORK
from .balance import lose, mean_input_torque, mesh_share
from .legs import (
    COASTING,
    LOCKED,
    RESTING,
    SLIPPING,
    choose_leg,
    closing_in,
    coast,
    coasting_torque,
    even_time,
    last_knot,
    leg_rate,
    mean_acceleration,
    rest,
    turn_locked,
)
from .rates import energy_at, flow, input_speed, look_up_input, ripple_at, side_at
from .step import slip

# legs and internal steps before a communication step is given up
MOST_STEPS = 20000
# a change of omega1 up to this fraction of it is small
SMALL_CHANGE = 0.2
# to find a ratio in the map
HALVINGS = 60
# speed of a shaft that is just pulled away, rad/s
STARTING = 1e-300


def torque_at(d, side, x, leg, v, alpha1):
    """Mean output torque now, the acceleration of the output shaft, that of link 2 and that of link 1."""
    load = x.load_torque
    rate = leg_rate(d, side, x, leg, v, alpha1)
    if leg == RESTING:
        return load, 0.0, 0.0, mean_acceleration(d, side.knots[0], rate)
    if leg == LOCKED:
        alpha = mean_acceleration(d, last_knot(side), rate)
        return load + d.J3 * alpha + d.b3 * x.omega3, alpha, alpha, alpha
    now = flow(d, side, x, abs(v), side.direction * rate, x.omega3)
    if leg == COASTING:
        torque = coasting_torque(d, side, x, abs(v))
        _, slowing, _ = closing_in(d, side, x, v, alpha1)
        return torque, -slowing, now[4][1], mean_acceleration(d, last_knot(side), rate)
    alpha1 = side.direction * now[5][1] if d.by_torque != 0.0 else rate
    return now[3][0], now[1][0], now[4][1], alpha1


def leg_speed(x, leg):
    """omega3 to look up in the map: a coasting shaft is beyond it, though both shafts may yet be at rest."""
    return max(x.omega3, STARTING) if leg == COASTING else x.omega3


def torques_at(d, side, x, leg, omega1, alpha1):
    """Mean input torque and mean mesh torque now, the speed of link 1 being given."""
    omega3 = x.omega3
    x.omega3 = leg_speed(x, leg)
    torque, alpha3, _, _ = torque_at(d, side, x, leg, omega1, alpha1)
    mean = mean_input_torque(d, side, x, omega1, alpha1, alpha3, torque)
    mesh = mesh_share(d, side, x, omega1, omega1, torque)
    x.omega3 = omega3
    return mean, mesh


def impulse_with_work(passed, omega1, alpha1, work, torque0, torque1):
    """Integral over a part of a torque with its work on link 1, by its ends where omega1 changes."""
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


def advance_leg(d, side, x, w, leg, v, alpha1, remaining):
    """Advance speeds and sums by one leg or internal step. Returns (time passed or -1, v at its end)."""
    energy0, share, _ = energy_at(d, side, x, v)
    prescribed = d.by_torque == 0.0
    omega3 = x.omega3
    impulse = 0.0
    torque0, mesh0 = 0.0, 0.0
    if leg == RESTING:
        h, impulse = rest(d, side, x, w, v, alpha1, remaining)
    elif leg == LOCKED:
        h, impulse = turn_locked(d, side, x, w, v, alpha1, remaining)
    elif leg == COASTING:
        h, impulse = coast(d, side, x, w, v, alpha1, remaining)
    else:
        if alpha1 != 0.0 and prescribed:
            torque0, mesh0 = torques_at(d, side, x, leg, v, alpha1)
        h, impulse = slip(d, side, x, w, v, alpha1, remaining)
        if h < 0.0:
            return -1.0, v
    end = v + alpha1 * h if prescribed else side.direction * w.next_speed
    x.output_impulse += impulse
    turn_against(x, x.load_torque, w.turned3)
    if prescribed:
        energy1, _, _ = energy_at(d, side, x, end)
        work = w.work + energy1 - energy0
        turned = h * (v + 0.5 * alpha1 * h)
        mesh_work = w.work
        mesh_taken = impulse if leg == LOCKED else 0.0
        input_taken = mesh_taken
        if d.lossy != 0.0:
            own, inner, own_impulse, inner_impulse = lose(d, side, x, w, v, end, h, omega3)
            if leg == COASTING:
                add_loss(x, FREEWHEEL, w.dragged)
                inner += w.dragged
                mesh_taken = side.direction * side.end * impulse
            mesh_taken += inner_impulse
            input_taken = mesh_taken + own_impulse
            mesh_work += inner
            work += inner + own
        if leg == SLIPPING:
            torque1, mesh1 = 0.0, 0.0
            if alpha1 != 0.0:
                torque1, mesh1 = torques_at(d, side, x, leg, end, alpha1)
            x.input_impulse += impulse_with_work(h, v, alpha1, work, torque0, torque1)
            x.mesh_impulse += impulse_with_work(h, v, alpha1, mesh_work, mesh0, mesh1)
        else:
            x.input_impulse += share * (end - v) + input_taken
            x.mesh_impulse += mesh_taken
    else:
        turned = side.direction * w.turned1
        work = x.drive_torque * turned
        x.theta1, x.theta1_low = add(x.theta1, x.theta1_low, turned)
        wrap_input_angle(x)
        mesh_work = w.work
        if d.lossy != 0.0:
            if leg == COASTING:
                add_loss(x, FREEWHEEL, w.dragged)
                mesh_work += w.dragged
            if leg != SLIPPING:
                energy1, _, _ = energy_at(d, side, x, end)
                w.lost = max(work - mesh_work - (energy1 - energy0), 0.0)
            mesh_work += lose(d, side, x, w, v, end, h, omega3)[1]
        if turned != 0.0:
            x.mesh_impulse += h * mesh_work / turned - d.b1 * turned
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, work)
    x.q, x.q_low = add(x.q, x.q_low, d.k * (turned - w.turned2))
    return h, end


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


def speed_at_start(d, x):
    """Speed v of the start: under its torque the mean omega1 = v g(omega3 / |v|) is looked for in the map."""
    omega1 = abs(x.omega1)
    if d.by_torque == 0.0 or omega1 == 0.0:
        return x.omega1
    side = side_at(d, x.omega1, 0.0)
    low = omega1 / last_knot(side).input[0]
    if x.omega3 < side.end * low:
        # a ratio within the map: the speed at which it is that of the two speeds
        low, high = 0.0, side.end
        for _ in range(HALVINGS):
            s = 0.5 * (low + high)
            if s * omega1 < x.omega3 * look_up_input(side, x, 1.0, s)[0]:
                low = s
            else:
                high = s
        low = omega1 / look_up_input(side, x, 1.0, low)[0]
    return math.copysign(low, x.omega1)


def trend(d, x, alpha1):
    """Where v goes from zero."""
    return x.drive_torque if d.by_torque != 0.0 else alpha1


def run_averaged(d, x, w, h):
    """Advance the mean motion by h. Returns a status."""
    alpha1 = x.alpha1
    time = 0.0
    v = x.omega1 if d.by_torque == 0.0 else x.map_speed
    for _ in range(MOST_STEPS):
        remaining = h - time
        side = side_at(d, v, trend(d, x, alpha1))
        leg = choose_leg(d, side, x, v, alpha1)
        show_mode(x, leg)
        # a leg ends where v passes zero: the map is another there
        rate = leg_rate(d, side, x, leg, v, alpha1)
        to_zero = -v / rate if v * rate < 0.0 and (leg != SLIPPING or d.by_torque == 0.0) else remaining
        cut = to_zero < remaining
        if cut:
            remaining = to_zero
        even = remaining if leg == SLIPPING else even_time(d, side, x, leg, v, alpha1, remaining, w.tolerance)
        passed, v = advance_leg(d, side, x, w, leg, v, alpha1, even)
        if passed < 0.0:
            return STEP_TOO_SMALL
        time += passed
        if passed >= remaining:
            if not cut:
                wrap_drive_angle(d, x)
                end_step(d, x, leg, v, x.omega1 + alpha1 * h if d.by_torque == 0.0 else v)
                return OK
            v = 0.0
    return TOO_MUCH_WORK


def end_step(d, x, leg, v, end):
    """Set the mean speeds at the end of a step or at the start; v, as it came, is end but for rounding."""
    # a shaft locked to link 1, or just come up with it, is exactly as fast
    if d.by_torque == 0.0 and (leg == LOCKED or (x.omega3 == v and v > 0.0)):
        x.omega3 = end
        x.omega3_low = 0.0
    if leg == LOCKED:
        x.omega2 = end
    side = side_at(d, end, trend(d, x, x.alpha1))
    leg = choose_leg(d, side, x, end, x.alpha1)
    show_mode(x, leg)
    x.omega2_low = 0.0
    if d.by_torque != 0.0:
        x.map_speed = end
        x.omega1 = input_speed(d, side, x, end)
        x.alpha1 = torque_at(d, side, x, leg, end, 0.0)[3]
    if leg == LOCKED:
        x.omega2 = x.omega3
    elif leg == RESTING:
        x.omega2 = 0.0
    else:
        x.omega2 = flow(d, side, x, abs(end), 0.0, x.omega3)[4][0]


def map_speed(d, x):
    """The speed v that the map goes with: omega1, or under its torque that of the energy."""
    return x.map_speed if d.by_torque != 0.0 else x.omega1


def averaged_energy(d, x):
    """Mean kinetic energy of the mechanism and the output shaft, J."""
    v = map_speed(d, x)
    energy, _, _ = energy_at(d, side_at(d, v, trend(d, x, x.alpha1)), x, v)
    return energy + 0.5 * d.J3 * x.omega3 * x.omega3


def write_averaged(d, x, y):
    """Mean torques, ripple and peak at the present speeds. Returns the acceleration of link 2.

    Of the mean output torque the mesh has its share, the housing takes the rest.
    """
    v = map_speed(d, x)
    alpha1 = x.alpha1
    side = side_at(d, v, trend(d, x, alpha1))
    leg = choose_leg(d, side, x, v, alpha1)
    omega3 = x.omega3
    x.omega3 = leg_speed(x, leg)
    torque, alpha3, alpha2, _ = torque_at(d, side, x, leg, v, alpha1)
    mesh = mesh_share(d, side, x, v, x.omega1, torque)
    y.input_torque = mean_input_torque(d, side, x, v, alpha1, alpha3, torque)
    y.mesh_torque = mesh
    y.output_torque = torque
    y.output_acceleration = alpha3
    y.housing_torque = torque + d.b2 * x.omega2 - mesh
    ripple = 0.0
    peak = abs(torque)
    if leg != LOCKED and leg != RESTING:
        ripple, peak = ripple_at(side, x, v)
    x.omega3 = omega3
    y.torque_ripple = ripple
    y.torque_peak = peak
    return alpha2
