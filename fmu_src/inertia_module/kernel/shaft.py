"""The elastic output over one step: the linear shaft eliminated from the collocation equations.

J4 omega4' = Ts - f omega4 - T_load + beta J4 omega3', Ts = c delta + d (omega3 - omega4) (DESIGN section 3).
With the rates v of omega3 at the stages, e = h A and K = c e^2 + d e, the rates u of the relative speed
omega3 - omega4 and the torques are

    (J4 + f e + K) u = (J4 (1 - beta) + f e) v + g - T0        Ts = T0 + K u

where T0 is the torque of uniform motion and g that of friction and load. As c grows Ts tends to what J4,
rigid with the hub, takes: nothing cancels, so a stiff shaft costs no small steps.
"""

from .collocation import eliminate, row
from .radau_table import NODES, STAGES
from .slots import *


def prepare_shaft(d, w, h):
    """Matrices of a step h: (J4 + f e + K)^-1 at W_INVERSE, K times it at W_GAIN, dTs/dv at W_SHAFT."""
    friction = d[D_FRICTION] * h
    damping = d[D_DAMPING] * h
    stiffness = d[D_STIFFNESS] * h * h
    for n in range(STAGES * STAGES):
        first = d[D_RADAU + n]
        torque = stiffness * d[D_RADAU_SQUARE + n] + damping * first
        w[W_GAIN + n] = torque
        w[W_JACOBIAN + n] = torque + friction * first
        w[W_INVERSE + n] = 0.0
    for i in range(STAGES):
        w[W_JACOBIAN + (STAGES + 1) * i] += d[D_J4]
        w[W_INVERSE + (STAGES + 1) * i] = 1.0
    eliminate(w, W_JACOBIAN, STAGES, W_INVERSE)
    multiply(w, W_GAIN, w, W_INVERSE, w, W_JACOBIAN)
    free = d[D_J4] * (1.0 - d[D_BALANCER])
    for n in range(STAGES * STAGES):
        w[W_GAIN + n] = w[W_JACOBIAN + n]
    if friction > 0.0:
        multiply(w, W_GAIN, d, D_RADAU, w, W_SHAFT)
        for n in range(STAGES * STAGES):
            w[W_SHAFT + n] = friction * w[W_SHAFT + n] + free * w[W_GAIN + n]
        return
    for n in range(STAGES * STAGES):
        w[W_SHAFT + n] = free * w[W_GAIN + n]


def multiply(a, left, b, right, w, target):
    """Product of two matrices; the target is neither of them."""
    for i in range(STAGES):
        for j in range(STAGES):
            value = 0.0
            for n in range(STAGES):
                value += a[left + STAGES * i + n] * b[right + STAGES * n + j]
            w[target + STAGES * i + j] = value


def uniform_torque(d, x, h, i):
    """T0 at stage i: torque if the relative speed did not change."""
    relative = x[X_RELATIVE]
    return d[D_STIFFNESS] * (x[X_TWIST] + relative * h * NODES[i]) + d[D_DAMPING] * relative


def driven_torque(d, x, load):
    """g: torque of friction and load on the driven mass at the beginning of the step."""
    return d[D_FRICTION] * (x[X_OMEGA3] - x[X_RELATIVE]) + load


def put_start_torque(d, x, w, h, load):
    """Ts at the stages if the hub keeps its speed, at W_STAGE_SHAFT_TORQUE; Ts with rates v adds dTs/dv v."""
    drag = driven_torque(d, x, load)
    for i in range(STAGES):
        w[W_SHAFT_RIGHT_SIDE + i] = drag - uniform_torque(d, x, h, i)
    for i in range(STAGES):
        w[W_STAGE_SHAFT_TORQUE + i] = uniform_torque(d, x, h, i) + row(w, W_GAIN, i, w, W_SHAFT_RIGHT_SIDE)


def follow_hub(d, x, w, h, load):
    """Relative rates and speeds, and Ts, at the stages, from the rates of the hub at W_RATE3."""
    drag = driven_torque(d, x, load)
    free = d[D_J4] * (1.0 - d[D_BALANCER])
    friction = d[D_FRICTION] * h
    for i in range(STAGES):
        own = free * w[W_RATE3 + i] + friction * row(d, D_RADAU, i, w, W_RATE3)
        w[W_SHAFT_RIGHT_SIDE + i] = own + drag - uniform_torque(d, x, h, i)
    for i in range(STAGES):
        w[W_RATE_RELATIVE + i] = row(w, W_INVERSE, i, w, W_SHAFT_RIGHT_SIDE)
        w[W_STAGE_SHAFT_TORQUE + i] = uniform_torque(d, x, h, i) + row(w, W_GAIN, i, w, W_SHAFT_RIGHT_SIDE)
    for i in range(STAGES):
        w[W_STAGE_RELATIVE + i] = x[X_RELATIVE] + h * row(d, D_RADAU, i, w, W_RATE_RELATIVE)
        w[W_STAGE_OMEGA3 + i] = x[X_OMEGA3] + h * row(d, D_RADAU, i, w, W_RATE3)


def shaft_torque(d, x):
    """Ts now."""
    return d[D_STIFFNESS] * x[X_TWIST] + d[D_DAMPING] * x[X_RELATIVE]


def relative_rate(d, x, load, torque, rate3):
    """Rate of omega3 - omega4 with the hub accelerating at rate3."""
    driven = torque - d[D_FRICTION] * (x[X_OMEGA3] - x[X_RELATIVE]) - load
    return (1.0 - d[D_BALANCER]) * rate3 - driven / d[D_J4]


def damp_error(d, eta, compliance, twist, omega3, relative):
    """(1 - eta J)^-1 applied to errors of (delta, omega3, omega3 - omega4): what stiffness leaves of them."""
    mobility = 1.0 / d[D_J4]
    drag = d[D_FRICTION] * mobility
    response = (1.0 - d[D_BALANCER]) * compliance + mobility + eta * drag * compliance
    spring = d[D_STIFFNESS]
    damping = spring * eta + d[D_DAMPING]
    rest = relative + eta * drag * omega3 - eta * spring * response * twist
    relative = rest / (1.0 + eta * drag + eta * damping * response)
    force = spring * twist + damping * relative
    return twist + eta * relative, omega3 - eta * compliance * force, relative


def stored_in_shaft(d, x):
    """Energy of the driven mass and the twist, J."""
    omega4 = x[X_OMEGA3] - x[X_RELATIVE]
    return 0.5 * d[D_J4] * omega4 * omega4 + 0.5 * d[D_STIFFNESS] * x[X_TWIST] * x[X_TWIST]
