"""Random mechanisms under random inputs: drawn by number, run, held to what holds of any motion, made small.

A number of a seed is always the same motion.
"""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
from pydantic import TypeAdapter

from inertia_module.common.files import content_hash, sources
from inertia_module.fmi.results import write_text
from inertia_module.interface.variables import BY_NAME, LARGEST_TORQUE, default_parameters
from inertia_module.kernel import codes
from inertia_module.kernel.codes import AVERAGED, DRIVE_TORQUE, ELASTIC, RIGID
from inertia_module.model import Module

from ..reference.cases import OMEGA1, OMEGA4
from ..reference.geometry import Array, UnavailableError, positions, ratio, satellite_ratio
from ..reference.motion import Reference
from ..reference.virtual_work import VirtualWork, period
from . import motion as motions
from .motion import Figure, Figures, Make, Motion, Parameters, Run, Segment
from .verdicts import BREACH, LARGEST_ERROR, ROUNDING, energy_bound

# digits of every number
DIGITS = 5
# averaged: the mean motion is integrated to 1e-4 of the largest speed, its energy to a tenth of that
AVERAGED_TOLERANCE = 1e-5
# viscous friction: the share of the motions that have some
FRICTION_SHARE, MOST_FRICTION = 0.3, 100.0
# losses by load, drag, gravity: the share of the motions that have each, efficiencies
LOSS_SHARE, PLAY_SHARE, EFFICIENCIES = 0.5, 0.3, (0.5, 0.9, 0.97, 0.99, 1.0 - 1e-12)
# names, formula and, if there is one, condition
DRAWS = {
    table: [(names.split(), *(compile(text, text, "eval") for text in texts)) for names, *texts in rows]
    for table, rows in tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")).items()
}
# of Draw, that formulas use
METHODS = ("choice", "random", "uniform", "randint", "decades", "between")
# averaged under a torque: least input inertia over the inertia of the imbalances; largest one, kg m^2
LEAST_INPUT_RATIO, LARGEST_INERTIA = 8.0, 1e5
# how often each of LEVELS is drawn
WEIGHTS = (1, 3, 8, 6)
STUDIES = Path(__file__).parents[1]
HEADINGS = ("level", "invariant", "runs", "explained", "sensitive", "failed", "worst", "bound", "number")
# rows that count motions with all checks done, and accepted motions
COMPLETE, ACCEPTED = "within the work limit", "accepted"
NUMBER = re.compile(r"(?<![\w.])-?\d+(\.\d+)?(e[-+]?\d+)?")


# --- checks ---

# viscous friction of the links, the drives and the output shaft
FRICTIONS = ("input_friction", "drive_friction", "link2_friction", "output_friction")
# of the module held to the reference, and the error from which on the motion has to explain it
REFERENCE_TOLERANCE, REFERENCE_ERROR = 1e-9, 1e-7
# evaluations that the reference may take, and from which on a motion is not run again in other ways
MOST_EVALUATIONS, LONGEST = 4e3, 1e7
# with losses they take longer
MOST_WITH_LOSSES = 500
SPLIT = 7
SHAFTS = ("input", "output")
# share of the fastest speed that is rounding of the slowest
OF_FASTEST = 1e-14
INERTIAS = ("input_inertia", "link2_inertia", "output_inertia", "driven_inertia")
COMPARED = ("input_speed", "omega2", "omega_hub", "omega_out", "energy_stored")
FACTOR = 4.0  # whose powers are exact
AS_SPEED = ("omega2_start", "omega_out_start", *FRICTIONS, "housing_drag_viscous", "output_drag_viscous")
AS_TORQUE = ("housing_drag", "output_drag", "gravity")
# without losses virtual work is Lagrange's equations: so kept outcomes call it
COMPARISONS = REFERENCE, VIRTUAL_WORK = "Lagrange's equations", "virtual work"
STEPS = "long and short steps"
# parameters that make the difference
LOSSES = (
    *AS_TORQUE,
    *("mesh_efficiency", "satellite_mesh_efficiency", "journal_friction"),
    *("housing_drag_viscous", "output_drag_viscous", "housing_stiffness", "freewheel_stiffness"),
    *("housing_engagement_angle", "output_engagement_angle"),
)
# distances that a change of the problem by the tolerance makes, that two runs may be apart
EXPLAINED = 10.0
# tolerances that they may be apart where a shaft swings, as in the bound of the energy residual
SWINGING = 100.0
SENSITIVE = math.inf  # bound where the motion multiplies errors so much that no method can tell


def held(apart: float, bound: float, sensitivity: Callable[[], float]) -> Figure:
    """A distance held to a bound; beyond it also to the distance that a change of the problem makes."""
    if apart <= bound:
        return Figure(apart, bound)
    spread = sensitivity()
    wider = SENSITIVE if spread > LARGEST_ERROR else min(bound + EXPLAINED * spread, LARGEST_ERROR)
    return Figure(apart, wider, explained=apart <= wider)


def of_one_run(motion: Motion, found: Run, make: Make) -> Figures:
    """All outputs are finite, energy does not come from nowhere, freewheels neither pull nor slip back."""
    figures = {"finite": Figure(float(not found.finite), 0.0)}
    # a velocity within rounding of the fastest is zero: so much energy comes and goes
    fastest = max(found.speed, *(part.fastest for part in motion.segments))
    rounding = ROUNDING * sum(motion[name] for name in INERTIAS) * fastest**2
    beyond = motions.relative(max(found.residual - rounding, 0.0), found.energy)
    tolerance = motion["tolerance"]
    if motion.level.fidelity == AVERAGED:
        tolerance = max(tolerance, AVERAGED_TOLERANCE)
    figures["energy residual"] = Figure(beyond, energy_bound(tolerance, found.turns))
    breaches = motions.BREACHES if motion.level.fidelity in (RIGID, ELASTIC) else (motions.REGAINED,)
    return figures | {name: Figure(found.share(name), BREACH) for name in breaches}


def of_steps(motion: Motion, found: Run, make: Make) -> Figures:
    """One long communication step as many short ones, to the tolerance and what the motion makes of it."""
    if motion.level.fidelity == AVERAGED:
        return {}
    tolerance, short = motion["tolerance"], motions.run(motion, make, SPLIT)
    if short.refused or short.broken:
        return {STEPS: Figure(math.inf, 0.0)}
    # what swings far slower than the fastest speed is followed to the tolerance of that alone
    elastic = motion.level.fidelity == ELASTIC
    swinging = motion["driven_inertia"] + motion["output_inertia"] if elastic else 0.0, tolerance
    bound = (SWINGING if elastic else EXPLAINED) * tolerance + ROUNDING

    def sensitivity() -> float:
        pairs = [(found, motions.run(beside, make)) for beside in motion.nudged(tolerance)]
        # a link 2 that bounces or swings on its spring multiplies errors that none of these makes
        kick = tolerance * found.speed
        pairs += [(short, motions.run(motion, make, SPLIT, kick=one)) for one in (kick, -kick)]
        return max((motions.distance(*pair, *swinging) for pair in pairs if not pair[1].refused), default=0.0)

    return {STEPS: held(motions.distance(found, short, *swinging), bound, sensitivity)}


def of_restore(motion: Motion, found: Run, make: Make) -> Figures:
    """A saved state runs on to the same bits in another instance."""
    restored = motions.run(motion, make, saved_at=len(motion.segments) // 2)
    return {"restored state": Figure(float(restored.state != found.state), 0.0)}


def of_scaling(motion: Motion, found: Run, make: Make) -> Figures:
    """Speeds by a power of two and torques by its square: the same motion in less time, to the bit."""
    if motion.level.fidelity != RIGID:
        return {}
    square = FACTOR**2
    faster = motion.changed(
        **{name: motion[name] * FACTOR for name in AS_SPEED},
        **{name: motion[name] * square for name in AS_TORQUE},
    )
    segments = tuple(part.scaled(FACTOR, square, 1.0 / FACTOR) for part in motion.segments)
    end = motions.run(replace(faster, segments=segments), make).end
    powers = {"angle": 0, "omega2": 1, "omega_out": 1, "energy_in": 2, "energy_out": 2}
    unlike = [name for name, power in powers.items() if end.get(name) != found.end[name] * FACTOR**power]
    return {"speed scaling": Figure(float(len(unlike)), 0.0)}


def of_momentum(motion: Motion, found: Run, make: Make) -> Figures:
    """Without a housing freewheel and weights momentum changes by what drive, load and friction give."""
    if motion.level.fidelity != RIGID or motion["housing_freewheel"] or motion["gravity"]:
        return {}
    p = {**default_parameters(), **motion.parameters}
    work, momenta = VirtualWork(p), []
    for point in found.points:
        torques, _, _ = work(point["drive_angle"])
        omega1, omega2 = point["input_speed"], point["omega2"]
        link1 = motion["input_inertia"] * omega1 + float(torques[0, :2] @ [omega1, omega2])
        rest = motion["link2_inertia"] * omega2 + motion["output_inertia"] * point["omega_hub"]
        momenta.append(link1 + rest)
    turned1, turned3 = (point[f"{name}_angle"] + 2.0 * math.pi * point[f"{name}_turns"] for name in SHAFTS)
    turned2 = turned1 - found.end["angle"] / ratio(p)
    impulses = (
        found.end["input_torque_mean"],
        -sum(part.load * part.duration for part in motion.segments),
        -motion["input_friction"] * turned1,
        -motion["link2_friction"] * turned2,
        -motion["output_friction"] * turned3,
    )
    # link 2 moves by what links 1 and 2 move apart
    rounding = OF_FASTEST * sum(motion[name] for name in INERTIAS[:-1]) * found.speed
    missing = max(abs(momenta[-1] - momenta[0] - sum(impulses)) - rounding, 0.0)
    bound = energy_bound(motion["tolerance"], found.turns)
    return {"momentum": Figure(motions.relative(missing, max(map(abs, (*momenta, *impulses)))), bound)}


def _by_reference(motion: Motion, most: float) -> Array:
    """Values of COMPARED after each segment by the reference, as far as it gets with so many evaluations."""
    first, rows = motion.segments[0], []
    with np.errstate(all="ignore"), suppress(ArithmeticError, UnavailableError, np.linalg.LinAlgError):
        reference = Reference(motion.parameters, first.omega1, first.load, first.drive, most)
        for part in motion.segments:
            reference.give(part.drive, part.load)
            if motion["drive"] != DRIVE_TORQUE:
                reference.turn(part.omega1, part.slope)
            reference.advance(reference.time + part.duration)
            rows.append([*reference.state[OMEGA1 : OMEGA4 + 1], reference.energy()])
    return np.array(rows)


def of_reference(motion: Motion, found: Run, make: Make) -> Figures:
    """Agreement of speeds and energies with the independent reference, with losses or without."""
    if motion.level.fidelity not in (RIGID, ELASTIC):
        return {}
    scales = np.array([*[found.speed] * (len(COMPARED) - 1), found.energy])

    def error(one: Array) -> float:
        both = min(len(one), len(expected))
        differences = np.abs(one[:both] - expected[:both]) / np.where(scales > 0.0, scales, 1.0)
        return float(np.max(differences, initial=0.0))

    lossy = any(motion[name] != default_parameters()[name] for name in LOSSES)
    name, most = (VIRTUAL_WORK, MOST_WITH_LOSSES) if lossy else (REFERENCE, MOST_EVALUATIONS)
    expected = _by_reference(motion, most)
    if not len(expected):
        return {}
    precise = motions.run(motion.changed(tolerance=REFERENCE_TOLERANCE), make)
    if precise.refused:
        return {name: Figure(math.inf, 0.0)}
    ours = np.array([[point[name] for name in COMPARED] for point in precise.points[1:]])

    def sensitivity() -> float:
        return max(error(_by_reference(one, 2.0 * most)) for one in motion.nudged(REFERENCE_TOLERANCE))

    return {name: held(error(ours), REFERENCE_ERROR, sensitivity)}


CHECKS = (of_one_run, of_steps, of_restore, of_scaling, of_momentum, of_reference)


@dataclass(frozen=True)
class Finding:
    """Result of the checks: figures by name, or the message of a refusal; long: it was run only once."""

    figures: Figures = field(default_factory=dict)
    refused: str = ""
    long: bool = False

    @property
    def failed(self) -> list[str]:
        """Names of the figures that do not hold."""
        return list(motions.missed(self.figures))

    @property
    def causes(self) -> list[str]:
        """Names of the figures that do not hold, or the refusal without its numbers."""
        return self.failed or [NUMBER.sub("#", self.refused)] * bool(self.refused)


def examine(motion: Motion, make: Make = Module, without_reference: bool = False) -> Finding:
    """Run a motion and hold it to all that has to be. Never raises."""
    figures: Figures = {}
    try:
        found = motions.run(motion, make)
        if found.broken:
            return Finding({found.broken: Figure(1.0, 0.0)})
        if found.refused:
            return Finding(refused=found.refused)
        long = found.evaluations > LONGEST
        for check in CHECKS[: 1 if long else -1 if without_reference else None]:
            figures |= check(motion, found, make)
        return Finding(figures, long=long)
    except Exception as error:  # whatever it is, it is a finding
        return Finding(figures | {f"{type(error).__name__}: {error}": Figure(1.0, 0.0)})


# --- drawn ---


def rounded(value: float, digits: int = DIGITS) -> float:
    """The number to so many digits."""
    return float(f"{value:.{digits}g}")


class Draw(Random):
    """Random numbers of few digits."""

    def decades(self, low: float, high: float) -> float:
        """Any power of ten between as likely as any other."""
        return rounded(10.0 ** self.uniform(math.log10(low), math.log10(high)))

    def between(self, low: float, high: float) -> float:
        """Any as likely."""
        return rounded(self.uniform(low, high))


def _inertia(motion: Motion) -> float:
    """About the inertia of link 2 and the imbalances about the central axis, kg m^2."""
    planar = motion["layout"]
    length = motion["sun_radius"] + motion["satellite_radius"] if planar else motion["wheel_radius"]
    mass = motion["satellites"] * motion["modules"] * motion["imbalance_mass"]
    return mass * length**2 + motion["link2_inertia"]


def _largest_imbalance_inertia(parameters: Parameters) -> float:
    """Return about the largest inertia of imbalances, satellite gears and drives at link 1, kg m^2."""
    p = {**default_parameters(), **parameters}
    angles, _ = period(p)
    satellites = range(int(p["satellites"]))
    squares = sum(np.sum(positions(p, angles, n)[:, 1:] ** 2, axis=1) for n in satellites)
    gear = p["satellite_inertia"] + p["satellite_transverse_inertia"]
    gears = p["modules"] * p["satellites"] * gear + p["drive_inertia"]
    return float(p["modules"] * p["imbalance_mass"] * np.max(squares) + gears)


def draws(table: str, scope: dict[str, Any]) -> Parameters:
    """Draw what the rows of a table beside the code say; scope: what formulas use, and what is drawn."""
    found: Parameters = {}
    for names, formula, *condition in DRAWS[table]:
        if all(eval(one, scope) for one in condition):
            for name in names:
                scope[name] = eval(formula, scope)
                found |= {name: scope[name]} if name in BY_NAME else {}
    return found


def draw_motion(seed: int, number: int, losses: bool = False) -> Motion:
    """The motion of this number in the campaign of this seed; losses: by load, drag and gravity besides."""
    draw = Draw(f"{seed}/{number}")
    (level,) = draw.choices(motions.LEVELS, WEIGHTS)
    methods = {name: getattr(draw, name) for name in METHODS}
    scope = (
        globals() | vars(codes) | methods | {"level": level, "rough": level.fidelity != AVERAGED or losses}
    )
    motion = Motion(draws("mechanism", scope), ())
    omega, inertia = scope["omega"], _inertia(motion)
    torque, body = inertia * omega**2, inertia / (motion["satellites"] * motion["modules"])
    full = {**default_parameters(), **motion.parameters}
    rate = omega * ratio(full) * (2.0 + 2.0 * satellite_ratio(full))
    travel, segments = draw.decades(0.3, 60.0), []
    by_torque, omega1 = motion["drive"] == DRIVE_TORQUE, omega * draw.choice([1.0, 1.0, -1.0, 0.0])
    for _ in range(draw.randint(1, 6)):
        duration = rounded(travel * draw.random() / rate + 1e-9)
        load, push = (draw.choice([0.0, 1.0, 1.0, -0.5]) * draw.decades(1e-3, 1.0) * torque for _ in range(2))
        slope = 0.0 if by_torque else draw.choice([0.0, 0.0, draw.between(-1.0, 1.0)]) * omega / duration
        drive = rounded(push) if by_torque else 0.0
        load = max(-LARGEST_TORQUE, min(rounded(load), LARGEST_TORQUE))
        drive = max(-LARGEST_TORQUE, min(drive, LARGEST_TORQUE))
        segments.append(Segment(duration, rounded(omega1), load, rounded(slope), drive))
        omega1 = draw.choice([omega1, omega1, omega1 + slope * duration, omega * draw.uniform(-1.0, 1.0)])
    scope |= {"torque": torque, "rate": rate, "body": body}
    parameters = motion.parameters | draws("friction", scope)
    if losses:
        parameters |= draws("losses", scope)
    if by_torque and level.fidelity == AVERAGED:
        least = LEAST_INPUT_RATIO * _largest_imbalance_inertia(parameters)
        parameters["input_inertia"] = min(rounded(parameters["input_inertia"] + least), LARGEST_INERTIA)
    return Motion(parameters, tuple(segments))


# --- a campaign ---


@dataclass(frozen=True)
class Outcome:
    """One motion of a campaign.

    Attributes:
        number: in the campaign. level: of fidelity. finding: what it showed.
        reproducer: of one that fails or is refused all that this needs, or None.
    """

    number: int
    level: str
    finding: Finding
    reproducer: dict[str, Any] | None = None


def outcomes_file(folder: Path, seed: int, losses: bool = False) -> Path:
    """The file in a folder that keeps the outcomes of a seed with this code: a line for each, in order."""
    parts = [path for part in ("reference", "stability") for path in (STUDIES / part).glob("*.*")]
    code = sources("interface/*.py", "kernel/**/*.py", "model.py")
    code |= {path.relative_to(STUDIES).as_posix(): path.read_bytes() for path in parts}
    return folder / f"random-{'losses-' * losses}{seed}-{content_hash(code)[:8]}.jsonl"


def line_of(outcome: Outcome) -> str:
    """The outcome as a line of its file."""
    return json.dumps(asdict(outcome)) + "\n"


def read_outcomes(path: Path) -> list[Outcome]:
    """The outcomes of a file, if there is one; its last line may be cut off."""
    lines = path.read_text().splitlines(keepends=True) if path.exists() else []
    read = TypeAdapter(Outcome).validate_python
    return [read(json.loads(line)) for line in lines if line.endswith("\n")]


def shrunk(motion: Motion, wanted: str, make: Make = Module) -> Motion:
    """The motion without the segments and parameters that its cause of failure or refusal does not need."""

    def tried(segments: tuple[Segment, ...], parameters: Parameters) -> Motion:
        less = replace(motion, segments=segments, parameters=parameters)
        return less if wanted in examine(less, make, wanted not in COMPARISONS).causes else motion

    for part in motion.segments:
        if len(motion.segments) > 1:
            motion = tried(tuple(one for one in motion.segments if one is not part), motion.parameters)
    for name in motion.parameters:
        others = {other: value for other, value in motion.parameters.items() if other != name}
        motion = tried(motion.segments, others)
    return motion


def try_number(seed: int, number: int, make: Make = Module, losses: bool = False) -> Outcome:
    """Draw a motion, examine it and, where it fails or is refused, make it smaller."""
    motion = draw_motion(seed, number, losses)
    finding = examine(motion, make)
    reproducer = shrunk(motion, finding.causes[0], make).as_dict() if finding.causes else None
    return Outcome(number, motion.level.name, finding, reproducer)


def run_random(
    number: int,
    seed: int,
    folder: Path,
    report: Callable[[float], None] = lambda done: None,
    losses: bool = False,
) -> list[Outcome]:
    """The outcomes of so many random motions, on all processors; the same for the same seed.

    Each is kept in the folder (see outcomes_file): a run that was stopped goes on behind the last one.
    """
    Module().load_kernel()  # compiled once, before there are many who would
    path = outcomes_file(folder, seed, losses)
    outcomes = read_outcomes(path)
    write_text(path, "".join(map(line_of, outcomes)))
    with ProcessPoolExecutor() as pool, path.open("a") as file:
        left = range(len(outcomes), number)
        for outcome in pool.map(partial(try_number, seed, losses=losses), left, chunksize=4):
            file.write(line_of(outcome))
            file.flush()
            outcomes.append(outcome)
            report(len(outcomes) / number)
    return outcomes[:number]


def rows_of(outcomes: Sequence[Outcome]) -> list[tuple[Any, ...]]:
    """A row of HEADINGS for each level and invariant; the last of a level count what was long, or refused.

    Runs, those explained, sensitive, failed; the value next to its bound, or furthest over, and where.
    """
    rows: list[tuple[Any, ...]] = []
    for level in sorted({outcome.level for outcome in outcomes}):
        here = [outcome for outcome in outcomes if outcome.level == level]
        found: dict[str, dict[int, Figure]] = {}
        for one in here:
            for name, figure in one.finding.figures.items():
                found.setdefault(name, {})[one.number] = figure
        for name, figures in found.items():
            told = {number: figure for number, figure in figures.items() if figure.bound < SENSITIVE}
            explained = sum(figure.explained for figure in told.values())
            failed = sum(not figure.holds for figure in told.values())
            where: tuple[Any, ...] = "", "", ""
            if told:
                number, worst = max(told.items(), key=lambda one: one[1].value / max(one[1].bound, 1e-300))
                where = f"{worst.value:.0e}", f"{worst.bound:.0e}", number
            rows.append((level, name, len(figures), explained, len(figures) - len(told), failed, *where))
        for name, part in ((COMPLETE, "long"), (ACCEPTED, "refused")):
            numbers = [one.number for one in here if getattr(one.finding, part)]
            rows.append((level, name, len(here), 0, 0, len(numbers), "", "", numbers[0] if numbers else ""))
    return rows


def findings(outcomes: Iterable[Outcome]) -> list[dict[str, Any]]:
    """Each way to fail or to be refused: how often, the first motion and what reproduces it."""
    kinds: dict[tuple[str, str], list[Outcome]] = {}
    for one in outcomes:
        if one.reproducer:
            kinds.setdefault((one.level, one.finding.causes[0]), []).append(one)
    told = []
    for (level, what), (first, *others) in kinds.items():
        sentence = "; ".join(motions.missed(first.finding.figures).values()) or first.finding.refused
        where = {"number": first.number, "sentence": sentence, "reproducer": first.reproducer}
        told.append({"level": level, "what": what, "count": 1 + len(others), **where})
    return told
