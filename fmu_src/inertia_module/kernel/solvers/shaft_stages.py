"""The elastic output over one step: the linear shaft eliminated from the collocation equations.

J4 omega4' = Ts - f omega4 - T_load + beta J4 omega3', Ts = c delta + d (omega3 - omega4) (docs/mechanics.md).
With the rates v of omega3 at the stages, e = h A and K = c e^2 + d e, the rates u of the relative speed
omega3 - omega4 and the torques are

    (J4 + f e + K) u = (J4 (1 - beta) + f e) v + g - T0        Ts = T0 + K u

where T0 is the torque of uniform motion and g that of friction and load. As c grows Ts tends to what J4,
rigid with the hub, takes: nothing cancels, so a stiff shaft costs no small steps.
"""

from .collocation import eliminate, row
from .radau import MATRIX, NODES, SQUARE, STAGES


def prepare_shaft(d, w, h):
    """Matrices of a step h: (J4 + f e + K)^-1 in w.inverse, K times it in w.gain, dTs/dv in w.shaft."""
    friction = d.friction * h
    damping = d.damping * h
    stiffness = d.stiffness * h * h
    for n in range(STAGES * STAGES):
        first = MATRIX[n]
        torque = stiffness * SQUARE[n] + damping * first
        w.gain[n] = torque
        w.jacobian[n] = torque + friction * first
        w.inverse[n] = 0.0
    for i in range(STAGES):
        w.jacobian[(STAGES + 1) * i] += d.J4
        w.inverse[(STAGES + 1) * i] = 1.0
    eliminate(w.jacobian, STAGES, w.inverse)
    multiply(w.gain, w.inverse, w.jacobian)
    free = d.J4 * (1.0 - d.balancer)
    for n in range(STAGES * STAGES):
        w.gain[n] = w.jacobian[n]
    if friction > 0.0:
        multiply(w.gain, MATRIX, w.shaft)
        for n in range(STAGES * STAGES):
            w.shaft[n] = friction * w.shaft[n] + free * w.gain[n]
        return
    for n in range(STAGES * STAGES):
        w.shaft[n] = free * w.gain[n]


def multiply(left, right, target):
    """Product of two matrices; the target is neither of them."""
    for i in range(STAGES):
        for j in range(STAGES):
            value = 0.0
            for n in range(STAGES):
                value += left[STAGES * i + n] * right[STAGES * n + j]
            target[STAGES * i + j] = value


def uniform_torque(d, x, h, i):
    """T0 at stage i: torque if the relative speed did not change."""
    relative = x.relative
    return d.stiffness * (x.twist + relative * h * NODES[i]) + d.damping * relative


def driven_torque(d, x, load):
    """g: torque of friction and load on the driven mass at the beginning of the step."""
    return d.friction * (x.omega3 - x.relative) + load


def start_torques(d, x, w, h, load):
    """Ts at the stages if the hub keeps its speed, in w.stage_shaft_torque; Ts with rates v adds dTs/dv v."""
    drag = driven_torque(d, x, load)
    for i in range(STAGES):
        w.shaft_right_side[i] = drag - uniform_torque(d, x, h, i)
    for i in range(STAGES):
        w.stage_shaft_torque[i] = uniform_torque(d, x, h, i) + row(w.gain, i, w.shaft_right_side)


def follow_hub(d, x, w, h, load):
    """Relative rates and speeds, and Ts, at the stages, from the rates of the hub in w.rate3."""
    drag = driven_torque(d, x, load)
    free = d.J4 * (1.0 - d.balancer)
    friction = d.friction * h
    for i in range(STAGES):
        own = free * w.rate3[i] + friction * row(MATRIX, i, w.rate3)
        w.shaft_right_side[i] = own + drag - uniform_torque(d, x, h, i)
    for i in range(STAGES):
        w.rate_relative[i] = row(w.inverse, i, w.shaft_right_side)
        w.stage_shaft_torque[i] = uniform_torque(d, x, h, i) + row(w.gain, i, w.shaft_right_side)
    for i in range(STAGES):
        w.stage_relative[i] = x.relative + h * row(MATRIX, i, w.rate_relative)
        w.stage_omega3[i] = x.omega3 + h * row(MATRIX, i, w.rate3)


def damp_error(d, eta, compliance, twist, omega3, relative):
    """(1 - eta J)^-1 applied to errors of (delta, omega3, omega3 - omega4): what stiffness leaves of them."""
    mobility = 1.0 / d.J4
    drag = d.friction * mobility
    response = (1.0 - d.balancer) * compliance + mobility + eta * drag * compliance
    spring = d.stiffness
    damping = spring * eta + d.damping
    rest = relative + eta * drag * omega3 - eta * spring * response * twist
    relative = rest / (1.0 + eta * drag + eta * damping * response)
    force = spring * twist + damping * relative
    return twist + eta * relative, omega3 - eta * compliance * force, relative
