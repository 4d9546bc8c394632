"""Fidelity averaged against rigid: kernel time on the urban scene, and mean speeds where the input torque is given.

The drive and load of the scene, recorded once, are played to the compiled kernel: no shell, no loop of the scene.
Run: python benchmarks/averaged.py
"""

import math
from pathlib import Path

import numpy as np
from figures import PLANAR

from inertia_module.cosimulation.interface import interface_inertia
from inertia_module.kernel.codes import AVERAGED, DRIVE_TORQUE, RIGID
from inertia_module.module import Module
from inertia_module.scene import load_scene
from inertia_module.studies.scene_run import run_in_process
from inertia_module.studies.timing import kernel_time

SCENE = Path(__file__).parent.parent / "examples" / "urban.toml"
FIDELITIES = {"rigid": RIGID, "averaged": AVERAGED}
LAYOUTS = {"bevel": {}, "planar": PLANAR}
SHARES = (0.5, 1.0, 2.0, 5.0, 10.0, 50.0)  # J1 over the greatest inertia the module has at its input
START = {"drive": DRIVE_TORQUE, "omega1": 100.0, "drive_torque": 4.0, "load_torque": 5.0}
STEP = 0.01
BEGIN, END = 2.0, 4.0  # s, of the means


def kernel_times(scene, record):
    """Kernel time of both fidelities for the recorded inputs, in steps of the scene and of 1 s."""
    found = []
    h = scene.run.communication_step
    per_second = round(1.0 / h)
    inputs = np.array([record["omega1"][1:], record["load_torque"][1:]])
    inputs = inputs[:, : inputs.shape[1] // per_second * per_second]
    coarse = inputs.reshape(2, -1, per_second).mean(axis=2)
    for step, given in ((h, inputs), (1.0, coarse)):
        rows = [(omega1, load, 0.0) for omega1, load in given.T.tolist()]
        for name, fidelity in FIDELITIES.items():
            parameters = {**scene.parameters(), "fidelity": fidelity, "tolerance": scene.accuracy.tolerance}
            module = Module("compiled").start(omega1=rows[0][0], load_torque=rows[0][1], **parameters)
            begin = module.save()
            for module.inputs.omega1, module.inputs.load_torque, _ in rows:
                module.advance(step)
            taken = kernel_time(module, begin, rows, step, patience=5.0)
            found.append((f"{name}, steps of {step:g} s", "time", 1e6 * taken / (step * len(rows)), "us"))
    return found


def figures_of_scene():
    """Kernel times, and the largest difference of the mean output speed over a second, of the largest omega1."""
    scene = load_scene(SCENE)
    records = {
        name: run_in_process(scene.replaced(mechanism={"fidelity": fidelity})).record
        for name, fidelity in FIDELITIES.items()
    }
    whole = round(1.0 / scene.run.communication_step)
    rigid, averaged = (record["omega_out"][1:].reshape(-1, whole).mean(axis=1) for record in records.values())
    largest = float(np.abs(rigid - averaged).max() / records["rigid"]["omega1"].max())
    return [
        *kernel_times(scene, records["rigid"]),
        ("averaged against rigid", "difference of mean output speed", 100.0 * largest, "%"),
    ]


def mean_speeds(fidelity, parameters):
    """Mean speeds of link 1 and of the output shaft between BEGIN and END, rad/s."""
    module = Module().start(**START, **parameters, fidelity=fidelity)
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
    """Errors of the mean speeds over the inertia of link 1: the averaged map is that of constant omega1."""
    found = []
    for layout, mechanism in LAYOUTS.items():
        greatest = interface_inertia(mechanism).greatest
        for share in SHARES:
            parameters = {**mechanism, "input_inertia": share * greatest}
            rigid, averaged = (mean_speeds(fidelity, parameters) for fidelity in FIDELITIES.values())
            for name, exact, ours in zip(("omega1", "omega_out"), rigid, averaged, strict=True):
                case = f"{layout}, J1 / Phi = {share:g}"
                found.append((case, f"{name}, rigid", exact, "rad/s"))
                found.append((case, f"{name}, error of averaged", 100.0 * (ours / exact - 1.0), "%"))
    return found


if __name__ == "__main__":
    for row in (*figures_of_scene(), *figures_by_torque()):
        print(*row)
