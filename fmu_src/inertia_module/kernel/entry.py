"""Entry of the kernel of the module, with all its operations (:mod:`.codes`)."""

from .accumulate import copy
from .buildability import buildability_warnings
from .codes import (
    CHECK,
    HANDLE_EVENT,
    OK,
    OUTPUT_DERIVATIVES,
    OUTPUTS,
    RIGID,
    START,
    START_STEADY,
    STEP,
    STEP_UNTIL_EVENT,
    UPDATE_PARAMETERS,
    WARN,
)
from .engine import handle_pending_event, update_motion
from .links import fastest_rate
from .outputs import write_late_outputs, write_outputs
from .records import Constants, Inputs, Outputs, Parameters, State, Workspace
from .step import advance, check_and_restore_map, start, start_steady, update_parameters

DIFFERENCING_PHASE = 1e-4  # rad of the fastest motion, length of a differencing step
N_DIFFERENCING_TRIALS = 3  # A trial in which a freewheel switches is repeated with shorter steps
DIFFERENCING_RETRY_FACTOR = 0.01  # Length of the steps over their length in the last trial
MIN_FREQUENCY = 1.0  # rad/s, of the fastest motion of a mechanism near rest


def extrapolate_inputs(u: Inputs, x: State) -> None:
    """Continue the inputs of the last step: its final speed and slope, and its torques.

    Args:
        u: Inputs, written.
        x: State.
    """
    u.omega1 = x.omega1
    u.omega1_rate = x.alpha1
    u.omega1_has_rate = 1.0
    u.load_torque = x.load_torque
    u.load_torque_has_rate = 0.0
    u.drive_torque = x.drive_torque
    u.drive_torque_has_rate = 0.0


def write_output_rates(d: Constants, u: Inputs, x: State, y: Outputs, w: Workspace) -> int:
    """Write the time derivative of each output to y, 1/s, from two short steps forward in time.

    With steps of length h the derivative is (4 (y(h) - y(0)) - (y(2 h) - y(0))) / (2 h), which is of order 2.
    The derivatives of step means and peaks are 0.

    Args:
        d: Constants.
        u: Inputs, overwritten.
        x: State, overwritten.
        y: Outputs, which are replaced by their derivatives.
        w: Workspace.

    Returns:
        Status.
    """
    handle_pending_event(d, x)
    if x.torques_continue == 0.0:
        update_motion(d, x)  # Parameters may have changed since the last step
    write_outputs(x, y)
    write_late_outputs(d, x, y)
    h = DIFFERENCING_PHASE / max(fastest_rate(d, x), MIN_FREQUENCY)
    copy(w.saved.numbers, x.numbers)
    copy(w.outputs_0.numbers, y.numbers)
    for trial in range(N_DIFFERENCING_TRIALS):
        if trial > 0:
            copy(x.numbers, w.saved.numbers)
            h *= DIFFERENCING_RETRY_FACTOR
        extrapolate_inputs(u, x)
        status = advance(d, u, x, y, w, h, STEP)
        copy(w.outputs_1.numbers, y.numbers)
        if status == OK:
            extrapolate_inputs(u, x)
            status = advance(d, u, x, y, w, h, STEP)
        if status != OK:
            return status
        if x.switches == w.saved.switches:
            break
    # y begins with the outputs that have derivatives (interface/models.py)
    count = len(w.outputs_0.numbers)
    for n in range(count):
        value = w.outputs_0.numbers[n]
        y.numbers[n] = ((w.outputs_1.numbers[n] - value) * 4.0 - (y.numbers[n] - value)) / (2.0 * h)
    for n in range(count, len(y.numbers)):
        y.numbers[n] = 0.0
    # Differences of wrapped angles jump, and differences of many revolutions are round-off
    y.output_angle = w.outputs_0.omega_out
    y.output_turns = 0.0
    y.output_flange_angle = w.outputs_0.omega_out
    y.input_flange_angle = w.outputs_0.input_speed
    return OK


def call(
    operation: int, p: Parameters, d: Constants, u: Inputs, x: State, y: Outputs, w: Workspace, h: float
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
        h: Length of the communication step, s; for START_STEADY an angle, rad.

    Returns:
        Status, or the sum of the warnings for WARN.
    """
    w.stops = 1.0 if operation == STEP_UNTIL_EVENT and p.fidelity >= RIGID else 0.0
    if operation == START:
        return start(p, d, u, x, y, w)
    if operation == CHECK:
        return check_and_restore_map(p, d, u, w)
    if operation == START_STEADY:
        return start_steady(p, d, u, x, y, w, h)
    if operation == WARN:
        return buildability_warnings(p)
    if operation == UPDATE_PARAMETERS:
        return update_parameters(p, d, x, w)
    if operation == OUTPUTS:
        write_late_outputs(d, x, y)
        return OK
    if operation == HANDLE_EVENT:
        handle_pending_event(d, x)
        write_outputs(x, y)
        return OK
    if operation == OUTPUT_DERIVATIVES:
        return write_output_rates(d, u, x, y, w)
    return advance(d, u, x, y, w, h, operation)
