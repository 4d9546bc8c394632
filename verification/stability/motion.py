"""Motions of a module: parameters, inputs over time, the run, and the comparison of two runs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Self

from pydantic import TypeAdapter

from inertia_module.common.errors import InertiaModuleError
from inertia_module.fidelity.levels import Level
from inertia_module.interface.variables import BY_NAME, LARGEST_STEP, LOSSES
from inertia_module.kernel.codes import AVERAGED, ELASTIC, KINEMATIC, RIGID
from inertia_module.kernel.equations.motion import evaluate
from inertia_module.kernel.equations.states import LOCKED, OVERRUNNING, is_mode_admissible
from inertia_module.kernel.links import response
from inertia_module.model import Module

from ..reference.geometry import shaft_frequency

ELASTIC_LEVELS = (Level(ELASTIC),)
LEVELS = (Level(KINEMATIC), Level(AVERAGED), Level(RIGID), *ELASTIC_LEVELS)
# compared at the end of a run
SPEEDS = ("omega2", "omega_out")
START_SPEEDS = ("omega2_start", "omega_out_start")
ENERGIES = ("energy_in", "energy_out")
IMPULSES = ("input_torque_mean", "output_torque_mean")
# the maximum of these torques is the torque scale of a run
TORQUES = ("load_torque", "input_torque", "mesh_torque", "output_torque", "housing_torque")
# losses that never decrease; the loss of the shaft includes the work of the balancer
LOST = tuple(name for name in LOSSES if name != "energy_lost_shaft")
# Conditions that hold except for round-off. SPEED applies to freewheels without wind-up and engagement angle,
# TORQUE and POWER to the sum of torque and drag.
SPEED, TORQUE, POWER, REGAINED = CONDITIONS = (
    "0 <= omega2 <= omega3",
    "Th, Tc >= 0",
    "torque or slip is 0",
    "lost energy regained",
)

Parameters = dict[str, int | float]
Make = Callable[[], Module]


@dataclass(frozen=True)
class Metric:
    """A measured value with its bound.

    Attributes:
        value: measured value.
        bound: maximum value allowed.
        is_explained: True if the sensitivity of the motion explains a value above the plain bound.
    """

    value: float
    bound: float
    is_explained: bool = False

    @property
    def holds(self) -> bool:
        """True if the value is within the bound; False for NaN."""
        return self.value <= self.bound


Metrics = dict[str, Metric]


def violations(metrics: Metrics) -> dict[str, str]:
    """Describe the metrics that exceed their bounds, by name.

    Args:
        metrics: metrics by name.
    """
    return {
        name: f"{name} {metric.value:.0e}, bound {metric.bound:.0e}"
        for name, metric in metrics.items()
        if not metric.holds
    }


@dataclass(frozen=True)
class Segment:
    """A time interval with constant inputs, except for a constant slope of the input speed.

    Attributes:
        duration: length, s.
        omega1: input speed at the beginning, rad/s.
        load: load torque, N.m.
        slope: input acceleration, rad/s^2.
        drive: torque on link 1 if the module is torque-driven, N.m.
        steps: minimum number of communication steps; a step is at most 1e6 s long.
        is_whole: True if the run with short steps keeps the steps of this segment.
    """

    duration: float
    omega1: float
    load: float
    slope: float = 0.0
    drive: float = 0.0
    steps: int = 1
    is_whole: bool = False

    @property
    def max_speed(self) -> float:
        """Maximum prescribed speed of link 1, rad/s."""
        return max(abs(self.omega1), abs(self.omega1 + self.slope * self.duration))

    def scaled(self, speed: float = 1.0, torque: float = 1.0, time: float = 1.0) -> Segment:
        """Return the segment with scaled inputs.

        Args:
            speed: factor of the speeds.
            torque: factor of the torques.
            time: factor of the duration.
        """
        return replace(
            self,
            duration=self.duration * time,
            omega1=self.omega1 * speed,
            load=self.load * torque,
            slope=self.slope * (speed / time),
            drive=self.drive * torque,
        )


@dataclass(frozen=True)
class Motion:
    """A module and its inputs over time.

    Attributes:
        parameters: parameters that differ from the defaults, by name.
        segments: inputs; each segment is one communication step, or several.
        turns: whole revolutions on the counters of pinion shaft and link 1 at the start.
    """

    parameters: Parameters
    segments: tuple[Segment, ...]
    turns: float = 0.0

    @classmethod
    def of(cls, values: dict[str, Any]) -> Self:
        """Return the motion of a dictionary.

        Args:
            values: result of as_dict.
        """
        return TypeAdapter(cls).validate_python(values)

    def as_dict(self) -> dict[str, Any]:
        """Return plain numbers by name, without the defaults, for printing and pasting."""
        plain: dict[str, Any] = TypeAdapter(Motion).dump_python(self, mode="json", exclude_defaults=True)
        return plain

    def __getitem__(self, name: str) -> float:
        """Return the value of a parameter.

        Args:
            name: name of the parameter.
        """
        return float(self.parameters.get(name, BY_NAME[name].start or 0.0))

    @property
    def level(self) -> Level:
        """Fidelity level."""
        return Level(int(self["fidelity"]))

    def changed(self, **parameters: float) -> Motion:
        """Return the motion with other parameters.

        Args:
            parameters: new values by name.
        """
        return replace(self, parameters=self.parameters | parameters)

    def perturbed(self, change: float) -> list[Motion]:
        """Return six motions: start angle, load, or input and start speeds changed in both directions.

        Args:
            change: change of the angle in rad, relative change of load and speeds.
        """
        motions = []
        for signed_change in (change, -change):
            start = self.parameters.get("drive_angle_start", 0.0) + signed_change
            loads = tuple(segment.scaled(torque=1.0 + signed_change) for segment in self.segments)
            speeds = tuple(segment.scaled(speed=1.0 + signed_change) for segment in self.segments)
            starts = {name: self[name] * (1.0 + signed_change) for name in START_SPEEDS if self[name]}
            rotated = self.changed(drive_angle_start=start)
            faster = replace(self.changed(**starts), segments=speeds)
            motions += [rotated, replace(self, segments=loads), faster]
        return motions

    def started(self, module: Module) -> Module:
        """Start a module with the parameters and the inputs of the first segment.

        Args:
            module: a new module.
        """
        first = self.segments[0]
        module.start(**self.parameters, omega1=first.omega1, load_torque=first.load, drive_torque=first.drive)
        if self.turns:
            module.state.drive_turns += self.turns
            module.state.input_turns += self.turns
        return module


def solve_at(module: Module, held: bool, driving: bool, load: float = 0.0, **motion: float) -> Any:
    """Solve the kernel's equations of motion at an instant and return its record of the mechanism.

    Args:
        module: a started module of the plain kernel, without losses; its state contains the input.
        held: True if the housing freewheel is locked.
        driving: True if the output freewheel is locked.
        load: load torque, N.m.
        motion: q in rad; omega1, omega2 and omega3 in rad/s.
    """
    x, machine = module.state, module.derived.machine
    x.housing_state, x.output_state = (LOCKED if locked else OVERRUNNING for locked in (held, driving))
    for name, value in motion.items():
        setattr(machine, name, value)
    prescribed = x.drive_torque if module.derived.by_torque else x.alpha1
    evaluate(module.derived, x, prescribed, load, False)
    return machine


def imbalance_inertia(derived: Any) -> float:
    """Return the maximum inertia of the unbalanced masses at link 2, k^2 G, in kg m^2.

    Args:
        derived: constants of a module.
    """
    radius = derived.pole_offset + 2.0 * derived.pole_arm
    return float(derived.mass * derived.k**2 * (radius * radius + derived.spin_square))


@dataclass
class Run:
    """Results of a run; maxima refer to the communication points.

    Attributes:
        end: speeds, energies, pinion-shaft angle and impulses at the end.
        points: all values at the start and after each segment.
        state: bytes of state and outputs at the end.
        is_finite: True if every output is finite at every communication point.
        residual: maximum energy residual, J.
        energy: maximum of input, output and stored energy, and of the kinetic energy that the unbalanced
            masses can have at these speeds, J.
        speed: maximum speed, rad/s.
        torque: maximum torque, N.m.
        breaches: maximum violation of each of CONDITIONS, in rad/s, N.m, W and J.
        lost: lost energy by cause without the loss of the shaft, J.
        phase: phase of the pulses and of an elastic shaft, rad.
        evaluations: number of right-hand-side evaluations.
        steps: number of communication steps.
        link2: inertia of link 2, kg m^2.
        rejection: message of the rejection that ended the run, or "".
        fault: a fault of the module, such as a rejected step that changed the state, or "".
    """

    end: dict[str, float] = field(default_factory=dict)
    points: list[dict[str, float]] = field(default_factory=list)
    state: bytes = b""
    is_finite: bool = True
    residual: float = 0.0
    energy: float = 0.0
    speed: float = 0.0
    torque: float = 0.0
    breaches: dict[str, float] = field(default_factory=lambda: dict.fromkeys(CONDITIONS, 0.0))
    lost: dict[str, float] = field(default_factory=dict)
    phase: float = 0.0
    evaluations: float = 0.0
    steps: int = 0
    link2: float = 0.0
    rejection: str = ""
    fault: str = ""

    @property
    def turns(self) -> float:
        """Revolutions of the pinion shaft."""
        return abs(self.end["angle"]) / (2.0 * math.pi)

    def relative_breach(self, condition: str) -> float:
        """Return the maximum violation of a condition, relative to its scale.

        The scales are maximum speed, maximum torque, their product, and maximum energy.

        Args:
            condition: one of CONDITIONS.
        """
        scales = self.speed, self.torque, self.speed * self.torque, self.energy
        return relative(self.breaches[condition], scales[CONDITIONS.index(condition)])

    def include_maxima(self, other: Run) -> None:
        """Include the maxima of another run of the motion; long steps miss the maxima within them.

        Args:
            other: a run with shorter steps.
        """
        self.energy = max(self.energy, other.energy)
        self.speed = max(self.speed, other.speed)
        self.torque = max(self.torque, other.torque)

    def record(self, module: Module) -> None:
        """Update the maxima at a communication point.

        Args:
            module: module at the communication point.
        """
        self.is_finite = self.is_finite and all(map(math.isfinite, module.outputs.numbers))
        self.residual = max(self.residual, abs(module["energy_residual"]))
        # a prescribed speed refers to the beginning of the step
        link1 = module["input_speed" if module["drive"] else "omega1"]
        fastest = max(abs(link1), abs(module["omega2"]))
        possible = 0.5 * imbalance_inertia(module.derived) * fastest * fastest
        self.energy = max(
            self.energy, possible, *(abs(module[name]) for name in (*ENERGIES, "energy_stored"))
        )
        self.speed = max(self.speed, abs(link1), *(abs(module[name]) for name in SPEEDS))
        self.torque = max(self.torque, *(abs(module[name]) for name in TORQUES))
        before, self.lost = self.lost, {name: module[name] for name in LOST}
        breaches = [(REGAINED, before.get(name, 0.0) - lost) for name, lost in self.lost.items()]
        if module["fidelity"] in (RIGID, ELASTIC):
            breaches += _freewheel_breaches(module)
        for name, value in breaches:
            self.breaches[name] = max(self.breaches[name], value)


def _freewheel_breaches(module: Module) -> list[tuple[str, float]]:
    """Return the violations of the conditions of both freewheels, as pairs of condition and value.

    Args:
        module: module at a communication point.
    """
    breaches = []
    is_elastic, omega2 = module["fidelity"] == ELASTIC, module["omega2"]
    slips = ("housing", "housing", omega2), ("output", "freewheel", module["omega_hub"] - omega2)
    for wheel, spring, slip in slips:
        if not module[f"{wheel}_freewheel"]:
            continue
        drag = module[f"{wheel}_drag"] + module[f"{wheel}_drag_viscous"] * max(slip, 0.0)
        torque = module[f"{wheel}_torque"] + drag
        breaches.append((TORQUE, -torque))
        if not is_elastic or module[f"{spring}_stiffness"] == 0.0:
            breaches.append((POWER, slip * torque))
            # within the engagement angle the freewheel may turn backward
            breaches.append((SPEED, -slip * (module[f"{wheel}_engagement_angle"] == 0.0)))
    return breaches


def _kick(module: Module, kick: float) -> None:
    """Change the speed of link 2 and of the links locked to it, unless a freewheel prevents it.

    Args:
        module: module at a communication point.
        kick: change of the speed of a free link 2, rad/s.
    """
    x, d = module.state, module.derived
    if x.housing_state != LOCKED:
        before, hub = x.omega2, d.J3 if x.output_state == LOCKED else 0.0
        x.omega2 += kick * response(d, d.J2 + hub)
        if not is_mode_admissible(d, x):
            x.omega2 = before
        x.rates_cached = 0.0


def run(motion: Motion, make: Make, split: int = 1, saved_at: int = -1, kick: float = 0.0) -> Run:
    """Run a module through a motion.

    Args:
        motion: parameters and inputs.
        make: function that returns a new module.
        split: number of short communication steps for each long one.
        saved_at: number of the segment at which another module continues from the saved state; -1 for none.
        kick: change of the speed of link 2 before each communication step, rad/s.
    """
    result, module = Run(), make()
    try:
        motion.started(module)
    except InertiaModuleError as error:
        result.rejection = str(error)
        return result
    begin = module["drive_angle"] + 2.0 * math.pi * module["drive_turns"]
    result.link2 = module["link2_inertia"]
    result.record(module)
    result.points.append(module.snapshot())
    for number, segment in enumerate(motion.segments):
        if number == saved_at:
            saved, module = module.save(), make()
            module.restore(saved)
        _advance(result, module, segment, 1 if segment.is_whole else split, kick)
        if result.rejection:
            return result
        result.points.append(module.snapshot())
    result.end |= {name: module[name] for name in (*SPEEDS, *ENERGIES)}
    turns = module["drive_turns"] - motion.turns
    result.end["angle"] = module["drive_angle"] + 2.0 * math.pi * turns - begin
    result.evaluations = module["rhs_evaluations"]
    result.state = bytes(module.state) + bytes(module.outputs)
    return result


def _advance(result: Run, module: Module, segment: Segment, split: int, kick: float) -> None:
    """Advance a module through a segment.

    Args:
        result: record to update.
        module: module at the beginning of the segment.
        segment: inputs.
        split: number of short communication steps for each long one.
        kick: change of the speed of link 2 before each communication step, rad/s.
    """
    count = max(segment.steps, math.ceil(segment.duration / LARGEST_STEP)) * split
    step = segment.duration / count
    impulses = dict.fromkeys(IMPULSES, 0.0)
    for n in range(count):
        omega1 = segment.omega1 + segment.slope * n * step
        module.set(omega1=omega1, load_torque=segment.load, drive_torque=segment.drive)
        if segment.slope and not module["input_hold"]:
            module.set_rates(omega1=segment.slope)
        if kick != 0.0:
            _kick(module, kick)
        before = bytes(module.state)
        try:
            module.advance(step)
        except InertiaModuleError as error:
            result.rejection = str(error)
            result.fault = _fault_after_rejection(module, before)
            return
        result.steps += 1
        result.phase += step * _phase_rate(module)
        for name in impulses:
            impulses[name] += module[name] * step
        result.record(module)
    for name, impulse in impulses.items():
        result.end[name] = result.end.get(name, 0.0) + impulse


def _fault_after_rejection(module: Module, before: bytes) -> str:
    """Return the fault of a module that rejected a step: a changed state or no valid next step; else "".

    Args:
        module: module after the rejected step.
        before: bytes of the state before the step.
    """
    if bytes(module.state) != before:
        return "a rejected step changed the state"
    module.set(omega1=1.0, load_torque=1.0)
    try:
        module.advance(1e-6)
    except InertiaModuleError as error:
        return f"no valid step after a rejected one: {error}"
    return ""


def _phase_rate(module: Module) -> float:
    """Return the rate of the phase that the integration must resolve, rad/s.

    It contains the highest harmonic of the pulses and the oscillation of an elastic shaft. The kernel treats
    a shaft as rigid if it oscillates faster than the pulses by more than 1 / sqrt(tolerance).

    Args:
        module: module at a communication point.
    """
    omega1 = module["input_speed" if module["drive"] else "omega1"]
    harmonic = float(module.derived.harmonic * module.derived.k)
    pulses = harmonic * max(abs(omega1 - module["omega2"]), abs(omega1))
    if module["fidelity"] != ELASTIC:
        return pulses
    shaft = shaft_frequency(module.__getitem__)
    fastest = harmonic * max(abs(omega1), abs(module["omega_hub"]), abs(module["omega_out"]))
    is_resolved = shaft * math.sqrt(module["tolerance"]) <= fastest
    return pulses + (shaft if is_resolved else 0.0)


def relative(value: float, scale: float) -> float:
    """Return the magnitude of a value relative to a scale; infinity if only the scale is zero.

    Args:
        value: a value.
        scale: scale in the same unit.
    """
    if value == 0.0:
        return 0.0
    return abs(value) / scale if scale > 0.0 else math.inf


def distance(first: Run, second: Run, inertia: float = 0.0, speed_fraction: float = 0.0) -> float:
    """Return the maximum difference between the ends of two runs, relative to the maxima of both.

    The scales are the maximum speed and the maximum energy; for impulses energy over speed, at least the
    impulse of link 2 at the maximum speed; for the pinion-shaft angle its change (at least 1 rad).

    Args:
        first: a run, whose angle and impulses are scales.
        second: another run of the same motion.
        inertia: inertia of hub and driven mass, kg m^2; it limits the accuracy of the output impulse.
        speed_fraction: fraction of the maximum speed below which an oscillation of this inertia is ignored.
    """
    speed = max(first.speed, second.speed)
    energy = max(first.energy, second.energy, inertia * speed_fraction * speed * speed)
    scales = dict.fromkeys(SPEEDS, speed) | dict.fromkeys(ENERGIES, energy)
    scales["angle"] = max(1.0, abs(first.end["angle"]))
    for name in IMPULSES:
        least = max(energy / speed if speed > 0.0 else 0.0, first.link2 * speed)
        scales[name] = max(abs(first.end[name]), least)
    scales["output_torque_mean"] = max(scales["output_torque_mean"], inertia * speed)
    return max(relative(first.end[name] - second.end[name], scale) for name, scale in scales.items())
