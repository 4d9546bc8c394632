"""Fidelity kinematic: omega2 = ratio omega1 is prescribed, and the torques follow by inverse dynamics.

The motion is an explicit function of time. All integrals over an interval are therefore sums over the nodes
of a Gauss rule, which are stored like the stages of a step. An interval ends where a mesh torque changes its
sign, because its losses have a kink there.
"""

import math

from ..equations.motion import evaluate
from ..equations.states import OVERRUNNING, RATIO_PRESCRIBED
from ..loads import store_beginning
from ..records import Constants, State, Workspace
from ..tableau import GAUSS_NODES, GAUSS_WEIGHTS, N_GAUSS_NODES
from .advance import add_changes
from .stages import set_changes, store_rates

MAX_PHASE = 1.0  # Phase of the highest harmonic in one interval, rad
# Equivalent frequency of a ramp over the square root of its phase acceleration. The error of the rule scales
# with the tenth derivative. For sin(t^2 / 2) it is 945 at t = 0, about as large as 2^10 for sin(2 t).
RAMP_PHASE_FACTOR = 2.0
N_SIGN_SAMPLES = 4  # Samples of the mesh torques in an interval, to detect a change of sign
N_BISECTIONS = 30  # Bisections that locate a change of sign
SIGN_CHANGE_RTOL = 1e-9  # Distance of the samples from the ends of the interval, over its length
REVERSAL_RTOL = 1e-12  # A reversal of link 1 before this fraction of the interval is at its beginning


def set_prescribed_contacts(x: State, omega1: float, omega2: float) -> None:
    """Set the states of the freewheels and the sign of the slip for prescribed speeds.

    Args:
        x: State, written.
        omega1: Speed of link 1, rad/s.
        omega2: Speed of link 2, rad/s.
    """
    x.housing_state = OVERRUNNING if omega2 > 0.0 else RATIO_PRESCRIBED
    x.output_state = RATIO_PRESCRIBED
    x.slip_sign = math.copysign(1.0, omega1 - omega2) if omega1 != omega2 else 0.0


def impose_ratio(d: Constants, x: State) -> None:
    """Set the speed of link 2 and of the output to ratio omega1.

    Args:
        d: Constants.
        x: State; omega1 is read.
    """
    x.omega2 = x.omega3 = d.kinematic_ratio * x.omega1
    set_prescribed_contacts(x, x.omega1, x.omega2)


def prescribe_motion(d: Constants, x: State, t: float) -> None:
    """Write the prescribed motion and its torques to d.machine.

    Args:
        d: Constants.
        x: State at the present time; the freewheel states and the sign of the slip are written.
        t: Time from the present, s.
    """
    m = d.machine
    angle1 = t * (x.omega1 + 0.5 * x.alpha1 * t)
    m.q = x.q + d.k * (1.0 - d.kinematic_ratio) * angle1
    m.theta1 = x.theta1 + angle1
    m.omega1 = x.omega1 + x.alpha1 * t
    m.omega2 = m.omega3 = d.kinematic_ratio * m.omega1
    m.alpha2 = d.kinematic_ratio * x.alpha1
    set_prescribed_contacts(x, m.omega1, m.omega2)
    evaluate(d, x, x.alpha1, 0.0, False)


def loss_signs(d: Constants, x: State, t: float) -> tuple[float, float]:
    """Return the signs of the mesh torques on which the mesh losses depend.

    Args:
        d: Constants.
        x: State at the present time.
        t: Time from the present, s.

    Returns:
        Sign of the power in mesh 2-16, signs of the satellite meshes as one number (0 without losses there).
    """
    prescribe_motion(d, x, t)
    x.step_evaluations += 1.0
    return d.machine.flow_sign, d.machine.tau6_signs if d.satellite_loss != 0.0 else 0.0


def has_signs(d: Constants, x: State, t: float, flow: float, spin: float) -> bool:
    """Return True if the mesh torques have the signs flow and spin.

    Args:
        d: Constants.
        x: State at the present time.
        t: Time from the present, s.
        flow: Sign of the power in mesh 2-16.
        spin: Signs of the satellite meshes.
    """
    flow_at_t, spin_at_t = loss_signs(d, x, t)
    return flow_at_t == flow and spin_at_t == spin


def time_to_kink(d: Constants, x: State, h: float) -> float:
    """Return the time to a reversal of link 1 or just after a sign change of a mesh torque, at most h, s.

    Args:
        d: Constants.
        x: State at the present time.
        h: Length of the interval, s.
    """
    reversal = -x.omega1 / x.alpha1 if x.omega1 * x.alpha1 < 0.0 else h
    if REVERSAL_RTOL * h < reversal < h:
        h = reversal
    if d.mesh_loss == 0.0 and d.satellite_loss == 0.0:
        return h
    low = SIGN_CHANGE_RTOL * h
    flow, spin = loss_signs(d, x, low)
    for n in range(N_SIGN_SAMPLES):
        high = h * (n + 1.0 - SIGN_CHANGE_RTOL) / N_SIGN_SAMPLES
        if not has_signs(d, x, high, flow, spin):
            for _ in range(N_BISECTIONS):
                middle = 0.5 * (low + high)
                if has_signs(d, x, middle, flow, spin):
                    low = middle
                else:
                    high = middle
            return high
        low = high
    return h


def advance_kinematic(d: Constants, x: State, w: Workspace, remaining: float) -> float:
    """Advance by one interval and return its length, s.

    Args:
        d: Constants.
        x: State, advanced.
        w: Workspace.
        remaining: Time until the end of the communication step, s.
    """
    rate = d.k * (1.0 - d.kinematic_ratio)
    h = min(remaining, d.max_step)
    scale = d.harmonic * abs(rate) + (1.0 if d.weight != 0.0 else 0.0)
    frequency = scale * max(abs(x.omega1), abs(x.omega1 + x.alpha1 * remaining))
    frequency += RAMP_PHASE_FACTOR * math.sqrt(scale * abs(x.alpha1))
    if frequency * h > MAX_PHASE:
        h = MAX_PHASE / frequency
    if d.losses != 0.0:
        h = time_to_kink(d, x, h)
    w.step = h
    store_beginning(d, x, x.omega1, x.alpha1, rate * x.omega1, rate * x.alpha1)
    work_out = 0.0
    for n in range(N_GAUSS_NODES):
        prescribe_motion(d, x, GAUSS_NODES[n] * h)
        x.flow_sign = d.machine.flow_sign
        store_rates(d, x, w, n)
        w.weights[n] = GAUSS_WEIGHTS[n]
        x.torque_peak = max(x.torque_peak, abs(d.machine.output))
        work_out += GAUSS_WEIGHTS[n] * h * d.machine.output * d.machine.omega2
    x.step_evaluations += N_GAUSS_NODES
    set_changes(d, x, w, w.change, h, 1, N_GAUSS_NODES)
    # Angles by their ratio, without the round-off of sums
    w.change.q = rate * w.change.theta1
    w.change.turned3 = d.kinematic_ratio * w.change.theta1
    w.load = 0.0  # The energy balance ends at the output
    x.energy_out += work_out
    add_changes(d, x, w)
    return h
