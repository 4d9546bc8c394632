"""Lysenko's mechanism as a chain of turned bodies in 30 digits, without the closed forms of the package."""

import mpmath as mp

from studies.papers.lysenko.equations import EXAMPLE, Mechanism

OMEGA, OMEGA_RATE = 37.0, 210.0

MECHANISMS = [
    EXAMPLE,
    Mechanism(R0=0.05, r=0.03, arm=0.02, m=0.8),
    Mechanism(R0=0.04, r=0.11, arm=0.2, m=0.3, J_carrier=1e-3, J_wheel=2e-4),
    Mechanism(R0=2.0, r=1e-3, arm=1e-6, m=5.0, J_carrier=0.1),
]
ALPHAS = [0.0, 0.4, 1.3, 1.5707963267948966, 2.2, 3.141592653589793, 4.0, 6.1, 1e4]


class Chain:
    """Carrier and wheel turned in the plane as complex numbers; time is zero at the angle asked for."""

    def __init__(self, mechanism, alpha, omega=OMEGA, omega_rate=0.0):
        mp.mp.dps = 30
        self.m = mechanism
        self.ratio = mp.mpf(mechanism.r) / mp.mpf(mechanism.R0)
        self.angle = lambda t: mp.mpf(alpha) + omega * t + omega_rate * t * t / 2

    def pin(self, t):
        return (mp.mpf(self.m.R0) + mp.mpf(self.m.r)) * mp.expj(self.ratio * self.angle(t))

    def mass(self, t):
        # the wheel has turned by the carrier's angle and by alpha on it; at alpha = 0 it points to O
        return self.pin(t) - mp.mpf(self.m.arm) * mp.expj(self.ratio * self.angle(t) + self.angle(t))

    def energy(self, t):
        carrier = mp.diff(lambda s: self.ratio * self.angle(s), t)
        wheel = mp.diff(lambda s: (1 + self.ratio) * self.angle(s), t)
        of_mass = mp.mpf(self.m.m) * abs(mp.diff(self.mass, t)) ** 2
        return (of_mass + self.m.J_carrier * carrier**2 + self.m.J_wheel * wheel**2) / 2

    def momentum(self, t):
        links = self.m.J_carrier * mp.diff(lambda s: self.ratio * self.angle(s), t)
        links += self.m.J_wheel * mp.diff(lambda s: (1 + self.ratio) * self.angle(s), t)
        return links + self.m.m * cross(self.mass(t), mp.diff(self.mass, t))

    def inertia_force(self):
        return -self.m.m * mp.diff(self.mass, 0, 2)


def cross(one, two):
    return one.real * two.imag - one.imag * two.real


def torque_scale(mechanism):
    return mechanism.m * mechanism.centre_distance * mechanism.arm * OMEGA**2 * (1 + mechanism.b) ** 2
