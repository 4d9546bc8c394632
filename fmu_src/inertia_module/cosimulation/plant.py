"""What an engine with its module is from outside: a plant whose omega1 is the speed asked for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence

from ..instance import Fmu
from .bond import Exchange, Ledger
from .engine import Engine

# what can be read besides the variables of the FMU
ENGINE_READINGS = {
    "engine_speed": "rad/s",
    "engine_torque": "N.m",
    "engine_angle": "rad",
    "engine_work_in": "J",
    "engine_work_out": "J",
    "engine_energy": "J",
    "bond_defect": "J",
}


class EnginePlant(ABC):
    """An engine in front of a module, seen from outside.

    Args:
        fmu: a started FMU of the module. engine: in front of it.
        substeps: equal communication steps between engine and module in each step of the plant.

    Attributes:
        ledger: sums over the run. exchange: of the last communication step, or None.

    Raises:
        ValueError: no substeps.
    """

    def __init__(self, fmu: Fmu, engine: Engine, substeps: int = 1) -> None:
        if substeps < 1:
            raise ValueError(f"substeps = {substeps} is refused: allowed is a whole number from 1")
        self.fmu, self.engine, self.substeps = fmu, engine, substeps
        self.ledger = Ledger()
        self.exchange: Exchange | None = None

    @property
    @abstractmethod
    def energy_stored(self) -> float:
        """Kinetic energy of engine and module together, J."""

    @abstractmethod
    def step(self, h: float) -> Exchange:
        """Advance both by one communication step, s.

        Raises:
            DriveError: the FMU refused the step; both are where they were, and a good step goes on.
        """

    def set(self, **values: float) -> None:
        """Set inputs of the FMU by name; omega1 is the speed the governor is asked for.

        Raises:
            ValueError: drive_torque, which the engine gives.
        """
        given: Mapping[str, float] = values
        if "drive_torque" in given:
            raise ValueError(
                f"drive_torque = {given['drive_torque']:g} N.m is refused: the engine gives it;"
                " allowed is omega1, the speed its governor is asked for"
            )
        if "omega1" in given:
            self.engine.reference = given["omega1"]
            given = {name: value for name, value in given.items() if name != "omega1"}
        self.fmu.set(**given)

    def advance(self, step: float) -> None:
        """Advance engine and module by a step, s, in substeps.

        Raises:
            DriveError: the FMU refused the step.
        """
        for _ in range(self.substeps):
            self.step(step / self.substeps)

    def read(self, names: Sequence[str]) -> tuple[float, ...]:
        """Values by name: variables of the FMU, and ENGINE_READINGS."""
        own = self._readings()
        others = iter(self.fmu.read([name for name in names if name not in own]))
        return tuple(own[name] if name in own else next(others) for name in names)

    def _readings(self) -> dict[str, float]:
        state = self.engine.state
        values = (
            state.speed,
            state.torque,
            state.angle,
            state.work_in,
            state.work_out,
            self.engine.energy_stored,
            self.ledger.defect,
        )
        return dict(zip(ENGINE_READINGS, values, strict=True))
