"""A communication step driven by the residual of the power bond (ECCO), without taking steps back.

The residual of a step, relative to the energy that passes or is stored, is compared with a tolerance; a PI
controller makes the next step longer or shorter:

    h_(n+1) = safety h_n eps_n^-(k_I + k_P) eps_(n-1)^k_P        eps = |residual| / (tolerance scale)

Sources: Sadjina et al. (2017), see bond.py; Gustafsson, Control theoretic techniques for stepsize selection
in explicit Runge-Kutta methods. ACM Transactions on Mathematical Software 17 (1991) 533-554, for k_I = 0.3/p
and k_P = 0.4/p with p the order of the residual of a step, here 2.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from .bond import Exchange
from .plant import EnginePlant

# an error below it counts as this
_LEAST_ERROR = 1e-12


@dataclass(frozen=True)
class ErrorControl:
    """How the residual sets the step.

    Attributes:
        tolerance: residual allowed in a step, relative to the kinetic energy of the engine.
        shortest, longest: steps, s. safety: share of the step that would just do.
        integral, proportional: k_I and k_P. slowest, fastest: limits of the change of a step.

    Raises:
        ValueError: a number that is not positive, or limits out of order.
    """

    tolerance: float
    shortest: float = 1e-5
    longest: float = 0.05
    safety: float = 0.9
    integral: float = 0.15
    proportional: float = 0.2
    slowest: float = 0.2
    fastest: float = 1.5

    def __post_init__(self) -> None:
        for name in ("tolerance", "shortest", "longest", "safety", "slowest", "fastest"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{name} = {value} is refused: allowed is a positive number")
        if not self.shortest <= self.longest:
            raise ValueError(
                f"shortest = {self.shortest:g} s is refused: allowed is up to longest = {self.longest:g} s"
            )
        if not self.slowest < 1.0 < self.fastest:
            raise ValueError(
                f"slowest = {self.slowest:g}, fastest = {self.fastest:g} are refused: allowed is 1 between"
            )

    def next_step(self, step: float, error: float, last_error: float) -> float:
        """The step after one of step s.

        Args:
            error, last_error: eps of this step and of the one before.
        """
        now, before = max(error, _LEAST_ERROR), max(last_error, _LEAST_ERROR)
        growth = math.pow(now, -self.integral) * math.pow(before / now, self.proportional)
        factor = min(max(self.safety * growth, self.slowest), self.fastest)
        return min(max(step * factor, self.shortest), self.longest)


def run_adaptive(coupled: EnginePlant, stop_time: float, control: ErrorControl) -> Iterator[Exchange]:
    """Step to the stop time, s, the step driven by the residual; gives each exchange.

    The first step is the shortest. The last one ends at the stop time.

    Raises:
        ValueError: the stop time is not positive. DriveError: the FMU refused a step.
    """
    if not (math.isfinite(stop_time) and stop_time > 0.0):
        raise ValueError(f"stop_time = {stop_time} is refused: allowed is a positive number of seconds")
    end = coupled.ledger.time + stop_time
    step, last_error = control.shortest, 1.0
    while coupled.ledger.time < end * (1.0 - 1e-12):
        left = end - coupled.ledger.time
        taken = left if left < 1.5 * step and left <= control.longest else min(step, left)
        exchange = coupled.step(taken)
        yield exchange
        scale = max(coupled.engine.energy_stored, 1e-300)
        error = abs(exchange.residual) / (control.tolerance * scale)
        step, last_error = control.next_step(taken, error, last_error), error
