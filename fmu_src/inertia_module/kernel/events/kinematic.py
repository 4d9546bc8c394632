"""Fidelity `kinematic`: omega2 = ratio omega1 is prescribed, torques follow by the equations of motion.

Their sums are those of a step whose stages are the nodes of a Gauss rule, as the motion at each is known.
"""

import math

from ..accumulate import add
from ..equations.motion import evaluate
from ..equations.states import GEARED, OPEN
from ..loads import sample_load
from ..tableau import GAUSS, GAUSS_NODES, GAUSS_WEIGHTS
from .advance import commit
from .stages import keep_rates, set_changes

# phase of the highest harmonic within one Gauss interval, rad
GAUSS_PHASE = 1.0
# what a ramp adds to the rate of the phase, over the square root of its acceleration: the tenth derivative,
# which the rule is off by, is 945 of sin(t^2 / 2) at rest, about that of sin(2 t)
RAMP = 2.0
# parts of an interval in which sign changes are looked for, to find one, and how near it is found
LOOKS = 4
HALVINGS = 30
NEAR = 1e-9
# a speed that turns back within this share of the interval is zero now
ROUNDING = 1e-12


def follow_ratio(x, omega1, omega2):
    """Let freewheels and friction do what they do at these prescribed speeds."""
    x.housing_state = OPEN if omega2 > 0.0 else GEARED
    x.output_state = GEARED
    x.slip_sign = math.copysign(1.0, omega1 - omega2) if omega1 != omega2 else 0.0


def keep_ratio(d, x):
    """Give link 2 and the output the speed that is prescribed."""
    x.omega2 = x.omega3 = d.kinematic_ratio * x.omega1
    x.omega2_low = x.omega3_low = 0.0
    follow_ratio(x, x.omega1, x.omega2)


def prescribe(d, x, t):
    """Motion the time t from now on and its torques, into d.machine."""
    m = d.machine
    turned1 = t * (x.omega1 + 0.5 * x.alpha1 * t)
    m.q = x.q + d.k * (1.0 - d.kinematic_ratio) * turned1
    m.theta1 = x.theta1 + turned1
    m.omega1 = x.omega1 + x.alpha1 * t
    m.omega2 = m.omega3 = d.kinematic_ratio * m.omega1
    m.alpha2 = d.kinematic_ratio * x.alpha1
    follow_ratio(x, m.omega1, m.omega2)
    evaluate(d, x, x.alpha1, 0.0, False)


def signs_at(d, x, t):
    """Signs of the torques that the meshes lose by, the time t from now on."""
    prescribe(d, x, t)
    x.step_evaluations += 1.0
    return d.machine.flow_sign, d.machine.spin_signs if d.satellite_loss != 0.0 else 0.0


def has_signs(d, x, t, flow, spin):
    """Return True if the torques have these signs (signs_at), the time t from now on."""
    flow_then, spin_then = signs_at(d, x, t)
    return flow_then == flow and spin_then == spin


def smooth_part(d, x, h):
    """The part of an interval h until link 1 turns back, or just past a sign change of a torque in a mesh."""
    turns_back = -x.omega1 / x.alpha1 if x.omega1 * x.alpha1 < 0.0 else h
    if ROUNDING * h < turns_back < h:
        h = turns_back
    if d.mesh_loss == 0.0 and d.satellite_loss == 0.0:
        return h
    low = NEAR * h
    flow, spin = signs_at(d, x, low)
    for n in range(LOOKS):
        high = h * (n + 1.0 - NEAR) / LOOKS
        if not has_signs(d, x, high, flow, spin):
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                if has_signs(d, x, middle, flow, spin):
                    low = middle
                else:
                    high = middle
            return high
        low = high
    return h


def advance_kinematic(d, x, w, remaining):
    """Advance by one interval. Returns the time passed, or -1 where the speeds are beyond all bounds."""
    rate = d.k * (1.0 - d.kinematic_ratio)
    h = min(remaining, d.max_step)
    scale = d.harmonic * abs(rate) + (1.0 if d.weight != 0.0 else 0.0)
    fastest = scale * max(abs(x.omega1), abs(x.omega1 + x.alpha1 * remaining))
    fastest += RAMP * math.sqrt(scale * abs(x.alpha1))
    if fastest * h > GAUSS_PHASE:
        h = GAUSS_PHASE / fastest
        if not h > 0.0:
            return -1.0
    if d.losses != 0.0:
        h = smooth_part(d, x, h)
    w.step = h
    out = 0.0
    for n in range(GAUSS):
        prescribe(d, x, GAUSS_NODES[n] * h)
        x.flow_sign = d.machine.flow_sign
        keep_rates(d, x, w, n)
        w.weights[n] = GAUSS_WEIGHTS[n]
        x.torque_peak = max(x.torque_peak, abs(d.machine.output))
        out += GAUSS_WEIGHTS[n] * h * d.machine.output * d.machine.omega2
    x.step_evaluations += GAUSS
    set_changes(d, x, w, h, 1, GAUSS)
    # the motion, without the rounding of a sum
    w.change.q = rate * w.change.theta1
    w.change.turned3 = d.kinematic_ratio * w.change.theta1
    w.load = 0.0  # the energy ends at the output
    x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, out)
    sample_load(d, x, x.q, x.omega1, d.kinematic_ratio * x.omega1, x.alpha1, d.kinematic_ratio * x.alpha1)
    commit(d, x, w)
    return h
