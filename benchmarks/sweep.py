"""Sweeps of scene R1 (one second, constant inputs, tolerance 1e-6): runs a second, and where the time goes.

Run: python benchmarks/sweep.py [RUNS]
"""

import os
import sys
import time
from pathlib import Path

from inertia_module.fmu.builder import current_module_fmu
from inertia_module.jobs.axes import axes_of, grid
from inertia_module.jobs.task import SceneTask
from inertia_module.jobs.workers import evaluations, pool
from inertia_module.scene import read_scene

SCENE = """
[drive]
kind = "constant"
omega1 = "100 rad/s"
[load]
kind = "torque"
torque = "10 N.m"
[run]
stop_time = "1 s"
communication_step = "1 s"
outputs = ["omega_out"]
"""


def measure(task, points, workers):
    """(runs a second, CPU time a run of this process with client and scheduler, that of a run itself), s."""
    with pool(task, workers=workers) as client:
        list(
            evaluations(client, task.identity, points[: 200 * workers])
        )  # instances are there, batches large
        began, spent = time.perf_counter(), time.process_time()
        rows = [row for batch in evaluations(client, task.identity, points) for row in batch.rows]
        passed, spent = time.perf_counter() - began, time.process_time() - spent
    assert not any(row.refused for row in rows)
    return len(rows) / passed, spent / len(rows), sum(row.cost for row in rows) / len(rows)


def main(runs):
    scene = read_scene(SCENE, Path())
    points = grid(axes_of([f"imbalance_mass=0.5:2:{runs}"], scene))
    task = SceneTask(scene.tables, current_module_fmu(Path("build")).read_bytes())
    print(f"load average {os.getloadavg()[0]:.1f}")
    rates = {}
    for workers in (1, 2):
        rates[workers], client, run = measure(task, points, workers)
        print(
            f"{workers} workers: {rates[workers]:.0f} runs/s; CPU of client and scheduler"
            f" {1e6 * client:.0f} us a run; a run takes {1e6 * run:.0f} us"
        )
    print(f"two workers are {rates[2] / rates[1]:.2f} times one")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000)
