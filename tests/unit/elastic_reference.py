"""The elastic output by SciPy: the reference mechanism with hub, shaft and driven mass, event by event."""

import numpy as np
from independent import J2, LOAD, OMEGA1, K, falling, push
from scipy.integrate import solve_ivp


class ElasticReference:
    """States q, omega2, omega3, delta, omega4 of DESIGN section 3.

    Args:
        hub, driven: J3, J4. stiffness, damping, friction, balancer: c, d, f, beta.
    """

    def __init__(self, hub, driven, stiffness, damping=0.0, friction=0.0, balancer=0.0):
        self.hub, self.driven, self.stiffness = hub, driven, stiffness
        self.damping, self.friction, self.balancer = damping, friction, balancer

    def torque(self, y):
        return self.stiffness * y[3] + self.damping * (y[2] - y[4])

    def rates(self, y, omega2_rate, omega3_rate):
        driven = self.torque(y) - self.friction * y[4] - LOAD + self.balancer * self.driven * omega3_rate
        return [K * (OMEGA1 - y[1]), omega2_rate, omega3_rate, y[2] - y[4], driven / self.driven]

    def held(self, _, y):
        return self.rates(y, 0.0, -self.torque(y) / self.hub)

    def free(self, _, y):
        own, torque = push(y[0], y[1])
        return self.rates(y, torque / (J2 + own), -self.torque(y) / self.hub)

    def driving(self, _, y):
        own, torque = push(y[0], y[1])
        rate = (torque - self.torque(y)) / (J2 + self.hub + own)
        return self.rates(y, rate, rate)

    def rest(self, _, y):
        return self.rates(y, 0.0, 0.0)

    def clutch_torque(self, y):
        return self.torque(y) + self.hub * self.driving(0.0, y)[1]

    def leaves(self, mode):
        """Guards of a mode, and what is exactly equal where one falls."""
        link2_stops = falling(lambda _, y: y[1])
        return {
            "held": [
                (falling(lambda _, y: -push(y[0], 0.0)[1]), None),
                (falling(lambda _, y: y[2]), "all stop"),
            ],
            "free": [(link2_stops, "link 2 stops"), (falling(lambda _, y: y[2] - y[1]), "equal")],
            "driving": [(falling(lambda _, y: self.clutch_torque(y)), None), (link2_stops, "all stop")],
            "rest": [
                (falling(lambda _, y: self.torque(y) - push(y[0], 0.0)[1]), None),
                (falling(lambda _, y: self.torque(y)), None),
            ],
        }[mode]

    def mode_after(self, mode, which, y):
        """The mode that follows when guard number which has fallen (no ties in the scenes tested)."""
        torque = push(y[0], y[1])[1]
        shaft = self.torque(y)
        if mode == "rest":
            return "driving" if which == 0 else ("free" if torque > 0.0 else "held")
        if mode == "held":
            return "free" if which == 0 else ("rest" if shaft > 0.0 else "held")
        if mode == "free":
            return "held" if which == 0 else "driving"
        if which == 0:
            return "free"
        return "rest" if shaft > 0.0 else ("free" if torque > 0.0 else "held")

    def state(self, duration):
        """(q, omega2, omega3, delta, omega4) after a while, from rest with the shaft untwisted."""
        time, y, mode = 0.0, np.zeros(5), "rest"
        while True:
            guards = [guard for guard, _ in self.leaves(mode)]
            rates = getattr(self, mode)
            found = solve_ivp(
                rates, (time, duration), y, "DOP853", rtol=1e-13, atol=1e-13, max_step=2e-4, events=guards
            )
            time, y = found.t[-1], found.y[:, -1]
            if found.status == 0:
                return y
            which = next(n for n, times in enumerate(found.t_events) if times.size)
            exact = self.leaves(mode)[which][1]
            if exact == "equal":
                y[1] = y[2]
            elif exact is not None:
                y[1] = 0.0
                y[2] = 0.0 if exact == "all stop" else y[2]
            mode = self.mode_after(mode, which, y)
