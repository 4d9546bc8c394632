"""Equation 3 of Stelmashchuk solved without closed forms: by integration, and in 50 digits."""

import itertools
import math

import mpmath as mp
import numpy as np
from scipy.integrate import solve_ivp

TWO_PI = 2.0 * math.pi


def law_in_words(kappa, kappa2):
    """The driving wheel, phase after phase as the paper has it: angle, velocity, acceleration."""
    if kappa < 0.5:
        angle = TWO_PI * kappa
        return kappa - math.sin(angle) / TWO_PI, 1 - math.cos(angle), TWO_PI * math.sin(angle)
    kappa -= 0.5
    if kappa < kappa2:
        return 0.5 + 2 * kappa, 2.0, 0.0
    kappa -= kappa2
    if kappa < 0.5:
        angle = TWO_PI * kappa
        return (
            0.5 + 2 * kappa2 + kappa + math.sin(angle) / TWO_PI,
            1 + math.cos(angle),
            -TWO_PI * math.sin(angle),
        )
    return 1 + 2 * kappa2, 0.0, 0.0


def integrated(kappa, nu, Pi, kappa2, beta):
    """Equation 3 integrated from one of the times kappa to the next: a, a', a''."""
    edges = [0.0, 0.5, 0.5 + kappa2, 1.0 + kappa2]

    def acceleration(t, angle, velocity):
        driving = law_in_words(t, kappa2)
        return nu**2 * (driving[0] - angle) + beta * driving[2] - 2 * Pi * velocity

    def rates(t, y):
        return y[1], acceleration(t, *y)

    # no step goes over a boundary, where a'' has a kink, and none is interpolated
    stops = sorted({*kappa.tolist(), *edges})
    state, rows = (0.0, 0.0), {0.0: (0.0, 0.0, 0.0)}
    for begin, end in itertools.pairwise(stops):
        state = solve_ivp(rates, (begin, end), state, "DOP853", rtol=3e-14, atol=1e-15).y[:, -1]
        rows[end] = (*state, acceleration(end, *state))
    return np.array([rows[time] for time in kappa.tolist()]).T


class Propagator:
    """Equation 3 for the twist, its forcing made part of the system, as a matrix exponential in 50 digits."""

    def __init__(self, nu, Pi, kappa2, beta):
        mp.mp.dps = 50
        nu, Pi, beta = mp.mpf(nu), mp.mpf(Pi), mp.mpf(beta)
        w = 2 * mp.pi
        self.systems = []
        for steady, wave in ((-2, 1), (-4, 0), (-2, -1), (0, 0)):
            rows = [
                [0, 1, 0, 0, 0],
                [-(nu**2), -2 * Pi, steady * Pi, wave * 2 * Pi, -wave * (1 - beta) * w],
                [0, 0, 0, 0, 0],
                [0, 0, 0, 0, -w],
                [0, 0, 0, w, 0],
            ]
            self.systems.append(mp.matrix(rows))
        self.edges = [mp.mpf(0), mp.mpf(0.5), mp.mpf(0.5) + kappa2, mp.mpf(1) + kappa2]
        self.starts = [(mp.mpf(0), mp.mpf(0))]
        for phase in range(3):
            self.starts.append(self.moved(phase, self.edges[phase + 1] - self.edges[phase])[:2])

    def moved(self, phase, time):
        start = mp.matrix([*self.starts[phase], 1, 1, 0])
        state = mp.expm(self.systems[phase] * time) * start
        return state[0], state[1], (self.systems[phase] * state)[1]

    def __call__(self, kappa):
        phase = max(number for number in range(4) if kappa >= self.edges[number])
        return [float(value) for value in self.moved(phase, mp.mpf(float(kappa)) - self.edges[phase])]
