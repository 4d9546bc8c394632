"""Fidelity kinematic: omega2 = ratio omega1 is prescribed, and the torques follow by inverse dynamics.

The motion is an explicit function of time. All integrals over an interval are therefore sums over the nodes
of a Gauss rule, which are stored like the stages of a step.
"""

import math

from ..equations.motion import evaluate
from ..equations.states import OVERRUNNING, RATIO_PRESCRIBED
from ..loads import store_beginning
from ..records import Constants, State, Workspace
from ..tableau import GAUSS_NODES, GAUSS_WEIGHTS, N_GAUSS_NODES
from .advance import add_changes
from .stages import set_changes, store_rates

# Phase of the highest harmonic in one interval, rad. Losses have kinks where a mesh torque changes its sign.
# The means are then accurate to about 1e-5.
MAX_PHASE, MAX_LOSSY_PHASE = 1.0, 0.25
# Equivalent frequency of a ramp over the square root of its phase acceleration. The error of the rule scales
# with the tenth derivative. For sin(t^2 / 2) it is 945 at t = 0, about as large as 2^10 for sin(2 t).
RAMP_PHASE_FACTOR = 2.0


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
    phase = MAX_LOSSY_PHASE if d.mesh_loss + d.satellite_loss > 0.0 else MAX_PHASE
    if frequency * h > phase:
        h = phase / frequency
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
