"""Comparison of the couplings of an engine and the module.

The map contains the errors of every coupling over step and inertia ratio. The second part contains the
energies of a car in the urban cycle. Both are written as CSV, the map also as a figure.
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
from matplotlib.patches import Patch

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
from inertia_module.common.colours import Picture, styled
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
# units of the columns by table
UNITS = {
    MAP: {"step": "s", "cost": "1/s"},
    URBAN: {"step": "s", "speed_error": "m/s", "cost": "1/s"}
    | dict.fromkeys(("engine", "output", "stored", "lost"), "J"),
}
# duration of a launch, and of the windows over which speeds are compared, s
STOP_TIME, WINDOW = 1.0, 0.02
N_WINDOWS = round(STOP_TIME / WINDOW)
TOLERANCE = 1e-8
# bandwidth of the governor with engine and module, rad/s; the bandwidth of its integral is a quarter
_BANDWIDTH = 20.0
# torque limits of the engine, N·m
_LIMITS = driveline.EngineMap((0.0,), (200.0,), (20.0,))
# a run is unstable if the relative error of the engine speed reaches this value
_UNSTABLE_ERROR = 0.9
TORQUE = "torque-driven"
# schemes by name; None: torque-driven module
COUPLINGS: dict[str, Scheme | None] = {TORQUE: None, **SCHEMES}
RATIOS = (0.1, 0.3, 0.5, 1.0, 2.0, 5.0)
# 2 ms does not divide the sample time of the governor (5 ms); 10 and 20 ms are longer
STEPS = (2e-4, 5e-4, 1e-3, 2e-3, 2.5e-3, 5e-3, 1e-2, 2e-2)
# module of the urban scene without the car
_URBAN_PARAMETERS = load_scene(example("urban")).parameters().items()
URBAN_MODULE = {
    name: value for name, value in _URBAN_PARAMETERS if name not in ("output_inertia", "input_hold")
}
# engine of a small car: inertia with flywheel, kg·m²; idle speed, rad/s
ENGINE_INERTIA, IDLE_SPEED = 0.15, 80.0
ENGINE_MAP = driveline.EngineMap(
    (0.0, 100.0, 200.0, 300.0, 400.0), (120.0, 150.0, 170.0, 160.0, 140.0), (10.0, 12.0, 15.0, 20.0, 25.0)
)
# runs of the urban cycle: substeps of the communication step by coupling
RUNS = {
    TORQUE: (4, 2, 1),
    "implicit ramp": (5, 1),
    "inertia module first ramp": (10,),
    "mean module first held": (10, 1),
    "mean jacobi held": (10, 1),
}


def governor(inertia: float) -> driveline.Governor:
    """Make the governor of an engine.

    Args:
        inertia: Inertia of the rotor and all parts that rotate with it, kg·m².
    """
    gain = _BANDWIDTH * inertia
    return driveline.Governor(gain, 0.25 * _BANDWIDTH * gain, sample_time=0.005)


@dataclass(frozen=True)
class CoupledCase:
    """Engine at constant reference speed while the module accelerates the output shaft from rest.

    Attributes:
        name: Name in the table.
        parameters: Parameters of the module that differ from the defaults.
        speed: Reference and start speed, rad/s.
        load_torque: Load torque, N·m.
        ratio: Maximum interface inertia over the inertia of the engine.
    """

    name: str
    parameters: Mapping[str, float]
    speed: float
    load_torque: float
    ratio: float

    @cached_property
    def interface(self) -> driveline.InterfaceInertia:
        """Return the interface inertia of the module, kg·m²."""
        return driveline.interface_inertia(self.parameters)

    def engine(self) -> Engine:
        """Make the engine at the start of the case."""
        inertia = self.interface.maximum / self.ratio
        return Engine(inertia, _LIMITS, governor(inertia + self.interface.mean), self.speed, self.speed)


# functions of the inertia ratio that make a case, by name
CASES: dict[str, Callable[[float], CoupledCase]] = {
    # module of the urban scene with 1 kg·m² at the output; scene R1
    "planar": partial(CoupledCase, "planar", {**URBAN_MODULE, "output_inertia": 1.0}, 200.0, 8.0),
    "bevel": partial(CoupledCase, "bevel", {}, 100.0, 10.0),
}
planar = CASES["planar"]


# --- a launch ---


class Course(NamedTuple):
    """Speeds of a run; NaN after its end.

    Attributes:
        omega1: Mean input speed in each window, rad/s.
        omega_out: Output speed at the end of each window, rad/s.
        work: Work of the engine, J.
        ledger: Sums over the run; zero without coupling.
    """

    omega1: Array
    omega_out: Array
    work: float
    ledger: Ledger


def monolithic(case: CoupledCase) -> Course:
    """Run engine and module as one system with the independent reference.

    Args:
        case: The case.
    """
    engine = case.engine()
    law = engine.governor
    motion = Reference(driveline.torque_driven(case.parameters, engine.inertia), case.speed, case.load_torque)
    samples = round(WINDOW / law.sample_time)
    integral = work = 0.0
    omega1, omega_out = [], []
    for window in range(N_WINDOWS):
        start_angle = motion.state[THETA1]
        for n in range(samples):
            angle, speed = motion.state[THETA1], motion.state[OMEGA1]
            torque, integral = law.sample(integral, case.speed, speed, engine.limits.limits(speed))
            motion.set_torques(torque, case.load_torque)
            motion.advance((window * samples + n + 1) * law.sample_time)
            work += torque * (motion.state[THETA1] - angle)
        omega1.append((motion.state[THETA1] - start_angle) / WINDOW)
        omega_out.append(motion.omega_out)
    return Course(np.array(omega1), np.array(omega_out), work, Ledger())


@contextmanager
def coupled(
    fmu_path: Path,
    scheme: Scheme | None,
    engine: Engine,
    inertia: float,
    parameters: Mapping[str, float],
    *start: Any,
    substeps: int = 1,
) -> Iterator[EnginePlant]:
    """Start engine and module with a coupling.

    Args:
        fmu_path: FMU of the module.
        scheme: Coupling scheme; None for a torque-driven module.
        engine: The engine.
        inertia: Interface inertia that the scheme uses, kg·m².
        parameters: Parameters of the module.
        start: Inputs and tolerance of the FMU.
        substeps: Number of communication steps in each step of the plant.
    """
    values = parameters if scheme is not None else driveline.torque_driven(parameters, engine.inertia)
    with Fmu(fmu_path, values, *start) as fmu:
        if scheme is None:
            yield TorqueDrivenEngine(fmu, engine, substeps)
        else:
            yield CoupledEngine(fmu, engine, scheme, inertia, substeps)


def coupled_engine(
    case: CoupledCase, scheme: Scheme | None, fmu_path: Path, tolerance: float = TOLERANCE
) -> AbstractContextManager[EnginePlant]:
    """Start engine and module of a case.

    Args:
        case: The case.
        scheme: Coupling scheme; None for a torque-driven module.
        fmu_path: FMU of the module.
        tolerance: Relative tolerance.
    """
    start = case.parameters, {"omega1": case.speed, "load_torque": case.load_torque}, tolerance
    return coupled(fmu_path, scheme, case.engine(), case.interface.middle, *start)


def course(
    case: CoupledCase, scheme: Scheme | None, step: float, fmu_path: Path, tolerance: float = TOLERANCE
) -> Course:
    """Run a case in equal steps.

    Args:
        case: The case.
        scheme: Coupling scheme; None for a torque-driven module.
        step: Communication step, s; rounded so that a window is a whole number of steps.
        fmu_path: FMU of the module.
        tolerance: Relative tolerance.
    """
    omega1, omega_out = np.full(N_WINDOWS, math.nan), np.full(N_WINDOWS, math.nan)
    count = max(1, round(WINDOW / step))
    with coupled_engine(case, scheme, fmu_path, tolerance) as plant:
        engine = plant.engine
        for n in range(N_WINDOWS):
            angle = engine.state.angle
            try:
                for _ in range(count):
                    plant.advance(WINDOW / count)
            except (FmuError, OverflowError):
                break
            omega1[n] = (engine.state.angle - angle) / WINDOW
            if not abs(engine.speed - case.speed) < _UNSTABLE_ERROR * case.speed:
                break
            (omega_out[n],) = plant.read(("omega_out",))
        return Course(omega1, omega_out, engine.state.work_in, plant.ledger)


class Trial(NamedTuple):
    """Errors and cost of a coupled run; errors are NaN if the run is unstable.

    Attributes:
        case: Name of the case.
        ratio: Maximum interface inertia over the inertia of the engine.
        scheme: Name of the coupling.
        step: Communication step, s.
        stable: True for a stable run.
        speed_error: Maximum error of the window means of omega1, relative to the engine speed.
        output_error: Maximum error of omega_out, relative to the maximum omega_out.
        energy_error: Energy lost at the coupling over the work of the engine.
        work_error: Relative error of the work of the engine.
        cost: Cost per simulated second (see Ledger.cost).
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
    def max_error(self) -> float:
        """Return the maximum of the errors of speed, output speed and energy; infinite if unstable."""
        errors = self.speed_error, self.output_error, abs(self.energy_error)
        return max(errors) if self.stable else math.inf


def trial(case: CoupledCase, name: str, step: float, reference: Course, fmu_path: Path) -> Trial:
    """Run a case with a coupling, and compare it with the reference.

    Args:
        case: The case.
        name: Name of the coupling.
        step: Communication step, s.
        reference: Monolithic run of the case.
        fmu_path: FMU of the module.
    """
    run = course(case, COUPLINGS[name], step, fmu_path)
    errors = (
        float(np.abs(run.omega1 - reference.omega1).max()) / case.speed,
        float(np.abs(run.omega_out - reference.omega_out).max() / np.abs(reference.omega_out).max()),
        run.ledger.defect / reference.work,
        run.work / reference.work - 1.0,
        run.ledger.cost / STOP_TIME,
    )
    stable = bool(np.isfinite(run.omega_out).all())
    values = errors if stable else [math.nan] * len(errors)
    return Trial(case.name, case.ratio, name, step, stable, *values)


def coupling_map(
    fmu_path: Path, progress: Progress = lambda fraction: None, quick: bool = False
) -> list[Trial]:
    """Measure all couplings over step, inertia ratio and case.

    Args:
        fmu_path: FMU of the module.
        progress: Function called with the completed fraction, 0 to 1.
        quick: True for one case, one ratio and two steps.
    """
    names, ratios, steps = (("planar",), (0.5,), (1e-3, 5e-3)) if quick else (CASES, RATIOS, STEPS)
    rows: list[Trial] = []
    for name, ratio in itertools.product(names, ratios):
        case = CASES[name](ratio)
        reference = monolithic(case)
        for coupling, step in itertools.product(COUPLINGS, steps):
            rows.append(trial(case, coupling, step, reference, fmu_path))
            progress(len(rows) / (len(names) * len(ratios) * len(COUPLINGS) * len(steps)))
    return rows


# --- the urban cycle: engine, module and car in closed loop ---


class UrbanRun(NamedTuple):
    """Energies of a run of the urban cycle.

    Attributes:
        scheme: Name of the coupling.
        step: Communication step between engine and module, s.
        engine: Work of the engine torque, J.
        output: Work on the load, J.
        lost: Energy lost in the module, J.
        stored: Increase of the kinetic energy of engine, module and car, J.
        residual: (engine - output - stored - lost) over engine.
        gross: Sum of the magnitudes of the energy lost at the coupling in each step, over engine.
        outside: Fraction of the time outside the tolerance band of the cycle.
        speed_error: RMS error of the car speed, m/s.
        cost: Cost per simulated second (see Ledger.cost).
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
    """Load the scene of the car in the urban cycle, with an engine that idles instead of stopping."""
    return load_scene(example("urban")).replaced(controller={"minimum": f"{IDLE_SPEED} rad/s"})


def urban_run(
    scene: Scene,
    fmu_path: Path,
    name: str,
    substeps: int,
    stop_time: float | None = None,
    progress: Progress | None = None,
) -> UrbanRun:
    """Run the urban cycle with a coupling.

    Args:
        scene: Scene of urban_scene.
        fmu_path: FMU of the module.
        name: Name of the coupling.
        substeps: Number of communication steps between engine and module per step of the scene.
        stop_time: Duration, s; None for the whole cycle.
        progress: Function called with the completed fraction, 0 to 1.
    """
    parameters = {**scene.parameters(), "input_hold": 0.0}
    start = driveline.initial_inputs(scene.surroundings)
    interface, speed = driveline.interface_inertia(parameters), start["omega1"]
    engine = Engine(ENGINE_INERTIA, ENGINE_MAP, governor(ENGINE_INERTIA + interface.mean), speed, speed)
    arguments = interface.middle, parameters, start, scene.accuracy.tolerance
    with coupled(fmu_path, COUPLINGS[name], engine, *arguments, substeps=substeps) as plant:
        before = plant.energy_stored
        loop = driveline.ClosedLoop(plant, scene.surroundings, ("omega_out",), scene.signal_units)
        table = loop.run(stop_time or scene.run.stop_time, progress)
        output, lost = plant.read(("energy_out", "energy_lost"))
        work, stored = engine.state.work_in, plant.energy_stored - before
    driven, outside = table["vehicle_speed"], 0.0
    if scene.cycle is not None:
        lower, upper = scene.cycle.tolerance_band(table.time)
        outside = float(np.mean((driven < lower) | (driven > upper)))
    return UrbanRun(
        scheme=name,
        step=scene.run.communication_step / substeps,
        engine=work,
        output=output,
        stored=stored,
        lost=lost,
        residual=(work - output - stored - lost) / work,
        gross=plant.ledger.defect_magnitude / work,
        outside=outside,
        speed_error=float(np.sqrt(np.mean((driven - table["reference"]) ** 2))),
        cost=plant.ledger.cost / plant.ledger.time,
    )


def urban_runs(fmu_path: Path, progress: Progress = lambda fraction: None) -> list[UrbanRun]:
    """Run the urban cycle with all couplings of RUNS.

    Args:
        fmu_path: FMU of the module.
        progress: Function called with the completed fraction, 0 to 1.
    """
    scene, runs = urban_scene(), [(name, n) for name, numbers in RUNS.items() for n in numbers]

    def report(number: int, fraction: float) -> None:
        progress((number + fraction) / len(runs))

    return [
        urban_run(scene, fmu_path, *run, progress=partial(report, number)) for number, run in enumerate(runs)
    ]


# --- figure and tables ---

# from blue (small) to red: ColorBrewer's RdYlBu reversed, whose lightness is readable with colour blindness
_COLOURS = ListedColormap(["#313695", "#4575b4", "#abd9e9", "#ffffbf", "#fdae61", "#d73027"], name="errors")
_BOUNDS = (1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 1.0)
_UNSTABLE = "#222222"
_NORM = BoundaryNorm(_BOUNDS, _COLOURS.N)


@styled()
def map_figure(rows: Sequence[Trial]) -> Figure:
    """Draw the maximum errors of couplings (rows) over inertia ratio and step; unstable runs are black.

    Args:
        rows: Runs of coupling_map.
    """
    cases = list(dict.fromkeys(row.case for row in rows))
    schemes = list(dict.fromkeys(row.scheme for row in rows))
    columns = sorted({(row.ratio, row.step) for row in rows})
    figure = Picture(figsize=(11, 0.6 + 1.9 * len(cases)), dpi=110, layout="constrained")
    panels = list(figure.subplots(len(cases), 1, squeeze=False).flat)
    for axes, case in zip(panels, cases, strict=True):
        errors = {(row.scheme, row.ratio, row.step): row.max_error for row in rows if row.case == case}
        grid = np.array([[errors.get((name, *column), math.inf) for column in columns] for name in schemes])
        clipped = np.clip(np.ma.masked_invalid(grid), _BOUNDS[0], 0.999 * _BOUNDS[-1])
        axes.set_facecolor(_UNSTABLE)
        axes.grid(visible=False)
        axes.pcolormesh(clipped, cmap=_COLOURS, norm=_NORM, edgecolors="white", linewidth=0.4)
        axes.invert_yaxis()
        axes.tick_params(length=0, labelsize=6.5)
        axes.set_yticks(np.arange(len(schemes)) + 0.5, schemes)
        axes.set_xticks(np.arange(len(columns)) + 0.5, [f"{1e3 * step:g}" for _, step in columns])
        for number, (ratio, _) in enumerate(columns):
            if number == 0 or columns[number - 1][0] != ratio:
                axes.axvline(number, color="black", linewidth=1.2)
                axes.text(number + 0.1, -0.15, f"Φ/J_E = {ratio:g}", fontsize=7.5)
        axes.set_xlabel(f"communication step [ms], {case}", fontsize=8)
    bar = figure.colorbar(ScalarMappable(_NORM, _COLOURS), ax=panels, fraction=0.03, pad=0.01)
    bar.set_ticks(list(_BOUNDS))
    bar.set_ticklabels([f"{100 * bound:g} %" for bound in _BOUNDS])
    bar.ax.tick_params(labelsize=7)
    bar.set_label("maximum error")
    figure.legend(handles=[Patch(color=_UNSTABLE, label="unstable")], loc="outside lower right")
    return figure


def write_part(folder: Path, name: str, rows: Sequence[Any]) -> dict[str, Path]:
    """Write the rows of a part as CSV, and the figure of the map; return the paths by description.

    Args:
        folder: Output folder.
        name: MAP or URBAN.
        rows: Rows of the part.
    """
    names = [heading(column, UNITS[name].get(column, "")) for column in rows[0]._fields]
    # six digits, because further digits depend on the machine
    cells = ([f"{value:.6g}" if isinstance(value, float) else value for value in row] for row in rows)
    paths = {name: write_rows(folder / f"coupling_{name}.csv", names, cells)}
    if name == MAP:
        paths["picture of the map"] = write_figure(folder / "coupling.png", map_figure(rows))
    return paths
