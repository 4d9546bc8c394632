"""DrivenShaft another way: the exponential of its augmented matrix at many digits, energies and all."""

from itertools import product

import mpmath

# rows of the linear state: twist, speed of the driven mass, time, one
TWIST, SPEED, TIME, ONE = range(4)
# the row that is one at all times
CLOCK = [mpmath.mpf(0), mpmath.mpf(0), mpmath.mpf(0), mpmath.mpf(1)]


def _system(J, c, d, f, beta, hub, slope, load):
    """Matrix of the linear state, and the shaft torque, slip and hub speed as rows over it."""
    number = mpmath.mpf
    slip = [number(0), number(-1), number(slope), number(hub)]
    torque = [number(d) * entry for entry in slip]
    torque[TWIST] += number(c)
    rate = [entry / number(J) for entry in torque]
    rate[SPEED] -= number(f) / number(J)
    rate[ONE] += number(beta) * number(slope) - number(load) / number(J)
    return mpmath.matrix([slip, rate, CLOCK, [number(0)] * 4]), torque, slip, rate


def _value(row, state):
    return sum(a * b for a, b in zip(row, state, strict=True))


def exact(J, c, d, f, beta, hub, slope, load, twist, omega4, h):
    """Everything at the end of a step of constant slope, by name; no jump at its beginning."""
    with mpmath.workdps(200):
        number = mpmath.mpf
        a, torque, slip, rate = _system(J, c, d, f, beta, hub, slope, load)
        begin = [number(twist), number(omega4), number(0), number(1)]
        hub_row = [number(0), number(0), number(slope), number(hub)]
        speed = [number(0), number(1), number(0), number(0)]
        forms = [
            (torque, CLOCK),
            (torque, hub_row),
            ([number(load) * s for s in speed], CLOCK),
            ([number(d) * s for s in slip], slip),
            ([number(f) * s for s in speed], speed),
            ([number(beta) * number(J) * number(slope) * s for s in speed], CLOCK),
        ]
        # products of two entries of the state are linear in themselves
        generator, start = mpmath.zeros(16 + len(forms)), mpmath.zeros(16 + len(forms), 1)
        for i, j in product(range(4), repeat=2):
            start[4 * i + j] = begin[i] * begin[j]
            for k in range(4):
                generator[4 * i + k, 4 * j + k] += a[i, j]
                generator[4 * k + i, 4 * k + j] += a[i, j]
            for row, (left, right) in enumerate(forms, 16):
                generator[row, 4 * i + j] += left[i] * right[j]
        end = mpmath.expm(generator * number(h), method="taylor") * start
        state = [end[4 * i + ONE] for i in range(4)]
        momentum, work, out, damped, rubbed, balanced = (end[16 + n] for n in range(6))
        return {
            "twist": state[TWIST],
            "omega_out": state[SPEED],
            "shaft_torque": _value(torque, state),
            "driven_acceleration": _value(rate, state),
            "shaft_torque_mean": momentum / number(h),
            "energy_in": work,
            "energy_out": out,
            "energy_lost": damped + rubbed - balanced,
        }
