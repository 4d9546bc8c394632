"""Link 2 held, the speed of link 1 prescribed: the motion is known, only the release has to be found.

With omega2 = 0 the drive angle is q + k (omega1 t + alpha1 t^2 / 2) and link 1 has one degree of freedom of
inertia Phi(q) = J1 + I + 2 k B + k^2 G, so work and impulse of the input torque are exact.
"""

import math

from ..accumulate import add, wrap_drive_angle
from ..codes import CLOSED_FORM, HELD, LINK2
from ..contact import TORQUE_ROUNDING
from ..guards import held_fourth_bound, keep_motion, threshold
from ..links import torque_scale
from ..loads import sample_load
from ..output_shaft import pass_while_held, stop, time_to_stop
from ..search import first_crossing
from ..works import add_held_works, held_angle, inertia_integral

# phase of the highest harmonic between two looks at the guard, rad
SCAN_PHASE = 1.5
# looks before the angle is wrapped and the work counted
MOST_LOOKS = 64


def advance_held(d, x, w, remaining):
    """Advance some intervals, to the release of link 2 or to where the output shaft stops.

    Returns:
        (time passed, whether the contact mode may change then).
    """
    omega1 = x.omega1
    alpha1 = w.prescribed
    w.solver = CLOSED_FORM
    stopping = time_to_stop(d, x, w.load, remaining) if x.mode == HELD else -1.0
    h = stopping if stopping >= 0.0 else remaining
    released = False
    energy = 0.0
    if omega1 != 0.0 or alpha1 != 0.0:  # else nothing turns: the guard stays as it is
        interval = min(h, d.max_step)
        rate = d.harmonic * d.k * max(abs(omega1), abs(omega1 + alpha1 * h))
        if rate * interval > SCAN_PHASE:
            interval = SCAN_PHASE / rate
        looks = 1
        if h > interval:
            looks = int(min(MOST_LOOKS, math.ceil(h / interval)))
            h = min(h, looks * interval)
        w.step = h
        fastest = max(abs(omega1), abs(omega1 + alpha1 * h))
        scale = torque_scale(d, fastest, alpha1, d.k * fastest, 0.0)
        zero = TORQUE_ROUNDING * (scale + abs(threshold(x, w)))
        sigma = first_crossing(d, x, w, LINK2, zero, held_fourth_bound(d, x, w, scale), looks)
        if sigma > 0.0:
            released = True
            looks = max(1, int(math.ceil(sigma * looks)))
            h *= sigma
        phi = 0.0
        if alpha1 != 0.0:
            for n in range(looks):
                phi += inertia_integral(d, x, x.q, omega1, alpha1, h * n / looks, h * (n + 1) / looks)
        for n in range(2 * looks):
            t = h * n / (2 * looks)
            sample_load(d, x, held_angle(d, x.q, omega1, alpha1, t), omega1 + alpha1 * t, 0.0, alpha1, 0.0)
        energy = add_held_works(d, x, x.q, omega1, alpha1, h, phi)
        x.q, x.q_low = add(x.q, x.q_low, d.k * h * (omega1 + 0.5 * alpha1 * h))
        wrap_drive_angle(d, x)
        x.omega1, x.omega1_low = add(x.omega1, x.omega1_low, alpha1 * h)
    keep_motion(x, (alpha1, 0.0, 0.0, 0.0, 0.0, 0.0, energy))  # only the last is looked at
    pass_while_held(d, x, w.load, h)
    if stopping >= 0.0 and h >= stopping and not released:
        stop(x)
        return h, True
    return h, released
