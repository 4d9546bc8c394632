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
from .dissipation import squares
from .motion import (
    describe_motion,
    move_acceleration,
    move_speed,
    move_twist,
    slip,
    speed_rate,
    torque_from_mass,
    torque_sums,
    turn_of_mass,
    twist_sum,
)
from .propagator import characteristic
from .responses import keep_responses


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


def stored_energy(p, x):
    """Kinetic energy of the driven mass and energy of the spring, J."""
    kinetic = p.driven_inertia * x.omega4 * x.omega4
    return 0.5 * (kinetic + p.shaft_stiffness * x.twist * x.twist)


def write_outputs(p, x, y):
    """All outputs and locals from the state."""
    y.shaft_torque = p.shaft_stiffness * x.twist + p.shaft_damping * slip(x)
    y.shaft_torque_mean = x.shaft_torque_mean
    y.omega_out = x.omega4
    y.driven_acceleration = x.acceleration
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
    swing, slow, fast = characteristic(d.rate, d.square)
    d.swing = swing
    d.slow = slow
    d.fast = fast
    d.step = 0.0
    for n in range(len(x.numbers)):
        x.numbers[n] = 0.0
    x.twist = p.twist_start
    x.omega4 = p.omega_out_start
    x.hub_speed = u.hub_speed
    x.held_input = u.hub_speed
    x.load_torque = u.load_torque
    x.acceleration = speed_rate(p, x)
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
    push = p.balancer * ((u.hub_speed - x.hub_speed) - x.hub_speed_low)
    x.hub_speed = u.hub_speed
    x.hub_speed_low = 0.0
    if push != 0.0:
        work = p.driven_inertia * push * (x.omega4 + 0.5 * push)
        x.omega4, x.omega4_low = add(x.omega4, x.omega4_low, push)
        x.energy_lost, x.energy_lost_low = add(x.energy_lost, x.energy_lost_low, -work)


def move(p, d, x, w, h):
    """Advance over the step, inputs taken: exact motion, mean torque and energies.

    The momentum the shaft passes is found from its twist or, where swings cancel in that, from the
    momentum of the driven mass: whichever rounds off less. The energies do not balance by construction.
    """
    describe_motion(p, d, x, w)
    hub = x.hub_speed
    ramp = x.hub_slope
    load = x.load_torque
    inertia = p.driven_inertia
    keep_responses(d, h)
    step = d.responses[0]
    slope = d.responses[1]
    impulse = d.responses[2]
    one = d.responses[3]
    two = d.responses[4]
    three = d.responses[5]
    four = d.responses[6]
    angle, turn = turn_of_mass(x, w, impulse, one, two, three, h)
    momentum, momentum_size, moment, moment_size = torque_sums(p, x, w, impulse, one, two, three, four, h)
    lost = 0.0
    if p.shaft_damping > 0.0 or p.driven_friction > 0.0:
        slips, speeds = squares(d, w, hub, ramp, h)
        lost = p.shaft_damping * slips + p.driven_friction * speeds
    before = x.omega4
    before_low = x.omega4_low
    x.hub_speed, x.hub_speed_low = add(x.hub_speed, x.hub_speed_low, ramp * h)
    move_twist(x, w, step, impulse, one, two)
    change_size = move_speed(x, w, slope, impulse, one, two)
    change = (x.omega4 - before) + (x.omega4_low - before_low)
    move_acceleration(p, x, w, slope, impulse, one)
    passed, size = torque_from_mass(p, ramp, load, change, change_size, angle, turn, h)
    if size < momentum_size:
        momentum = passed
    # integral of the angle: of the hub's less the twist
    twisted, twisted_size = twist_sum(w, one, two, three)
    swept = h * h * (0.5 * hub + ramp * h / 6.0) - twisted
    swept_size = h * h * (0.5 * abs(hub) + abs(ramp) * h / 6.0) + twisted_size
    passed, size = torque_from_mass(
        p, 0.5 * ramp * h, 0.5 * load * h, angle - before * h, turn + abs(before) * h, swept, swept_size, h
    )
    if size < moment_size:
        moment = passed
    x.energy_in, x.energy_in_low = add(
        x.energy_in, x.energy_in_low, (hub + ramp * h) * momentum - ramp * moment
    )
    x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, load * angle)
    x.energy_lost, x.energy_lost_low = add(
        x.energy_lost, x.energy_lost_low, lost - p.balancer * inertia * ramp * angle
    )
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
    acceleration = x.acceleration
    relative = x.hub_slope - acceleration
    torque = p.shaft_stiffness * slip(x) + p.shaft_damping * relative
    y.shaft_torque = torque
    y.shaft_torque_mean = 0.0
    y.omega_out = acceleration
    y.driven_acceleration = (torque - p.driven_friction * acceleration) / p.driven_inertia
    y.twist = slip(x)


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
