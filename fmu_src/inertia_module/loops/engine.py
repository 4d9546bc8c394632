"""An engine or motor, alone and in front of a module.

The engine is a rotor with inertia, limits of torque over speed, and a sampled speed governor:

    J_E omega' = tau - T        -drag(omega) <= tau <= greatest(omega)

The governor samples the speed, sets tau and holds it until the next sample. So between samples omega is
linear under a constant load T, and a step of any length is exact, works and impulses included.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

import numpy as np

from ..harness.fmu import Fmu, FmuError
from ..kernel.codes import DRIVE_SPEED, DRIVE_TORQUE
from ..kernel.links import inertia_at_input
from ..memory import Module, Plant
from .sources import Table, between

__all__ = [
    "SCHEMES",
    "CoupledEngine",
    "Engine",
    "EngineMap",
    "EnginePlant",
    "EngineState",
    "Governor",
    "InterfaceInertia",
    "Ledger",
    "Scheme",
    "TorqueDrivenEngine",
    "interface_inertia",
    "torque_driven",
]

# --- the engine ---

# of a sample time: the end of a step this close to a sample is at the sample
_ROUNDING = 1e-9


def _positive(name: str, value: float, unit: str) -> None:
    if not (math.isfinite(value) and value > 0.0):
        raise ValueError(f"{name} must be a positive number of {unit}, is {value}")


@dataclass(frozen=True)
class EngineMap:
    """Limits of the torque over the speed, linear between breakpoints, constant beyond them.

    Attributes:
        speed: breakpoints, rad/s, rising. greatest: torque at full load, N.m, at each of them, from 0.
        drag: torque against the motion without fuel, N.m, from 0.

    Raises:
        ValueError: breakpoints that do not rise, or torques negative or not one for each.
    """

    speed: tuple[float, ...]
    greatest: tuple[float, ...]
    drag: tuple[float, ...]

    def __post_init__(self) -> None:
        for name, torques in (("greatest", self.greatest), ("drag", self.drag)):
            try:
                Table(self.speed, torques)
            except ValueError as error:
                raise ValueError(f"speed and {name}: {error}") from None
            if min(torques) < 0.0:
                raise ValueError(f"{name} must be torques from 0 N.m, has {min(torques)}")

    def limits(self, speed: float) -> tuple[float, float]:
        """Least and greatest torque at a speed, N.m. The drag acts on a turning engine only."""
        drag = between(self.speed, self.drag, speed) if speed > 0.0 else 0.0
        return -drag, between(self.speed, self.greatest, speed)


@dataclass(frozen=True)
class Governor:
    """PI speed governor, sampled, with anti-windup by back-calculation against the limits of the moment.

    Where the torque is cut off, the integral is led back with the time constant of the governor,
    proportional_gain / integral_gain, but not faster than the sample time.
    Source: Åström and Murray, Feedback Systems (2nd edition 2021), section 11.4.

    Attributes:
        proportional_gain: N.m per rad/s. integral_gain: N.m per rad. sample_time: s.

    Raises:
        ValueError: a gain is negative or not finite, or the sample time is not positive.
    """

    proportional_gain: float
    integral_gain: float
    sample_time: float = 0.005

    def __post_init__(self) -> None:
        _positive("sample_time", self.sample_time, "seconds")
        for name in ("proportional_gain", "integral_gain"):
            gain = getattr(self, name)
            if not (math.isfinite(gain) and gain >= 0.0):
                raise ValueError(f"{name} must be a finite number from 0, is {gain}")

    def sample(
        self,
        integral: float,
        reference: float,
        speed: float,
        limits: tuple[float, float],
        feedforward: float = 0.0,
    ) -> tuple[float, float]:
        """Compute one sample of the governor.

        Args:
            integral: N.m. reference, speed: rad/s. limits: least and greatest torque, N.m.
            feedforward: torque besides that of the error, N.m.

        Returns:
            (torque, integral for the next sample), N.m.
        """
        error = reference - speed
        wanted = feedforward + self.proportional_gain * error + integral
        torque = min(max(wanted, limits[0]), limits[1])
        grown = integral + self.sample_time * self.integral_gain * error
        if self.integral_gain > 0.0:
            tracking = max(self.sample_time, self.proportional_gain / self.integral_gain)
            grown -= self.sample_time / tracking * (wanted - torque)
        return torque, grown


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
        _positive("inertia", inertia, "kg.m2")
        for name, value in (("reference", reference), ("speed", speed), ("torque", torque)):
            if not math.isfinite(value):
                raise ValueError(f"{name} must be a finite number, is {value}")
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

        Raises:
            ValueError: the step is not positive.
        """
        _positive("step", step, "seconds")
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
        engine: in front of it. drive: what the module has to be driven by.
        substeps: equal communication steps between engine and module in each step of the plant.

    Attributes:
        ledger: sums over the run.

    Raises:
        ValueError: no substeps, another drive, or speeds that differ.
    """

    def __init__(self, fmu: Fmu, engine: Engine, drive: int, substeps: int) -> None:
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
    def energy_stored(self) -> float:
        """Kinetic energy of engine and module together, J."""
        return self.fmu["energy_stored"]

    @abstractmethod
    def _exchange(self, h: float) -> tuple[float, float]:
        """Advance both by a step, s: work of the engine and on the module, J; neither moves on an error."""

    def set(self, **values: float) -> None:
        """Set inputs of the FMU by name; omega1 is the speed the governor is asked for.

        Raises:
            ValueError: drive_torque, which the engine gives.
        """
        if "drive_torque" in values:
            raise ValueError(
                f"drive_torque = {values['drive_torque']:g} N.m cannot be set, the engine gives it;"
                " set omega1, the speed its governor is asked for"
            )
        if "omega1" in values:
            self.engine.reference = values.pop("omega1")
        self.fmu.set(**values)

    def advance(self, step: float) -> None:
        """Advance engine and module by a step, s, in substeps.

        Raises:
            FmuError: the FMU refused a substep; both are where they were before it, and a good one goes on.
        """
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


class InterfaceInertia(NamedTuple):
    """Interface inertia over the angle of the drive, kg.m2."""

    least: float
    mean: float
    greatest: float

    @property
    def middle(self) -> float:
        """Mean of the least and the greatest, kg.m2."""
        return 0.5 * (self.least + self.greatest)


def interface_inertia(parameters: Mapping[str, float]) -> InterfaceInertia:
    """The interface inertia of a module: what its input shaft feels when its speed changes suddenly.

    With link 2 held, omega1 turns everything: Phi = J1 + I + 2 k B + k^2 G. Where link 2 is free to follow,
    or drives the shaft, less of it answers a jump: Phi - k^2 (B + k G)^2 / (J + k^2 G), with J = J2 or
    J2 + J3. So Phi is the most an engine can meet.

    Args:
        parameters: those that differ from the defaults.

    Raises:
        Refused: the module refuses the parameters.
    """
    module = Module("plain")
    module.check(**{**parameters, "fidelity": 2.0})
    turns = int(module.derived.period_turns)
    angles = np.linspace(0.0, 2.0 * math.pi * turns, 180 * turns, endpoint=False)
    values = [float(inertia_at_input(module.derived, float(q))) for q in angles]  # type: ignore[no-untyped-call]
    return InterfaceInertia(min(values), sum(values) / len(values), max(values))


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
        fmu: at its start; drive is speed and input_hold constant; a native one for INERTIA and IMPLICIT.
        engine: as of EnginePlant. substeps: likewise. scheme: of coupling.
        inertia: interface inertia the engine takes into account (INERTIA), kg.m2; see interface_inertia.

    Raises:
        ValueError: as EnginePlant, no inertia for INERTIA, or another input_hold.
    """

    def __init__(
        self, fmu: Fmu, engine: Engine, scheme: Scheme, inertia: float | None = None, substeps: int = 1
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


def torque_driven(parameters: Mapping[str, float], inertia: float) -> dict[str, float]:
    """Parameters of a module that is driven by torque and carries the rotor of its engine.

    Args:
        parameters: of the module, those that differ from the defaults. inertia: of the engine, kg.m2.
    """
    own = parameters.get("input_inertia", 0.0)
    return {**parameters, "drive": float(DRIVE_TORQUE), "input_inertia": own + inertia}


class TorqueDrivenEngine(EnginePlant):
    """An engine whose torque goes to the module, which carries its rotor and gives the speed back.

    Left of the engine are its map and its sampled governor, which see input_speed at communication points.
    Between two samples the torque is constant, so with steps that end at every sample the two do exactly what
    one piece would do, whatever the inertia. In a longer step the governor takes the samples that are due
    with the speed at its beginning, and the module gets the mean of the torques: no energy is lost by that.

    Args:
        fmu: at its start; the inertia of the engine is in its input_inertia (see torque_driven). Of the
            readings, engine_work_out is all that the torque has done (the rotor takes none of it), and
            engine_energy, the rotor's, is a part of energy_stored of the FMU.
        engine: as of EnginePlant. substeps: likewise.

    Raises:
        ValueError: as EnginePlant, or a module that cannot carry the rotor.
    """

    def __init__(self, fmu: Fmu, engine: Engine, substeps: int = 1) -> None:
        super().__init__(fmu, engine, DRIVE_TORQUE, substeps)
        inertia = fmu["input_inertia"]
        if inertia < engine.inertia * (1.0 - 1e-9):
            raise ValueError(
                f"input_inertia of the FMU must be at least {engine.inertia:g} kg.m2, for it carries the"
                f" engine's rotor too, is {inertia:g}"
            )
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
