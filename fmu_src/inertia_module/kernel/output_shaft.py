"""The output shaft turns against the load; while link 2 does not drive it (rigid) it coasts and rests."""

from .accumulate import add
from .codes import HELD_DRIVING, LINK2, OUTPUT


def turn(x, load, angle):
    """Count an angle of the output, driven mass if elastic, and the work on the load."""
    x.turned3 += angle
    x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, load * angle)


def coast(d, x, load, h):
    """Uniform deceleration by the load over h, with its work."""
    change = -load * h / d.J3
    turn(x, load, h * (x.omega3 + 0.5 * change))
    x.omega3, x.omega3_low = add(x.omega3, x.omega3_low, change)


def stop(x):
    """Set the shaft at rest exactly."""
    x.omega3 = 0.0
    x.omega3_low = 0.0


def time_to_stop(d, x, load, remaining):
    """Time until the coasting shaft stops, or -1 if it does not in the time remaining."""
    if load > 0.0 and d.J3 * x.omega3 < load * remaining:
        return d.J3 * x.omega3 / load
    return -1.0


def meet(d, x, which):
    """Set the speeds exactly equal where free link 2 has met the output shaft."""
    if which == LINK2:
        if x.omega3 < 0.0:
            stop(x)
    elif which == OUTPUT or x.omega3 < x.omega2:
        if d.housing != 0.0 and x.omega3 < 0.0:
            stop(x)
        x.omega2 = x.omega3
        x.omega2_low = x.omega3_low


def pass_while_held(d, x, load, h):
    """The shaft over h while link 2 is held: it rests with link 2 against the load, or coasts."""
    if x.mode == HELD_DRIVING:
        x.output_impulse += load * h
        x.output_square += load * load * h
        x.torque_peak = max(x.torque_peak, abs(load))
    else:
        coast(d, x, load, h)
