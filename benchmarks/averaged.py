"""Kernel time per simulated second of fidelity averaged against rigid, on the urban scene.

The drive and load of the scene, recorded once, are played to the compiled kernel in a compiled loop:
no shell, no Python. Run: python benchmarks/averaged.py
"""

import argparse
import json
import statistics
import time
from pathlib import Path

import numba
import numpy as np

from inertia_module import compiled
from inertia_module.cli import current_fmu
from inertia_module.kernel import codes
from inertia_module.model import INERTIA_MODULE
from inertia_module.module import Module
from inertia_module.scene import load_scene, run_scene

SCENE = Path(__file__).parent.parent / "examples" / "urban.toml"
REPEATS = 7


def recorded_inputs():
    """(parameters, omega1, load torque) of the scene at its communication points."""
    scene = load_scene(SCENE)
    record = run_scene(scene, current_fmu()).record
    return scene, record["omega1"][1:], record["load_torque"][1:]


def player(operation=codes.STEP_ONLY):
    """Compiled loop: steps of h with the inputs given, from the state given."""
    entry = compiled.load()
    omega1_place, load_place = INERTIA_MODULE.place("omega1"), INERTIA_MODULE.place("load_torque")

    @numba.njit
    def play(p, d, u, x, y, w, omega1, load, h):
        for n in range(omega1.size):
            u[omega1_place] = omega1[n]
            u[load_place] = load[n]
            status = entry(operation, p.ctypes, d.ctypes, u.ctypes, x.ctypes, y.ctypes, w.ctypes, h)
            if status != 0:
                return n, status
        return omega1.size, 0

    return play


def measure(play, parameters, omega1, load, h):
    """(median kernel time per simulated second, s; output speed at the end)."""
    module = Module("compiled").start(omega1=float(omega1[0]), load_torque=float(load[0]), **parameters)
    begin = [np.array(record.numbers[:]) for record in module._records]
    times = []
    for _ in range(REPEATS + 1):
        arrays = [values.copy() for values in begin]
        start = time.perf_counter()
        done, status = play(*arrays, omega1, load, h)
        times.append(time.perf_counter() - start)
        if status:
            raise RuntimeError(f"step {done} is refused with status {status}")
    return statistics.median(times[1:]) / (omega1.size * h), arrays[4][INERTIA_MODULE.place("omega_out")]


def difference_of_means():
    """Largest difference of the mean output speed over a second between averaged and rigid, of max omega1."""
    means = {}
    fastest = 0.0
    scene = load_scene(SCENE)
    whole = round(1.0 / scene.run.communication_step)
    for fidelity in (codes.RIGID, codes.AVERAGED):
        record = run_scene(scene.replaced(mechanism={"fidelity": fidelity}), current_fmu()).record
        means[fidelity] = record["omega_out"][1:].reshape(-1, whole).mean(axis=1)
        fastest = max(fastest, float(record["omega1"].max()))
    return float(np.abs(means[codes.RIGID] - means[codes.AVERAGED]).max()) / fastest


def rows():
    scene, omega1, load = recorded_inputs()
    play = player()
    h = scene.run.communication_step
    per_second = round(1.0 / h)
    whole = omega1.size // per_second * per_second
    coarse = [series[:whole].reshape(-1, per_second).mean(axis=1) for series in (omega1, load)]
    found = []
    for label, inputs, step_size in (
        ("scene", (omega1[:whole], load[:whole]), h),
        ("1 s", coarse, 1.0),
    ):
        series = [np.ascontiguousarray(values) for values in inputs]
        costs = {}
        for name, fidelity in (("rigid", codes.RIGID), ("averaged", codes.AVERAGED)):
            parameters = {**scene.parameters(), "fidelity": fidelity, "tolerance": scene.accuracy.tolerance}
            costs[name], speed = measure(play, parameters, *series, step_size)
            found.append(
                {
                    "steps": label,
                    "step_s": step_size,
                    "fidelity": name,
                    "us_per_simulated_second": costs[name] * 1e6,
                    "ns_per_step": costs[name] * step_size * 1e9,
                    "omega_out_end": speed,
                }
            )
        found[-1]["rigid_over_averaged"] = costs["rigid"] / costs["averaged"]
    return found


def lines(found):
    """Table and sentences of the page."""
    text = [
        "| steps | fidelity | us per simulated second | ns per step | rigid over averaged |",
        "|---|---|---|---|---|",
    ]
    for row in found:
        share = f"{row['rigid_over_averaged']:.1f}" if "rigid_over_averaged" in row else ""
        text.append(
            f"| {row['step_s']:g} s | {row['fidelity']} | {row['us_per_simulated_second']:.3g} |"
            f" {row['ns_per_step']:.3g} | {share} |"
        )
    costs = [row["us_per_simulated_second"] for row in found]
    return [
        *text,
        "",
        f"Rigid in steps of the scene costs {costs[0] / costs[-1]:.0f} times averaged in steps of 1 s. Means of"
        f" the output speed over a second differ by {100 * difference_of_means():.2g} % of the largest omega1"
        " at most.",
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="print JSON")
    found = rows()
    if parser.parse_args().json:
        print(json.dumps(found, indent=2))
        return
    print("\n".join(lines(found)))


if __name__ == "__main__":
    main()
