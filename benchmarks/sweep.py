"""Sweeps of scene R1 (one second, constant inputs, tolerance 1e-6): runs a second, and where the time goes.

Run: python benchmarks/sweep.py [RUNS]
"""

import os
import sys
import time
from pathlib import Path

from inertia_module.fmu.builder import current_fmu
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
    """Runs a second, and CPU time a run, s, of this process (client, scheduler) and of the workers."""
    with pool(task, workers=workers) as client:
        list(
            evaluations(client, task.identity, points[: 200 * workers])
        )  # instances are there, batches large
        began, before = time.perf_counter(), times(client)
        rows = [row for batch in evaluations(client, task.identity, points) for row in batch.rows]
        passed, after = time.perf_counter() - began, times(client)
    assert not any(row.refused for row in rows)
    here, there = ((now - then) / len(rows) for now, then in zip(after, before, strict=True))
    return len(rows) / passed, here, there


def times(client):
    """CPU time of this process and of all workers, s."""
    return time.process_time(), sum(client.run(time.process_time).values())


def main(runs):
    scene = read_scene(SCENE, Path())
    points = grid(axes_of([f"imbalance_mass=0.5:2:{runs}"], scene))
    task = SceneTask(scene.tables, current_fmu().read_bytes())
    print(f"load average {os.getloadavg()[0]:.1f}")
    rates = {}
    for workers in (1, 2):
        rates[workers], here, there = measure(task, points, workers)
        print(
            f"{workers} workers: {rates[workers]:.0f} runs/s; CPU a run: {1e6 * here:.0f} us of client and"
            f" scheduler, {1e6 * there:.0f} us of workers; two free cores: {2.0 / (here + there):.0f} runs/s"
        )
    print(f"two workers are {rates[2] / rates[1]:.2f} times one")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000)
