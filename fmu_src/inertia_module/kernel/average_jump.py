"""A jump of the input speed in fidelity averaged: the shaft keeps its speed, or follows if locked."""

from .accumulate import add
from .average_legs import can_lock, header_at
from .average_rates import energy_at, ratio
from .held import GAUSS_NODE_1, GAUSS_NODE_2, GAUSS_WEIGHT_1, GAUSS_WEIGHT_2, GAUSS_WEIGHT_3
from .slots import *

# a jump up to this fraction of omega1 changes next to nothing in the inertia on its way
SMALL_JUMP = 1e-3


def takes_up_jump(d, x, jump, h):
    """Whether a shaft locked to link 1 can follow a jump of omega1 within the step: then it is a ramp."""
    load = x[X_LOAD_TORQUE]
    omega1 = x[X_OMEGA1]
    ramp = x[X_ALPHA1] + jump / h
    if not can_lock(d, x, D_MAP_FORWARD, omega1, 0.0, x[X_OMEGA3], max(load, 0.0)):
        return False
    lowest = min(omega1, omega1 + ramp * h)
    return lowest > 0.0 and 0.0 <= load + d[D_J3] * ramp <= d[D_MAP_LOCK] * lowest * lowest


def part_of_jump(d, x, header, start, jump):
    """Impulse of the input torque through a jump that keeps the sign of omega1, omega3 as it is."""
    if abs(jump) <= SMALL_JUMP * abs(start):
        return jump * input_inertia(d, x, header, start + 0.5 * jump)
    near = input_inertia(d, x, header, start + GAUSS_NODE_1 * jump)
    near += input_inertia(d, x, header, start + (1.0 - GAUSS_NODE_1) * jump)
    middle = input_inertia(d, x, header, start + GAUSS_NODE_2 * jump)
    middle += input_inertia(d, x, header, start + (1.0 - GAUSS_NODE_2) * jump)
    centre = input_inertia(d, x, header, start + 0.5 * jump)
    return jump * (GAUSS_WEIGHT_1 * near + GAUSS_WEIGHT_2 * middle + GAUSS_WEIGHT_3 * centre)


def input_inertia(d, x, header, omega1):
    """dP1/domega1 at constant omega3: epsilon - sigma epsilon' / 2, kg m^2."""
    _, share, share1 = energy_at(d, x, header, omega1, x[X_OMEGA3])
    sigma = ratio(x[X_OMEGA3], abs(omega1))
    return share - 0.5 * sigma * share1 if sigma < d[header + 1] else share


def jump_averaged(d, x, jump):
    """Apply a jump of omega1: the shaft keeps its speed, the mechanism takes up its mean energy.

    Returns:
        Impulse of the input torque, N m s.
    """
    start = x[X_OMEGA1]
    end = start + jump
    header0 = header_at(start, jump)
    header1 = header_at(end, -jump)
    before, _, _ = energy_at(d, x, header0, start, x[X_OMEGA3])
    after, _, _ = energy_at(d, x, header1, end, x[X_OMEGA3])
    add(x, X_ENERGY_IN, after - before)
    x[X_OMEGA1] = end
    if header0 == header1:
        return part_of_jump(d, x, header0, start, jump)
    return part_of_jump(d, x, header0, start, -start) + part_of_jump(d, x, header1, 0.0, end)
