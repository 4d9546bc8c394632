"""Fidelity averaged against rigid: kernel time on the urban scene, and mean speeds where the input torque is given.

The drive and load of the scene, recorded once, are played to the compiled kernel. Measured by speed.py.
"""

import math

import numpy as np

from inertia_module.common.examples import example
from inertia_module.driveline import interface_inertia
from inertia_module.fidelity.trials import kernel_time, run_in_process
from inertia_module.kernel.codes import AVERAGED, DRIVE_TORQUE, RIGID
from inertia_module.model import Module
from inertia_module.scene import load_scene

FIDELITIES = {"rigid": RIGID, "averaged": AVERAGED}
LAYOUTS = {"bevel": {}, "planar": load_scene(example("planar")).parameters()}
SHARES = (5.0, 10.0, 50.0)  # J1 over the greatest inertia the module has at its input
START = {
    "drive": DRIVE_TORQUE,
    "omega1": 100.0,
    "drive_torque": 4.0,
    "load_torque": 5.0,
    "output_inertia": 5.0,
}
ANGLES = 12  # drive angles that the rigid module starts at: its energy at the start depends on it
STEP = 0.01
BEGIN, END = 2.0, 4.0  # s, of the means


def kernel_times(scene, record):
    """Kernel time of both fidelities for the recorded inputs, in steps of the scene and of 1 s."""
    found, h = [], scene.run.communication_step
    inputs = np.column_stack([record["omega1"], record["load_torque"], 0.0 * record["omega1"]])[1:]
    for step, number in ((h, 1), (1.0, round(1.0 / h))):
        given = inputs[: len(inputs) // number * number].reshape(-1, number, 3).mean(axis=1)
        for name, fidelity in FIDELITIES.items():
            parameters = {**scene.parameters(), "fidelity": fidelity, "tolerance": scene.accuracy.tolerance}
            module = Module("compiled").start(omega1=given[0, 0], load_torque=given[0, 1], **parameters)
            taken = kernel_time(module, module.save(), given, step)
            found.append((f"{name}, steps of {step:g} s", "time", 1e6 * taken / (step * len(given)), "us"))
    return found


def figures_of_scene():
    """Kernel times, and the largest difference of the mean output speed over a second, of the largest omega1."""
    scene = load_scene(example("urban"))
    records = {
        name: run_in_process(scene.replaced(mechanism={"fidelity": fidelity}))
        for name, fidelity in FIDELITIES.items()
    }
    whole = round(1.0 / scene.run.communication_step)
    rigid, averaged = (record["omega_out"][1:].reshape(-1, whole).mean(axis=1) for record in records.values())
    largest = float(np.abs(rigid - averaged).max() / records["rigid"]["omega1"].max())
    return [
        *kernel_times(scene, records["rigid"]),
        ("averaged against rigid", "difference of mean output speed", 100.0 * largest, "%"),
    ]


def mean_speeds(parameters):
    """Mean speeds of link 1 and of the output shaft between BEGIN and END, rad/s."""
    module = Module().start(**parameters | START)
    output, angle = [], 0.0
    for n in range(round(END / STEP)):
        if n == round(BEGIN / STEP):
            angle = module["input_angle"] + 2.0 * math.pi * module["input_turns"]
        module.advance(STEP)
        if n >= round(BEGIN / STEP):
            output.append(module["omega_out"])
    turned = module["input_angle"] + 2.0 * math.pi * module["input_turns"] - angle
    return turned / (END - BEGIN), sum(output) / len(output)


def figures_by_torque():
    """Errors of the mean speeds over the inertia of link 1, the rigid ones being means over where it starts."""
    found = []
    for layout, mechanism in LAYOUTS.items():
        greatest = interface_inertia(mechanism).maximum
        for share in SHARES:
            parameters = {**mechanism, "input_inertia": share * greatest}
            averaged = mean_speeds({**parameters, "fidelity": AVERAGED})
            starts = [
                mean_speeds({**parameters, "drive_angle_start": 2.0 * math.pi * n / ANGLES})
                for n in range(ANGLES)
            ]
            rigid = np.mean(starts, axis=0)
            for name, exact, ours in zip(("omega1", "omega_out"), rigid, averaged, strict=True):
                case = f"{layout}, J1 / Phi = {share:g}"
                found.append((case, f"{name}, rigid", exact, "rad/s"))
                found.append((case, f"{name}, error of averaged", 100.0 * (ours / exact - 1.0), "%"))
    return found
