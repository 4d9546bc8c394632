"""The elastic output alone: hub of given speed, spring and damper, driven mass (DESIGN section 3).

    Ts = c delta + d (omega_h - omega4)      delta' = omega_h - omega4
    J4 omega4' = Ts - f omega4 - T_load + beta J4 omega_h'

Stelmashchuk's stepping mechanism in SI units. The speed of the hub is constant or linear over a step, so
the motion is exact in one go, however stiff the shaft and long the step (propagator). A jump of the hub's
speed at the beginning of a step changes the speed of the driven mass by beta times the jump at once, and
leaves the twist; the torque of the shaft stays finite, so its mean holds no impulse.
"""

from ..accumulate import add, copy
from ..codes import (
    BAD_HUB_SPEED,
    BAD_HUB_SPEED_RATE,
    BAD_LOAD_TORQUE,
    BAD_LOAD_TORQUE_RATE,
    BAD_STEP,
    CHECK,
    NOT_FINITE,
    OK,
    OUTPUTS,
    RATES,
    START,
)
from ..limits import LARGEST_SPEED, LARGEST_STEP, LARGEST_TORQUE
from .motion import end, integral, keep_step, square_integral
from .propagator import characteristic


def check_inputs(u):
    """Status of the inputs: finite and within what a drivetrain can mean."""
    if not abs(u.hub_speed) <= LARGEST_SPEED:
        return BAD_HUB_SPEED
    if not abs(u.load_torque) <= LARGEST_TORQUE:
        return BAD_LOAD_TORQUE
    return OK


def check_rates(u, h):
    """Status of the rates of the inputs that are given: no input becomes absurd within the step h."""
    if u.hub_speed_rate_given != 0.0:
        if not abs(u.hub_speed + u.hub_speed_rate * h) <= LARGEST_SPEED:
            return BAD_HUB_SPEED_RATE
    if u.load_torque_rate_given != 0.0:
        if not abs(u.load_torque + u.load_torque_rate * h) <= LARGEST_TORQUE:
            return BAD_LOAD_TORQUE_RATE
    return OK


def driven_rate(p, x):
    """Acceleration of the driven mass by shaft, friction and load of this instant, rad/s^2."""
    shaft = p.shaft_stiffness * x.twist + p.shaft_damping * x.slip
    return (shaft - p.driven_friction * x.omega4 - x.load_torque) / p.driven_inertia


def stored_energy(p, x):
    """Kinetic energy of the driven mass and energy of the spring, J."""
    kinetic = p.driven_inertia * x.omega4 * x.omega4
    return 0.5 * (kinetic + p.shaft_stiffness * x.twist * x.twist)


def write_outputs(p, x, y):
    """All outputs and locals from the state."""
    y.shaft_torque = p.shaft_stiffness * x.twist + p.shaft_damping * x.slip
    y.shaft_torque_mean = x.shaft_torque_mean
    y.omega_out = x.omega4
    y.driven_acceleration = driven_rate(p, x) + p.balancer * x.hub_slope
    y.twist = x.twist
    stored = stored_energy(p, x)
    y.energy_in = x.energy_in
    y.energy_out = x.energy_out
    y.energy_stored = stored
    y.energy_lost = x.energy_lost
    passed = (x.energy_in - x.energy_out) - x.energy_lost
    y.energy_residual = passed - (stored - x.energy_start)


def start(p, d, u, x, y):
    """Derive the constants and set the state at the end of initialisation.

    Args:
        p: parameters, each within its range. u: inputs.
        d: derived constants, x: state, y: outputs, all written.

    Returns:
        Status: OK, BAD_HUB_SPEED or BAD_LOAD_TORQUE.
    """
    status = check_inputs(u)
    if status != OK:
        return status
    d.rate = (p.shaft_damping + p.driven_friction) / p.driven_inertia
    d.square = p.shaft_stiffness / p.driven_inertia
    d.swing, d.slow, d.fast = characteristic(d.rate, d.square)
    d.step = 0.0
    for n in range(len(x.numbers)):
        x.numbers[n] = 0.0
    x.twist = p.twist_start
    x.omega4 = p.omega_out_start
    x.slip = u.hub_speed - x.omega4
    x.hub_speed = u.hub_speed
    x.held_input = u.hub_speed
    x.load_torque = u.load_torque
    x.energy_start = stored_energy(p, x)
    write_outputs(p, x, y)
    return OK


def begin(p, u, x, h):
    """Take the inputs of the coming step; a jump of the hub's speed pushes the driven mass."""
    slope = 0.0
    if u.hub_speed_rate_given != 0.0:
        slope = u.hub_speed_rate
    elif p.input_hold != 0.0 and x.held_step > 0.0:
        slope = (u.hub_speed - x.held_input) / x.held_step
    x.hub_slope = slope
    x.held_input = u.hub_speed
    x.held_step = h
    x.load_torque = u.load_torque
    if u.load_torque_rate_given != 0.0:
        x.load_torque += 0.5 * h * u.load_torque_rate  # its mean over the step
    jump = (u.hub_speed - x.hub_speed) - x.hub_speed_low
    x.hub_speed = u.hub_speed
    x.hub_speed_low = 0.0
    push = p.balancer * jump
    if jump != 0.0:
        x.slip, x.slip_low = add(x.slip, x.slip_low, jump - push)
        work = p.driven_inertia * push * (x.omega4 + 0.5 * push)
        x.omega4, x.omega4_low = add(x.omega4, x.omega4_low, push)
        x.energy_lost, x.energy_lost_low = add(x.energy_lost, x.energy_lost_low, -work)


def describe(p, d, x, w):
    """Write the motions of twist, slip and driven mass over the coming step, as motion.end takes them."""
    turned = p.driven_friction / p.driven_inertia
    damped = p.shaft_damping / p.driven_inertia
    load = x.load_torque / p.driven_inertia
    # of the hub's acceleration, what pushes the mass and what the twist is left with
    pushed = p.balancer * x.hub_slope
    left = (1.0 - p.balancer) * x.hub_slope
    rate = driven_rate(p, x)
    # what pulls the twist but the spring, and what drives the mass but its own motion
    push = turned * x.hub_speed + load + left
    drive = d.square * x.twist + damped * x.hub_speed - load + pushed
    ramp = turned * x.hub_slope
    drag = damped * x.hub_slope
    bend = d.square * x.hub_slope
    copy(w.twist, (x.twist, x.slip + d.rate * x.twist, push, ramp))
    copy(w.slip, (x.slip, push - d.square * x.twist, ramp, 0.0))
    copy(w.slip_rate, (left - rate, ramp - d.square * x.slip, 0.0, 0.0))
    copy(w.speed, (x.omega4, drive, d.square * x.hub_speed + drag, bend))
    copy(w.speed_rate, (rate + pushed, d.square * x.slip + drag, bend, 0.0))


def move(p, d, x, w, h):
    """Advance over the step, inputs taken: exact motion, mean torque and energies.

    The energies do not balance by construction.
    """
    describe(p, d, x, w)
    keep_step(d, w, h)
    ramp = x.hub_slope
    load = x.load_torque
    stiffness = p.shaft_stiffness
    damping = p.shaft_damping
    # integrals of the shaft torque and of that
    momentum = stiffness * integral(d, w.twist, 1) + damping * integral(d, w.slip, 1)
    moment = stiffness * integral(d, w.twist, 2) + damping * integral(d, w.slip, 2)
    angle = integral(d, w.speed, 1)
    lost = damping * square_integral(d, w.slip) + p.driven_friction * square_integral(d, w.speed)
    lost -= p.balancer * p.driven_inertia * ramp * angle
    x.hub_speed, x.hub_speed_low = add(x.hub_speed, x.hub_speed_low, ramp * h)
    x.twist, x.twist_low = end(d, w.twist, w.slip, x.twist_low)
    x.slip, x.slip_low = end(d, w.slip, w.slip_rate, x.slip_low)
    x.omega4, x.omega4_low = end(d, w.speed, w.speed_rate, x.omega4_low)
    work = x.hub_speed * momentum - ramp * moment
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, work)
    x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, load * angle)
    x.energy_lost, x.energy_lost_low = add(x.energy_lost, x.energy_lost_low, lost)
    x.shaft_torque_mean = momentum / h


def advance(p, d, u, x, y, w, h):
    """Advance by the communication step h, s.

    A status other than OK leaves state and outputs as they were.

    Args:
        p, d, u: parameters, derived constants, inputs (held or extrapolated over the step).
        x, y: state and outputs, written. w: workspace.
    """
    if not 0.0 < h <= LARGEST_STEP:
        return BAD_STEP
    status = check_inputs(u)
    if status == OK:
        status = check_rates(u, h)
    if status != OK:
        return status
    copy(w.before.numbers, x.numbers)
    begin(p, u, x, h)
    move(p, d, x, w, h)
    for n in range(len(x.numbers)):
        if not abs(x.numbers[n]) < 1e300:
            status = NOT_FINITE
    if status != OK:
        copy(x.numbers, w.before.numbers)
        return status
    write_outputs(p, x, y)
    return OK


def write_rates(p, x, y):
    """Rate of each output, per second, in its place in y; the step mean holds for its step."""
    acceleration = driven_rate(p, x) + p.balancer * x.hub_slope
    relative = x.hub_slope - acceleration
    torque = p.shaft_stiffness * x.slip + p.shaft_damping * relative
    y.shaft_torque = torque
    y.shaft_torque_mean = 0.0
    y.omega_out = acceleration
    y.driven_acceleration = (torque - p.driven_friction * acceleration) / p.driven_inertia
    y.twist = x.slip


def call(operation, p, d, u, x, y, w, h):
    """The one entry of the compiled kernel: the operations of :mod:`.codes`. Returns a status."""
    if operation == START:
        return start(p, d, u, x, y)
    if operation == CHECK:
        return check_inputs(u)
    if operation == OUTPUTS:
        write_outputs(p, x, y)
        return OK
    if operation == RATES:
        write_rates(p, x, y)
        return OK
    return advance(p, d, u, x, y, w, h)
