"""Engine with its module from outside: a plant whose omega1 is the speed asked for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from ..harness.fmu import Fmu
from ..kernel.codes import DRIVE_SPEED
from .engine import Engine


class Exchange(NamedTuple):
    """Exchange between engine and module in one communication step: each side's own account.

    Attributes:
        step: s. engine_torque, module_torque: means over the step, N.m. engine_work, module_work: J.
    """

    step: float
    engine_torque: float
    module_torque: float
    engine_work: float
    module_work: float

    @property
    def defect(self) -> float:
        """Energy lost between both, J: each side is exact for what it was given."""
        return self.engine_work - self.module_work


@dataclass
class Ledger:
    """Sums over a run.

    Attributes:
        time: s. steps: communication steps. fmu_steps: steps of the FMU, those taken back included.
        derivatives: directional derivatives asked for. defect: energy lost on the bond, J.
        defect_magnitude: sum of |defect| of the steps, J.
    """

    time: float = 0.0
    steps: int = 0
    fmu_steps: int = 0
    derivatives: int = 0
    defect: float = 0.0
    defect_magnitude: float = 0.0

    @property
    def cost(self) -> int:
        """In steps of the FMU; a directional derivative takes two, those of outputs are not counted."""
        return self.fmu_steps + 2 * self.derivatives

    def add(self, exchange: Exchange) -> None:
        """Add a communication step."""
        self.time += exchange.step
        self.steps += 1
        self.defect += exchange.defect
        self.defect_magnitude += abs(exchange.defect)


class EnginePlant(ABC):
    """An engine in front of a module, seen from outside.

    Args:
        fmu: a started FMU of the module with omega1 = speed of the engine.
        engine: in front of it. drive: what the module has to be driven by.
        substeps: equal communication steps between engine and module in each step of the plant.

    Attributes:
        ledger: sums over the run.

    Raises:
        ValueError: no substeps, another drive, or speeds that differ.
    """

    def __init__(self, fmu: Fmu, engine: Engine, drive: int, substeps: int = 1) -> None:
        if substeps < 1:
            raise ValueError(f"substeps must be a whole number from 1, is {substeps}")
        given, speed = fmu.read(("drive", "input_speed"))
        if given != drive:
            asked, other = ("speed", "torque") if drive == DRIVE_SPEED else ("torque", "speed")
            raise ValueError(f"drive of the FMU must be {asked} for {type(self).__name__}, is {other}")
        if abs(speed - engine.speed) > 1e-9 * max(1.0, abs(speed)):
            raise ValueError(f"omega1 of the FMU must be the engine's {engine.speed:g} rad/s, is {speed:g}")
        self.fmu, self.engine, self.substeps = fmu, engine, substeps
        self.ledger = Ledger()

    @property
    @abstractmethod
    def energy_stored(self) -> float:
        """Kinetic energy of engine and module together, J."""

    @abstractmethod
    def _exchange(self, h: float) -> Exchange:
        """Advance both by one communication step, s; what raises leaves both where they were."""

    def step(self, h: float) -> Exchange:
        """Advance both by one communication step, s.

        Raises:
            FmuError: the FMU refused the step; both are where they were, and a good step goes on.
        """
        exchange = self._exchange(h)
        self.ledger.add(exchange)
        return exchange

    def set(self, **values: float) -> None:
        """Set inputs of the FMU by name; omega1 is the speed the governor is asked for.

        Raises:
            ValueError: drive_torque, which the engine gives.
        """
        given: Mapping[str, float] = values
        if "drive_torque" in given:
            raise ValueError(
                f"drive_torque = {given['drive_torque']:g} N.m cannot be set, the engine gives it;"
                " set omega1, the speed its governor is asked for"
            )
        if "omega1" in given:
            self.engine.reference = given["omega1"]
            given = {name: value for name, value in given.items() if name != "omega1"}
        self.fmu.set(**given)

    def advance(self, step: float) -> None:
        """Advance engine and module by a step, s, in substeps.

        Raises:
            FmuError: the FMU refused the step.
        """
        for _ in range(self.substeps):
            self.step(step / self.substeps)

    def read(self, names: Sequence[str]) -> tuple[float, ...]:
        """Values by name: variables of the FMU, and engine_speed, engine_torque, engine_angle (SI units),
        engine_work_in, engine_work_out, engine_energy and bond_defect, J.
        """
        state = self.engine.state
        own = {
            "engine_speed": state.speed,
            "engine_torque": state.torque,
            "engine_angle": state.angle,
            "engine_work_in": state.work_in,
            "engine_work_out": state.work_out,
            "engine_energy": self.engine.energy_stored,
            "bond_defect": self.ledger.defect,
        }
        others = iter(self.fmu.read([name for name in names if name not in own]))
        return tuple(own[name] if name in own else next(others) for name in names)
