"""Launch with a real engine: how far does it sag, how soon is the car up to speed, where does the energy go?

A small engine idles in front of the module and the car stands. The driver asks for a speed; the governor may
take what the torque limits of the engine leave. While the car is slow the module takes little: its mean input
torque is the output torque times the speed ratio. As the car gains speed that outgrows the engine, which is
pulled down until module and car are locked up.

Once the engine's rotor is in the module, which is driven by torque (drive = torque) in steps of one sample of
the governor, and once the engine is coupled by its speed, implicitly, in shorter steps. Both are the same
machine: what differs is what is lost between engine and module, and what a run costs.

Run: python examples/studies/engine_launch.py    (leaves out/engine_launch/table.csv and plot.png)
"""

import time
from pathlib import Path

import numpy as np
from launch import FMU, MECHANISM

from inertia_module import loops
from inertia_module.cosimulation import (
    SCHEMES,
    CoupledEngine,
    Engine,
    EngineMap,
    Governor,
    TorqueDrivenEngine,
    torque_driven,
)
from inertia_module.harness.results import Result, write_figure
from inertia_module.harness.simulate import Fmu

INERTIA = 0.15  # kg.m2, of the engine
LIMITS = EngineMap((0.0, 100.0, 200.0, 300.0), (20.0, 30.0, 36.0, 32.0), (6.0, 8.0, 10.0, 14.0))
GOVERNOR = Governor(3.0, 12.0, sample_time=0.01)
IDLE = 80.0  # rad/s
ASKED = (150.0, 200.0, 250.0)  # rad/s, from START on over a second
START = 0.5  # s
STOP = 12.0  # s
STEP = 0.01  # s, of the loop around engine and module
SPEED = 25.0 / 3.6  # m/s, to be reached
WAYS = {"torque": 1, "implicit": 5}  # substeps of the loop's step
OUTPUTS = ("engine_speed", "engine_torque", "omega_out", "bond_defect")


def plant(way, fmu, engine):
    """Engine and module as one plant."""
    if way == "torque":
        return TorqueDrivenEngine(fmu, engine, WAYS[way])
    return CoupledEngine(fmu, engine, SCHEMES["implicit ramp"], substeps=WAYS[way])


def launch(asked, way, path=FMU):
    """The launch: (table over time, energies by name, J, seconds it took)."""
    car = loops.vehicle_load(STEP, mass=900.0, wheel_radius=0.29, final_drive=4.0, drag_area=0.65)
    wanted = loops.Table([START, START + 1.0], [IDLE, asked])
    systems = [loops.source("omega1", wanted, STEP), loops.source("brake_force", 0.0, STEP), car.system]
    surroundings = loops.connect(systems)
    engine = Engine(INERTIA, LIMITS, GOVERNOR, IDLE, IDLE)
    parameters = {**MECHANISM, "output_inertia": 0.05 + car.rigid_inertia}
    if way == "torque":
        parameters = torque_driven(parameters, INERTIA)
    with Fmu(path, parameters, loops.initial_inputs(surroundings), tolerance=1e-8) as fmu:
        coupled = plant(way, fmu, engine)
        before = coupled.energy_stored
        began = time.perf_counter()
        table = loops.ClosedLoop(coupled, surroundings, OUTPUTS).run(STOP)
        seconds = time.perf_counter() - began
        work, out, lost = coupled.read(("engine_work_in", "energy_out", "energy_lost"))
        stored = coupled.energy_stored - before
    energies = {"engine": work, "load": out + lost, "stored": stored, "missing": work - out - lost - stored}
    return table, energies, seconds


def smooth(table, width=0.2):
    """Speed of the engine without its pulses: mean over a time, s."""
    rows = round(width / STEP)
    return np.convolve(table["engine_speed"], np.full(rows, 1.0 / rows), mode="valid")


def judge(table, asked):
    """(deepest sag below what is asked after the driver's ramp, rad/s; time from START to SPEED, s)."""
    settled = round((START + 1.0) / STEP)
    there = np.flatnonzero(table["vehicle_speed"] >= SPEED)
    reached = table.time[there[0]] - START if there.size else np.inf
    return asked - smooth(table)[settled:].min(), reached


def study(fmu=FMU):
    """Rows (asked, way, sag, time to speed, energies, seconds) and the launches by (asked, way)."""
    rows, tables = [], {}
    for asked in ASKED:
        for way in WAYS:
            table, energies, seconds = launch(asked, way, fmu)
            tables[asked, way] = table
            rows.append((asked, way, *judge(table, asked), energies, seconds))
    return rows, tables


def main():
    rows, tables = study()
    print("asked   coupled    step   sag     25 km/h after   engine   load     stored   missing   run")
    print("rad/s   by         ms     rad/s   s               kJ       kJ       kJ       of work   s")
    for asked, way, sag, reached, energies, seconds in rows:
        engine, load, stored, missing = (1e-3 * value for value in energies.values())
        print(
            f"{asked:<7g} {way:<10} {1e3 * STEP / WAYS[way]:<6g} {sag:<7.2f} {reached:<15.3f} {engine:<8.2f}"
            f" {load:<8.2f} {stored:<8.2f} {missing / engine:<9.1e} {seconds:.2f}"
        )
    columns = {"time": tables[ASKED[0], "torque"].time}
    for asked in ASKED:
        columns[f"engine_{asked:g}"] = tables[asked, "torque"]["engine_speed"]
        columns[f"output_{asked:g}"] = tables[asked, "torque"]["omega_out"]
    result = Result.from_columns(columns, {name: "rad/s" for name in columns if name != "time"})
    folder = Path("out") / "engine_launch"
    print(result.to_csv(folder / "table.csv"))
    print(write_figure(folder / "plot.png", result.figure()))


if __name__ == "__main__":
    main()
