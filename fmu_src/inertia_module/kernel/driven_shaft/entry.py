"""The elastic output alone: hub of given speed, spring and damper, driven mass (docs/driven_shaft.md).

    Ts = c delta + d (omega_h - omega4)      delta' = omega_h - omega4
    J4 omega4' = Ts - f omega4 - T_load + beta J4 omega_h'

Stelmashchuk's stepping mechanism in SI units. The speed of the hub is constant or linear over a step, so
it is exact, however stiff the shaft and long the step. A jump of the hub's speed at its beginning changes
omega4 by beta times the jump at once and leaves the twist; the torque of the shaft stays finite, so its mean
holds no impulse. The slip delta' is kept besides omega4: each may be small where the other is not.
"""

from ..accumulate import add, clear, copy
from ..codes import CHECK, NOT_FINITE, OK, OUTPUTS, RATES, START, TUNE
from ..inputs import check_hold, check_inputs, check_step, mean_torque, take_speed
from .motion import characteristic, end, integral, keep_step, square_integral, write_row

# its records (see kernel.fields)
STATE = (
    *("twist", "twist_low", "slip", "slip_low", "omega4", "omega4_low"),
    *("hub_slope", "held_input", "length", "load_torque", "shaft_torque_mean", "energy_start"),
    *("energy_in", "energy_in_low", "energy_out", "energy_out_low", "energy_lost", "energy_lost_low"),
)
# all per inertia: the characteristic equation is lambda^2 + rate lambda + square = 0; what swing, slow and
# fast are tells motion.characteristic. Then the step last taken, the responses to it and its Gramian
CONSTANTS = ("rate", "square", "swing", "slow", "fast", "step", ("responses", 6), ("gramian", 16))
# z1 to z4 of the motions over the step in hand, room for the Gramian (motion), the state before the step
WORKSPACE = (
    *(("twist", 4), ("slip", 4), ("slip_rate", 4), ("speed", 4), ("speed_rate", 4)),
    *(("move", 16), ("product", 16), ("before", STATE)),
)


def driven_acceleration(p, x):
    """Acceleration of the driven mass now, rad/s^2: without the push of the balancer, and with it."""
    shaft = p.shaft_stiffness * x.twist + p.shaft_damping * x.slip
    own = (shaft - p.driven_friction * x.omega4 - x.load_torque) / p.driven_inertia
    return own, own + p.balancer * x.hub_slope


def stored_energy(p, x):
    """Kinetic energy of the driven mass and energy of the spring, J."""
    kinetic = p.driven_inertia * x.omega4 * x.omega4
    return 0.5 * (kinetic + p.shaft_stiffness * x.twist * x.twist)


def write_outputs(p, x, y):
    """All outputs and locals from the state."""
    y.shaft_torque = p.shaft_stiffness * x.twist + p.shaft_damping * x.slip
    y.shaft_torque_mean = x.shaft_torque_mean
    y.omega_out = x.omega4
    _, y.driven_acceleration = driven_acceleration(p, x)
    y.twist = x.twist
    y.energy_in = x.energy_in
    y.energy_out = x.energy_out
    y.energy_stored = stored_energy(p, x)
    y.energy_lost = x.energy_lost
    passed = (x.energy_in - x.energy_out) - x.energy_lost
    y.energy_residual = passed - (y.energy_stored - x.energy_start)


def derive(p, d):
    """Fill d from p; no parameters within their ranges are refused together."""
    d.rate = (p.shaft_damping + p.driven_friction) / p.driven_inertia
    d.square = p.shaft_stiffness / p.driven_inertia
    d.swing, d.slow, d.fast = characteristic(d.rate, d.square)
    d.step = 0.0


def start(p, d, u, x, y):
    """Derive d from p; set x and y at the end of initialisation. Returns OK or the status of bad inputs."""
    derive(p, d)
    status = check_inputs(u)
    if status != OK:
        return status
    clear(x.numbers)
    x.twist = p.twist_start
    x.omega4 = p.omega_out_start
    x.slip = u.hub_speed - x.omega4
    x.held_input = u.hub_speed
    x.load_torque = u.load_torque
    x.energy_start = stored_energy(p, x)
    write_outputs(p, x, y)
    return OK


def begin(p, u, x, h):
    """Take the inputs of the coming step; a jump of the hub's speed pushes the driven mass."""
    jump = (u.hub_speed - x.held_input) - x.hub_slope * x.length
    push = p.balancer * jump
    work = p.driven_inertia * push * (x.omega4 + 0.5 * push)
    # the one of slip and speed that has kept fewer digits follows from the other
    if abs(x.omega4) + abs(push) < abs(x.slip) + abs(jump - push):
        x.omega4, x.omega4_low = add(x.omega4, x.omega4_low, push)
        x.slip, x.slip_low = add(u.hub_speed, -x.omega4_low, -x.omega4)
    else:
        x.slip, x.slip_low = add(x.slip, x.slip_low, jump - push)
        x.omega4, x.omega4_low = add(u.hub_speed, -x.slip_low, -x.slip)
    x.energy_lost, x.energy_lost_low = add(x.energy_lost, x.energy_lost_low, -work)
    x.hub_slope = take_speed(p.input_hold, x, u.hub_speed, u.hub_speed_rate_given, u.hub_speed_rate)
    x.length = h
    x.load_torque = mean_torque(u.load_torque, u.load_torque_rate_given, u.load_torque_rate, h)


def describe(p, d, x, w):
    """Write z1 to z4 of the motions over the coming step, and of the rates of two (:mod:`.motion`)."""
    slope = x.hub_slope
    own, acceleration = driven_acceleration(p, x)
    left = (1.0 - p.balancer) * slope
    friction = p.driven_friction / p.driven_inertia
    damping = p.shaft_damping / p.driven_inertia
    load = x.load_torque / p.driven_inertia
    # what pulls the twist but the spring, and what drives the mass but its own motion
    pull = left + friction * x.held_input + load
    drive = p.balancer * slope + damping * x.held_input - load + d.square * x.twist
    write_row(w.twist, 0, x.twist, x.slip + d.rate * x.twist, pull, friction * slope)
    write_row(w.slip, 0, x.slip, pull - d.square * x.twist, friction * slope, 0.0)
    write_row(w.slip_rate, 0, left - own, friction * slope - d.square * x.slip, 0.0, 0.0)
    write_row(w.speed, 0, x.omega4, drive, damping * slope + d.square * x.held_input, d.square * slope)
    write_row(w.speed_rate, 0, acceleration, damping * slope + d.square * x.slip, d.square * slope, 0.0)


def move(p, d, x, w, h):
    """Advance over the step, inputs taken: exact motion, mean torque and energies, which may not balance."""
    describe(p, d, x, w)
    keep_step(d, w, h)
    # integral of the shaft torque, and of that integral
    momentum = p.shaft_stiffness * integral(d, w.twist, 1) + p.shaft_damping * integral(d, w.slip, 1)
    moment = p.shaft_stiffness * integral(d, w.twist, 2) + p.shaft_damping * integral(d, w.slip, 2)
    angle = integral(d, w.speed, 1)
    lost = p.shaft_damping * square_integral(d, w.slip) + p.driven_friction * square_integral(d, w.speed)
    lost -= p.balancer * p.driven_inertia * x.hub_slope * angle
    x.twist, x.twist_low = end(d, w.twist, w.slip, x.twist_low)
    x.slip, x.slip_low = end(d, w.slip, w.slip_rate, x.slip_low)
    x.omega4, x.omega4_low = end(d, w.speed, w.speed_rate, x.omega4_low)
    work = (x.held_input + x.hub_slope * h) * momentum - x.hub_slope * moment
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, work)
    x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, x.load_torque * angle)
    x.energy_lost, x.energy_lost_low = add(x.energy_lost, x.energy_lost_low, lost)
    x.shaft_torque_mean = momentum / h


def advance(p, d, u, x, y, w, h):
    """Advance by the communication step h, s. Any status but OK leaves state and outputs as they were."""
    status = check_step(u, h)
    if status == OK:
        status = check_hold(p.input_hold, x, u.hub_speed, u.hub_speed_rate_given, h)
    if status != OK:
        return status
    copy(w.before.numbers, x.numbers)
    begin(p, u, x, h)
    move(p, d, x, w, h)
    for n in range(len(x.numbers)):
        if not abs(x.numbers[n]) < 1e300:
            copy(x.numbers, w.before.numbers)
            return NOT_FINITE
    write_outputs(p, x, y)
    return OK


def write_rates(p, x, y):
    """Rate of each output, per second, in its place in y; the step mean holds for its step."""
    _, acceleration = driven_acceleration(p, x)
    y.shaft_torque = p.shaft_stiffness * x.slip + p.shaft_damping * (x.hub_slope - acceleration)
    y.shaft_torque_mean = 0.0
    y.omega_out = acceleration
    y.driven_acceleration = (y.shaft_torque - p.driven_friction * acceleration) / p.driven_inertia
    y.twist = x.slip


def call(operation, p, d, u, x, y, w, h):
    """The one entry of the compiled kernel: the operations of :mod:`.codes`. Returns a status."""
    if operation == START:
        return start(p, d, u, x, y)
    if operation == CHECK:
        derive(p, d)
        return check_inputs(u)
    if operation == TUNE:
        derive(p, d)
        return OK
    if operation == OUTPUTS:
        write_outputs(p, x, y)
        return OK
    if operation == RATES:
        write_rates(p, x, y)
        return OK
    return advance(p, d, u, x, y, w, h)
