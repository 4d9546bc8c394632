"""One trial: the module is run in long steps, in many short ones, tightly, and slightly changed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, Protocol

from ...errors import Refused
from ...kernel import codes
from ...module import Module
from ...variables import LARGEST_STEP
from .bounds import tolerance_of
from .case import ELASTIC, EVENT, KINEMATIC, TIMESTEPPING, Case, Segment

# the run the others are measured against: tighter by this, down to what doubles allow
TIGHTER = 1e-4
TIGHTEST = 1e-13
# rad of the highest harmonic in a step of method timestepping
FIXED_PHASE = 0.1
# what has to be finite is everything; what is compared at the end of a run is this
SPEEDS = ("omega2", "omega_out")
ENERGIES = ("energy_in", "energy_out")
TORQUES = ("input_torque", "mesh_torque", "output_torque")


class Plant(Protocol):
    """What a trial needs of the module."""

    outputs: Any
    derived: Any
    state: Any

    def start(self, **values: float) -> Any:
        """Set values and take the initial state."""

    def set(self, **values: float) -> None:
        """Set inputs."""

    def advance(self, step_size: float) -> None:
        """Advance by a communication step."""

    def __getitem__(self, name: str) -> float: ...


@dataclass
class Run:
    """What one run showed.

    Attributes:
        end: values at the end: speeds, energies, drive angle gone through, impulses of the torques.
        finite: whether every output was, at every communication point.
        residual: largest energy residual, J. speed, torque: largest seen, rad/s, N m.
        energy: largest of input, output, stored, and what the imbalances can have at the speeds seen, J.
        reversal: deepest breach of omega2 >= 0 or omega3 >= omega2, rad/s.
        pull: deepest breach of Tc >= 0 or Th >= 0, N m.
        phase: advance of what has to be followed, rad. evaluations, steps: what it took.
        fixed_steps: internal steps of method timestepping.
        refused: message of the refusal that ended it, or "".
        broken: what an error must not do and it did, or "".
    """

    end: dict[str, float] = field(default_factory=dict)
    finite: bool = True
    residual: float = 0.0
    energy: float = 0.0
    speed: float = 0.0
    torque: float = 0.0
    reversal: float = 0.0
    pull: float = 0.0
    phase: float = 0.0
    fixed_steps: int = 0
    evaluations: float = 0.0
    steps: int = 0
    refused: str = ""
    broken: str = ""


def imbalance_energy(derived: Any, speed: float) -> float:
    """Largest kinetic energy of the imbalances behind link 2 at this speed, k^2 G speed^2 / 2, J."""
    far = derived.pole_offset + 2.0 * derived.pole_arm
    inertia = derived.mass * derived.k**2 * (far * far + derived.spin)
    return float(0.5 * inertia * speed * speed)


def _look(run: Run, plant: Plant, parameters: dict[str, float]) -> None:
    """Take note of what shows at a communication point."""
    values = {
        name: plant[name]
        for name in (*SPEEDS, *ENERGIES, *TORQUES, "omega_hub", "energy_stored", "housing_torque")
    }
    run.finite = run.finite and all(map(math.isfinite, plant.outputs.numbers))
    run.residual = max(run.residual, abs(plant["energy_residual"]))
    run.energy = max(run.energy, *(abs(values[name]) for name in (*ENERGIES, "energy_stored")))
    fastest = max(abs(plant["omega1"]), abs(values["omega2"]))
    run.energy = max(run.energy, imbalance_energy(plant.derived, fastest))
    run.speed = max(run.speed, abs(plant["omega1"]), *(abs(values[name]) for name in SPEEDS))
    run.torque = max(run.torque, abs(plant["load_torque"]), *(abs(values[name]) for name in TORQUES))
    if parameters.get("fidelity", codes.RIGID) in (codes.RIGID, codes.ELASTIC):
        if parameters.get("housing_freewheel", True):
            run.reversal = max(run.reversal, -values["omega2"])
            run.pull = max(run.pull, -values["housing_torque"])
        if parameters.get("output_freewheel", True):
            run.reversal = max(run.reversal, values["omega2"] - values["omega_hub"])
            run.pull = max(run.pull, -values["output_torque"])


def _rate(plant: Plant, parameters: dict[str, float], omega1: float) -> float:
    """Rate of the phase that has to be followed, rad/s: of the highest harmonic and of an elastic shaft.

    A shaft that oscillates faster than the pulses by more than 1 / sqrt(tolerance) is not followed.
    """
    harmonic = float(plant.derived.harmonic * plant.derived.k)
    pulses = harmonic * max(abs(omega1 - plant["omega2"]), abs(omega1))
    if parameters["fidelity"] != ELASTIC or parameters["method"] != EVENT:
        return pulses
    inertias = 1.0 / plant["output_inertia"] + 1.0 / plant["driven_inertia"]
    shaft = math.sqrt(plant["shaft_stiffness"] * inertias)
    fastest = harmonic * max(abs(omega1), abs(plant["omega_hub"]), abs(plant["omega_out"]))
    followed = shaft * math.sqrt(plant["tolerance"]) <= fastest
    return pulses + (shaft if followed else 0.0)


def _recovers(plant: Plant, before: bytes) -> str:
    """What is wrong with the module after a refused step, or ""."""
    if bytes(plant.state) != before:
        return "a refused step changed the state"
    plant.set(omega1=1.0, load_torque=1.0)
    try:
        plant.advance(1e-6)
    except Refused as error:
        return f"no good step after a refused one: {error}"
    return ""


def _go(run: Run, plant: Plant, segment: Segment, split: int, parameters: dict[str, float]) -> None:
    """Advance through a segment, each of its steps split in so many."""
    count = max(segment.steps, math.ceil(segment.duration / LARGEST_STEP)) * split
    step = segment.duration / count
    impulses = dict.fromkeys(("input_torque_mean", "output_torque_mean"), 0.0)
    for n in range(count):
        omega1 = segment.omega1 + segment.slope * n * step
        plant.set(omega1=omega1, load_torque=segment.load)
        before = bytes(plant.state)
        try:
            plant.advance(step)
        except Refused as error:
            run.refused = str(error)
            run.broken = _recovers(plant, before)
            return
        run.steps += 1
        if plant["max_step"] > 0.0:
            run.fixed_steps += math.ceil(step / plant["max_step"])
        run.phase += step * _rate(plant, parameters, omega1)
        for name in impulses:
            impulses[name] += plant[name] * step
        _look(run, plant, parameters)
    for name, impulse in impulses.items():
        run.end[name] = run.end.get(name, 0.0) + impulse


def run_once(
    plant: Plant, parameters: dict[str, float], segments: tuple[Segment, ...], split: int, turns: float = 0.0
) -> Run:
    """Run through the segments with each step split in so many.

    Args:
        plant: not started yet. parameters: over the defaults. turns: already on the counters.
    """
    run = Run()
    first = segments[0]
    try:
        plant.start(**parameters, omega1=first.omega1, load_torque=first.load)
    except Refused as error:
        run.refused = str(error)
        return run
    if turns:
        plant.state.drive_turns += turns
        plant.state.input_turns += turns
    begin = plant["drive_angle"] + 2.0 * math.pi * plant["drive_turns"]
    _look(run, plant, parameters)
    for segment in segments:
        _go(run, plant, segment, 1 if segment.whole else split, parameters)
        if run.refused:
            return run
    for name in (*SPEEDS, *ENERGIES):
        run.end[name] = plant[name]
    gone = plant["drive_angle"] + 2.0 * math.pi * (plant["drive_turns"] - turns)
    run.end["angle"] = gone - begin
    run.evaluations = plant["rhs_evaluations"]
    return run


def distance(one: Run, other: Run) -> float:
    """Largest difference of what two runs end with, relative to the largest seen in them.

    Speeds to the fastest, energies to the largest, impulses to energy over speed, the drive angle to
    what it has gone through (at least a radian).
    """
    speed = max(one.speed, other.speed)
    energy = max(one.energy, other.energy)
    scales = dict.fromkeys(SPEEDS, speed) | dict.fromkeys(ENERGIES, energy)
    scales["angle"] = max(1.0, abs(one.end["angle"]))
    for name in ("input_torque_mean", "output_torque_mean"):
        scales[name] = max(abs(one.end[name]), energy / speed if speed > 0.0 else 0.0)
    worst = 0.0
    for name, scale in scales.items():
        gap = abs(one.end[name] - other.end[name])
        if gap > 0.0:
            worst = max(worst, gap / scale if scale > 0.0 else math.inf)
    return worst


@dataclass(frozen=True)
class Trial:
    """The runs of a case.

    Attributes:
        case: what was tried. long, short: in long communication steps and in many short ones.
        tight: at a far tighter tolerance, by events (None where it is refused).
        sensitivity: of the motion itself: largest distance from tight that a relative change by the
            tolerance in the angle at the start, in the load or in the speed of link 1 makes.
        exception: an exception that is no refusal, or "".
    """

    case: Case
    long: Run
    short: Run | None = None
    tight: Run | None = None
    sensitivity: float = 0.0
    exception: str = ""


def nudged(
    parameters: dict[str, float], segments: tuple[Segment, ...], change: float
) -> list[tuple[dict[str, float], tuple[Segment, ...]]]:
    """The same slightly changed: angle at the start, load and speed of link 1, each to both sides."""
    beside = []
    for part in (change, -change):
        start = parameters.get("drive_angle_start", 0.0) + part
        beside.append((parameters | {"drive_angle_start": start}, segments))
        loads = tuple(replace(segment, load=segment.load * (1.0 + part)) for segment in segments)
        beside.append((parameters, loads))
        speeds = tuple(
            replace(segment, omega1=segment.omega1 * (1.0 + part), slope=segment.slope * (1.0 + part))
            for segment in segments
        )
        beside.append((parameters, speeds))
    return beside


def try_case(case: Case, plant: Callable[[], Plant] = Module) -> Trial:
    """All runs of a case. Never raises.

    Args:
        plant: makes a module not started yet.
    """
    try:
        return _runs(case, plant)
    except Exception as error:  # whatever it is, it is a finding
        return Trial(case, Run(), exception=f"{type(error).__name__}: {error}")


def fixed_step(parameters: dict[str, float], segments: tuple[Segment, ...], plant: Plant) -> float:
    """Step of method timestepping: FIXED_PHASE of the highest harmonic at the fastest input, s; 0 at rest."""
    plant.start(**parameters | {"fidelity": KINEMATIC, "method": EVENT})
    fastest = max(max(abs(s.omega1), abs(s.omega1 + s.slope * s.duration)) for s in segments)
    rate = float(plant.derived.harmonic * plant.derived.k) * fastest
    return min(FIXED_PHASE / rate, LARGEST_STEP) if rate > 1e-300 else 0.0


def _runs(case: Case, plant: Callable[[], Plant]) -> Trial:
    extreme = case.extreme
    rung = case.rung
    parameters = {**extreme.parameters, "fidelity": rung.fidelity, "method": rung.method}
    if rung.method == TIMESTEPPING and "max_step" not in parameters:
        parameters["max_step"] = fixed_step(parameters, extreme.segments, plant())
    long = run_once(plant(), parameters, extreme.segments, 1, extreme.turns)
    if long.refused:
        return Trial(case, long)
    short = run_once(plant(), parameters, extreme.segments, extreme.split, extreme.turns)
    precise = parameters | {"method": EVENT, "max_step": 0.0}
    tight, sensitivity = _precise(plant, tuple(precise.items()), extreme.segments, tolerance_of(case))
    return Trial(case, long, short, tight, sensitivity)


@lru_cache(maxsize=1)  # the methods of a fidelity, which come one after the other, share it
def _precise(
    plant: Callable[[], Plant],
    parameters: tuple[tuple[str, float], ...],
    segments: tuple[Segment, ...],
    tolerance: float,
) -> tuple[Run | None, float]:
    """The tight run, or None where it is refused, and the sensitivity of the motion (see Trial)."""
    precise = dict(parameters) | {"tolerance": max(TIGHTER * tolerance, TIGHTEST)}
    tight = run_once(plant(), precise, segments, 1)
    if tight.refused:
        return None, 0.0
    sensitivity = 0.0
    for values, beside in nudged(precise, segments, tolerance):
        run = run_once(plant(), values, beside, 1)
        if not run.refused:
            sensitivity = max(sensitivity, distance(run, tight))
    return tight, sensitivity
