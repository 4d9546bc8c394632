"""Checks of a random motion: invariants, and agreement with the independent reference."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np

from inertia_module.contract.variables import default_parameters
from inertia_module.kernel.codes import AVERAGED, DRIVE_TORQUE, ELASTIC, EVENT, RIGID, TIMESTEPPING
from inertia_module.memory import Module

from ..reference.cases import OMEGA1, OMEGA4
from ..reference.geometry import Array, Unavailable, ratio
from ..reference.motion import Reference
from ..reference.virtual_work import VirtualWork
from .extremes import TIMESTEPPING_ACCURACY
from .motion import Make, Motion, Run, distance, relative, run
from .trial import BREACH, LARGEST_ERROR, ROUNDING, Figure, Figures, energy_bound

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
INERTIAS = ("input_inertia", "link2_inertia", "output_inertia", "driven_inertia")
COMPARED = ("input_speed", "omega2", "omega_hub", "omega_out", "energy_stored")
FACTOR = 4.0  # whose powers are exact
AS_SPEED = ("omega2_start", "omega_out_start", *FRICTIONS, "housing_drag_viscous", "output_drag_viscous")
AS_TORQUE = ("housing_drag", "output_drag", "gravity")
# without losses virtual work is Lagrange's equations: so kept outcomes call it
REFERENCE, VIRTUAL_WORK, STEPS = "Lagrange's equations", "virtual work", "long and short steps"
# parameters that make the difference
LOSSES = (
    *AS_TORQUE,
    *("mesh_efficiency", "satellite_mesh_efficiency", "journal_friction"),
    *("housing_drag_viscous", "output_drag_viscous", "housing_stiffness", "freewheel_stiffness"),
)
# distances that a change of the problem by the tolerance makes, that two runs may be apart
EXPLAINED = 10.0
# tolerances that they may be apart where a shaft swings, as in the bound of the energy residual
SWINGING = 100.0
SENSITIVE = math.inf  # bound where the motion multiplies errors so much that no method can tell


def explained(apart: float, bound: float, spreads: list[float]) -> Figure:
    """A distance beyond its bound, where a change of the problem by the tolerance makes such distances."""
    spread = max(spreads, default=0.0)
    wider = SENSITIVE if spread > LARGEST_ERROR else min(bound + EXPLAINED * spread, LARGEST_ERROR)
    return Figure(apart, wider, explained=apart <= wider)


def of_one_run(motion: Motion, found: Run, make: Make) -> Figures:
    """All outputs are finite, energy does not come from nowhere, freewheels neither pull nor slip back."""
    figures = {"finite": Figure(float(not found.finite), 0.0)}
    # a velocity within rounding of the fastest is zero: so much energy comes and goes
    fastest = max(found.speed, *(part.fastest for part in motion.segments))
    rounding = ROUNDING * sum(motion[name] for name in INERTIAS) * fastest**2
    name, energy, accuracy = "energy residual", found.residual, motion["tolerance"]
    if motion.level.method == TIMESTEPPING:
        name, energy, accuracy = "energy from nowhere", found.gained, TIMESTEPPING_ACCURACY
    beyond = relative(max(energy - rounding, 0.0), found.energy)
    figures[name] = Figure(beyond, energy_bound(accuracy))
    if motion.level.fidelity in (RIGID, ELASTIC):
        figures["0 <= omega2 <= omega3"] = Figure(relative(found.reversal, found.speed), BREACH)
        figures["Th, Tc >= 0"] = Figure(relative(found.pull, found.torque), BREACH)
        power = relative(found.slipping, found.speed * found.torque)
        figures["torque or slip is 0"] = Figure(power, BREACH)
    figures["lost energy regained"] = Figure(relative(found.regained, found.energy), BREACH)
    return figures


def of_steps(motion: Motion, found: Run, make: Make) -> Figures:
    """One long communication step as many short ones, to the tolerance and what the motion makes of it."""
    if motion.level.method == TIMESTEPPING or motion.level.fidelity == AVERAGED:
        return {}
    tolerance, short = motion["tolerance"], run(motion, make, SPLIT)
    if short.refused or short.broken:
        return {STEPS: Figure(math.inf, 0.0)}
    # what swings far slower than the fastest speed is followed to the tolerance of that alone
    elastic = motion.level.fidelity == ELASTIC
    swinging = motion["driven_inertia"] if elastic else 0.0, tolerance
    bound = (SWINGING if elastic else EXPLAINED) * tolerance + ROUNDING
    apart = distance(found, short, *swinging)
    if apart <= bound:
        return {STEPS: Figure(apart, bound)}
    runs = [run(beside, make) for beside in motion.nudged(tolerance)]
    spreads = [distance(found, other, *swinging) for other in runs if not other.refused]
    return {STEPS: explained(apart, bound, spreads)}


def of_restore(motion: Motion, found: Run, make: Make) -> Figures:
    """A saved state runs on to the same bits in another instance."""
    restored = run(motion, make, saved_at=len(motion.segments) // 2)
    return {"restored state": Figure(float(restored.state != found.state), 0.0)}


def of_scaling(motion: Motion, found: Run, make: Make) -> Figures:
    """Speeds by a power of two and torques by its square: the same motion in less time, to the bit."""
    if (motion.level.fidelity, motion.level.method) != (RIGID, EVENT):
        return {}
    square = FACTOR**2
    faster = motion.changed(
        **{name: motion[name] * FACTOR for name in AS_SPEED},
        **{name: motion[name] * square for name in AS_TORQUE},
    )
    segments = tuple(part.scaled(FACTOR, square, 1.0 / FACTOR) for part in motion.segments)
    end = run(replace(faster, segments=segments), make).end
    powers = {"angle": 0, "omega2": 1, "omega_out": 1, "energy_in": 2, "energy_out": 2}
    unlike = [name for name, power in powers.items() if end.get(name) != found.end[name] * FACTOR**power]
    return {"scaling by the speed": Figure(float(len(unlike)), 0.0)}


def of_momentum(motion: Motion, found: Run, make: Make) -> Figures:
    """Without a housing freewheel and weights momentum changes by what drive, load and friction give."""
    if motion.level.fidelity != RIGID or motion["housing_freewheel"] or motion["gravity"]:
        return {}
    if motion.level.method == TIMESTEPPING and any(motion[name] for name in FRICTIONS):
        return {}  # its friction is of first order in its steps
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
    missing = momenta[-1] - momenta[0] - sum(impulses)
    bound = BREACH if motion.level.method == TIMESTEPPING else energy_bound(motion["tolerance"])
    return {"momentum": Figure(relative(missing, max(map(abs, (*momenta, *impulses)))), bound)}


def _by_reference(motion: Motion, most: float) -> Array:
    """Values of COMPARED after each segment by the reference, as far as it gets with so many evaluations."""
    first, rows = motion.segments[0], []
    with np.errstate(all="ignore"), suppress(ArithmeticError, Unavailable, np.linalg.LinAlgError):
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
    if motion.level.method != EVENT or motion.level.fidelity not in (RIGID, ELASTIC):
        return {}
    scales = np.array([*[found.speed] * (len(COMPARED) - 1), found.energy])

    def error(one: Array, other: Array) -> float:
        both = min(len(one), len(other))
        differences = np.abs(one[:both] - other[:both]) / np.where(scales > 0.0, scales, 1.0)
        return float(np.max(differences, initial=0.0))

    lossy = any(motion[name] != default_parameters()[name] for name in LOSSES)
    name, most = (VIRTUAL_WORK, MOST_WITH_LOSSES) if lossy else (REFERENCE, MOST_EVALUATIONS)
    expected = _by_reference(motion, most)
    if not len(expected):
        return {}
    precise = run(motion.changed(tolerance=REFERENCE_TOLERANCE), make)
    if precise.refused:
        return {name: Figure(math.inf, 0.0)}
    ours = np.array([[point[name] for name in COMPARED] for point in precise.points[1:]])
    apart = error(ours, expected)
    if apart <= REFERENCE_ERROR:
        return {name: Figure(apart, REFERENCE_ERROR)}
    beside = (_by_reference(other, 2.0 * most) for other in motion.nudged(REFERENCE_TOLERANCE))
    return {name: explained(apart, REFERENCE_ERROR, [error(other, expected) for other in beside])}


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
        return [name for name, figure in self.figures.items() if not figure.holds]


def examine(motion: Motion, make: Make = Module, without_reference: bool = False) -> Finding:
    """Run a motion and hold it to all that has to be. Never raises."""
    figures: Figures = {}
    try:
        found = run(motion, make)
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
