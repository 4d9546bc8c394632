"""An engine with a rotor of its own: its speed goes to the module, the mean torque of each step comes back.

n numbers the communication points. What is left between the speeds of engine and module at a point is made up
for by a jump at the beginning of the module's next step, whose impulse is in the next step mean.
"""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

from ..harness.fmu import Fmu, FmuError
from ..kernel.codes import DRIVE_SPEED
from .engine import Engine, EngineState, LoadTorque
from .plant import EnginePlant, Exchange

# a step has no need to be made again where the speeds at its end agree to this, relative
_AGREEMENT = 1e-11
# least inertia that a directional derivative may give, in engine inertias
_LEAST_SLOPE = -0.5


class Scheme(StrEnum):
    """A scheme of coupling: who goes first, and what corrects the step.

    JACOBI: both step with what was known at the communication point; the module at a held speed.
    MODULE_FIRST: the engine has the torque of the same step; the module at a held speed.
    INERTIA: the module first, along the speed extrapolated; the engine takes the interface inertia into
        account for what its own acceleration changes in the torque.
    IMPLICIT: the step is tried, taken back and made again along the speed that the module's directional
        derivative says the engine will have.
    """

    JACOBI = "mean jacobi held"
    MODULE_FIRST = "mean module first held"
    INERTIA = "inertia module first ramp"
    IMPLICIT = "implicit ramp"


# by name
SCHEMES = {scheme.value: scheme for scheme in Scheme}


class _Answer(NamedTuple):
    """Result of a step of the module: mean torque, N.m, energy_in, J, its last speed, rad/s, its acceleration
    with the jump at the beginning, rad/s2.
    """

    torque: float
    energy: float
    speed: float
    acceleration: float

    def with_inertia(self, inertia: float, acceleration: float | None = None) -> LoadTorque:
        """Its torque, less what its own acceleration took of it, plus what the engine's will take."""
        own = self.acceleration if acceleration is None else acceleration
        return LoadTorque(self.torque - inertia * own, inertia)


class CoupledEngine(EnginePlant):
    """An engine in front of a module; seen from outside it is a plant whose omega1 is the speed asked for.

    Args:
        fmu: a started FMU of the module with omega1 = speed of the engine, whose drive is speed and whose
            input_hold is constant; a native one for INERTIA and IMPLICIT.
        engine: at the same speed. scheme: of coupling.
        inertia: interface inertia the engine takes into account (INERTIA), kg.m2; see interface.py.
        substeps: equal communication steps between engine and module in each step of the plant.

    Attributes:
        ledger: sums over the run.

    Raises:
        ValueError: the speeds differ, no inertia for INERTIA, a module driven by torque or with another
            input_hold, or no substeps.
    """

    def __init__(
        self,
        fmu: Fmu,
        engine: Engine,
        scheme: Scheme,
        inertia: float | None = None,
        substeps: int = 1,
    ) -> None:
        super().__init__(fmu, engine, DRIVE_SPEED, substeps)
        if scheme == Scheme.INERTIA and (inertia is None or not inertia > 0.0):
            raise ValueError(f"inertia must be a positive interface inertia, kg.m2, is {inertia}")
        if fmu["input_hold"] != 0.0:
            raise ValueError("input_hold must be constant, is linear: the scheme gives the derivative")
        self.scheme = scheme
        # interface inertia: given, or that an implicit step found last
        self._inertia = inertia if scheme == Scheme.INERTIA and inertia is not None else 0.0
        self._last = _Answer(fmu["input_torque"], fmu["energy_in"], engine.speed, 0.0)
        self._acceleration = 0.0  # of the engine in its last step, mean

    @property
    def energy_stored(self) -> float:
        """Kinetic energy of engine and module together, J."""
        return self.engine.energy_stored + self.fmu["energy_stored"]

    def _exchange(self, h: float) -> Exchange:
        before, last = self.engine.state, self._last
        if self.scheme == Scheme.IMPLICIT:
            after, answer = self._implicit(h)
        else:
            ramped = self.scheme == Scheme.INERTIA
            answer = self._move_module(h, self._acceleration if ramped else None)
            torque = last.torque if self.scheme == Scheme.JACOBI else answer.torque
            load = answer.with_inertia(self._inertia) if ramped else LoadTorque(torque)
            after = self.engine.after(h, load)
        self.engine.state, self._last = after, answer
        self._acceleration = (after.speed - before.speed) / h
        return Exchange(
            h,
            (after.impulse_out - before.impulse_out) / h,
            answer.torque,
            after.work_out - before.work_out,
            answer.energy - last.energy,
        )

    def _move_module(self, h: float, rate: float | None) -> _Answer:
        """Step the module from the engine's speed on, which is held or goes on with a rate."""
        self.fmu.set(omega1=self.engine.speed)
        if rate is not None:
            self.fmu.set_rates(omega1=rate)
        self.fmu.advance(h)
        self.ledger.fmu_steps += 1
        end = self.engine.speed + (rate or 0.0) * h
        torque, energy = self.fmu.read(("input_torque_mean", "energy_in"))
        return _Answer(torque, energy, end, (end - self._last.speed) / h)

    def _implicit(self, h: float) -> tuple[EngineState, _Answer]:
        """Try the step, take it back and make it again."""
        engine, kept = self.engine, self.fmu.get_state()
        try:
            first = engine.after(h, self._last.with_inertia(self._inertia)).speed
            rate = (first - engine.speed) / h
            tried = answer = self._move_module(h, rate)
            (slope,) = self.fmu.jacobian(("input_torque_mean",), ("omega1",))[0]
            self.ledger.derivatives += 1
            least = _LEAST_SLOPE * engine.inertia
            inertia = max(slope * h, least)
            wanted = engine.after(h, tried.with_inertia(inertia, rate)).speed
            if abs(wanted - first) > _AGREEMENT * abs(wanted):
                self.fmu.set_state(kept)
                answer = self._move_module(h, (wanted - engine.speed) / h)
                # the secant is what the next step is tried with
                inertia = max((answer.torque - tried.torque) / (wanted - first) * h, least)
        except FmuError:
            self.fmu.set_state(kept)
            raise
        finally:
            self.fmu.free_state(kept)
        self._inertia = inertia
        return engine.after(h, LoadTorque(answer.torque)), answer
