"""Link 2 in motion, free or driving the output shaft: steps of the embedded pair up to the next event."""

from .accumulate import add, assign, wrap_drive_angle
from .dormand_prince import dense_change, error_norm, keep_end, quadrature, result, stages
from .dormand_prince_table import STAGE_NODES
from .dynamics import angular_momentum, motion_rates
from .events import first_event, is_step_quiet
from .held import coast
from .slots import *

# phase of the highest harmonic within one step, rad
STEP_PHASE = 12.0
# the same where the inertia behind link 2 all but vanishes at an angle: its speed has a spike there,
# which is not to be stepped over
CUSP_PHASE = 1.0
CUSP_RATIO = 1e-2
# steps before the work is counted
SEGMENT_STEPS = 64
SAFETY = 0.9
SMALLEST_FACTOR = 0.2
LARGEST_FACTOR = 5.0
REJECTIONS = 100


def highest_rate(d, w, omega2, h):
    """Fastest rate of the highest harmonic over a step h, rad/s."""
    omega1 = w[W_OMEGA1]
    slip = max(abs(omega1 - omega2), abs(omega1 + w[W_ALPHA1] * h - omega2))
    return d[D_HARMONIC] * d[D_K] * slip


def has_cusp(d, w):
    """Whether the inertia behind link 2 is far smaller where the imbalance rests in link 1 than elsewhere."""
    moving = d[D_K] * d[D_K] * d[D_MASS]
    offset = d[D_POLE_OFFSET]
    far = offset + 2.0 * d[D_POLE_ARM]
    least = d[D_J2] + d[D_K] * d[D_K] * d[D_J16] + w[W_SHAFT_INERTIA] + moving * offset * offset
    return least < CUSP_RATIO * moving * (far * far + d[D_SPIN])


def longest_step(d, w, omega2, remaining):
    """Longest step that can be searched for events: a bounded phase of the highest harmonic."""
    step = min(remaining, d[D_MAX_STEP])
    fastest = highest_rate(d, w, omega2, step)
    phase = CUSP_PHASE if has_cusp(d, w) else STEP_PHASE
    if fastest * step > phase:
        step = phase / fastest
    return step


def response(d, w):
    """How much of its own speed the mechanism can impart to link 2 and what it carries, 0 to 1.

    The natural measure of an error of omega2: behind a heavy shaft the speed hardly changes, yet its
    small changes are the torque.
    """
    own = d[D_ALPHA_SLOPE]
    return own / (own + d[D_J2] + w[W_SHAFT_INERTIA]) if own > 0.0 else 1.0


def inertia_scale(d):
    """Upper bound of the inertia that takes part in P, kg m^2."""
    return (d[D_ALPHA_SLOPE] + 0.5 * d[D_I_SLOPE]) / d[D_K] + d[D_J1] + d[D_J2]


def try_steps(d, x, w, remaining, alpha2, momentum):
    """Make the longest step whose error is allowed; the stages are left in w, its length in W_STEP.

    The size for the next step is carried in the state, from one communication step to the next.

    Returns:
        (change of q, change of omega2, largest speed), or a largest speed of -1 if no step will do.
    """
    omega1 = w[W_OMEGA1]
    omega2 = x[X_OMEGA2]
    carried = x[X_STEP_SIZE]
    limit = longest_step(d, w, omega2, remaining)
    share = response(d, w)
    h = min(limit, carried) if carried > 0.0 else 0.1 * limit
    for attempt in range(REJECTIONS):
        w[W_STEP] = h
        stages(d, w, x[X_Q], omega2, alpha2, momentum)
        x[X_STEP_EVALUATIONS] += 11.0
        change_q = h * result(w, W_RATE_Q)
        change2 = h * result(w, W_RATE_OMEGA2)
        ends = max(abs(omega1 + w[W_ALPHA1] * h), abs(omega2 + change2))
        fastest = max(ends, max(abs(omega1), abs(omega2)))
        measure = max(share * fastest, abs(change2))  # the load may change the speed more than the mechanism
        # alpha1 times the integral of P is work, to be compared with the energy at these speeds
        ramp = inertia_scale(d) * fastest * fastest / abs(w[W_ALPHA1]) if w[W_ALPHA1] != 0.0 else 0.0
        tolerance = d[D_TOLERANCE]
        error = 0.0 if measure == 0.0 else 1e300
        if 0.0 < measure < 1e300:
            error = error_norm(w, tolerance, tolerance * measure, W_MOMENTUM, tolerance * ramp)
        factor = LARGEST_FACTOR
        if not error < 1e300:
            factor = SMALLEST_FACTOR
        elif error > 0.0:
            factor = min(LARGEST_FACTOR, max(SMALLEST_FACTOR, SAFETY * error**-0.125))
        if error <= 1.0:
            # a step cut short by the end of the communication step says little about longer ones
            x[X_STEP_SIZE] = max(factor * h, carried) if attempt == 0 and h < carried else factor * h
            return change_q, change2, fastest
        h *= factor
    return 0.0, 0.0, -1.0


def meet(d, x, which):
    """Set the speeds exactly equal where free link 2 has met the output shaft."""
    if which == LINK2:
        if x[X_OMEGA3] < 0.0:
            assign(x, X_OMEGA3, 0.0)
    elif which == OUTPUT or x[X_OMEGA3] < x[X_OMEGA2]:
        if d[D_HOUSING] != 0.0 and x[X_OMEGA3] < 0.0:
            assign(x, X_OMEGA3, 0.0)
        x[X_OMEGA2] = x[X_OMEGA3]
        x[X_OMEGA2_LOW] = x[X_OMEGA3_LOW]


def commit(d, x, w, passed, change_q, change2, which):
    """Take the step over; where a velocity has met its limit, or passed it within rounding, set it there."""
    add(x, X_Q, change_q)
    wrap_drive_angle(d, x)
    add(x, X_OMEGA2, change2)
    if which == LINK2 or (d[D_HOUSING] != 0.0 and x[X_OMEGA2] < 0.0):
        assign(x, X_OMEGA2, 0.0)
    if x[X_MODE] == DRIVING:
        x[X_OMEGA3] = x[X_OMEGA2]
        x[X_OMEGA3_LOW] = x[X_OMEGA2_LOW]
        return
    coast(d, x, w[W_LOAD], passed)
    meet(d, x, which)


def add_square(d, x, w, sigma):
    """Integral of Tc^2 over the step or its part sigma, and its peak. Overwrites the stage rates."""
    share = sigma if sigma >= 0.0 else 1.0
    for n in range(8 if sigma < 0.0 else 12):
        torque = w[W_LOAD] + d[D_J3] * w[W_RATE_OMEGA2 + n]
        if STAGE_NODES[n] <= share:
            x[X_TORQUE_PEAK] = max(x[X_TORQUE_PEAK], abs(torque))
        w[W_RATE_OMEGA2 + n] = torque * torque
    x[X_OUTPUT_SQUARE] += quadrature(w, W_RATE_OMEGA2, sigma)


def add_works(d, x, w, start1, start2, passed, turned2, momentum, momentum_end, ramp):
    """Impulses and works of the torques over the time passed since link 1 and 2 had start1 and start2.

    M1 - Tc is the rate of the angular momentum P and Tc = J3 omega3' + load, so the impulses are
    exact in the end values, and so is the work while omega1 is constant. With a ramp the work takes
    the integral of P as well (ramp, times alpha1): that of omega1 dP is omega1 P less it.
    """
    load = w[W_LOAD]
    alpha1 = w[W_ALPHA1]
    end1 = start1 + alpha1 * passed
    impulse = momentum_end - momentum
    work = end1 * momentum_end - start1 * momentum - ramp
    if x[X_MODE] == DRIVING:
        end2 = x[X_OMEGA2]
        clutch = d[D_J3] * (end2 - start2) + load * passed
        impulse += clutch
        work += d[D_J3] * (end1 * end2 - start1 * start2 - alpha1 * turned2)
        work += load * passed * (start1 + 0.5 * alpha1 * passed)
        x[X_OUTPUT_IMPULSE] += clutch
        add(x, X_ENERGY_OUT, load * turned2)
    x[X_INPUT_IMPULSE] += impulse
    add(x, X_ENERGY_IN, start1 * impulse if alpha1 == 0.0 else work)


def one_step(d, x, w, remaining, alpha2, jerk2, momentum):
    """One accepted step, shortened to the first event in it.

    Returns:
        (time passed or -1 if no step is small enough, change of q, guard that fell or NONE,
        omega2', omega2'' and P at the end, alpha1 times the integral of P).
    """
    change_q, change2, fastest = try_steps(d, x, w, remaining, alpha2, momentum)
    if fastest < 0.0:
        return -1.0, 0.0, NONE, 0.0, 0.0, 0.0, 0.0
    h = w[W_STEP]
    alpha1 = w[W_ALPHA1]
    omega2 = x[X_OMEGA2]
    end2 = omega2 + change2
    end1 = w[W_OMEGA1] + alpha1 * h
    alpha2_end, jerk2_end, momentum_end = motion_rates(
        d, x[X_Q] + change_q, end1, alpha1, end2, w[W_SHAFT_INERTIA], w[W_SHAFT_TORQUE]
    )
    x[X_STEP_EVALUATIONS] += 1.0
    keep_end(d, w, end2, alpha2_end, momentum_end)
    phase = h * max(highest_rate(d, w, omega2, h), highest_rate(d, w, end2, h))
    sigma = -1.0
    which = NONE
    if not is_step_quiet(d, x, w, phase, end2, alpha2, jerk2, alpha2_end, jerk2_end):
        taken = max(response(d, w) * fastest, max(abs(omega2), max(abs(end2), abs(x[X_OMEGA3]))))
        sigma, which = first_event(d, x, w, phase, fastest, taken)
    if sigma < 0.0:
        which = NONE
        sigma = -1.0
    else:
        change_q = dense_change(w, W_DENSE_Q, sigma)
        change2 = dense_change(w, W_DENSE_OMEGA2, sigma)
    passed = sigma * h if sigma >= 0.0 else h
    ramp = alpha1 * quadrature(w, W_MOMENTUM, sigma) if alpha1 != 0.0 else 0.0
    if x[X_MODE] == DRIVING:
        add_square(d, x, w, sigma)
    commit(d, x, w, passed, change_q, change2, which)
    if which != NONE:
        momentum_end = angular_momentum(d, x[X_Q], w[W_OMEGA1] + alpha1 * passed, x[X_OMEGA2])
        x[X_STEP_EVALUATIONS] += 1.0
    return passed, change_q, which, alpha2_end, jerk2_end, momentum_end, ramp


def advance_moving(d, x, w, omega1, alpha1, load, remaining):
    """Advance to the next event, the end of the time remaining, or SEGMENT_STEPS steps.

    Returns:
        (time passed or -1 if no step is small enough, whether the contact mode may change then).
    """
    driving = x[X_MODE] == DRIVING
    w[W_COLLOCATED] = PULSE
    w[W_ALPHA1] = alpha1
    w[W_LOAD] = load
    w[W_SHAFT_INERTIA] = d[D_J3] if driving else 0.0
    w[W_SHAFT_TORQUE] = load if driving else 0.0
    start2 = x[X_OMEGA2]
    alpha2, jerk2, momentum = motion_rates(
        d, x[X_Q], omega1, alpha1, start2, w[W_SHAFT_INERTIA], w[W_SHAFT_TORQUE]
    )
    x[X_STEP_EVALUATIONS] += 1.0
    momentum_start = momentum
    time = 0.0
    angle = 0.0
    ramp = 0.0
    which = NONE
    for _ in range(SEGMENT_STEPS):
        w[W_OMEGA1] = omega1 + alpha1 * time
        passed, change_q, which, alpha2, jerk2, momentum, part = one_step(
            d, x, w, remaining - time, alpha2, jerk2, momentum
        )
        if passed < 0.0:
            return -1.0, False
        angle += change_q
        ramp += part
        done = passed >= remaining - time
        time = remaining if done else time + passed
        if done or which != NONE:
            break
    turned2 = time * (omega1 + 0.5 * alpha1 * time) - angle / d[D_K]
    add_works(d, x, w, omega1, start2, time, turned2, momentum_start, momentum, ramp)
    return time, which != NONE
