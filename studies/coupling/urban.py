"""Where the energy goes over the urban cycle: engine, module and car in closed loop."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from inertia_module.cosimulation import Engine, EngineMap, interface_inertia, torque_driven
from inertia_module.harness.fmu import Fmu
from inertia_module.harness.simulate import Progress
from inertia_module.loops import ClosedLoop, connect, initial_inputs
from inertia_module.scene import Scene, load_scene

from .case import governor
from .trial import COUPLINGS, TORQUE, couple

SCENE = Path("examples") / "urban.toml"
# a small car's engine, kg.m2, with its flywheel
ENGINE_INERTIA = 0.15
IDLE_SPEED = 80.0
ENGINE_MAP = EngineMap(
    (0.0, 100.0, 200.0, 300.0, 400.0), (120.0, 150.0, 170.0, 160.0, 140.0), (10.0, 12.0, 15.0, 20.0, 25.0)
)
# coupling, and substeps of the scene's communication step
RUNS = (
    (TORQUE, 4),
    (TORQUE, 2),
    (TORQUE, 1),
    ("implicit ramp", 5),
    ("implicit ramp", 1),
    ("inertia module first ramp", 10),
    ("mean module first held", 10),
    ("mean module first held", 1),
    ("mean jacobi held", 10),
    ("mean jacobi held", 1),
)


@dataclass(frozen=True)
class UrbanRun:
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

    UNITS: ClassVar[dict[str, str]] = {"step": "s", "speed_error": "m/s", "cost": "1/s"} | dict.fromkeys(
        ("engine", "output", "stored", "lost"), "J"
    )

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


def urban_scene(path: Path = SCENE) -> Scene:
    """The scene of the car in the urban cycle, its engine idling where it would stop."""
    return load_scene(path).replaced(controller={"minimum": f"{IDLE_SPEED} rad/s"})


def urban_run(
    scene: Scene,
    fmu_path: Path,
    name: str,
    substeps: int,
    stop_time: float | None = None,
    progress: Progress | None = None,
) -> UrbanRun:
    """Drive the cycle.

    Args:
        scene: of urban_scene. fmu_path: of the module. name: in COUPLINGS.
        substeps: in each step of the scene.
        stop_time: s, by default that of the scene. progress: told how much is done (0 to 1).
    """
    surroundings = connect(list(scene.systems()))
    parameters = {**scene.parameters(), "input_hold": 0.0}
    start = initial_inputs(surroundings)
    interface = interface_inertia(parameters)
    speed, scheme = start["omega1"], COUPLINGS[name]
    engine = Engine(ENGINE_INERTIA, ENGINE_MAP, governor(ENGINE_INERTIA + interface.mean), speed, speed)
    if scheme is None:
        parameters = torque_driven(parameters, engine.inertia)
    with Fmu(fmu_path, parameters, start, scene.accuracy.tolerance) as fmu:
        coupled = couple(fmu, engine, scheme, interface.middle, substeps)
        before = coupled.energy_stored
        loop = ClosedLoop(coupled, surroundings, ("omega_out",), scene.signal_units)
        table = loop.run(stop_time or scene.run.stop_time, progress)
        output, lost = fmu.read(("energy_out", "energy_lost"))
        worked, stored = engine.state.work_in, coupled.energy_stored - before
    driven, outside = table["vehicle_speed"], 0.0
    if scene.cycle is not None:
        lower, upper = scene.cycle.tolerance_band(table.time)
        outside = float(np.mean((driven < lower) | (driven > upper)))
    return UrbanRun(
        name,
        scene.run.communication_step / substeps,
        worked,
        output,
        stored,
        lost,
        (worked - output - stored - lost) / worked,
        coupled.ledger.defect_magnitude / worked,
        outside,
        float(np.sqrt(np.mean((driven - table["reference"]) ** 2))),
        coupled.ledger.cost / coupled.ledger.time,
    )


def urban_runs(fmu_path: Path, scene_path: Path = SCENE, progress: Progress | None = None) -> list[UrbanRun]:
    """All of RUNS (arguments of urban_run)."""
    scene = urban_scene(scene_path)
    found = []
    for number, (name, substeps) in enumerate(RUNS):

        def report(done: float, number: int = number) -> None:
            if progress is not None:
                progress((number + done) / len(RUNS))

        found.append(urban_run(scene, fmu_path, name, substeps, progress=report))
    return found
