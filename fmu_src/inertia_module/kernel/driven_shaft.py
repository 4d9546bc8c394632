"""The elastic output alone: hub of given speed, spring and damper, driven mass (DESIGN section 3).

    Ts = c delta + d (omega_h - omega4)      delta' = omega_h - omega4
    J4 omega4' = Ts - f omega4 - T_load + beta J4 omega_h'

Stelmashchuk's stepping mechanism in SI units. The speed of the hub is constant or linear over a step, so
the motion is exact in one go, however stiff the shaft and long the step (propagator). A jump of the hub's
speed at the beginning of a step changes the speed of the driven mass by beta times the jump at once, and
leaves the twist; the torque of the shaft stays finite, so its mean holds no impulse.
"""

from .accumulate import add, assign
from .dissipation import squares
from .driven_motion import (
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
from .driven_shaft_slots import *
from .kept_responses import keep_responses
from .limits import LARGEST_SPEED, LARGEST_STEP, LARGEST_TORQUE
from .propagator import characteristic
from .slots import (
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


def check_inputs(u):
    """Status of the inputs: finite and within what a drivetrain can mean."""
    if not abs(u[U_HUB_SPEED]) <= LARGEST_SPEED:
        return BAD_HUB_SPEED
    if not abs(u[U_LOAD_TORQUE]) <= LARGEST_TORQUE:
        return BAD_LOAD_TORQUE
    return OK


def check_rates(u, h):
    """Status of the rates of the inputs that are given: no input becomes absurd within the step h."""
    if u[U_HUB_SPEED_RATE_GIVEN] != 0.0:
        if not abs(u[U_HUB_SPEED] + u[U_HUB_SPEED_RATE] * h) <= LARGEST_SPEED:
            return BAD_HUB_SPEED_RATE
    if u[U_LOAD_TORQUE_RATE_GIVEN] != 0.0:
        if not abs(u[U_LOAD_TORQUE] + u[U_LOAD_TORQUE_RATE] * h) <= LARGEST_TORQUE:
            return BAD_LOAD_TORQUE_RATE
    return OK


def stored_energy(p, x):
    """Kinetic energy of the driven mass and energy of the spring, J."""
    kinetic = p[P_DRIVEN_INERTIA] * x[X_OMEGA4] * x[X_OMEGA4]
    return 0.5 * (kinetic + p[P_STIFFNESS] * x[X_TWIST] * x[X_TWIST])


def write_outputs(p, x, y):
    """All outputs and locals from the state."""
    y[Y_SHAFT_TORQUE] = p[P_STIFFNESS] * x[X_TWIST] + p[P_DAMPING] * slip(x)
    y[Y_SHAFT_TORQUE_MEAN] = x[X_SHAFT_TORQUE_MEAN]
    y[Y_OMEGA_OUT] = x[X_OMEGA4]
    y[Y_ACCELERATION] = x[X_ACCELERATION]
    y[Y_TWIST] = x[X_TWIST]
    stored = stored_energy(p, x)
    y[Y_ENERGY_IN] = x[X_ENERGY_IN]
    y[Y_ENERGY_OUT] = x[X_ENERGY_OUT]
    y[Y_ENERGY_STORED] = stored
    y[Y_ENERGY_LOST] = x[X_ENERGY_LOST]
    passed = (x[X_ENERGY_IN] - x[X_ENERGY_OUT]) - x[X_ENERGY_LOST]
    y[Y_ENERGY_RESIDUAL] = passed - (stored - x[X_ENERGY_START])


def start(p, d, u, x, y):
    """Derive the constants and set the state at the end of initialisation.

    Args:
        p: parameters (P_SIZE), each within its range. u: inputs (U_SIZE).
        d: derived constants (D_SIZE), x: state (X_SIZE), y: outputs (Y_SIZE), all written.

    Returns:
        Status: OK, BAD_HUB_SPEED or BAD_LOAD_TORQUE.
    """
    status = check_inputs(u)
    if status != OK:
        return status
    d[D_RATE] = (p[P_DAMPING] + p[P_FRICTION]) / p[P_DRIVEN_INERTIA]
    d[D_SQUARE] = p[P_STIFFNESS] / p[P_DRIVEN_INERTIA]
    swing, slow, fast = characteristic(d[D_RATE], d[D_SQUARE])
    d[D_SWING] = swing
    d[D_SLOW] = slow
    d[D_FAST] = fast
    d[D_STEP] = 0.0
    for n in range(X_SIZE):
        x[n] = 0.0
    x[X_TWIST] = p[P_TWIST_START]
    x[X_OMEGA4] = p[P_OMEGA_OUT_START]
    x[X_HUB_SPEED] = u[U_HUB_SPEED]
    x[X_HELD_INPUT] = u[U_HUB_SPEED]
    x[X_LOAD_TORQUE] = u[U_LOAD_TORQUE]
    x[X_ACCELERATION] = speed_rate(p, x)
    x[X_ENERGY_START] = stored_energy(p, x)
    write_outputs(p, x, y)
    return OK


def begin(p, u, x, h):
    """Take the inputs of the coming step; a jump of the hub's speed pushes the driven mass."""
    slope = 0.0
    if u[U_HUB_SPEED_RATE_GIVEN] != 0.0:
        slope = u[U_HUB_SPEED_RATE]
    elif p[P_INPUT_HOLD] != 0.0 and x[X_HELD_STEP] > 0.0:
        slope = (u[U_HUB_SPEED] - x[X_HELD_INPUT]) / x[X_HELD_STEP]
    x[X_HUB_SLOPE] = slope
    x[X_HELD_INPUT] = u[U_HUB_SPEED]
    x[X_HELD_STEP] = h
    x[X_LOAD_TORQUE] = u[U_LOAD_TORQUE]
    if u[U_LOAD_TORQUE_RATE_GIVEN] != 0.0:
        x[X_LOAD_TORQUE] += 0.5 * h * u[U_LOAD_TORQUE_RATE]  # its mean over the step
    push = p[P_BALANCER] * ((u[U_HUB_SPEED] - x[X_HUB_SPEED]) - x[X_HUB_SPEED_LOW])
    assign(x, X_HUB_SPEED, u[U_HUB_SPEED])
    if push != 0.0:
        work = p[P_DRIVEN_INERTIA] * push * (x[X_OMEGA4] + 0.5 * push)
        add(x, X_OMEGA4, push)
        add(x, X_ENERGY_LOST, -work)


def move(p, d, x, w, h):
    """Advance over the step, inputs taken: exact motion, mean torque and energies.

    The momentum the shaft passes is found from its twist or, where swings cancel in that, from the
    momentum of the driven mass: whichever rounds off less. The energies do not balance by construction.
    """
    describe_motion(p, d, x, w)
    hub = x[X_HUB_SPEED]
    ramp = x[X_HUB_SLOPE]
    load = x[X_LOAD_TORQUE]
    inertia = p[P_DRIVEN_INERTIA]
    keep_responses(d, h)
    step = d[D_RESPONSES]
    slope = d[D_RESPONSES + 1]
    impulse = d[D_RESPONSES + 2]
    one = d[D_RESPONSES + 3]
    two = d[D_RESPONSES + 4]
    three = d[D_RESPONSES + 5]
    four = d[D_RESPONSES + 6]
    angle, turn = turn_of_mass(x, w, impulse, one, two, three, h)
    momentum, momentum_size, moment, moment_size = torque_sums(p, x, w, impulse, one, two, three, four, h)
    lost = 0.0
    if p[P_DAMPING] > 0.0 or p[P_FRICTION] > 0.0:
        slips, speeds = squares(d, w, hub, ramp, h)
        lost = p[P_DAMPING] * slips + p[P_FRICTION] * speeds
    before = x[X_OMEGA4]
    before_low = x[X_OMEGA4_LOW]
    add(x, X_HUB_SPEED, ramp * h)
    move_twist(x, w, step, impulse, one, two)
    change_size = move_speed(x, w, slope, impulse, one, two)
    change = (x[X_OMEGA4] - before) + (x[X_OMEGA4_LOW] - before_low)
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
    add(x, X_ENERGY_IN, (hub + ramp * h) * momentum - ramp * moment)
    add(x, X_ENERGY_OUT, load * angle)
    add(x, X_ENERGY_LOST, lost - p[P_BALANCER] * inertia * ramp * angle)
    x[X_SHAFT_TORQUE_MEAN] = momentum / h


def advance(p, d, u, x, y, w, h):
    """Advance by the communication step h, s.

    A status other than OK leaves state and outputs as they were.

    Args:
        p, d, u: parameters, derived constants, inputs (held or extrapolated over the step).
        x, y: state and outputs, written. w: workspace (W_SIZE).
    """
    if not 0.0 < h <= LARGEST_STEP:
        return BAD_STEP
    status = check_inputs(u)
    if status == OK:
        status = check_rates(u, h)
    if status != OK:
        return status
    for n in range(X_SIZE):
        w[W_STATE + n] = x[n]
    begin(p, u, x, h)
    move(p, d, x, w, h)
    for n in range(X_SIZE):
        if not abs(x[n]) < 1e300:
            status = NOT_FINITE
    if status != OK:
        for n in range(X_SIZE):
            x[n] = w[W_STATE + n]
        return status
    write_outputs(p, x, y)
    return OK


def write_rates(p, x, y):
    """Rate of each output, per second, in its place in y; the step mean holds for its step."""
    acceleration = x[X_ACCELERATION]
    relative = x[X_HUB_SLOPE] - acceleration
    torque = p[P_STIFFNESS] * slip(x) + p[P_DAMPING] * relative
    y[Y_SHAFT_TORQUE] = torque
    y[Y_SHAFT_TORQUE_MEAN] = 0.0
    y[Y_OMEGA_OUT] = acceleration
    y[Y_ACCELERATION] = (torque - p[P_FRICTION] * acceleration) / p[P_DRIVEN_INERTIA]
    y[Y_TWIST] = slip(x)


def call(operation, p, d, u, x, y, w, h):
    """The one entry of the compiled kernel: the operations of :mod:`.slots`. Returns a status."""
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
