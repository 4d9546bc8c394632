"""Balance of the mean power of link 1: mesh and input torque, losses by cause, jumps of its speed.

    M1 omega1 = T omega3 + losses + E'        M2 omega1 = T omega3 + losses behind the mesh

Friction of link 1 and of the output is known as it is, the other losses are those of the map.
At a jump the shaft keeps its speed, or follows if locked.
"""

from ..accumulate import add, add_loss
from ..codes import VISCOUS
from ..tableau import GAUSS, GAUSS_NODES, GAUSS_WEIGHTS
from .legs import can_lock, coasting_torque, locked_torque, most_locked_torque
from .rates import energy_at, lost_between, ratio, shares, side_at, slowness
from .step import middle_speed

# Simpson's rule
ENDS = 1.0 / 6.0
MIDDLE = 2.0 / 3.0
# a jump up to this fraction of omega1 changes next to nothing in the inertia on its way
SMALL_JUMP = 1e-3


def lost_power(side, x, speed, cause):
    """Mean power that a cause takes from link 2 and what moves in it, by the map, W."""
    now, _ = shares(slowness(side, speed))
    lost, _ = lost_between(side, x, ratio(x.omega3, speed), cause, now)
    return speed * speed * speed * max(lost, 0.0)


def lost_torque(d, side, x, speed):
    """Torque that losses take from link 1 in the mean, N m: friction of its own, and that of the rest.

    By torque they are one.
    """
    if d.lossy == 0.0 or speed == 0.0:
        return 0.0, 0.0
    # drag of an output that coasts, and the losses of the map
    beyond = max(x.omega3 - side.end * speed, 0.0)
    inner = max(-coasting_torque(d, side, x, speed) * beyond, 0.0)
    for cause in range(len(x.lost)):
        inner += lost_power(side, x, speed, cause)
    return d.b1 * speed if d.by_torque == 0.0 else 0.0, inner / speed


def mesh_share(d, side, x, v, omega1, torque):
    """Mean mesh torque, what goes out and what is lost behind the mesh over omega1: power balances."""
    if omega1 == 0.0:
        return 0.0
    passed = torque * x.omega3 / omega1 if torque != 0.0 else 0.0
    if d.by_torque != 0.0:
        passed -= d.b1 * omega1
    return passed + lost_torque(d, side, x, abs(v))[1] * abs(v) / omega1


def mean_input_torque(d, side, x, omega1, alpha1, alpha3, torque):
    """M1 of the mean balance M1 omega1 = T omega3 + losses + dE/dt, E = omega1^2 epsilon(sigma) / 2."""
    if d.by_torque != 0.0:
        return x.drive_torque
    _, share, share1 = energy_at(d, side, x, omega1)
    sigma = ratio(x.omega3, abs(omega1))
    if sigma >= side.end:
        return share * alpha1 + mesh_share(d, side, x, omega1, omega1, torque) + d.b1 * omega1
    sign = 1.0 if omega1 >= 0.0 else -1.0
    own, lost = lost_torque(d, side, x, abs(omega1))
    ideal = sign * torque * sigma + (share - 0.5 * sigma * share1) * alpha1 + sign * 0.5 * share1 * alpha3
    return ideal + sign * (own + lost)


def lose(d, side, x, w, v, end, h, omega3):
    """Add the losses of a leg over h, but for drag of a shaft that coasts: from v at its ends, omega3 at its
    beginning, and what the leg has left in w. By torque w.lost is all that is lost, and shared out.

    Returns:
        (energies lost by friction of link 1 and behind its mesh, J, impulses that they take, N m s).
    """
    add_loss(x, VISCOUS, w.lost3)
    last = x.omega3
    middle = middle_speed(h, w.turned3, omega3, last)
    friction = d.b1 if d.by_torque == 0.0 else 0.0
    share = 1.0
    own = inner = own_impulse = inner_impulse = 0.0
    for adding in range(0 if d.by_torque != 0.0 else 1, 2):
        own = inner = own_impulse = inner_impulse = 0.0
        for n in range(3):
            speed = abs(v + 0.5 * n * (end - v))
            x.omega3 = last
            if n < 2:
                x.omega3 = omega3 if n == 0 else middle
            weight = share * h * (MIDDLE if n == 1 else ENDS)
            own += weight * friction * speed * speed
            own_impulse += weight * friction * speed
            for cause in range(len(x.lost)):
                lost = weight * lost_power(side, x, speed, cause)
                if adding == 1:
                    add_loss(x, cause, lost)
                inner += lost
                inner_impulse += lost / speed if speed > 0.0 else 0.0
        if d.by_torque != 0.0 and adding == 0:
            share = w.lost / (own + inner) if own + inner > 0.0 else 0.0
    add_loss(x, VISCOUS, own)
    return own, inner, side.direction * own_impulse, side.direction * inner_impulse


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
