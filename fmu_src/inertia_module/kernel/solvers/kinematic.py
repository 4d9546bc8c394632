"""Fidelity `kinematic`: omega2 = ratio omega1 is prescribed, torques follow by inverse dynamics."""

import math

from ..accumulate import add, add_loss, wrap_input_angle
from ..codes import FREEWHEEL, JOURNAL, MESH, VISCOUS
from ..gauss import GAUSS_NODE_1, GAUSS_NODE_2, GAUSS_WEIGHT_1, GAUSS_WEIGHT_2, GAUSS_WEIGHT_3
from ..general.prescribed import prescribed_torques
from ..links import friction_power, torques
from ..loads import sample_load

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


def prescribed_at(d, x, ratio, omega1, alpha1, t):
    """Motion and torques (in d.machine) the time t into the interval. Returns omega1."""
    x.step_evaluations += 1.0
    speed = omega1 + alpha1 * t
    turned1 = t * (omega1 + 0.5 * alpha1 * t)
    q = x.q + d.k * (1.0 - ratio) * turned1
    prescribed_torques(d, q, x.theta1 + turned1, speed, alpha1, ratio * speed, ratio * alpha1)
    return speed


def add_general(d, x, omega2, rate_q, weight):
    """Add what prescribed_torques has found at a node to the sums; rate_q: |q'|, rad/s."""
    m = d.machine
    x.housing_impulse += weight * m.housing
    add_loss(x, MESH, weight * rate_q * (d.mesh_loss * abs(m.mesh) / d.k + m.spun))
    add_loss(x, JOURNAL, weight * rate_q * m.journals)
    add_loss(x, FREEWHEEL, -weight * m.housing * omega2)


def add_node(d, x, ratio, omega1, alpha1, t, weight):
    """Add one Gauss node, the time t into the interval, to the sums over the communication step."""
    if d.losses != 0.0:
        speed = prescribed_at(d, x, ratio, omega1, alpha1, t)
        drive, mesh = d.machine.drive, d.machine.mesh
        add_general(d, x, ratio * speed, abs(d.k * (1.0 - ratio) * speed), weight)
    else:
        speed = omega1 + alpha1 * t
        angle = x.q + d.k * (1.0 - ratio) * t * (omega1 + 0.5 * alpha1 * t)
        drive, mesh = torques(d, angle, speed, alpha1, ratio * speed, ratio * alpha1)
        x.step_evaluations += 1.0
    output = mesh - ratio * (d.J2 * alpha1 + d.b2 * speed)
    if d.losses != 0.0:
        output += d.machine.housing
    x.input_impulse += weight * drive
    x.output_impulse += weight * output
    x.output_square += weight * output * output
    x.torque_peak = max(x.torque_peak, abs(output))
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, weight * drive * speed)
    x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, weight * output * ratio * speed)
    add_loss(x, VISCOUS, weight * friction_power(d, speed, ratio * speed, d.b2))


def same_signs(d, flow, spin):
    """Tell whether the torques in d.machine, by whose signs the meshes lose, are of these signs."""
    return (d.machine.torque < 0.0) == flow and (d.satellite_loss == 0.0 or d.machine.spin_signs == spin)


def smooth_part(d, x, ratio, omega1, alpha1, h):
    """The part of an interval h until link 1 turns back, or just past a sign change of a torque in a mesh."""
    turns_back = -omega1 / alpha1 if omega1 * alpha1 < 0.0 else h
    if ROUNDING * h < turns_back < h:
        h = turns_back
    if d.mesh_loss == 0.0 and d.satellite_loss == 0.0:
        return h
    low = NEAR * h
    prescribed_at(d, x, ratio, omega1, alpha1, low)
    flow, spin = d.machine.torque < 0.0, d.machine.spin_signs
    for n in range(LOOKS):
        high = h * (n + 1.0 - NEAR) / LOOKS
        prescribed_at(d, x, ratio, omega1, alpha1, high)
        if not same_signs(d, flow, spin):
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                prescribed_at(d, x, ratio, omega1, alpha1, middle)
                if same_signs(d, flow, spin):
                    low = middle
                else:
                    high = middle
            return high
        low = high
    return h


def advance_kinematic(d, x, ratio, omega1, alpha1, remaining):
    """Advance by one interval. Returns the time passed."""
    rate = d.k * (1.0 - ratio)
    h = min(remaining, d.max_step)
    scale = d.harmonic * abs(rate) + (1.0 if d.weight != 0.0 else 0.0)
    fastest = scale * max(abs(omega1), abs(omega1 + alpha1 * remaining))
    fastest += RAMP * math.sqrt(scale * abs(alpha1))
    if fastest * h > GAUSS_PHASE:
        h = GAUSS_PHASE / fastest
    if d.losses != 0.0:
        h = smooth_part(d, x, ratio, omega1, alpha1, h)
    add_node(d, x, ratio, omega1, alpha1, GAUSS_NODE_1 * h, GAUSS_WEIGHT_1 * h)
    add_node(d, x, ratio, omega1, alpha1, GAUSS_NODE_2 * h, GAUSS_WEIGHT_2 * h)
    add_node(d, x, ratio, omega1, alpha1, 0.5 * h, GAUSS_WEIGHT_3 * h)
    add_node(d, x, ratio, omega1, alpha1, h - GAUSS_NODE_2 * h, GAUSS_WEIGHT_2 * h)
    add_node(d, x, ratio, omega1, alpha1, h - GAUSS_NODE_1 * h, GAUSS_WEIGHT_1 * h)
    sample_load(d, x, x.q, omega1, ratio * omega1, alpha1, ratio * alpha1)
    turned1 = h * (omega1 + 0.5 * alpha1 * h)
    x.theta1, x.theta1_low = add(x.theta1, x.theta1_low, turned1)
    wrap_input_angle(x)
    x.turned3 += ratio * turned1
    x.q, x.q_low = add(x.q, x.q_low, rate * turned1)
    return h
