"""One trial: the module is run in long steps, in many short ones, tightly, and slightly changed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

from inertia_module.common.errors import Refused
from inertia_module.contract.variable import LARGEST_STEP
from inertia_module.kernel.codes import ELASTIC, EVENT, KINEMATIC, TIMESTEPPING
from inertia_module.memory import Module

from ..reference.geometry import shaft_frequency, swing_frequency
from .case import Case, Segment
from .record import ENERGIES, IMPULSES, SPEEDS, Run, input_speed, look

# the run the others are measured against: tighter by this, down to what doubles allow
TIGHTER = 1e-4
TIGHTEST = 1e-13
# rad of the highest harmonic in a step of method timestepping
FIXED_PHASE = 0.1
Parameters = dict[str, float]


def _rate(module: Module, omega1: float) -> float:
    """Rate of the phase that has to be followed, rad/s: of the highest harmonic and of an elastic shaft.

    A shaft that oscillates faster than the pulses by more than 1 / sqrt(tolerance) is not followed.
    """
    harmonic = float(module.derived.harmonic * module.derived.k)
    pulses = harmonic * max(abs(omega1 - module["omega2"]), abs(omega1))
    if module["fidelity"] != ELASTIC or module["method"] != EVENT:
        return pulses
    shaft = shaft_frequency(module.__getitem__)
    fastest = harmonic * max(abs(omega1), abs(module["omega_hub"]), abs(module["omega_out"]))
    followed = shaft * math.sqrt(module["tolerance"]) <= fastest
    return pulses + (shaft if followed else 0.0)


def _recovers(module: Module, before: bytes) -> str:
    """What is wrong with the module after a refused step, or ""."""
    if bytes(module.state) != before:
        return "a refused step changed the state"
    module.set(omega1=1.0, load_torque=1.0)
    try:
        module.advance(1e-6)
    except Refused as error:
        return f"no good step after a refused one: {error}"
    return ""


def _go(run: Run, module: Module, segment: Segment, split: int) -> None:
    """Advance through a segment, each of its steps split in so many."""
    count = max(segment.steps, math.ceil(segment.duration / LARGEST_STEP)) * split
    step = segment.duration / count
    impulses = dict.fromkeys(IMPULSES, 0.0)
    for n in range(count):
        omega1 = segment.omega1 + segment.slope * n * step
        module.set(omega1=omega1, load_torque=segment.load, drive_torque=segment.drive)
        if segment.slope and not module["input_hold"]:
            module.set_rates(omega1=segment.slope)
        before = bytes(module.state)
        try:
            module.advance(step)
        except Refused as error:
            run.refused = str(error)
            run.broken = _recovers(module, before)
            return
        run.steps += 1
        if module["max_step"] > 0.0:
            run.fixed_steps += math.ceil(step / module["max_step"])
        run.phase += step * _rate(module, input_speed(module))
        for name in impulses:
            impulses[name] += module[name] * step
        look(run, module)
    for name, impulse in impulses.items():
        run.end[name] = run.end.get(name, 0.0) + impulse


def run_once(
    module: Module, parameters: Parameters, segments: tuple[Segment, ...], split: int, turns: float = 0.0
) -> Run:
    """Run through the segments with each step split in so many.

    Args:
        module: not started yet. parameters: over the defaults. turns: already on the counters.
    """
    run = Run()
    first = segments[0]
    try:
        module.start(**parameters, omega1=first.omega1, load_torque=first.load, drive_torque=first.drive)
    except Refused as error:
        run.refused = str(error)
        return run
    if turns:
        module.state.drive_turns += turns
        module.state.input_turns += turns
    begin = module["drive_angle"] + 2.0 * math.pi * module["drive_turns"]
    look(run, module)
    for segment in segments:
        _go(run, module, segment, 1 if segment.whole else split)
        if run.refused:
            return run
    run.end |= {name: module[name] for name in (*SPEEDS, *ENERGIES)}
    run.end["angle"] = module["drive_angle"] + 2.0 * math.pi * (module["drive_turns"] - turns) - begin
    run.evaluations = module["rhs_evaluations"]
    return run


def distance(one: Run, other: Run, inertia: float = 0.0, share: float = 0.0) -> float:
    """Largest difference of what two runs end with, relative to the largest seen in them.

    Speeds to the fastest, energies to the largest, impulses to energy over speed, the drive angle to
    what it has gone through (at least a radian).

    Args:
        inertia: driven, kg m^2: the output's impulse is known as well as its speed is.
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


def relative(value: float, scale: float) -> float:
    """Size of a value, of its scale; infinite where that is zero and the value is not."""
    if value == 0.0:
        return 0.0
    return abs(value) / scale if scale > 0.0 else math.inf


@dataclass(frozen=True)
class Trial:
    """The runs of a case.

    Attributes:
        case: what was tried. long, short: in long communication steps and in many short ones.
        tight: at a far tighter tolerance, by events (None where it is refused).
        sensitivity: of the motion itself: largest distance from tight that a relative change by the
            tolerance in the angle at the start, in the load or in the speed of link 1 makes.
    """

    case: Case
    long: Run
    short: Run | None = None
    tight: Run | None = None
    sensitivity: float = 0.0


def nudged(
    parameters: Parameters, segments: tuple[Segment, ...], change: float
) -> list[tuple[Parameters, tuple[Segment, ...]]]:
    """The same slightly changed: angle at the start, load and speed of link 1, each to both sides."""
    beside = []
    for part in (change, -change):
        start = parameters.get("drive_angle_start", 0.0) + part
        factor = 1.0 + part
        loads = tuple(replace(one, load=one.load * factor, drive=one.drive * factor) for one in segments)
        speeds = tuple(replace(one, omega1=one.omega1 * factor, slope=one.slope * factor) for one in segments)
        turned = parameters | {"drive_angle_start": start}
        beside += [(turned, segments), (parameters, loads), (parameters, speeds)]
    return beside


def fixed_step(parameters: Parameters, segments: tuple[Segment, ...], module: Module) -> float:
    """Step of method timestepping, s; 0 at rest without weights.

    FIXED_PHASE of the highest harmonic at the fastest input and of the swing of link 2 on weights.
    """
    module.start(**parameters | {"fidelity": KINEMATIC, "method": EVENT})
    fastest = max(max(abs(s.omega1), abs(s.omega1 + s.slope * s.duration)) for s in segments)
    rate = float(module.derived.harmonic * module.derived.k) * fastest
    rate += swing_frequency(module.__getitem__)
    return min(FIXED_PHASE / rate, LARGEST_STEP) if rate > 1e-300 else 0.0


def _runs(case: Case, make: Callable[[], Module]) -> Trial:
    extreme, tolerance = case.extreme, case.parameter("tolerance")
    segments = extreme.segments
    parameters = extreme.parameters | case.level.values
    if case.level.method == TIMESTEPPING and "max_step" not in parameters:
        parameters["max_step"] = fixed_step(parameters, segments, make())
    long = run_once(make(), parameters, segments, 1, extreme.turns)
    if long.refused:
        return Trial(case, long)
    short = run_once(make(), parameters, segments, extreme.split, extreme.turns)
    precise = parameters | {"method": EVENT, "max_step": 0.0}
    tight, sensitivity = _precise(make, tuple(precise.items()), segments, tolerance)
    return Trial(case, long, short, tight, sensitivity)


@lru_cache(maxsize=1)  # the methods of a fidelity, which come one after the other, share it
def _precise(
    make: Callable[[], Module],
    parameters: tuple[tuple[str, float], ...],
    segments: tuple[Segment, ...],
    tolerance: float,
) -> tuple[Run | None, float]:
    """The tight run, or None where it is refused, and the sensitivity of the motion (see Trial)."""
    precise = dict(parameters) | {"tolerance": max(TIGHTER * tolerance, TIGHTEST)}
    tight = run_once(make(), precise, segments, 1)
    if tight.refused:
        return None, 0.0
    changed = [run_once(make(), *beside, 1) for beside in nudged(precise, segments, tolerance)]
    return tight, max((distance(run, tight) for run in changed if not run.refused), default=0.0)


def try_case(case: Case, make: Callable[[], Module] = Module) -> Trial:
    """All runs of a case. Never raises.

    Args:
        make: makes a module not started yet.
    """
    try:
        return _runs(case, make)
    except Exception as error:  # whatever else it is, it is a finding
        return Trial(case, Run(broken=f"{type(error).__name__}: {error}"))
