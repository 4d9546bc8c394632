"""DrivenShaft another way: the exponential of its augmented matrix at many digits, energies and all."""

import mpmath
from scipy.integrate import solve_ivp

# rows of the linear state: twist, speed of the driven mass, time, one
TWIST, SPEED, TIME, ONE = range(4)


def _system(J, c, d, f, beta, hub, slope, load):
    """Matrix of the linear state, and the shaft torque, slip and hub speed as rows over it."""
    number = mpmath.mpf
    slip = [number(0), number(-1), number(slope), number(hub)]
    torque = [number(d) * entry for entry in slip]
    torque[TWIST] += number(c)
    rate = [entry / number(J) for entry in torque]
    rate[SPEED] -= number(f) / number(J)
    rate[ONE] += number(beta) * number(slope) - number(load) / number(J)
    clock = [number(0), number(0), number(0), number(1)]
    return mpmath.matrix([slip, rate, clock, [number(0)] * 4]), torque, slip, rate


def _value(row, state):
    return sum(a * b for a, b in zip(row, state, strict=True))


def exact(J, c, d, f, beta, hub, slope, load, twist, omega4, h, digits=200, energies=True):
    """Everything at the end of a step of constant slope, by name; no jump at its beginning."""
    with mpmath.workdps(digits):
        number = mpmath.mpf
        a, torque, slip, rate = _system(J, c, d, f, beta, hub, slope, load)
        begin = [number(twist), number(omega4), number(0), number(1)]
        size = 4
        forms = []
        if energies:
            # products of two entries of the state are linear in themselves
            size = 16
            hub_row = [number(0), number(0), number(slope), number(hub)]
            speed = [number(0), number(1), number(0), number(0)]
            forms = [
                (torque, clock_row()),
                (torque, hub_row),
                ([number(load) * s for s in speed], clock_row()),
                ([number(d) * s for s in slip], slip),
                ([number(f) * s for s in speed], speed),
                ([number(beta) * number(J) * number(slope) * s for s in speed], clock_row()),
            ]
        generator = mpmath.zeros(size + len(forms))
        for i in range(4):
            for j in range(4):
                for k in range(4 if energies else 0):
                    generator[4 * i + k, 4 * j + k] += a[i, j]
                    generator[4 * k + i, 4 * k + j] += a[i, j]
                if not energies:
                    generator[i, j] = a[i, j]
        for row, (left, right) in enumerate(forms, size):
            for i in range(4):
                for j in range(4):
                    generator[row, 4 * i + j] += left[i] * right[j]
        start = mpmath.zeros(size + len(forms), 1)
        for i in range(4):
            for j in range(4 if energies else 0):
                start[4 * i + j] = begin[i] * begin[j]
            if not energies:
                start[i] = begin[i]
        end = mpmath.expm(generator * number(h), method="taylor") * start
        state = [end[4 * i + ONE] for i in range(4)] if energies else [end[i] for i in range(4)]
        found = {
            "twist": state[TWIST],
            "omega_out": state[SPEED],
            "shaft_torque": _value(torque, state),
            "driven_acceleration": _value(rate, state),
        }
        if energies:
            momentum, work, out, damped, rubbed, balanced = (end[size + n] for n in range(6))
            found |= {
                "shaft_torque_mean": momentum / number(h),
                "energy_in": work,
                "energy_out": out,
                "energy_lost": damped + rubbed - balanced,
            }
        return found


def clock_row():
    """The row that is one at all times."""
    return [mpmath.mpf(0), mpmath.mpf(0), mpmath.mpf(0), mpmath.mpf(1)]


def integrated(J, c, d, f, beta, hub, hub_rate, load, h, rtol=1e-11):
    """Twist and speed at h from rest for any motion of the hub (functions of time), by SciPy."""

    def rates(t, y):
        twist, omega4 = y
        slip = hub(t) - omega4
        return [slip, (c * twist + d * slip - f * omega4 - load) / J + beta * hub_rate(t)]

    solution = solve_ivp(rates, (0.0, h), [0.0, 0.0], method="DOP853", rtol=rtol, atol=1e-14)
    return solution.y[:, -1]
