"""Engine with a rotor, coupled to the FMU of a module by speed or by torque.

The engine is a rotor with inertia, torque limits over speed and a sampled speed governor:

    J_E omega' = tau - T        -drag(omega) <= tau <= greatest(omega)

The governor samples the speed, sets tau and keeps it constant until the next sample. With a constant load T
the speed is linear between samples, so steps of any length are exact, including works and impulses.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

from inertia_module.common.errors import FmuError
from inertia_module.driveline import EngineMap, Governor
from inertia_module.fmi.instance import Fmu
from inertia_module.model import Plant

# a step that ends this close to a sample, relative to the sample time, ends at the sample
_ROUNDING = 1e-9


class EngineState(NamedTuple):
    """State of an engine.

    Attributes:
        speed: Speed, rad/s.
        angle: Angle, rad.
        integral: Integral of the governor, N·m.
        torque: Torque until the next sample, N·m.
        wait: Time to the next sample, s.
        work_in: Work of the engine torque since the start, J.
        work_out: Work on the load since the start, J.
        impulse_out: Impulse on the load since the start, N·m·s.
    """

    speed: float
    angle: float = 0.0
    integral: float = 0.0
    torque: float = 0.0
    wait: float = 0.0
    work_in: float = 0.0
    work_out: float = 0.0
    impulse_out: float = 0.0


class Engine:
    """Engine with governor.

    Args:
        inertia: Inertia of the rotor and all parts that rotate with it, kg·m².
        limits: Torque limits over speed.
        governor: Speed governor.
        reference: Reference speed of the governor, rad/s; can be set at any time.
        speed: Start speed, rad/s.
        torque: Start value of the governor's integral, N·m.

    Attributes:
        state: All quantities that change in a step; can be set to an earlier state.
    """

    def __init__(
        self,
        inertia: float,
        limits: EngineMap,
        governor: Governor,
        reference: float,
        speed: float,
        torque: float = 0.0,
    ) -> None:
        self.inertia, self.limits, self.governor = inertia, limits, governor
        self.reference = reference
        self.state = EngineState(speed, integral=torque)

    @property
    def speed(self) -> float:
        """Return the speed, rad/s."""
        return self.state.speed

    @property
    def energy_stored(self) -> float:
        """Return the kinetic energy, J."""
        return 0.5 * self.inertia * self.state.speed**2

    def after(self, step: float, load: float | None, inertia: float = 0.0) -> EngineState:
        """Return the state after a step under the load T = load + inertia omega'; the engine does not change.

        Args:
            step: Length of the step, s.
            load: Load torque, N·m. None: the speed is constant and all torque is transmitted to the load, for
                an engine whose rotor is simulated elsewhere.
            inertia: Inertia that rotates with the engine, kg·m².
        """
        state, remaining = self.state, step
        sample_time = self.governor.sample_time
        while True:
            if state.wait <= _ROUNDING * sample_time:
                limits = self.limits.limits(state.speed)
                torque, integral = self.governor.sample(state.integral, self.reference, state.speed, limits)
                state = state._replace(torque=torque, integral=integral, wait=state.wait + sample_time)
            # the acceleration is constant until the next sample
            h = min(state.wait, remaining)
            remaining -= h
            mean, end, on_load = state.speed, state.speed, state.torque
            if load is not None:
                acceleration = (state.torque - load) / (self.inertia + inertia)
                mean, end = state.speed + 0.5 * h * acceleration, state.speed + h * acceleration
                on_load = state.torque - self.inertia * acceleration
            rotation = h * mean
            state = state._replace(
                speed=end,
                angle=state.angle + rotation,
                wait=state.wait - h,
                work_in=state.work_in + state.torque * rotation,
                work_out=state.work_out + on_load * rotation,
                impulse_out=state.impulse_out + h * on_load,
            )
            if remaining <= _ROUNDING * min(sample_time, step):
                return state


# --- in front of a module ---

# outputs of a torque-driven module that the engine uses
_OUTPUTS = ("input_speed", "input_angle", "input_turns", "energy_in")


@dataclass
class Ledger:
    """Sums over a run.

    Attributes:
        time: Simulated time, s.
        steps: Number of communication steps.
        fmu_steps: Number of steps of the FMU, including repeated steps.
        derivatives: Number of directional derivatives.
        defect: Energy lost at the coupling, J: work of the engine minus work on the module. Each side is
            exact for its inputs.
        defect_magnitude: Sum of |defect| over the steps, J.
    """

    time: float = 0.0
    steps: int = 0
    fmu_steps: int = 0
    derivatives: int = 0
    defect: float = 0.0
    defect_magnitude: float = 0.0

    @property
    def cost(self) -> int:
        """Return the cost in steps of the FMU; a directional derivative costs two steps."""
        return self.fmu_steps + 2 * self.derivatives


class EnginePlant(Plant):
    """Engine and module as a plant; its input omega1 is the reference speed of the governor.

    Args:
        fmu: Started FMU of the module, whose omega1 is the engine speed.
        engine: The engine.
        substeps: Number of communication steps between engine and module in each step of the plant.

    Attributes:
        ledger: Sums over the run.
    """

    def __init__(self, fmu: Fmu, engine: Engine, substeps: int) -> None:
        self.fmu, self.engine, self.substeps = fmu, engine, substeps
        self.ledger = Ledger()

    @property
    def energy_stored(self) -> float:
        """Return the kinetic energy of engine and module, J."""
        return self.fmu["energy_stored"]

    @abstractmethod
    def _exchange(self, h: float) -> tuple[float, float]:
        """Advance engine and module; after an error both are at the start of the step.

        Args:
            h: Length of the step, s.

        Returns:
            Work of the engine and work on the module, J.
        """

    def set(self, **values: float) -> None:
        """Set inputs of the FMU; omega1 is the reference speed of the governor.

        Args:
            values: Values by name.
        """
        if "omega1" in values:
            self.engine.reference = values.pop("omega1")
        self.fmu.set(**values)

    def advance(self, step: float) -> None:
        """Advance engine and module in substeps; after an error both are at the start of the failed substep.

        Args:
            step: Length of the step, s.
        """
        h, ledger = step / self.substeps, self.ledger
        for _ in range(self.substeps):
            work, module_work = self._exchange(h)
            ledger.time += h
            ledger.steps += 1
            ledger.defect += work - module_work
            ledger.defect_magnitude += abs(work - module_work)

    def read(self, names: Sequence[str]) -> tuple[float, ...]:
        """Return values of the FMU or of the engine.

        Values of the engine are engine_speed, engine_torque, engine_angle, engine_work_in, engine_work_out,
        engine_energy and bond_defect, in SI units.

        Args:
            names: Names of the values.
        """
        state = self.engine.state
        engine_values = {
            "engine_speed": state.speed,
            "engine_torque": state.torque,
            "engine_angle": state.angle,
            "engine_work_in": state.work_in,
            "engine_work_out": state.work_out,
            "engine_energy": self.engine.energy_stored,
            "bond_defect": self.ledger.defect,
        }
        others = iter(self.fmu.read([name for name in names if name not in engine_values]))
        return tuple(engine_values[name] if name in engine_values else next(others) for name in names)


class Scheme(StrEnum):
    """Coupling scheme: order of the two sides, and correction of the step.

    JACOBI: Both sides use values of the communication point; the module steps at constant speed.
    MODULE_FIRST: The engine uses the torque of the same step; the module steps at constant speed.
    INERTIA: The module steps first with an extrapolated speed. The engine accounts for the interface inertia,
        the change of the torque due to its own acceleration.
    IMPLICIT: The step is tried, restored and repeated with the engine speed that follows from the module's
        directional derivative.
    """

    JACOBI = "mean jacobi held"
    MODULE_FIRST = "mean module first held"
    INERTIA = "inertia module first ramp"
    IMPLICIT = "implicit ramp"


# schemes by name
SCHEMES = {scheme.value: scheme for scheme in Scheme}


class _ModuleStep(NamedTuple):
    """Results of a step of the module.

    Attributes:
        torque: Mean input torque, N·m.
        energy: energy_in, J.
        speed: Speed at the end of the step, rad/s.
        acceleration: Mean acceleration, including a jump of the speed, rad/s².
    """

    torque: float
    energy: float
    speed: float
    acceleration: float

    def load(self, inertia: float) -> tuple[float, float]:
        """Return load, N·m, and inertia, kg·m², on the engine; its acceleration replaces the module's.

        Args:
            inertia: Interface inertia, kg·m².
        """
        return self.torque - inertia * self.acceleration, inertia


class CoupledEngine(EnginePlant):
    """Engine with a rotor: the module receives its speed and returns the mean torque of a step.

    A difference between the speeds of engine and module at a communication point is removed by a jump at the
    start of the module's next step. The mean torque of this step includes the impulse.

    Args:
        fmu: Started FMU with speed drive and zero-order input hold; a native FMU for INERTIA and IMPLICIT.
        engine: The engine.
        scheme: Coupling scheme.
        inertia: Interface inertia for scheme INERTIA, kg·m² (see interface_inertia).
        substeps: Number of communication steps in each step of the plant.
    """

    def __init__(
        self, fmu: Fmu, engine: Engine, scheme: Scheme, inertia: float | None = None, substeps: int = 1
    ) -> None:
        super().__init__(fmu, engine, substeps)
        self.scheme = scheme
        # interface inertia: constant, or from the last implicit step
        self._inertia = inertia if scheme == Scheme.INERTIA and inertia else 0.0
        self._last = _ModuleStep(fmu["input_torque"], fmu["energy_in"], engine.speed, 0.0)
        self._acceleration = 0.0  # mean acceleration of the engine in its last step, rad/s²

    @property
    def energy_stored(self) -> float:
        """Return the kinetic energy of engine and module, J."""
        return self.engine.energy_stored + super().energy_stored

    def _exchange(self, h: float) -> tuple[float, float]:
        before, last = self.engine.state, self._last
        if self.scheme == Scheme.IMPLICIT:
            after, result = self._implicit(h)
        else:
            ramped = self.scheme == Scheme.INERTIA
            result = self._move_module(h, self._acceleration if ramped else None)
            load_source = last if self.scheme == Scheme.JACOBI else result
            after = self.engine.after(h, *load_source.load(self._inertia))
        self.engine.state, self._last = after, result
        self._acceleration = (after.speed - before.speed) / h
        return after.work_out - before.work_out, result.energy - last.energy

    def _move_module(self, h: float, rate: float | None) -> _ModuleStep:
        """Step the module from the engine speed, which is constant or changes at a rate, rad/s²."""
        self.fmu.set(omega1=self.engine.speed)
        if rate is not None:
            self.fmu.set_rates(omega1=rate)
        self.fmu.advance(h)
        self.ledger.fmu_steps += 1
        end = self.engine.speed + (rate or 0.0) * h
        torque, energy = self.fmu.read(("input_torque_mean", "energy_in"))
        return _ModuleStep(torque, energy, end, (end - self._last.speed) / h)

    def _implicit(self, h: float) -> tuple[EngineState, _ModuleStep]:
        """Try the step, restore the state, and repeat the step with the corrected speed."""
        engine, saved_state = self.engine, self.fmu.get_state()
        try:
            predicted = engine.after(h, *self._last.load(self._inertia)).speed
            rate = (predicted - engine.speed) / h
            trial = result = self._move_module(h, rate)
            (slope,) = self.fmu.jacobian(("input_torque_mean",), ("omega1",))[0]
            self.ledger.derivatives += 1
            # lower bound, because a directional derivative can be negative
            min_inertia = -0.5 * engine.inertia
            inertia = max(slope * h, min_inertia)
            speed = engine.after(h, trial.torque - inertia * rate, inertia).speed
            # repeat only if the speed changes
            if abs(speed - predicted) > 1e-11 * abs(speed):
                self.fmu.set_state(saved_state)
                result = self._move_module(h, (speed - engine.speed) / h)
                # the next step starts with the secant
                inertia = max((result.torque - trial.torque) / (speed - predicted) * h, min_inertia)
        except FmuError:
            self.fmu.set_state(saved_state)
            raise
        self._inertia = inertia
        return engine.after(h, result.torque), result


class TorqueDrivenEngine(EnginePlant):
    """Engine whose rotor is part of the module: the module receives its torque and returns the speed.

    In a step longer than the sample time, the governor uses the speed at the start of the step for all
    samples in it, and the module receives the mean torque. No energy is lost.

    engine_work_out is the whole work of the torque, because the rotor belongs to the module. engine_energy,
    the energy of the rotor, is part of energy_stored of the FMU.

    Args:
        fmu: Started FMU whose input_inertia includes the inertia of the engine (see torque_driven).
        engine: The engine.
        substeps: Number of communication steps in each step of the plant.
    """

    def __init__(self, fmu: Fmu, engine: Engine, substeps: int = 1) -> None:
        super().__init__(fmu, engine, substeps)
        self._last = fmu.read(_OUTPUTS)

    def _exchange(self, h: float) -> tuple[float, float]:
        before, after = self.engine.state, self.engine.after(h, None)
        torque = (after.impulse_out - before.impulse_out) / h
        self.fmu.set(drive_torque=torque)
        self.fmu.advance(h)
        self.ledger.fmu_steps += 1
        speed, angle, turns, energy = outputs = self.fmu.read(_OUTPUTS)
        _, last_angle, last_turns, last_energy = self._last
        rotation = (angle - last_angle) + 2.0 * math.pi * (turns - last_turns)
        work = torque * rotation
        self._last = outputs
        self.engine.state = after._replace(
            speed=speed,
            angle=before.angle + rotation,
            work_in=before.work_in + work,
            work_out=before.work_out + work,
        )
        return work, energy - last_energy
