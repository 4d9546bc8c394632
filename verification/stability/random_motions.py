"""Random machines with random inputs, checked against the laws of mechanics and the independent reference.

Seed and number determine a machine and its inputs completely.
"""

from __future__ import annotations

import csv
import math
import statistics
import tomllib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

import numpy as np

from inertia_module.fmi import results
from inertia_module.interface.variables import (
    BY_NAME,
    ENUMERATIONS,
    LARGEST_SPEED,
    LARGEST_TORQUE,
    default_parameters,
)
from inertia_module.kernel import codes
from inertia_module.kernel.codes import AVERAGED, DRIVE_TORQUE, ELASTIC, RIGID
from inertia_module.model import Module

from ..reference.cases import OMEGA1, OMEGA4
from ..reference.geometry import Array, UnavailableError, positions, ratio, satellite_ratio
from ..reference.motion import Reference
from ..reference.virtual_work import VirtualWork, period
from . import motion as motions
from .motion import Make, Metric, Metrics, Motion, Parameters, Run, Segment
from .verdicts import (
    BREACH,
    BROKEN,
    DEGRADED,
    EXACT,
    LARGEST_ERROR,
    REJECTED,
    ROUNDING,
    SENSITIVE,
    VERDICTS,
    energy_bound,
)

# significant digits of all drawn numbers
DIGITS = 5
# fractions of the machines with friction, with each loss, and with an engagement angle of each freewheel
FRICTION_SHARE, LOSS_SHARE, ANGLE_SHARE = 0.3, 0.5, 0.3
EFFICIENCIES = (0.8, 0.9, 0.97, 0.99, 1.0 - 1e-12)
# draws: names, formula and, if there is one, condition
DRAWS = {
    table: [(names.split(), *(compile(text, text, "eval") for text in texts)) for names, *texts in rows]
    for table, rows in tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")).items()
}
# methods of Draw in the formulas
METHODS = ("choice", "random", "uniform", "randint", "decades", "between")
# averaged, torque-driven: minimum inertia of link 1 relative to the inertia of the unbalanced masses
INPUT_INERTIA_RATIO = 8.0
# weights of motions.LEVELS
WEIGHTS = (1, 3, 8, 6)

# --- checks ---

# averaged integrates speeds to 1e-4 of the maximum speed and energies to a tenth of that
AVERAGED_TOLERANCE = 1e-5
FRICTIONS = ("input_friction", "drive_friction", "link2_friction", "output_friction")
# tolerance of the module for the comparison with the reference, and bound of the relative error
REFERENCE_TOLERANCE, REFERENCE_ERROR = 1e-9, 1e-7
# limit of the right-hand-side evaluations of the reference
MAX_EVALUATIONS = 5000
# factors of the durations if the reference needs more evaluations; each multiplies the last one
SHORTENED = (0.1, 0.1, 0.1)
# short communication steps for each long one
SPLIT = 7
SHAFTS = ("input", "output")
# round-off of a speed, relative to the maximum speed
SPEED_ROUNDING = 1e-14
INERTIAS = ("input_inertia", "link2_inertia", "output_inertia", "driven_inertia")
COMPARED = ("input_speed", "omega2", "omega_hub", "omega_out", "energy_stored")
# factor of the speeds in the check of the scaling; a power of two causes no round-off
SPEED_FACTOR = 4.0
SCALE_WITH_SPEED = (
    "omega2_start",
    "omega_out_start",
    *FRICTIONS,
    "housing_drag_viscous",
    "output_drag_viscous",
)
SCALE_WITH_TORQUE = ("housing_drag", "output_drag", "gravity")
REFERENCE = "independent reference"
STEPS = "long and short steps"
# bounds of differences between two runs: multiples of the sensitivity, of the tolerance (rigid, elastic)
SENSITIVITY_FACTOR, STEPS_FACTOR, ELASTIC_STEPS_FACTOR = 10.0, 10.0, 100.0


def widened(error: float, bound: float, sensitivity: Callable[[], float]) -> Metric:
    """Return an error with its bound, which the sensitivity widens if the error exceeds it.

    Args:
        error: relative error.
        bound: plain bound.
        sensitivity: function that computes the sensitivity of the motion; above LARGEST_ERROR no method can
            decide which result is right, and the bound becomes infinite.
    """
    if error <= bound:
        return Metric(error, bound)
    spread = sensitivity()
    wide = math.inf if spread > LARGEST_ERROR else min(bound + SENSITIVITY_FACTOR * spread, LARGEST_ERROR)
    return Metric(error, wide, is_explained=error <= wide)


def check_run(motion: Motion, result: Run, make: Make) -> Metrics:
    """Check finite outputs, energy balance and freewheel conditions of a run.

    Args:
        motion: parameters and inputs.
        result: the run.
        make: function that returns a new module.
    """
    metrics = {"finite": Metric(float(not result.is_finite), 0.0)}
    fastest = max(result.speed, *(segment.max_speed for segment in motion.segments))
    rounding = ROUNDING * sum(motion[name] for name in INERTIAS) * fastest**2
    residual = motions.relative(max(result.residual - rounding, 0.0), result.energy)
    tolerance = motion["tolerance"]
    if motion.level.fidelity == AVERAGED:
        tolerance = max(tolerance, AVERAGED_TOLERANCE)
    metrics["energy residual"] = Metric(residual, energy_bound(tolerance, result.turns))
    has_pulses = motion.level.fidelity in (RIGID, ELASTIC)
    conditions = motions.CONDITIONS if has_pulses else (motions.REGAINED,)
    return metrics | {name: Metric(result.relative_breach(name), BREACH) for name in conditions}


def check_steps(motion: Motion, result: Run, make: Make) -> Metrics:
    """Compare long communication steps with short ones (not averaged).

    Args:
        motion: parameters and inputs.
        result: the run in long steps.
        make: function that returns a new module.
    """
    if motion.level.fidelity == AVERAGED:
        return {}
    tolerance, short = motion["tolerance"], motions.run(motion, make, SPLIT)
    if short.rejection or short.fault:
        return {STEPS: Metric(math.inf, 0.0)}
    # the error of a slow oscillation of the shaft is relative to the maximum speed
    is_elastic = motion.level.fidelity == ELASTIC
    inertia = motion["driven_inertia"] + motion["output_inertia"] if is_elastic else 0.0
    bound = (ELASTIC_STEPS_FACTOR if is_elastic else STEPS_FACTOR) * tolerance + ROUNDING

    def sensitivity() -> float:
        pairs = [(result, motions.run(perturbed, make)) for perturbed in motion.perturbed(tolerance)]
        # no change of the inputs causes the errors that a bouncing link 2 amplifies
        kick = tolerance * result.speed
        pairs += [(short, motions.run(motion, make, SPLIT, kick=one_kick)) for one_kick in (kick, -kick)]
        distances = (motions.distance(*pair, inertia, tolerance) for pair in pairs if not pair[1].rejection)
        return max(distances, default=0.0)

    return {STEPS: widened(motions.distance(result, short, inertia, tolerance), bound, sensitivity)}


def check_restored_state(motion: Motion, result: Run, make: Make) -> Metrics:
    """Check that another instance continues a saved state with identical bits.

    Args:
        motion: parameters and inputs.
        result: the run of one instance.
        make: function that returns a new module.
    """
    restored = motions.run(motion, make, saved_at=len(motion.segments) // 2)
    return {"restored state": Metric(float(restored.state != result.state), 0.0)}


def check_scaling(motion: Motion, result: Run, make: Make) -> Metrics:
    """Check that speeds times 4 and torques times 16 give the same motion with identical bits (rigid).

    Args:
        motion: parameters and inputs.
        result: the run with the original speeds.
        make: function that returns a new module.
    """
    if motion.level.fidelity != RIGID:
        return {}
    square = SPEED_FACTOR**2
    faster = motion.changed(
        **{name: motion[name] * SPEED_FACTOR for name in SCALE_WITH_SPEED},
        **{name: motion[name] * square for name in SCALE_WITH_TORQUE},
    )
    segments = tuple(segment.scaled(SPEED_FACTOR, square, 1.0 / SPEED_FACTOR) for segment in motion.segments)
    if not is_in_range(faster.parameters, segments):
        return {}
    end = motions.run(replace(faster, segments=segments), make).end
    powers = {"angle": 0, "omega2": 1, "omega_out": 1, "energy_in": 2, "energy_out": 2}
    different = [n for n, power in powers.items() if end.get(n) != result.end[n] * SPEED_FACTOR**power]
    return {"speed scaling": Metric(float(len(different)), 0.0)}


def is_in_range(parameters: Parameters, segments: Iterable[Segment]) -> bool:
    """Return True if parameters and inputs are in their ranges.

    Args:
        parameters: parameters by name.
        segments: inputs.
    """
    return all(BY_NAME[name].accepts(float(value)) for name, value in parameters.items()) and all(
        segment.max_speed <= LARGEST_SPEED and max(abs(segment.load), abs(segment.drive)) <= LARGEST_TORQUE
        for segment in segments
    )


def check_momentum(motion: Motion, result: Run, make: Make) -> Metrics:
    """Compare the change of the momentum with the impulses (rigid, without housing freewheel).

    Args:
        motion: parameters and inputs.
        result: the run.
        make: function that returns a new module.
    """
    if (
        motion.level.fidelity != RIGID
        or motion["housing_freewheel"]
        or motion["gravity"]
        or motion["windage"]
    ):
        return {}
    p = {**default_parameters(), **motion.parameters}
    work, momenta = VirtualWork(p), []
    for point in result.points:
        torques, _, _ = work(point["drive_angle"])
        omega1, omega2 = point["input_speed"], point["omega2"]
        link1 = motion["input_inertia"] * omega1 + float(torques[0, :2] @ [omega1, omega2])
        others = motion["link2_inertia"] * omega2 + motion["output_inertia"] * point["omega_hub"]
        momenta.append(link1 + others)
    angle1, angle3 = (point[f"{name}_angle"] + 2.0 * math.pi * point[f"{name}_turns"] for name in SHAFTS)
    angle2 = angle1 - result.end["angle"] / ratio(p)
    impulses = (
        result.end["input_torque_mean"],
        -sum(segment.load * segment.duration for segment in motion.segments),
        -motion["input_friction"] * angle1,
        -motion["link2_friction"] * angle2,
        -motion["output_friction"] * angle3,
    )
    rounding = SPEED_ROUNDING * sum(motion[name] for name in INERTIAS[:-1]) * result.speed
    difference = max(abs(momenta[-1] - momenta[0] - sum(impulses)) - rounding, 0.0)
    bound = energy_bound(motion["tolerance"], result.turns)
    return {"momentum": Metric(motions.relative(difference, max(map(abs, (*momenta, *impulses)))), bound)}


def reference_values(motion: Motion, max_evaluations: float) -> Array:
    """Return COMPARED after each segment by the reference, (segments, 5), until the evaluations end.

    Args:
        motion: parameters and inputs.
        max_evaluations: limit of the evaluations.
    """
    first, rows = motion.segments[0], []
    with np.errstate(all="ignore"), suppress(ArithmeticError, UnavailableError, np.linalg.LinAlgError):
        reference = Reference(motion.parameters, first.omega1, first.load, first.drive, max_evaluations)
        for segment in motion.segments:
            reference.set_torques(segment.drive, segment.load)
            if motion["drive"] != DRIVE_TORQUE:
                reference.set_speed(segment.omega1, segment.slope)
            reference.advance(reference.time + segment.duration)
            rows.append([*reference.state[OMEGA1 : OMEGA4 + 1], reference.energy()])
    return np.array(rows)


def motion_for_reference(motion: Motion) -> tuple[Motion, Array]:
    """Return the motion and its values by the reference, (segments, 5).

    If the reference does not reach the end of the first segment, all segments are shortened.

    Args:
        motion: parameters and inputs.
    """
    expected = reference_values(motion, MAX_EVALUATIONS)
    for factor in SHORTENED:
        if len(expected):
            break
        segments = tuple(replace(part, duration=factor * part.duration) for part in motion.segments)
        motion = replace(motion, segments=segments)
        expected = reference_values(motion, MAX_EVALUATIONS)
    return motion, expected


def check_reference(motion: Motion, result: Run, make: Make) -> Metrics:
    """Compare speeds and stored energy with the independent reference (rigid, elastic).

    Args:
        motion: parameters and inputs.
        result: a run.
        make: function that returns a new module.
    """
    if motion.level.fidelity not in (RIGID, ELASTIC):
        return {}
    motion, expected = motion_for_reference(motion)
    precise = motions.run(motion.changed(tolerance=REFERENCE_TOLERANCE), make)
    if precise.rejection:
        return {REFERENCE: Metric(math.inf, 0.0)}
    if not len(expected):
        return {}
    # the energy of a mechanism at rest is round-off
    least = REFERENCE_TOLERANCE * sum(motion[name] for name in INERTIAS) * precise.speed**2
    scales = np.array([*[precise.speed] * (len(COMPARED) - 1), max(precise.energy, least)])

    def error(values: Array) -> float:
        count = min(len(values), len(expected))
        differences = np.abs(values[:count] - expected[:count]) / np.where(scales > 0.0, scales, 1.0)
        return float(np.max(differences, initial=0.0))

    def sensitivity() -> float:
        perturbed = motion.perturbed(REFERENCE_TOLERANCE)
        return max(error(reference_values(one_motion, 2.0 * MAX_EVALUATIONS)) for one_motion in perturbed)

    values = np.array([[point[name] for name in COMPARED] for point in precise.points[1:]])
    return {REFERENCE: widened(error(values), REFERENCE_ERROR, sensitivity)}


CHECKS = (check_run, check_steps, check_restored_state, check_scaling, check_momentum, check_reference)


@dataclass(frozen=True)
class Finding:
    """Result of all checks of a motion.

    Attributes:
        metrics: metrics by name.
        rejection: message of the rejection, or "".
        fault: message of a fault or of an exception, or "".
    """

    metrics: Metrics = field(default_factory=dict)
    rejection: str = ""
    fault: str = ""

    @property
    def failed(self) -> list[str]:
        """Fault and names of the metrics that exceed their bounds."""
        return [self.fault] * bool(self.fault) + list(motions.violations(self.metrics))

    @property
    def verdict(self) -> str:
        """One of the verdicts of the extremes; sensitive if only the sensitivity explains the error."""
        if self.fault:
            return BROKEN
        if self.rejection:
            return REJECTED
        if self.failed:
            return DEGRADED
        is_explained = REFERENCE in self.metrics and self.metrics[REFERENCE].value > REFERENCE_ERROR
        return SENSITIVE if is_explained else EXACT


def examine(motion: Motion, make: Make = Module, with_reference: bool = True) -> Finding:
    """Run a motion and check it. Never raises.

    Args:
        motion: parameters and inputs.
        make: function that returns a new module.
        with_reference: False to omit the comparison with the reference, which takes the most time.
    """
    metrics: Metrics = {}
    try:
        result = motions.run(motion, make)
        if result.rejection or result.fault:
            return Finding(rejection=result.rejection, fault=result.fault)
        for check in CHECKS if with_reference else CHECKS[:-1]:
            metrics |= check(motion, result, make)
        return Finding(metrics)
    except Exception as error:  # every exception is a finding
        return Finding(metrics, fault=f"{type(error).__name__}: {error}")


# --- draws ---


def rounded(value: float, digits: int = DIGITS) -> float:
    """Return a number with few significant digits.

    Args:
        value: a number.
        digits: number of significant digits.
    """
    return float(f"{value:.{digits}g}")


class Draw(Random):
    """Random numbers with few digits."""

    def decades(self, low: float, high: float) -> float:
        """Return a number from a log-uniform distribution.

        Args:
            low: minimum.
            high: maximum.
        """
        return rounded(10.0 ** self.uniform(math.log10(low), math.log10(high)))

    def between(self, low: float, high: float) -> float:
        """Return a number from a uniform distribution.

        Args:
            low: minimum.
            high: maximum.
        """
        return rounded(self.uniform(low, high))


def limited(name: str, value: float) -> float:
    """Return a value, limited to the range of a variable.

    Args:
        name: name of the variable.
        value: value in the unit of the variable.
    """
    low, high = BY_NAME[name].ends
    return type(value)(min(max(value, low), high))


def _output_inertia(motion: Motion) -> float:
    """Estimate the inertia of link 2 and the unbalanced masses about the central axis, kg m^2.

    Args:
        motion: a motion.
    """
    is_planar = motion["layout"]
    length = motion["sun_radius"] + motion["satellite_radius"] if is_planar else motion["wheel_radius"]
    mass = motion["satellites"] * motion["modules"] * motion["imbalance_mass"]
    return mass * length**2 + motion["link2_inertia"]


def _max_imbalance_inertia(parameters: Parameters) -> float:
    """Estimate the maximum inertia of unbalanced masses, satellites and pinion shafts at link 1, kg m^2.

    Args:
        parameters: parameters by name.
    """
    p = {**default_parameters(), **parameters}
    angles, _ = period(p)
    satellites = range(int(p["satellites"]))
    squares = sum(np.sum(positions(p, angles, n)[:, 1:] ** 2, axis=1) for n in satellites)
    gear = p["satellite_inertia"] + p["satellite_transverse_inertia"]
    gears = p["modules"] * p["satellites"] * gear + p["drive_inertia"]
    return float(p["modules"] * p["imbalance_mass"] * np.max(squares) + gears)


def draw_parameters(table: str, scope: dict[str, Any]) -> Parameters:
    """Draw the rows of a table of random_motions.toml and return the parameters among them.

    Args:
        table: name of the table.
        scope: names of the formulas; receives all drawn values.
    """
    parameters: Parameters = {}
    for names, formula, *conditions in DRAWS[table]:
        if all(eval(condition, scope) for condition in conditions):
            for name in names:
                value = eval(formula, scope)
                if name in BY_NAME:
                    value = parameters[name] = limited(name, value)
                scope[name] = value
    return parameters


def _draw_segments(draw: Draw, omega: float, torque: float, rate: float, is_torque_driven: bool) -> Any:
    """Yield one to six segments of random inputs.

    Args:
        draw: random numbers.
        omega: speed scale, rad/s.
        torque: torque scale, N.m.
        rate: rate of the highest harmonic, rad/s.
        is_torque_driven: True if the input is a torque.
    """
    travel, omega1 = draw.decades(0.3, 60.0), omega * draw.choice([1.0, 1.0, -1.0, 0.0])
    for _ in range(draw.randint(1, 6)):
        duration = rounded(travel * draw.random() / rate + 1e-9)
        load, push = (draw.choice([0.0, 1.0, 1.0, -0.5]) * draw.decades(1e-3, 1.0) * torque for _ in range(2))
        slope = (
            0.0 if is_torque_driven else draw.choice([0.0, 0.0, draw.between(-1.0, 1.0)]) * omega / duration
        )
        drive = limited("drive_torque", rounded(push)) if is_torque_driven else 0.0
        load = limited("load_torque", rounded(load))
        yield Segment(duration, rounded(omega1), load, rounded(slope), drive)
        omega1 = draw.choice([omega1, omega1, omega1 + slope * duration, omega * draw.uniform(-1.0, 1.0)])


def draw_motion(seed: int, number: int, losses: bool = True) -> Motion:
    """Draw a random machine with its inputs.

    Args:
        seed: random seed.
        number: number of the machine.
        losses: False for a machine that has no losses except viscous friction.
    """
    draw = Draw(f"{seed}/{number}")
    (level,) = draw.choices(motions.LEVELS, WEIGHTS)
    methods = {name: getattr(draw, name) for name in METHODS}
    scope = globals() | vars(codes) | methods | {"level": level}
    scope["may_have_friction"] = losses or level.fidelity != AVERAGED
    motion = Motion(draw_parameters("mechanism", scope), ())
    omega, inertia = scope["omega"], _output_inertia(motion)
    torque = inertia * omega**2
    full = {**default_parameters(), **motion.parameters}
    rate = omega * ratio(full) * (2.0 + 2.0 * satellite_ratio(full))
    is_torque_driven = motion["drive"] == DRIVE_TORQUE
    segments = tuple(_draw_segments(draw, omega, torque, rate, is_torque_driven))
    scope |= {"torque": torque, "body_inertia": inertia / (motion["satellites"] * motion["modules"])}
    parameters = motion.parameters | draw_parameters("friction", scope)
    if losses:
        parameters |= draw_parameters("losses", scope)
    if is_torque_driven and level.fidelity == AVERAGED:
        minimum = INPUT_INERTIA_RATIO * _max_imbalance_inertia(parameters)
        parameters["input_inertia"] = limited("input_inertia", rounded(parameters["input_inertia"] + minimum))
    return Motion(parameters, segments)


# --- the table of the random machines ---


class Row(NamedTuple):
    """Result of a random machine.

    Attributes:
        number: number of the machine.
        level: fidelity level.
        layout: layout.
        drive: input at link 1, speed or torque.
        verdict: one of the verdicts of the extremes.
        error: relative error against the reference with two digits, or "" without a comparison.
        reason: failed checks, or message of the rejection.
    """

    number: int
    level: str
    layout: str
    drive: str
    verdict: str
    error: str
    reason: str


def examine_number(seed: int, number: int) -> Row:
    """Draw a machine and examine it.

    Args:
        seed: random seed.
        number: number of the machine.
    """
    motion = draw_motion(seed, number)
    finding = examine(motion)
    error = f"{finding.metrics[REFERENCE].value:.1e}" if REFERENCE in finding.metrics else ""
    layout, drive = (ENUMERATIONS[name.title()][int(motion[name])][0] for name in ("layout", "drive"))
    reason = finding.rejection or ", ".join(finding.failed)
    return Row(number, motion.level.name, layout, drive, finding.verdict, error, reason)


def examine_machines(
    count: int, seed: int, workers: int | None = None, report: Callable[[float], None] = lambda _: None
) -> list[Row]:
    """Examine the first machines of a seed in several processes.

    Args:
        count: number of machines.
        seed: random seed.
        workers: number of processes; None for one per processor.
        report: function that receives the completed fraction.
    """
    Module().load_kernel()  # compile it before the processes start
    rows = []
    with ProcessPoolExecutor(workers) as pool:
        for row in pool.map(partial(examine_number, seed), range(count), chunksize=4):
            rows.append(row)
            report(len(rows) / count)
    return rows


def write_rows(path: Path, rows: Iterable[Row]) -> Path:
    """Write rows as CSV and return the path.

    Args:
        path: path of the file.
        rows: rows of the table.
    """
    return results.write_rows(path, Row._fields, rows)


def read_rows(path: Path) -> list[Row]:
    """Read the rows of a file.

    Args:
        path: path of a file by write_rows.
    """

    def read() -> Iterator[Row]:
        for line in csv.DictReader(path.read_text(encoding="utf-8").splitlines()):
            yield Row(int(line.pop("number")), **line)

    return list(read())


def counts(rows: Iterable[Row]) -> list[tuple[Any, ...]]:
    """Return a row for each fidelity level.

    A row contains the level, the number of machines, of each of VERDICTS, and of the machines that the
    reference judged, their median and their maximum error.

    Args:
        rows: rows of the table.
    """
    groups: dict[str, list[Row]] = {level.name: [] for level in motions.LEVELS}
    for row in rows:
        groups[row.level].append(row)
    table = []
    for level, group in groups.items():
        count = Counter(row.verdict for row in group)
        errors = [float(row.error) for row in group if row.error]
        figures = (
            (f"{value:.0e}" for value in (statistics.median(errors), max(errors))) if errors else ("", "")
        )
        table.append((level, len(group), *(count[name] for name in VERDICTS), len(errors), *figures))
    return table
