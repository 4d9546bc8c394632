"""An engine with a rotor of its own, coupled to the FMU of a module by speed and by torque.

The engine is a rotor with inertia, limits of torque over speed, and a sampled speed governor:

    J_E omega' = tau - T        -drag(omega) <= tau <= greatest(omega)

The governor samples the speed, sets tau and holds it until the next sample. So between samples omega is
linear under a constant load T, and a step of any length is exact, works and impulses included.
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

# of a sample time: the end of a step this close to a sample is at the sample
_ROUNDING = 1e-9


class EngineState(NamedTuple):
    """State of an engine.

    Attributes:
        speed: rad/s. angle: rad. integral: of the governor, N.m. torque: held until the next sample, N.m.
        wait: time to the next sample, s. work_in: of the torque of the engine since the start, J.
        work_out: done on the load, J. impulse_out: of the load, N.m.s.
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
    """An engine with governor.

    Args:
        inertia: of rotor and all that turns with it, kg.m2. limits: of the torque. governor: of the speed.
        reference: speed the governor is asked for, rad/s; may be set at any time.
        speed: at the start, rad/s. torque: held by the governor's integral at the start, N.m.

    Attributes:
        state: all that changes in a step; may be set to an old one.
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
        """Speed now, rad/s."""
        return self.state.speed

    @property
    def energy_stored(self) -> float:
        """Kinetic energy, J."""
        return 0.5 * self.inertia * self.state.speed**2

    def after(self, step: float, load: float | None, inertia: float = 0.0) -> EngineState:
        """The state after a step, s, of any length under T = load + inertia omega'; the engine stays.

        Args:
            step: s.
            load: N.m. None: its speed stays as it is and all torque goes on to the load, as with an engine
                whose rotor is simulated elsewhere: it knows its speed at the beginning of a step only.
            inertia: that turns with the engine, kg.m2.
        """
        state, left = self.state, step
        sample_time = self.governor.sample_time
        while True:
            if state.wait <= _ROUNDING * sample_time:
                limits = self.limits.limits(state.speed)
                torque, integral = self.governor.sample(state.integral, self.reference, state.speed, limits)
                state = state._replace(torque=torque, integral=integral, wait=state.wait + sample_time)
            # to the next sample the acceleration is constant
            h = min(state.wait, left)
            left -= h
            mean, end, on_load = state.speed, state.speed, state.torque
            if load is not None:
                acceleration = (state.torque - load) / (self.inertia + inertia)
                mean, end = state.speed + 0.5 * h * acceleration, state.speed + h * acceleration
                on_load = state.torque - self.inertia * acceleration
            turned = h * mean
            state = state._replace(
                speed=end,
                angle=state.angle + turned,
                wait=state.wait - h,
                work_in=state.work_in + state.torque * turned,
                work_out=state.work_out + on_load * turned,
                impulse_out=state.impulse_out + h * on_load,
            )
            if left <= _ROUNDING * min(sample_time, step):
                return state


# --- in front of a module ---

# variables of a module driven by torque that the engine goes on with
_ANSWERS = ("input_speed", "input_angle", "input_turns", "energy_in")


@dataclass
class Ledger:
    """Sums over a run.

    Attributes:
        time: s. steps: communication steps. fmu_steps: steps of the FMU, those taken back included.
        derivatives: directional derivatives asked for.
        defect: energy lost between both, J: work of the engine less work on the module; each side is exact
            for what it was given. defect_magnitude: sum of |defect| of the steps, J.
    """

    time: float = 0.0
    steps: int = 0
    fmu_steps: int = 0
    derivatives: int = 0
    defect: float = 0.0
    defect_magnitude: float = 0.0

    @property
    def cost(self) -> int:
        """Cost in steps of the FMU; a directional derivative takes two, those of outputs are not counted."""
        return self.fmu_steps + 2 * self.derivatives


class EnginePlant(Plant):
    """An engine in front of a module: a plant whose omega1 is the speed the governor is asked for.

    Args:
        fmu: a started FMU of the module with omega1 = speed of the engine.
        engine: in front of it.
        substeps: equal communication steps between engine and module in each step of the plant.

    Attributes:
        ledger: sums over the run.
    """

    def __init__(self, fmu: Fmu, engine: Engine, substeps: int) -> None:
        self.fmu, self.engine, self.substeps = fmu, engine, substeps
        self.ledger = Ledger()

    @property
    def energy_stored(self) -> float:
        """Kinetic energy of engine and module together, J."""
        return self.fmu["energy_stored"]

    @abstractmethod
    def _exchange(self, h: float) -> tuple[float, float]:
        """Advance both by a step, s: work of the engine and on the module, J; neither moves on an error."""

    def set(self, **values: float) -> None:
        """Set inputs of the FMU by name; omega1 is the speed the governor is asked for."""
        if "omega1" in values:
            self.engine.reference = values.pop("omega1")
        self.fmu.set(**values)

    def advance(self, step: float) -> None:
        """Advance engine and module by a step, s, in substeps; both are before one that the FMU refuses."""
        h, ledger = step / self.substeps, self.ledger
        for _ in range(self.substeps):
            given, got = self._exchange(h)
            ledger.time += h
            ledger.steps += 1
            ledger.defect += given - got
            ledger.defect_magnitude += abs(given - got)

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


class Scheme(StrEnum):
    """Coupling scheme: order of the two sides, and correction of the step.

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
    """Mean torque of a step, N.m, energy_in, J, last speed, rad/s, acceleration with its jump, rad/s2."""

    torque: float
    energy: float
    speed: float
    acceleration: float

    def load(self, inertia: float) -> tuple[float, float]:
        """Load and inertia on the engine: with its acceleration in place of the module's own."""
        return self.torque - inertia * self.acceleration, inertia


class CoupledEngine(EnginePlant):
    """An engine with a rotor of its own: its speed goes to the module, the mean torque of a step comes back.

    What is left between the speeds of engine and module at a communication point is made up for by a jump at
    the beginning of the module's next step, whose impulse is in the next step mean.

    Args:
        fmu: at its start; drive is speed and input_hold zero_order; a native one for INERTIA and IMPLICIT.
        engine: as of EnginePlant. substeps: likewise. scheme: of coupling.
        inertia: interface inertia the engine takes into account (INERTIA), kg.m2; see interface_inertia.
    """

    def __init__(
        self, fmu: Fmu, engine: Engine, scheme: Scheme, inertia: float | None = None, substeps: int = 1
    ) -> None:
        super().__init__(fmu, engine, substeps)
        self.scheme = scheme
        # interface inertia: given, or that an implicit step found last
        self._inertia = inertia if scheme == Scheme.INERTIA and inertia else 0.0
        self._last = _Answer(fmu["input_torque"], fmu["energy_in"], engine.speed, 0.0)
        self._acceleration = 0.0  # of the engine in its last step, mean

    @property
    def energy_stored(self) -> float:
        """Kinetic energy of engine and module together, J."""
        return self.engine.energy_stored + super().energy_stored

    def _exchange(self, h: float) -> tuple[float, float]:
        before, last = self.engine.state, self._last
        if self.scheme == Scheme.IMPLICIT:
            after, answer = self._implicit(h)
        else:
            ramped = self.scheme == Scheme.INERTIA
            answer = self._move_module(h, self._acceleration if ramped else None)
            known = last if self.scheme == Scheme.JACOBI else answer
            after = self.engine.after(h, *known.load(self._inertia))
        self.engine.state, self._last = after, answer
        self._acceleration = (after.speed - before.speed) / h
        return after.work_out - before.work_out, answer.energy - last.energy

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
            first = engine.after(h, *self._last.load(self._inertia)).speed
            rate = (first - engine.speed) / h
            tried = answer = self._move_module(h, rate)
            (slope,) = self.fmu.jacobian(("input_torque_mean",), ("omega1",))[0]
            self.ledger.derivatives += 1
            # what a directional derivative may give
            least = -0.5 * engine.inertia
            inertia = max(slope * h, least)
            wanted = engine.after(h, tried.torque - inertia * rate, inertia).speed
            # else there is no need to make it again
            if abs(wanted - first) > 1e-11 * abs(wanted):
                self.fmu.set_state(kept)
                answer = self._move_module(h, (wanted - engine.speed) / h)
                # the secant is what the next step is tried with
                inertia = max((answer.torque - tried.torque) / (wanted - first) * h, least)
        except FmuError:
            self.fmu.set_state(kept)
            raise
        self._inertia = inertia
        return engine.after(h, answer.torque), answer


class TorqueDrivenEngine(EnginePlant):
    """An engine whose torque goes to the module, which carries its rotor and gives the speed back.

    In a step longer than a sample time the governor takes the samples that are due with the speed at its
    beginning, and the module gets the mean of the torques: no energy is lost by that.

    Args:
        fmu: at its start; the inertia of the engine is in its input_inertia (see torque_driven). Of the
            readings, engine_work_out is all that the torque has done (the rotor takes none of it), and
            engine_energy, the rotor's, is a part of energy_stored of the FMU.
        engine: as of EnginePlant. substeps: likewise.
    """

    def __init__(self, fmu: Fmu, engine: Engine, substeps: int = 1) -> None:
        super().__init__(fmu, engine, substeps)
        self._last = fmu.read(_ANSWERS)

    def _exchange(self, h: float) -> tuple[float, float]:
        before, after = self.engine.state, self.engine.after(h, None)
        torque = (after.impulse_out - before.impulse_out) / h
        self.fmu.set(drive_torque=torque)
        self.fmu.advance(h)
        self.ledger.fmu_steps += 1
        speed, angle, turns, energy = answers = self.fmu.read(_ANSWERS)
        _, last_angle, last_turns, last_energy = self._last
        turned = (angle - last_angle) + 2.0 * math.pi * (turns - last_turns)
        work = torque * turned
        self._last = answers
        self.engine.state = after._replace(
            speed=speed,
            angle=before.angle + turned,
            work_in=before.work_in + work,
            work_out=before.work_out + work,
        )
        return work, energy - last_energy
