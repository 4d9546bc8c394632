"""The elastic shaft behind the output freewheel, and the driven mass at its end (docs/mechanics.md).

Ts = c delta + d (omega3 - omega4)        J4 omega4' = Ts - f omega4 - T_load + beta J4 omega3'
"""

from .codes import DRIVING, HELD_DRIVING


def shaft_torque(d, x):
    """Ts now, N m."""
    return d.stiffness * x.twist + d.damping * x.relative


def load_behind_freewheel(d, x):
    """Torque on the hub behind the output freewheel, the load or that of the elastic shaft, N m, and its
    rate.

    The rate is that behind a hub of constant speed.
    """
    load = x.load_torque
    if d.elastic == 0.0:
        return load, 0.0
    torque = shaft_torque(d, x)
    return torque, d.stiffness * x.relative + d.damping * relative_rate(d, x, load, torque, 0.0)


def carried_by_link2(d, x, torque):
    """Inertia, friction and torque against it that link 2 carries now (see links.accelerations)."""
    return (d.J3, d.b3, torque) if x.mode == DRIVING else (0.0, 0.0, 0.0)


def rate_alone(d, x, torque):
    """Acceleration of the output shaft, or the hub, that friction and this torque brake: rad/s^2."""
    return -(torque + d.b3 * x.omega3) / d.J3


def hub_rate(d, x, torque, alpha2):
    """Acceleration of the hub: with link 2, at rest with it, or by what brakes it alone."""
    if x.mode == DRIVING:
        return alpha2
    return 0.0 if x.mode == HELD_DRIVING else rate_alone(d, x, torque)


def relative_rate(d, x, load, torque, rate3):
    """Rate of omega3 - omega4 with the hub accelerating at rate3."""
    driven = torque - d.friction * (x.omega3 - x.relative) - load
    return (1.0 - d.balancer) * rate3 - driven / d.J4


def stored_in_shaft(d, x):
    """Energy of the driven mass and the twist, J."""
    omega4 = x.omega3 - x.relative
    return 0.5 * d.J4 * omega4 * omega4 + 0.5 * d.stiffness * x.twist * x.twist
