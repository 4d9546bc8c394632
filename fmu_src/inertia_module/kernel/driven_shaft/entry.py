"""Entry of the kernel of the driven shaft: hub with prescribed speed, spring and damper, driven mass.

    Ts = c delta + d (omega_h - omega4)      delta' = omega_h - omega4
    J4 omega4' = Ts - f omega4 - T_load + beta J4 omega_h'

This is the stepping mechanism of Stelmashchuk in SI units (driven_shaft.md). The speed of the hub is
constant or linear over a step, so the step is exact for any stiffness and length (:mod:`.motion`). A jump of
the hub speed at the beginning of a step changes omega4 by beta times the jump at once and does not change the
twist. The shaft torque stays finite, so its mean contains no impulse. The slip delta' is a state next to
omega4 because each can be small when the other is not.
"""

from ..accumulate import clear, copy
from ..codes import CHECK, NOT_FINITE, OK, OUTPUT_DERIVATIVES, OUTPUTS, START, UPDATE_PARAMETERS
from ..inputs import check_hold, check_inputs, check_step, mean_torque, update_held_speed
from ..records import ShaftConstants, ShaftInputs, ShaftOutputs, ShaftParameters, ShaftState, ShaftWorkspace
from .motion import cache_step, characteristic_rates, end_value, integral, square_integral, write_row

# Records (see kernel.fields for their form).
STATE = (
    *("twist", "slip", "omega4"),  # rad, rad/s, rad/s
    *("hub_slope", "last_input_speed"),  # rad/s^2, rad/s: hub acceleration and hub speed of the last step
    *("length", "load_torque", "shaft_torque_mean"),  # s, N m, N m: of the last step
    "energy_start",  # J, stored energy at the start
    *("energy_in", "energy_out", "energy_lost"),  # J
)
CONSTANTS = (
    *("damping_rate", "frequency_squared"),  # 1/s, 1/s^2: (d + f) / J4 and c / J4
    *("damped_frequency", "slow_rate", "fast_rate"),  # 1/s (motion.characteristic_rates)
    *("step", ("responses", 6), ("gramian", 16)),  # s: length of the cached step (motion.cache_step)
)
WORKSPACE = (
    # z1 to z4 of each motion at the beginning of the step (motion)
    *(("twist", 4), ("slip", 4), ("slip_rate", 4), ("speed", 4), ("speed_rate", 4)),
    *(("transition", 16), ("product", 16)),  # E(t), W(t) E(t)
    ("before", STATE),  # State before the step
)

OVERFLOW = 1e300  # Magnitude from which a number of the state counts as not finite


def driven_acceleration(p: ShaftParameters, x: ShaftState) -> tuple[float, float]:
    """Return the acceleration of the driven mass without and with the balancer, rad/s^2.

    Args:
        p: Parameters.
        x: State.
    """
    shaft = p.shaft_stiffness * x.twist + p.shaft_damping * x.slip
    own = (shaft - p.driven_friction * x.omega4 - x.load_torque) / p.driven_inertia
    return own, own + p.balancer * x.hub_slope


def shaft_energy(p: ShaftParameters, x: ShaftState) -> float:
    """Return the stored energy of the driven mass and the spring, J.

    Args:
        p: Parameters.
        x: State.
    """
    kinetic = p.driven_inertia * x.omega4 * x.omega4
    return 0.5 * (kinetic + p.shaft_stiffness * x.twist * x.twist)


def write_shaft_outputs(p: ShaftParameters, x: ShaftState, y: ShaftOutputs) -> None:
    """Write all outputs and local variables.

    Args:
        p: Parameters.
        x: State.
        y: Outputs, written.
    """
    y.shaft_torque = p.shaft_stiffness * x.twist + p.shaft_damping * x.slip
    y.shaft_torque_mean = x.shaft_torque_mean
    y.omega_out = x.omega4
    _, y.driven_acceleration = driven_acceleration(p, x)
    y.twist = x.twist
    y.energy_in = x.energy_in
    y.energy_out = x.energy_out
    y.energy_stored = shaft_energy(p, x)
    y.energy_lost = x.energy_lost
    net = (x.energy_in - x.energy_out) - x.energy_lost
    y.energy_residual = net - (y.energy_stored - x.energy_start)


def derive_shaft(p: ShaftParameters, d: ShaftConstants) -> None:
    """Fill d from p. All combinations of parameters within their ranges are valid.

    Args:
        p: Parameters.
        d: Constants, written.
    """
    d.damping_rate = (p.shaft_damping + p.driven_friction) / p.driven_inertia
    d.frequency_squared = p.shaft_stiffness / p.driven_inertia
    d.damped_frequency, d.slow_rate, d.fast_rate = characteristic_rates(d.damping_rate, d.frequency_squared)
    d.step = 0.0


def start_shaft(p: ShaftParameters, d: ShaftConstants, u: ShaftInputs, x: ShaftState, y: ShaftOutputs) -> int:
    """Set constants, state and outputs at the end of the initialisation.

    Args:
        p: Parameters.
        d: Constants, written.
        u: Inputs.
        x: State, written.
        y: Outputs, written.

    Returns:
        Status of the inputs.
    """
    derive_shaft(p, d)
    status = check_inputs(u)
    if status != OK:
        return status
    clear(x.numbers)
    x.twist = p.twist_start
    x.omega4 = p.omega_out_start
    x.slip = u.hub_speed - x.omega4
    x.last_input_speed = u.hub_speed
    x.load_torque = u.load_torque
    x.energy_start = shaft_energy(p, x)
    write_shaft_outputs(p, x, y)
    return OK


def begin_shaft_step(p: ShaftParameters, u: ShaftInputs, x: ShaftState, h: float) -> None:
    """Copy the inputs of a step to the state; the balancer transmits a jump of the hub speed at once.

    Args:
        p: Parameters.
        u: Inputs.
        x: State, written.
        h: Length of the step, s.
    """
    jump = (u.hub_speed - x.last_input_speed) - x.hub_slope * x.length
    push = p.balancer * jump
    work = p.driven_inertia * push * (x.omega4 + 0.5 * push)
    # The larger one of slip and omega4, whose sum is hub_speed, follows from the smaller one
    if abs(x.omega4) + abs(push) < abs(x.slip) + abs(jump - push):
        x.omega4 += push
        x.slip = u.hub_speed - x.omega4
    else:
        x.slip += jump - push
        x.omega4 = u.hub_speed - x.slip
    x.energy_lost -= work
    x.hub_slope = update_held_speed(p.input_hold, x, u.hub_speed, u.hub_speed_has_rate, u.hub_speed_rate)
    x.length = h
    x.load_torque = mean_torque(u.load_torque, u.load_torque_has_rate, u.load_torque_rate, h)


def write_motions(p: ShaftParameters, d: ShaftConstants, x: ShaftState, w: ShaftWorkspace) -> None:
    """Write z1 to z4 (:mod:`.motion`) of twist, slip and speed, and of the rates of slip and speed.

    Args:
        p: Parameters.
        d: Constants.
        x: State with the inputs of the step.
        w: Workspace, written.
    """
    slope = x.hub_slope
    own, acceleration = driven_acceleration(p, x)
    net_slope = (1.0 - p.balancer) * slope
    friction = p.driven_friction / p.driven_inertia
    damping = p.shaft_damping / p.driven_inertia
    load = x.load_torque / p.driven_inertia
    # z3 of the twist without the spring, z2 of the speed without its own damping
    pull = net_slope + friction * x.last_input_speed + load
    drive = p.balancer * slope + damping * x.last_input_speed - load + d.frequency_squared * x.twist
    write_row(w.twist, 0, x.twist, x.slip + d.damping_rate * x.twist, pull, friction * slope)
    write_row(w.slip, 0, x.slip, pull - d.frequency_squared * x.twist, friction * slope, 0.0)
    write_row(w.slip_rate, 0, net_slope - own, friction * slope - d.frequency_squared * x.slip, 0.0, 0.0)
    write_row(
        w.speed,
        0,
        x.omega4,
        drive,
        damping * slope + d.frequency_squared * x.last_input_speed,
        d.frequency_squared * slope,
    )
    write_row(
        w.speed_rate,
        0,
        acceleration,
        damping * slope + d.frequency_squared * x.slip,
        d.frequency_squared * slope,
        0.0,
    )


def move_shaft(p: ShaftParameters, d: ShaftConstants, x: ShaftState, w: ShaftWorkspace, h: float) -> None:
    """Advance motion, mean torque and energies over a step whose inputs are in the state.

    Each energy is an integral of its own, so their balance is a check.

    Args:
        p: Parameters.
        d: Constants; the cached step is written.
        x: State, advanced.
        w: Workspace.
        h: Length of the step, s.
    """
    write_motions(p, d, x, w)
    cache_step(d, w, h)
    # First and second integral of the shaft torque
    momentum = p.shaft_stiffness * integral(d, w.twist, 1) + p.shaft_damping * integral(d, w.slip, 1)
    moment = p.shaft_stiffness * integral(d, w.twist, 2) + p.shaft_damping * integral(d, w.slip, 2)
    angle = integral(d, w.speed, 1)
    lost = p.shaft_damping * square_integral(d, w.slip) + p.driven_friction * square_integral(d, w.speed)
    lost -= p.balancer * p.driven_inertia * x.hub_slope * angle
    x.twist = end_value(d, w.twist, w.slip)
    x.slip = end_value(d, w.slip, w.slip_rate)
    x.omega4 = end_value(d, w.speed, w.speed_rate)
    work = (x.last_input_speed + x.hub_slope * h) * momentum - x.hub_slope * moment
    x.energy_in += work
    x.energy_out += x.load_torque * angle
    x.energy_lost += lost
    x.shaft_torque_mean = momentum / h


def advance_shaft(
    p: ShaftParameters,
    d: ShaftConstants,
    u: ShaftInputs,
    x: ShaftState,
    y: ShaftOutputs,
    w: ShaftWorkspace,
    h: float,
) -> int:
    """Advance by a communication step. Unless the status is OK, state and outputs are unchanged.

    Args:
        p: Parameters.
        d: Constants; the cached step is written.
        u: Inputs.
        x: State, advanced.
        y: Outputs, written.
        w: Workspace.
        h: Length of the step, s.

    Returns:
        Status.
    """
    status = check_step(u, h)
    if status == OK:
        status = check_hold(p.input_hold, x, u.hub_speed, u.hub_speed_has_rate, h)
    if status != OK:
        return status
    copy(w.before.numbers, x.numbers)
    begin_shaft_step(p, u, x, h)
    move_shaft(p, d, x, w, h)
    for n in range(len(x.numbers)):
        if not abs(x.numbers[n]) < OVERFLOW:
            copy(x.numbers, w.before.numbers)
            return NOT_FINITE
    write_shaft_outputs(p, x, y)
    return OK


def write_shaft_rates(p: ShaftParameters, x: ShaftState, y: ShaftOutputs) -> None:
    """Write the time derivative of each output to y, 1/s; it is 0 for the step mean.

    Args:
        p: Parameters.
        x: State.
        y: Outputs, which are replaced by their derivatives.
    """
    _, acceleration = driven_acceleration(p, x)
    y.shaft_torque = p.shaft_stiffness * x.slip + p.shaft_damping * (x.hub_slope - acceleration)
    y.shaft_torque_mean = 0.0
    y.omega_out = acceleration
    y.driven_acceleration = (y.shaft_torque - p.driven_friction * acceleration) / p.driven_inertia
    y.twist = x.slip


def call(
    operation: int,
    p: ShaftParameters,
    d: ShaftConstants,
    u: ShaftInputs,
    x: ShaftState,
    y: ShaftOutputs,
    w: ShaftWorkspace,
    h: float,
) -> int:
    """Execute an operation.

    Args:
        operation: START, STEP and so on (:mod:`.codes`).
        p: Parameters.
        d: Constants.
        u: Inputs.
        x: State.
        y: Outputs and local variables.
        w: Workspace; nothing in it survives the call.
        h: Length of the communication step, s.

    Returns:
        Status.
    """
    if operation == START:
        return start_shaft(p, d, u, x, y)
    if operation == CHECK:
        derive_shaft(p, d)
        return check_inputs(u)
    if operation == UPDATE_PARAMETERS:
        derive_shaft(p, d)
        return OK
    if operation == OUTPUTS:
        write_shaft_outputs(p, x, y)
        return OK
    if operation == OUTPUT_DERIVATIVES:
        write_shaft_rates(p, x, y)
        return OK
    return advance_shaft(p, d, u, x, y, w, h)
