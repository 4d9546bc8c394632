"""The power bond between engine and module: speed one way, torque the other, and the energy lost on it.

Over a step the engine does the work W_E = integral of T_E omega_E, the module takes W_M = integral of M1
omega1. Each side is exact for the torque and speed it was given, so the defect of a coupling is W_E - W_M
and nothing else. From what is exchanged alone (means over the step) it is estimated as h (T_E omega_E - T_M
omega_M): the residual of the bond, which needs no audit in the FMU.

Source: Sadjina, Kyllingstad, Skjong and Pedersen, Energy conservation and power bonds in co-simulations:
non-iterative adaptive step size control and error estimation. Engineering with Computers 33 (2017) 607-620.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple


class Exchange(NamedTuple):
    """What passed over the bond in one communication step.

    Attributes:
        step: s. engine_speed, module_speed: means over the step on either side, rad/s.
        engine_torque, module_torque: likewise, N.m. engine_work, module_work: each side's own account, J.
    """

    step: float
    engine_speed: float
    module_speed: float
    engine_torque: float
    module_torque: float
    engine_work: float
    module_work: float

    @property
    def residual(self) -> float:
        """Energy lost on the bond as estimated from the exchanged means, J."""
        return self.step * (self.engine_torque * self.engine_speed - self.module_torque * self.module_speed)

    @property
    def defect(self) -> float:
        """Energy lost on the bond by the accounts of both sides, J."""
        return self.engine_work - self.module_work

    @property
    def impulse_defect(self) -> float:
        """Angular momentum lost on the bond, N.m.s."""
        return self.step * (self.engine_torque - self.module_torque)


@dataclass
class Ledger:
    """Sums over a run.

    Attributes:
        time: s. steps: communication steps. fmu_steps: steps of the FMU, those taken back included.
        derivatives: directional derivatives asked for.
        engine_work, module_work: J. impulse_defect: N.m.s. defect_magnitude: sum of |defect|, J.
        residual_magnitude: sum of |residual|, J.
    """

    time: float = 0.0
    steps: int = 0
    fmu_steps: int = 0
    derivatives: int = 0
    engine_work: float = 0.0
    module_work: float = 0.0
    impulse_defect: float = 0.0
    defect_magnitude: float = 0.0
    residual_magnitude: float = 0.0

    @property
    def defect(self) -> float:
        """Energy lost on the bond since the start, J."""
        return self.engine_work - self.module_work

    @property
    def cost(self) -> int:
        """In steps of the FMU; a directional derivative takes two, those of outputs are not counted."""
        return self.fmu_steps + 2 * self.derivatives

    def add(self, exchange: Exchange) -> None:
        """Book a communication step."""
        self.time += exchange.step
        self.steps += 1
        self.engine_work += exchange.engine_work
        self.module_work += exchange.module_work
        self.impulse_defect += exchange.impulse_defect
        self.defect_magnitude += abs(exchange.defect)
        self.residual_magnitude += abs(exchange.residual)
