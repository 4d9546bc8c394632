"""Balance of the mean power of link 1: mesh and input torque, losses by cause.

    M1 omega1 = T omega3 + losses + E'        M2 omega1 = T omega3 + losses behind the mesh

Friction of link 1 and of the output is known as it is, the other losses are those of the map.
"""

from ..accumulate import add_loss
from ..codes import VISCOUS
from .legs import coasting_torque
from .rates import by_speed, energy_at, find_knot, ratio, slowness
from .step import middle_speed

# Simpson's rule
ENDS = 1.0 / 6.0
MIDDLE = 2.0 / 3.0


def lost_at_knot(knot, cause, w):
    """Mean power that a cause takes at a knot, over the cube of the speed; w: see slowness."""
    s = knot.slower
    slower = s[0].lost[cause], s[1].lost[cause], s[2].lost[cause]
    slowest = s[3].lost[cause], s[4].lost[cause], s[5].lost[cause]
    return by_speed(knot.lost[cause], slower, slowest, (0.0, s[6].lost[cause], s[7].lost[cause]), w)[0]


def lost_power(d, side, x, speed, cause):
    """Mean power that a cause takes from link 2 and what moves in it, by the map, W."""
    n = find_knot(side, x, ratio(x.omega3, speed))
    here = side.knots[n]
    after = side.knots[min(n + 1, int(side.count) - 1)]
    width = after.ratio - here.ratio
    t = min((ratio(x.omega3, speed) - here.ratio) / width, 1.0) if width > 0.0 else 0.0
    w = slowness(side, speed) if side.slow != 0.0 else 0.0
    first = lost_at_knot(here, cause, w)
    last = lost_at_knot(after, cause, w)
    return speed * speed * speed * max(first + t * (last - first), 0.0)


def lost_torque(d, side, x, speed):
    """Torque that losses take from link 1 in the mean, N m: friction of its own, and that of the rest."""
    if d.lossy == 0.0 or speed == 0.0:
        return 0.0, 0.0
    # drag of an output that coasts, and the losses of the map
    beyond = max(x.omega3 - side.end * speed, 0.0)
    inner = max(-coasting_torque(d, side, x, speed) * beyond, 0.0)
    for cause in range(len(x.lost)):
        inner += lost_power(d, side, x, speed, cause)
    return d.b1 * speed, inner / speed


def mesh_share(d, side, x, omega1, torque):
    """Mean mesh torque, what goes out and what is lost behind the mesh over omega1: power balances."""
    if omega1 == 0.0:
        return 0.0
    passed = torque * x.omega3 / omega1 if torque != 0.0 else 0.0
    lost = lost_torque(d, side, x, abs(omega1))[1]
    return passed + (lost if omega1 > 0.0 else -lost)


def mean_input_torque(d, side, x, omega1, alpha1, alpha3, torque):
    """M1 of the mean balance M1 omega1 = T omega3 + losses + dE/dt, E = omega1^2 epsilon(sigma) / 2."""
    if d.by_torque != 0.0:
        return x.drive_torque
    _, share, share1 = energy_at(d, side, x, omega1)
    sigma = ratio(x.omega3, abs(omega1))
    if sigma >= side.end:
        return share * alpha1 + mesh_share(d, side, x, omega1, torque) + d.b1 * omega1
    sign = 1.0 if omega1 >= 0.0 else -1.0
    own, lost = lost_torque(d, side, x, abs(omega1))
    ideal = sign * torque * sigma + (share - 0.5 * sigma * share1) * alpha1 + sign * 0.5 * share1 * alpha3
    return ideal + sign * (own + lost)


def lose(d, side, x, w, v, end, h, omega3):
    """Add the losses of a leg over h, but for drag of a shaft that coasts: from v at its ends, omega3 at its
    beginning, and what the leg has left in w.

    Returns:
        (energies lost by friction of link 1 and behind its mesh, J, impulses that they take, N m s).
    """
    add_loss(x, VISCOUS, w.lost3)
    own = inner = own_impulse = inner_impulse = 0.0
    last = x.omega3
    middle = middle_speed(h, w.turned3, omega3, last)
    for n in range(3):
        speed = abs(v + 0.5 * n * (end - v))
        x.omega3 = last
        if n < 2:
            x.omega3 = omega3 if n == 0 else middle
        weight = h * (MIDDLE if n == 1 else ENDS)
        own += weight * d.b1 * speed * speed
        own_impulse += weight * d.b1 * speed
        for cause in range(len(x.lost)):
            lost = weight * lost_power(d, side, x, speed, cause)
            add_loss(x, cause, lost)
            inner += lost
            inner_impulse += lost / speed if speed > 0.0 else 0.0
    add_loss(x, VISCOUS, own)
    return own, inner, side.direction * own_impulse, side.direction * inner_impulse
