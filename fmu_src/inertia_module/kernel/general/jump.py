"""A jump of the input speed: that of the ideal machine, its impulses in all means (docs/mechanics.md)."""

from ..impulse import jump_input
from ..links import angular_momentum


def jump_general(p, d, x, jump, stiff):
    """Apply a jump of omega1. Returns as impulse.jump_input; that of the housing is added to x."""
    momentum = angular_momentum(d, x.q, x.omega1, x.omega2)
    drive, output = jump_input(p, d, x, jump, stiff)
    x.housing_impulse += angular_momentum(d, x.q, x.omega1, x.omega2) - momentum - drive + output
    return drive, output
