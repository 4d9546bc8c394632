"""A motion: a module with its inputs over time. It is run, and held against other runs of it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Self

from pydantic import TypeAdapter

from inertia_module.common.errors import Refused
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
# compared at the end of a run; and the torques whose largest is its scale
SPEEDS = ("omega2", "omega_out")
ENERGIES = ("energy_in", "energy_out")
IMPULSES = ("input_torque_mean", "output_torque_mean")
TORQUES = ("load_torque", "input_torque", "mesh_torque", "output_torque", "housing_torque")
# not the shaft's: a balancer gives energy, and of a shaft too stiff to be followed it is a difference
LOST = tuple(name for name in LOSSES if name != "energy_lost_shaft")
# never breached but for rounding, and what a breach is relative to; the first three without drag, the speeds
# only of freewheels without wind-up and play
SPEED, TORQUE, POWER, REGAINED = BREACHES = (
    "0 <= omega2 <= omega3",
    "Th, Tc >= 0",
    "torque or slip is 0",
    "lost energy regained",
)

Parameters = dict[str, int | float]
Make = Callable[[], Module]


@dataclass(frozen=True)
class Figure:
    """One measured figure and the bound it is held to; explained: the motion's own sensitivity widened it."""

    value: float
    bound: float
    explained: bool = False

    @property
    def holds(self) -> bool:
        """True within the bound (not for NaN)."""
        return self.value <= self.bound


Figures = dict[str, Figure]


def missed(figures: Figures) -> dict[str, str]:
    """Tell by name, with value and bound, of the figures that do not hold."""
    return {
        name: f"{name} {figure.value:.0e}, bound {figure.bound:.0e}"
        for name, figure in figures.items()
        if not figure.holds
    }


@dataclass(frozen=True)
class Segment:
    """A stretch of time with given inputs.

    Attributes:
        duration: s. omega1: at its beginning, rad/s. load: N.m. slope: of omega1, rad/s^2.
        drive: torque on link 1, where the drive gives one, N.m.
        steps: communication steps it takes at least (a step may be up to 1e6 s long).
        whole: whether its steps stay as they are in the run of many short ones.
    """

    duration: float
    omega1: float
    load: float
    slope: float = 0.0
    drive: float = 0.0
    steps: int = 1
    whole: bool = False

    @property
    def fastest(self) -> float:
        """Largest speed of link 1, rad/s, where it is given."""
        return max(abs(self.omega1), abs(self.omega1 + self.slope * self.duration))

    def scaled(self, speed: float = 1.0, torque: float = 1.0, time: float = 1.0) -> Segment:
        """The segment with its speeds, torques and duration times these factors."""
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
        parameters: over the defaults. segments: each a communication step, or split into many.
        turns: whole turns already on the counters of the drive and of link 1.
    """

    parameters: Parameters
    segments: tuple[Segment, ...]
    turns: float = 0.0

    @classmethod
    def of(cls, values: dict[str, Any]) -> Self:
        """The motion that as_dict has written."""
        return TypeAdapter(cls).validate_python(values)

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers that can be printed and pasted, without those at their defaults."""
        plain: dict[str, Any] = TypeAdapter(Motion).dump_python(self, mode="json", exclude_defaults=True)
        return plain

    def __getitem__(self, name: str) -> float:
        """Value of a parameter."""
        return float(self.parameters.get(name, BY_NAME[name].start or 0.0))

    @property
    def level(self) -> Level:
        """Its level of fidelity."""
        return Level(int(self["fidelity"]))

    def changed(self, **parameters: float) -> Motion:
        """The motion with other parameters."""
        return replace(self, parameters=self.parameters | parameters)

    def nudged(self, change: float) -> list[Motion]:
        """The motion slightly changed: angle at the start, load, speed of link 1, each to both sides."""
        beside = []
        for part in (change, -change):
            start = self.parameters.get("drive_angle_start", 0.0) + part
            loads = tuple(one.scaled(torque=1.0 + part) for one in self.segments)
            speeds = tuple(one.scaled(speed=1.0 + part) for one in self.segments)
            turned = self.changed(drive_angle_start=start)
            beside += [turned, replace(self, segments=loads), replace(self, segments=speeds)]
        return beside

    def started(self, module: Module) -> Module:
        """The module started with the parameters and the inputs of the first segment."""
        first = self.segments[0]
        module.start(**self.parameters, omega1=first.omega1, load_torque=first.load, drive_torque=first.drive)
        if self.turns:
            module.state.drive_turns += self.turns
            module.state.input_turns += self.turns
        return module


def solve_at(module: Module, held: bool, driving: bool, load: float = 0.0, **motion: float) -> Any:
    """Accelerations and torques of the kernel's equations at an instant, by the names of fields.MACHINE.

    Args:
        module: plain and started, without losses; alpha1 or drive_torque of its state is given.
        held, driving: whether the freewheels to housing and output are locked. load: N.m.
        motion: q, omega1, omega2, omega3.
    """
    x, machine = module.state, module.derived.machine
    x.housing_state, x.output_state = (LOCKED if locked else OVERRUNNING for locked in (held, driving))
    for name, value in motion.items():
        setattr(machine, name, value)
    prescribed = x.drive_torque if module.derived.by_torque else x.alpha1
    evaluate(module.derived, x, prescribed, load, False)
    return machine


def imbalance_inertia(derived: Any) -> float:
    """Largest inertia of the imbalances behind link 2, k^2 G, kg m^2."""
    far = derived.pole_offset + 2.0 * derived.pole_arm
    return float(derived.mass * derived.k**2 * (far * far + derived.spin))


@dataclass
class Run:
    """Record of a run: the largest at its communication points of all that is held to a bound.

    Attributes:
        end: values at the end: speeds, energies, drive angle gone through, impulses of the torques.
        points: all values at the start and after each segment. state: state and outputs at the end.
        finite: whether every output was, at every communication point.
        residual: largest energy residual, J.
        energy: largest of input, output, stored, and what the imbalances can have at the speeds seen, J.
        speed, torque: largest seen, rad/s, N.m.
        breaches: deepest of each of BREACHES, rad/s, N.m, W, J.
        lost: energy lost so far by cause, but the shaft's, J.
        phase: advance of what has to be followed, rad. evaluations, steps: what it took.
        refused: message of the refusal that ended it, or "".
        broken: what must never happen and did, such as an exception that is no refusal, or "".
    """

    end: dict[str, float] = field(default_factory=dict)
    points: list[dict[str, float]] = field(default_factory=list)
    state: bytes = b""
    finite: bool = True
    residual: float = 0.0
    energy: float = 0.0
    speed: float = 0.0
    torque: float = 0.0
    breaches: dict[str, float] = field(default_factory=lambda: dict.fromkeys(BREACHES, 0.0))
    lost: dict[str, float] = field(default_factory=dict)
    phase: float = 0.0
    evaluations: float = 0.0
    steps: int = 0
    refused: str = ""
    broken: str = ""

    @property
    def turns(self) -> float:
        """Turns of the drives that its end tells of."""
        return abs(self.end["angle"]) / (2.0 * math.pi)

    def share(self, breach: str) -> float:
        """Deepest breach relative to the largest speed, torque, their product, or energy."""
        scales = self.speed, self.torque, self.speed * self.torque, self.energy
        return relative(self.breaches[breach], scales[BREACHES.index(breach)])

    def look(self, module: Module) -> None:
        """Take note of what shows at a communication point."""
        self.finite = self.finite and all(map(math.isfinite, module.outputs.numbers))
        self.residual = max(self.residual, abs(module["energy_residual"]))
        # at the beginning of the step where it is given
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
        elastic, omega2 = module["fidelity"] == ELASTIC, module["omega2"]
        slips = ("housing", "housing", omega2), ("output", "freewheel", module["omega_hub"] - omega2)
        for wheel, spring, slip in slips if elastic or module["fidelity"] == RIGID else ():
            if not module[f"{wheel}_freewheel"]:
                continue
            drag = module[f"{wheel}_drag"] + module[f"{wheel}_drag_viscous"] * max(slip, 0.0)
            held = module[f"{wheel}_torque"] + drag
            breaches.append((TORQUE, -held))
            if not elastic or module[f"{spring}_stiffness"] == 0.0:
                breaches.append((POWER, slip * held))
                # while it winds up, or is within its play, it may turn backwards
                breaches.append((SPEED, -slip * (module[f"{wheel}_engagement_angle"] == 0.0)))
        for name, value in breaches:
            self.breaches[name] = max(self.breaches[name], value)


def _kick(module: Module, kick: float) -> None:
    """Change the speed of link 2 and what it is locked to, rad/s, where no freewheel is in the way."""
    x, d = module.state, module.derived
    if x.housing_state != LOCKED:
        before, carried = x.omega2, d.J3 if x.output_state == LOCKED else 0.0
        x.omega2 += kick * response(d, d.J2 + carried)
        if not is_mode_admissible(d, x):
            x.omega2 = before
        x.rates_cached = 0.0


def run(motion: Motion, make: Make, split: int = 1, saved_at: int = -1, kick: float = 0.0) -> Run:
    """Run a module through a motion, each long communication step split in so many short ones.

    From the segment saved_at on another module goes on from the saved state. With each step link 2 is kicked,
    rad/s, as far as the mechanism could move it so.
    """
    found, module = Run(), make()
    try:
        motion.started(module)
    except Refused as error:
        found.refused = str(error)
        return found
    begin = module["drive_angle"] + 2.0 * math.pi * module["drive_turns"]
    found.look(module)
    found.points.append(module.snapshot())
    for number, segment in enumerate(motion.segments):
        if number == saved_at:
            saved, module = module.save(), make()
            module.restore(saved)
        _advance(found, module, segment, 1 if segment.whole else split, kick)
        if found.refused:
            return found
        found.points.append(module.snapshot())
    found.end |= {name: module[name] for name in (*SPEEDS, *ENERGIES)}
    turns = module["drive_turns"] - motion.turns
    found.end["angle"] = module["drive_angle"] + 2.0 * math.pi * turns - begin
    found.evaluations = module["rhs_evaluations"]
    found.state = bytes(module.state) + bytes(module.outputs)
    return found


def _advance(found: Run, module: Module, segment: Segment, split: int, kick: float) -> None:
    """Advance through a segment, each of its steps split in so many; link 2 is kicked before each."""
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
        except Refused as error:
            found.refused = str(error)
            if bytes(module.state) != before:
                found.broken = "a refused step changed the state"
                return
            module.set(omega1=1.0, load_torque=1.0)
            try:
                module.advance(1e-6)
            except Refused as next_one:
                found.broken = f"no good step after a refused one: {next_one}"
            return
        found.steps += 1
        found.phase += step * _followed_rate(module)
        for name in impulses:
            impulses[name] += module[name] * step
        found.look(module)
    for name, impulse in impulses.items():
        found.end[name] = found.end.get(name, 0.0) + impulse


def _followed_rate(module: Module) -> float:
    """Rate of the phase that has to be followed, rad/s: of the highest harmonic and of an elastic shaft.

    A shaft that oscillates faster than the pulses by more than 1 / sqrt(tolerance) is not followed.
    """
    omega1 = module["input_speed" if module["drive"] else "omega1"]
    harmonic = float(module.derived.harmonic * module.derived.k)
    pulses = harmonic * max(abs(omega1 - module["omega2"]), abs(omega1))
    if module["fidelity"] != ELASTIC:
        return pulses
    shaft = shaft_frequency(module.__getitem__)
    fastest = harmonic * max(abs(omega1), abs(module["omega_hub"]), abs(module["omega_out"]))
    followed = shaft * math.sqrt(module["tolerance"]) <= fastest
    return pulses + (shaft if followed else 0.0)


def relative(value: float, scale: float) -> float:
    """Size of a value, of its scale; infinite where that is zero and the value is not."""
    if value == 0.0:
        return 0.0
    return abs(value) / scale if scale > 0.0 else math.inf


def distance(one: Run, other: Run, inertia: float = 0.0, share: float = 0.0) -> float:
    """Largest difference of what two runs end with, relative to the largest seen in them.

    Speeds to the fastest, energies to the largest, impulses to energy over speed, the drive angle to
    what it has gone through (at least a radian).

    Args:
        inertia: of hub and driven mass, kg m^2: the output's impulse is known as well as their speeds are.
        share: of the fastest speed: with a slower swing the inertia may have any energy.
    """
    speed = max(one.speed, other.speed)
    energy = max(one.energy, other.energy, inertia * share * speed * speed)
    scales = dict.fromkeys(SPEEDS, speed) | dict.fromkeys(ENERGIES, energy)
    scales["angle"] = max(1.0, abs(one.end["angle"]))
    for name in IMPULSES:
        scales[name] = max(abs(one.end[name]), energy / speed if speed > 0.0 else 0.0)
    scales["output_torque_mean"] = max(scales["output_torque_mean"], inertia * speed)
    return max(relative(one.end[name] - other.end[name], scale) for name, scale in scales.items())
