"""Fidelity averaged against rigid: kernel time of the urban scene, mean speeds of the torque-driven module.

The inputs of the scene are recorded once and replayed to the compiled kernel. speed.py measures both.
"""

import math

import numpy as np

from inertia_module.common.examples import example
from inertia_module.driveline import interface_inertia
from inertia_module.fidelity.measure import run_in_process
from inertia_module.fidelity.timing import kernel_time
from inertia_module.kernel.codes import AVERAGED, DRIVE_TORQUE, RIGID
from inertia_module.model import Module
from inertia_module.scene import load_scene

FIDELITIES = {"rigid": RIGID, "averaged": AVERAGED}
LAYOUTS = {"bevel": {}, "planar": load_scene(example("planar")).parameters()}
# J1 over the maximum inertia of the module at its input
INERTIA_RATIOS = (5.0, 10.0, 50.0)
START = {
    "drive": DRIVE_TORQUE,
    "omega1": 100.0,
    "drive_torque": 4.0,
    "load_torque": 5.0,
    "output_inertia": 5.0,
}
# number of start angles of the pinion shaft, on which the energy of the rigid module depends
N_START_ANGLES = 12
STEP = 0.01
# time range of the means, s
BEGIN, END = 2.0, 4.0


def kernel_times(scene, record):
    """Measure both fidelities with the recorded inputs, in steps of the scene and of 1 s.

    Args:
        scene: Scene with its parameters and communication step.
        record: Record with omega1 (rad/s) and load_torque (N·m).

    Returns:
        List of (case, "time", kernel time in us per simulated second, "us").
    """
    rows, h = [], scene.run.communication_step
    inputs = np.column_stack([record["omega1"], record["load_torque"], 0.0 * record["omega1"]])[1:]
    for step, number in ((h, 1), (1.0, round(1.0 / h))):
        values = inputs[: len(inputs) // number * number].reshape(-1, number, 3).mean(axis=1)
        for name, fidelity in FIDELITIES.items():
            parameters = {**scene.parameters(), "fidelity": fidelity, "tolerance": scene.accuracy.tolerance}
            module = Module("compiled").start(omega1=values[0, 0], load_torque=values[0, 1], **parameters)
            time = kernel_time(module, module.save(), values, step)
            rows.append((f"{name}, steps of {step:g} s", "time", 1e6 * time / (step * len(values)), "us"))
    return rows


def measure_scene():
    """Measure kernel times of the urban scene, and the difference of mean output speeds.

    The difference is the maximum over means of one second, relative to the maximum omega1.
    """
    scene = load_scene(example("urban"))
    records = {
        name: run_in_process(scene.replaced(mechanism={"fidelity": fidelity}))
        for name, fidelity in FIDELITIES.items()
    }
    rows_per_second = round(1.0 / scene.run.communication_step)
    rigid, averaged = (
        record["omega_out"][1:].reshape(-1, rows_per_second).mean(axis=1) for record in records.values()
    )
    difference = float(np.abs(rigid - averaged).max() / records["rigid"]["omega1"].max())
    return [
        *kernel_times(scene, records["rigid"]),
        ("averaged against rigid", "difference of mean output speed", 100.0 * difference, "%"),
    ]


def mean_speeds(parameters):
    """Return the mean speeds of link 1 and of the output shaft between BEGIN and END, rad/s.

    Args:
        parameters: Parameters that differ from the defaults, by name.
    """
    module = Module().start(**parameters | START)
    output, angle = [], 0.0
    for n in range(round(END / STEP)):
        if n == round(BEGIN / STEP):
            angle = module["input_angle"] + 2.0 * math.pi * module["input_turns"]
        module.advance(STEP)
        if n >= round(BEGIN / STEP):
            output.append(module["omega_out"])
    input_turn = module["input_angle"] + 2.0 * math.pi * module["input_turns"] - angle
    return input_turn / (END - BEGIN), sum(output) / len(output)


def measure_torque_drive():
    """Measure errors of mean speeds for several inertias of link 1; rigid: means over start angles."""
    rows = []
    for layout, mechanism in LAYOUTS.items():
        max_inertia = interface_inertia(mechanism).maximum
        for ratio in INERTIA_RATIOS:
            parameters = {**mechanism, "input_inertia": ratio * max_inertia}
            averaged = mean_speeds({**parameters, "fidelity": AVERAGED})
            starts = [
                mean_speeds({**parameters, "drive_angle_start": 2.0 * math.pi * n / N_START_ANGLES})
                for n in range(N_START_ANGLES)
            ]
            rigid = np.mean(starts, axis=0)
            for name, exact, actual in zip(("omega1", "omega_out"), rigid, averaged, strict=True):
                case = f"{layout}, J1 / Phi = {ratio:g}"
                rows.append((case, f"{name}, rigid", exact, "rad/s"))
                rows.append((case, f"{name}, error of averaged", 100.0 * (actual / exact - 1.0), "%"))
    return rows
