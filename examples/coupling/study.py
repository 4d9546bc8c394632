"""Engine coupled to the module: every coupling over step and inertia ratio, and the energies of a cycle.

Each part gives rows, which are written as CSV; the map is drawn too.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from examples.coupling.engine import (
    SCHEMES,
    CoupledEngine,
    Engine,
    EnginePlant,
    Ledger,
    Scheme,
    TorqueDrivenEngine,
)
from inertia_module import driveline
from inertia_module.common.errors import FmuError
from inertia_module.common.examples import example
from inertia_module.fmi.instance import Fmu
from inertia_module.fmi.results import heading, write_figure, write_rows
from inertia_module.fmi.simulate import Progress
from inertia_module.scene import Scene, load_scene
from verification.reference.cases import OMEGA1, THETA1
from verification.reference.geometry import Array
from verification.reference.motion import Reference

MAP, URBAN = "map", "urban"
# of columns of their tables
UNITS = {
    MAP: {"step": "s", "cost": "1/s"},
    URBAN: {"step": "s", "speed_error": "m/s", "cost": "1/s"}
    | dict.fromkeys(("engine", "output", "stored", "lost"), "J"),
}
# a launch lasts as long, and speeds are averaged and compared over windows, s
STOP_TIME, WINDOW = 1.0, 0.02
WINDOWS = round(STOP_TIME / WINDOW)
TOLERANCE = 1e-8
# the governor closes its loop at this rate, rad/s, on engine and module together; its integral at a quarter
_BANDWIDTH = 20.0
# of the engine: least and greatest torque, N.m
_LIMITS = driveline.EngineMap((0.0,), (200.0,), (20.0,))
# what is called unstable: the engine off its speed by this share, which no course here comes near to
_OFF = 0.9
TORQUE = "torque-driven"
# by name; None: the module is driven by torque
COUPLINGS: dict[str, Scheme | None] = {TORQUE: None, **SCHEMES}
RATIOS = (0.1, 0.3, 0.5, 1.0, 2.0, 5.0)
# 2 ms does not divide the sample time of the governor (5 ms); 10 and 20 ms are longer
STEPS = (2e-4, 5e-4, 1e-3, 2e-3, 2.5e-3, 5e-3, 1e-2, 2e-2)
# the module of it, without its car
_GIVEN = load_scene(example("urban")).parameters().items()
URBAN_MODULE = {name: value for name, value in _GIVEN if name not in ("output_inertia", "input_hold")}
# a small car's engine, kg.m2, with its flywheel; rad/s at which it idles
ENGINE_INERTIA, IDLE_SPEED = 0.15, 80.0
ENGINE_MAP = driveline.EngineMap(
    (0.0, 100.0, 200.0, 300.0, 400.0), (120.0, 150.0, 170.0, 160.0, 140.0), (10.0, 12.0, 15.0, 20.0, 25.0)
)
# of the urban cycle: by coupling the substeps of the scene's communication step
RUNS = {
    TORQUE: (4, 2, 1),
    "implicit ramp": (5, 1),
    "inertia module first ramp": (10,),
    "mean module first held": (10, 1),
    "mean jacobi held": (10, 1),
}


def governor(inertia: float) -> driveline.Governor:
    """Make a governor for what turns with the engine, its rotor included, kg.m2."""
    gain = _BANDWIDTH * inertia
    return driveline.Governor(gain, 0.25 * _BANDWIDTH * gain, sample_time=0.005)


@dataclass(frozen=True)
class CoupledCase:
    """Engine that holds its speed while the module launches the output shaft.

    Attributes:
        name: as the table calls it. parameters: of the module, those that differ from the defaults.
        speed: the governor's, also that at the start, rad/s. load_torque: N.m.
        ratio: greatest interface inertia over the inertia of the engine.
    """

    name: str
    parameters: Mapping[str, float]
    speed: float
    load_torque: float
    ratio: float

    @cached_property
    def interface(self) -> driveline.InterfaceInertia:
        """Interface inertia of the module, kg.m2."""
        return driveline.interface_inertia(self.parameters)

    def engine(self) -> Engine:
        """Make the engine at the start of the case."""
        inertia = self.interface.maximum / self.ratio
        return Engine(inertia, _LIMITS, governor(inertia + self.interface.mean), self.speed, self.speed)


# by name and greatest interface inertia over that of the engine
CASES: dict[str, Callable[[float], CoupledCase]] = {
    # module of the urban scene, launching 1 kg.m2; scene R1
    "planar": partial(CoupledCase, "planar", {**URBAN_MODULE, "output_inertia": 1.0}, 200.0, 8.0),
    "bevel": partial(CoupledCase, "bevel", {}, 100.0, 10.0),
}
planar = CASES["planar"]


# --- a launch ---


class Course(NamedTuple):
    """Speeds of a run, NaN where it did not get.

    Attributes:
        omega1: mean over each window, rad/s. omega_out: at the end of each, rad/s. work: of the engine, J.
        ledger: sums over it, if it was coupled.
    """

    omega1: Array
    omega_out: Array
    work: float
    ledger: Ledger


def one_piece(case: CoupledCase) -> Course:
    """Engine and module in one piece by the independent reference, from sample to sample of the governor."""
    engine = case.engine()
    law = engine.governor
    motion = Reference(driveline.torque_driven(case.parameters, engine.inertia), case.speed, case.load_torque)
    samples = round(WINDOW / law.sample_time)
    integral = work = 0.0
    omega1, omega_out = [], []
    for window in range(WINDOWS):
        began = motion.state[THETA1]
        for n in range(samples):
            angle, speed = motion.state[THETA1], motion.state[OMEGA1]
            torque, integral = law.sample(integral, case.speed, speed, engine.limits.limits(speed))
            motion.give(torque, case.load_torque)
            motion.advance((window * samples + n + 1) * law.sample_time)
            work += torque * (motion.state[THETA1] - angle)
        omega1.append((motion.state[THETA1] - began) / WINDOW)
        omega_out.append(motion.omega_out)
    return Course(np.array(omega1), np.array(omega_out), work, Ledger())


@contextmanager
def coupled(
    fmu_path: Path,
    scheme: Scheme | None,
    engine: Engine,
    inertia: float,
    parameters: Mapping[str, float],
    *given: Any,
    substeps: int = 1,
) -> Iterator[EnginePlant]:
    """Engine and module at their start by a scheme, or by torque; given is what Fmu takes besides.

    The scheme reckons with an interface of this inertia, kg.m2.
    """
    values = parameters if scheme is not None else driveline.torque_driven(parameters, engine.inertia)
    with Fmu(fmu_path, values, *given) as fmu:
        if scheme is None:
            yield TorqueDrivenEngine(fmu, engine, substeps)
        else:
            yield CoupledEngine(fmu, engine, scheme, inertia, substeps)


def coupled_engine(
    case: CoupledCase, scheme: Scheme | None, fmu_path: Path, tolerance: float = TOLERANCE
) -> AbstractContextManager[EnginePlant]:
    """Engine and module at the start of a case."""
    given = case.parameters, {"omega1": case.speed, "load_torque": case.load_torque}, tolerance
    return coupled(fmu_path, scheme, case.engine(), case.interface.middle, *given)


def course(
    case: CoupledCase, scheme: Scheme | None, step: float, fmu_path: Path, tolerance: float = TOLERANCE
) -> Course:
    """Run a case in equal steps, s, a whole number of them in a window (arguments of coupled_engine)."""
    omega1, omega_out = np.full(WINDOWS, math.nan), np.full(WINDOWS, math.nan)
    count = max(1, round(WINDOW / step))
    with coupled_engine(case, scheme, fmu_path, tolerance) as plant:
        engine = plant.engine
        for n in range(WINDOWS):
            angle = engine.state.angle
            try:
                for _ in range(count):
                    plant.advance(WINDOW / count)
            except (FmuError, OverflowError):
                break
            omega1[n] = (engine.state.angle - angle) / WINDOW
            if not abs(engine.speed - case.speed) < _OFF * case.speed:
                break
            (omega_out[n],) = plant.read(("omega_out",))
        return Course(omega1, omega_out, engine.state.work_in, plant.ledger)


class Trial(NamedTuple):
    """Errors of a run against the reference, what it loses and costs; errors are NaN where it is unstable.

    Attributes:
        case, ratio, scheme: what was run. step: communication step, s. stable: whether it was.
        speed_error: greatest error of the mean of omega1 over a window, relative to the engine's speed.
        output_error: the same of omega_out, relative to the greatest omega_out.
        energy_error: energy lost on the bond over the work of the engine. work_error: of that work.
        cost: see Ledger.cost, for a simulated second.
    """

    case: str
    ratio: float
    scheme: str
    step: float
    stable: bool
    speed_error: float
    output_error: float
    energy_error: float
    work_error: float
    cost: float

    @property
    def worst(self) -> float:
        """Worst of the errors of speed, output speed and energy; infinite if unstable."""
        errors = self.speed_error, self.output_error, abs(self.energy_error)
        return max(errors) if self.stable else math.inf


def trial(case: CoupledCase, name: str, step: float, reference: Course, fmu_path: Path) -> Trial:
    """Run a case by a coupling of this name in steps, s, and compare it with its reference."""
    found = course(case, COUPLINGS[name], step, fmu_path)
    errors = (
        float(np.abs(found.omega1 - reference.omega1).max()) / case.speed,
        float(np.abs(found.omega_out - reference.omega_out).max() / np.abs(reference.omega_out).max()),
        found.ledger.defect / reference.work,
        found.work / reference.work - 1.0,
        found.ledger.cost / STOP_TIME,
    )
    stable = bool(np.isfinite(found.omega_out).all())
    known = errors if stable else [math.nan] * len(errors)
    return Trial(case.name, case.ratio, name, step, stable, *known)


def coupling_map(fmu_path: Path, progress: Progress = lambda done: None, quick: bool = False) -> list[Trial]:
    """Measure all couplings over step, inertia ratio and case; quick: a corner of it."""
    names, ratios, steps = (("planar",), (0.5,), (1e-3, 5e-3)) if quick else (CASES, RATIOS, STEPS)
    rows: list[Trial] = []
    for name, ratio in itertools.product(names, ratios):
        case = CASES[name](ratio)
        reference = one_piece(case)
        for coupling, step in itertools.product(COUPLINGS, steps):
            rows.append(trial(case, coupling, step, reference, fmu_path))
            progress(len(rows) / (len(names) * len(ratios) * len(COUPLINGS) * len(steps)))
    return rows


# --- the urban cycle: engine, module and car in closed loop ---


class UrbanRun(NamedTuple):
    """Energies of a run, J, but for the shares.

    Attributes:
        scheme: name. step: communication step between engine and module, s.
        engine: work of the engine's torque. output: work on the load. lost: in the module.
        stored: gain of kinetic energy of engine, module and car.
        residual: engine - output - stored - lost, over engine.
        gross: sum of the magnitudes of what is lost on the bond in each step, over engine.
        outside: share of the time out of the tolerance of the cycle.
        speed_error: rms of the car's speed against the cycle, m/s. cost: see Ledger.cost, for a second.
    """

    scheme: str
    step: float
    engine: float
    output: float
    stored: float
    lost: float
    residual: float
    gross: float
    outside: float
    speed_error: float
    cost: float


def urban_scene() -> Scene:
    """Load the scene of the car in the urban cycle, its engine idling where it would stop."""
    return load_scene(example("urban")).replaced(controller={"minimum": f"{IDLE_SPEED} rad/s"})


def urban_run(
    scene: Scene,
    fmu_path: Path,
    name: str,
    substeps: int,
    stop_time: float | None = None,
    progress: Progress | None = None,
) -> UrbanRun:
    """Drive the cycle of urban_scene by a coupling of this name, to its end or to another time, s."""
    parameters = {**scene.parameters(), "input_hold": 0.0}
    start = driveline.initial_inputs(scene.surroundings)
    interface, speed = driveline.interface_inertia(parameters), start["omega1"]
    engine = Engine(ENGINE_INERTIA, ENGINE_MAP, governor(ENGINE_INERTIA + interface.mean), speed, speed)
    given = interface.middle, parameters, start, scene.accuracy.tolerance
    with coupled(fmu_path, COUPLINGS[name], engine, *given, substeps=substeps) as plant:
        before = plant.energy_stored
        loop = driveline.ClosedLoop(plant, scene.surroundings, ("omega_out",), scene.signal_units)
        table = loop.run(stop_time or scene.run.stop_time, progress)
        output, lost = plant.read(("energy_out", "energy_lost"))
        worked, stored = engine.state.work_in, plant.energy_stored - before
    driven, outside = table["vehicle_speed"], 0.0
    if scene.cycle is not None:
        lower, upper = scene.cycle.tolerance_band(table.time)
        outside = float(np.mean((driven < lower) | (driven > upper)))
    return UrbanRun(
        scheme=name,
        step=scene.run.communication_step / substeps,
        engine=worked,
        output=output,
        stored=stored,
        lost=lost,
        residual=(worked - output - stored - lost) / worked,
        gross=plant.ledger.defect_magnitude / worked,
        outside=outside,
        speed_error=float(np.sqrt(np.mean((driven - table["reference"]) ** 2))),
        cost=plant.ledger.cost / plant.ledger.time,
    )


def urban_runs(fmu_path: Path, progress: Progress = lambda done: None) -> list[UrbanRun]:
    """Drive all of RUNS (arguments of urban_run)."""
    scene, runs = urban_scene(), [(name, n) for name, numbers in RUNS.items() for n in numbers]

    def tell(number: int, done: float) -> None:
        progress((number + done) / len(runs))

    return [
        urban_run(scene, fmu_path, *one, progress=partial(tell, number)) for number, one in enumerate(runs)
    ]


# --- what is left of it ---

# from blue (good) to red, which the colour-blind tell apart by lightness: ColorBrewer's RdYlBu reversed
_COLOURS = ListedColormap(["#313695", "#4575b4", "#abd9e9", "#ffffbf", "#fdae61", "#d73027"], name="errors")
_BOUNDS = (1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 1.0)
_UNSTABLE = "#222222"
_NORM = BoundaryNorm(_BOUNDS, _COLOURS.N)


def map_figure(rows: Sequence[Trial]) -> Figure:
    """Draw the worst errors: couplings from top to bottom, steps within inertia ratios from left to right.

    What is unstable is black.
    """
    cases = list(dict.fromkeys(row.case for row in rows))
    schemes = list(dict.fromkeys(row.scheme for row in rows))
    columns = sorted({(row.ratio, row.step) for row in rows})
    figure = Figure(figsize=(11, 0.6 + 1.9 * len(cases)), dpi=110, layout="constrained")
    panels = list(figure.subplots(len(cases), 1, squeeze=False).flat)
    for axes, case in zip(panels, cases, strict=True):
        found = {(row.scheme, row.ratio, row.step): row.worst for row in rows if row.case == case}
        grid = np.array([[found.get((name, *column), math.inf) for column in columns] for name in schemes])
        shown = np.clip(np.ma.masked_invalid(grid), _BOUNDS[0], 0.999 * _BOUNDS[-1])
        axes.set_facecolor(_UNSTABLE)
        axes.pcolormesh(shown, cmap=_COLOURS, norm=_NORM, edgecolors="white", linewidth=0.4)
        axes.invert_yaxis()
        axes.tick_params(length=0, labelsize=6.5)
        axes.set_yticks(np.arange(len(schemes)) + 0.5, schemes)
        axes.set_xticks(np.arange(len(columns)) + 0.5, [f"{1e3 * step:g}" for _, step in columns])
        for number, (ratio, _) in enumerate(columns):
            if number == 0 or columns[number - 1][0] != ratio:
                axes.axvline(number, color="black", linewidth=1.2)
                axes.text(number + 0.1, -0.15, f"Φ/J_E = {ratio:g}", fontsize=7.5)
        axes.set_xlabel(f"communication step, ms ({case})", fontsize=8)
    bar = figure.colorbar(ScalarMappable(_NORM, _COLOURS), ax=panels, fraction=0.03, pad=0.01)
    bar.set_ticks(list(_BOUNDS))
    bar.set_ticklabels([f"{100 * bound:g} %" for bound in _BOUNDS])
    bar.ax.tick_params(labelsize=7)
    return figure


def write_part(folder: Path, name: str, rows: Sequence[Any]) -> dict[str, Path]:
    """Write the rows of a part as CSV, whole or not at all, and the picture of the map; by what they are."""
    names = [heading(column, UNITS[name].get(column, "")) for column in rows[0]._fields]
    # six digits: further ones depend on the machine
    cells = ([f"{value:.6g}" if isinstance(value, float) else value for value in row] for row in rows)
    written = {name: write_rows(folder / f"coupling_{name}.csv", names, cells)}
    if name == MAP:
        written["picture of the map"] = write_figure(folder / "coupling.png", map_figure(rows))
    return written
