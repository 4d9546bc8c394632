"""A jump of the input speed in fidelity averaged: the shaft keeps its speed, or follows if locked."""

from ..accumulate import add
from ..tableau import GAUSS, GAUSS_NODES, GAUSS_WEIGHTS
from .legs import can_lock, locked_torque, most_locked_torque
from .rates import energy_at, ratio, side_at

# a jump up to this fraction of omega1 changes next to nothing in the inertia on its way
SMALL_JUMP = 1e-3


def takes_up_jump(d, x, jump, h):
    """Tell whether a shaft locked to link 1 can follow a jump of omega1 within the step as a ramp."""
    load = x.load_torque
    omega1 = x.omega1
    ramp = x.alpha1 + jump / h
    if not can_lock(d, d.forward, x, omega1, 0.0, max(load, 0.0)):
        return False
    lowest = min(omega1, omega1 + ramp * h)
    if not lowest > 0.0:
        return False
    torque = locked_torque(d, d.forward, load, lowest, ramp)
    return -d.output_drag <= torque <= most_locked_torque(d, d.forward, lowest)


def input_inertia(d, side, x, omega1):
    """dP1/domega1 at constant omega3: epsilon - sigma epsilon' / 2, kg m^2."""
    _, share, share1 = energy_at(d, side, x, omega1)
    sigma = ratio(x.omega3, abs(omega1))
    return share - 0.5 * sigma * share1 if sigma < side.end else share


def part_of_jump(d, side, x, start, jump):
    """Impulse of the input torque through a jump that keeps the sign of omega1, omega3 as it is."""
    if abs(jump) <= SMALL_JUMP * abs(start):
        return jump * input_inertia(d, side, x, start + 0.5 * jump)
    impulse = 0.0
    for n in range(GAUSS):
        impulse += GAUSS_WEIGHTS[n] * jump * input_inertia(d, side, x, start + GAUSS_NODES[n] * jump)
    return impulse


def jump_averaged(d, x, jump):
    """Apply a jump of omega1: the shaft keeps its speed, the mechanism takes up its mean energy.

    Returns:
        Impulse of the input torque, N m s.
    """
    start = x.omega1
    end = start + jump
    before_side = side_at(d, start, jump)
    after_side = side_at(d, end, -jump)
    before, _, _ = energy_at(d, before_side, x, start)
    after, _, _ = energy_at(d, after_side, x, end)
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, after - before)
    x.omega1 = end
    if before_side.direction == after_side.direction:
        return part_of_jump(d, before_side, x, start, jump)
    return part_of_jump(d, before_side, x, start, -start) + part_of_jump(d, after_side, x, 0.0, end)
