"""The reference scene by SciPy: equations and freewheels written out afresh, from positions alone."""

import numpy as np
from geometry import position, ratio, series_rate, taylor
from scenes import REFERENCE, parameters
from scipy.integrate import solve_ivp

P = parameters()
OMEGA1, LOAD = REFERENCE["omega1"], REFERENCE["load_torque"]
J2, J3, K = P["link2_inertia"], P["output_inertia"], ratio(P)
TURNS = 10  # of the drive in one period of the motion


def _fourier(points=256):
    """Reduced inertia (I, G) over a period as Fourier series: orders per turn and coefficients."""
    samples = np.zeros((points, 2))
    for n in range(points):
        r = taylor(lambda q: position(P, q), 2.0 * np.pi * TURNS * n / points)
        samples[n] = (r[0, 1:] ** 2).sum(), (series_rate(r)[0] ** 2).sum()
    coefficients = P["imbalance_mass"] * np.fft.fft(samples, axis=0) / points
    orders = np.fft.fftfreq(points, 1.0 / points) / TURNS
    large = np.abs(coefficients).max(axis=1) > 1e-13 * np.abs(coefficients).max()
    return orders[large], coefficients[large].T


ORDERS, (I_TERMS, G_TERMS) = _fourier()


def push(q, omega2):
    """(k^2 G, mesh torque on link 2 if it were not accelerated), the input speed being constant."""
    waves = np.exp(1j * ORDERS * q)
    rates = 1j * ORDERS * waves
    i1, g, g1 = (I_TERMS @ rates).real, (G_TERMS @ waves).real, (G_TERMS @ rates).real
    return K * K * g, K * (0.5 * g1 * (K * (OMEGA1 - omega2)) ** 2 - 0.5 * i1 * OMEGA1**2)


def held(_, y):
    return [K * OMEGA1, 0.0, -LOAD / J3]


def free(_, y):
    own, torque = push(y[0], y[1])
    return [K * (OMEGA1 - y[1]), torque / (J2 + own), -LOAD / J3]


def driving(_, y):
    own, torque = push(y[0], y[1])
    alpha2 = (torque - LOAD) / (J2 + J3 + own)
    return [K * (OMEGA1 - y[1]), alpha2, alpha2]


def rest(_, y):
    return [K * OMEGA1, 0.0, 0.0]


def falling(function):
    """An event that ends the mode where the function falls through zero."""
    function.terminal, function.direction = True, -1
    return function


# guards of each mode, the mode behind each, and what is exactly equal there
LINK2_STOPS = falling(lambda _, y: y[1])
MODES = {
    held: [
        (falling(lambda _, y: -push(y[0], 0.0)[1]), free, None),
        (falling(lambda _, y: y[2]), rest, "all stop"),
    ],
    free: [(LINK2_STOPS, held, "link 2 stops"), (falling(lambda _, y: y[2] - y[1]), driving, "equal")],
    driving: [
        (falling(lambda _, y: LOAD + J3 * driving(0.0, y)[1]), free, None),
        (LINK2_STOPS, rest, "all stop"),
    ],
    rest: [(falling(lambda _, y: LOAD - push(y[0], 0.0)[1]), driving, None)],
}


def reference_scene(duration):
    """(q, omega2, omega3) of the reference scene after a while."""
    time, y, mode = 0.0, np.zeros(3), rest
    while True:
        guards = [guard for guard, _, _ in MODES[mode]]
        found = solve_ivp(
            mode, (time, duration), y, "DOP853", rtol=1e-13, atol=1e-13, max_step=5e-4, events=guards
        )
        time, y = found.t[-1], found.y[:, -1]
        if found.status == 0:
            return tuple(y)
        which = next(n for n, times in enumerate(found.t_events) if times.size)
        _, mode, exact = MODES[mode][which]
        if exact == "equal":
            y[1] = y[2]
        elif exact is not None:
            y[1] = 0.0
            y[2] = 0.0 if exact == "all stop" else y[2]
