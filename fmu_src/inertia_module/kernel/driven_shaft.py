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
from .driven_shaft_slots import *
from .propagator import characteristic, responses
from .slots import BAD_LOAD_TORQUE, BAD_STEP, NOT_FINITE, OK
from .step import LARGEST_SPEED, LARGEST_STEP, LARGEST_TORQUE, START


def check_inputs(u):
    """Status of the inputs: finite and within what a drivetrain can mean."""
    if not abs(u[U_HUB_SPEED]) <= LARGEST_SPEED:
        return BAD_HUB_SPEED
    if not abs(u[U_LOAD_TORQUE]) <= LARGEST_TORQUE:
        return BAD_LOAD_TORQUE
    return OK


def slip(x):
    """Speed of the hub over the driven mass, rad/s: no digit is lost where the two nearly agree."""
    return ((x[X_HUB_SPEED] - x[X_OMEGA4]) - x[X_OMEGA4_LOW]) + x[X_HUB_SPEED_LOW]


def stored_energy(p, x):
    """Kinetic energy of the driven mass and energy of the spring, J."""
    kinetic = p[P_DRIVEN_INERTIA] * x[X_OMEGA4] * x[X_OMEGA4]
    return 0.5 * (kinetic + p[P_STIFFNESS] * x[X_TWIST] * x[X_TWIST])


def speed_rate(p, x):
    """omega4' from the torques of this instant, rad/s^2."""
    shaft = p[P_STIFFNESS] * x[X_TWIST] + p[P_DAMPING] * slip(x)
    torque = shaft - p[P_FRICTION] * x[X_OMEGA4] - x[X_LOAD_TORQUE]
    return torque / p[P_DRIVEN_INERTIA] + p[P_BALANCER] * x[X_HUB_SLOPE]


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
    if p[P_INPUT_HOLD] != 0.0 and x[X_HELD_STEP] > 0.0:
        slope = (u[U_HUB_SPEED] - x[X_HELD_INPUT]) / x[X_HELD_STEP]
    x[X_HUB_SLOPE] = slope
    x[X_HELD_INPUT] = u[U_HUB_SPEED]
    x[X_HELD_STEP] = h
    x[X_LOAD_TORQUE] = u[U_LOAD_TORQUE]
    push = p[P_BALANCER] * ((u[U_HUB_SPEED] - x[X_HUB_SPEED]) - x[X_HUB_SPEED_LOW])
    assign(x, X_HUB_SPEED, u[U_HUB_SPEED])
    if push != 0.0:
        work = p[P_DRIVEN_INERTIA] * push * (x[X_OMEGA4] + 0.5 * push)
        add(x, X_OMEGA4, push)
        add(x, X_ENERGY_LOST, -work)


def describe_motion(p, d, x, w):
    """Write into the workspace what drives slip and speed over the coming step."""
    inertia = p[P_DRIVEN_INERTIA]
    slope = x[X_HUB_SLOPE]
    turned = p[P_FRICTION] / inertia
    w[W_SLIP] = slip(x)
    # what pulls the twist at the beginning, the spring apart
    w[W_STEADY_PUSH] = turned * x[X_HUB_SPEED] + x[X_LOAD_TORQUE] / inertia + (1.0 - p[P_BALANCER]) * slope
    w[W_SLIP_PULL] = w[W_STEADY_PUSH] - d[D_SQUARE] * x[X_TWIST]
    w[W_SLIP_RAMP] = turned * slope
    w[W_OMEGA4] = x[X_OMEGA4]
    w[W_SPEED_RATE] = speed_rate(p, x)
    w[W_SPEED_PULL] = d[D_SQUARE] * w[W_SLIP] + p[P_DAMPING] / inertia * slope
    w[W_SPEED_RAMP] = d[D_SQUARE] * slope


def move_twist(x, w, step, impulse, one, two):
    """Twist at the end of the step: by its change or anew, whichever rounds off less."""
    given = w[W_SLIP] * impulse
    ramped = w[W_SLIP_RAMP] * two
    changed = w[W_SLIP_PULL] * one
    kept = step * x[X_TWIST]
    pushed = w[W_STEADY_PUSH] * one
    if abs(kept) + abs(pushed) < abs(changed):
        assign(x, X_TWIST, given + kept + pushed + ramped)
    else:
        add(x, X_TWIST, given + changed + ramped)


def move_speed(x, w, slope, impulse, one, two):
    """Speed of the driven mass at the end: by its change or from the slip, whichever rounds off less."""
    by_rate = w[W_SPEED_RATE] * impulse
    by_pull = w[W_SPEED_PULL] * one
    by_ramp = w[W_SPEED_RAMP] * two
    kept = w[W_SLIP] * slope
    pulled = w[W_SLIP_PULL] * impulse
    ramped = w[W_SLIP_RAMP] * one
    if abs(kept) + abs(pulled) + abs(ramped) < abs(by_rate) + abs(by_pull) + abs(by_ramp):
        assign(x, X_OMEGA4, x[X_HUB_SPEED])
        x[X_OMEGA4_LOW] = x[X_HUB_SPEED_LOW]
        add(x, X_OMEGA4, -(kept + pulled + ramped))
    else:
        add(x, X_OMEGA4, by_rate + by_pull + by_ramp)


def move_acceleration(p, x, w, slope, impulse, one):
    """omega4' at the end: carried on or from the torques, whichever rounds off less."""
    carried = w[W_SPEED_RATE] * slope
    pulled = w[W_SPEED_PULL] * impulse
    ramped = w[W_SPEED_RAMP] * one
    torques = (
        abs(p[P_STIFFNESS] * x[X_TWIST])
        + abs(p[P_DAMPING] * slip(x))
        + abs(p[P_FRICTION] * x[X_OMEGA4])
        + abs(x[X_LOAD_TORQUE])
    )
    if abs(carried) + abs(pulled) + abs(ramped) < torques / p[P_DRIVEN_INERTIA]:
        x[X_ACCELERATION] = carried + pulled + ramped
    else:
        x[X_ACCELERATION] = speed_rate(p, x)


def move(p, d, x, w, h):
    """Advance over the step, inputs taken: exact motion, mean torque and energies."""
    describe_motion(p, d, x, w)
    hub = x[X_HUB_SPEED]
    ramp = x[X_HUB_SLOPE]
    step, slope, impulse, one, two, three, four = responses(
        d[D_RATE], d[D_SQUARE], d[D_SWING], d[D_SLOW], d[D_FAST], h
    )
    # change of the twist, its integral and the integral of that
    change = w[W_SLIP] * impulse + w[W_SLIP_PULL] * one + w[W_SLIP_RAMP] * two
    sum1 = w[W_SLIP] * one + w[W_SLIP_PULL] * two + w[W_SLIP_RAMP] * three
    sum2 = w[W_SLIP] * two + w[W_SLIP_PULL] * three + w[W_SLIP_RAMP] * four
    c = p[P_STIFFNESS]
    twist = x[X_TWIST]
    momentum = c * (twist * h + sum1) + p[P_DAMPING] * change
    # integral of the momentum passed so far: with it the torque is weighed by the time left
    moment = c * (0.5 * h * h * twist + sum2) + p[P_DAMPING] * sum1
    angle = w[W_OMEGA4] * h + (w[W_SPEED_RATE] * one + w[W_SPEED_PULL] * two + w[W_SPEED_RAMP] * three)
    balanced = p[P_BALANCER] * p[P_DRIVEN_INERTIA] * ramp * angle
    lost = 0.0
    if p[P_DAMPING] > 0.0 or p[P_FRICTION] > 0.0:
        slips, speeds = squares(d, w, hub, ramp, h)
        lost = p[P_DAMPING] * slips + p[P_FRICTION] * speeds
    add(x, X_ENERGY_IN, (hub + ramp * h) * momentum - ramp * moment)
    add(x, X_ENERGY_OUT, x[X_LOAD_TORQUE] * angle)
    add(x, X_ENERGY_LOST, lost - balanced)
    add(x, X_HUB_SPEED, ramp * h)
    move_twist(x, w, step, impulse, one, two)
    move_speed(x, w, slope, impulse, one, two)
    move_acceleration(p, x, w, slope, impulse, one)
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


def call(operation, p, d, u, x, y, w, h):
    """The one entry of the compiled kernel: START or STEP, of :mod:`.step`."""
    if operation == START:
        return start(p, d, u, x, y)
    return advance(p, d, u, x, y, w, h)
