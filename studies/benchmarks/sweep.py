"""Speed of sweeps, and where their time goes.

Of scene R1 (one second, constant inputs, tolerance 1e-6) runs a second with one worker and with two; of a launch with
engine, vehicle and closed loop the time of a run with two workers against that alone in this process.

Run: python -m studies.benchmarks.sweep [RUNS]
"""

import os
import sys
import time
from pathlib import Path

from inertia_module import current_fmu, example, load_scene
from inertia_module.jobs.axes import axes_of, grid
from inertia_module.jobs.evaluation import Task, evaluate, summaries
from inertia_module.jobs.workers import evaluations, pool
from inertia_module.scene import read_scene
from inertia_module.scene.run import SceneRunner

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
LAUNCHES, ALONE = 40, 5


def task_and_points(scene, runs):
    """The task of a scene and its points: imbalances of 0.5 to 2 kg."""
    points = grid(axes_of([f"imbalance_mass=0.5:2:{runs}"], scene))
    return Task(current_fmu().read_bytes(), scene.tables, summaries), points


def measure(task, points, workers):
    """Wall time of a run, and CPU time of it, s, of this process (client, scheduler) and of the workers."""
    with pool(task, workers=workers) as client:
        # instances are there then, and batches large
        list(evaluations(client, task.identity, points[: len(points) // 10]))
        began, before = time.perf_counter(), times(client)
        rows = [row for batch in evaluations(client, task.identity, points) for row in batch.rows]
        passed, after = time.perf_counter() - began, times(client)
    assert not any(row.refused for row in rows)
    here, there = ((now - then) / len(rows) for now, then in zip(after, before, strict=True))
    return passed / len(rows), here, there


def times(client):
    """CPU time of this process and of all workers, s."""
    return time.process_time(), sum(client.run(time.process_time).values())


def own_time(task, points):
    """Time of a run in this process, s: the mean of some."""
    with SceneRunner(current_fmu()) as runner:
        figures_of = task.prepare(task.settings, runner)
        evaluate(figures_of, points[:1])
        began = time.perf_counter()
        evaluate(figures_of, points)
        return (time.perf_counter() - began) / len(points)


def main(runs):
    print(f"load average {os.getloadavg()[0]:.1f}")
    task, points = task_and_points(read_scene(SCENE, Path()), runs)
    found = {}
    for workers in (1, 2):
        found[workers], here, there = measure(task, points, workers)
        print(
            f"R1, {workers} workers: {1.0 / found[workers]:.0f} runs/s; CPU a run: {1e6 * here:.0f} us of client"
            f" and scheduler, {1e6 * there:.0f} us of workers; two free cores: {2.0 / (here + there):.0f} runs/s"
        )
    print(f"two workers are {found[1] / found[2]:.2f} times one")
    task, points = task_and_points(load_scene(example("engine_launch")), LAUNCHES)
    alone, (wall, *_) = own_time(task, points[:: LAUNCHES // ALONE]), measure(task, points, 2)
    print(
        f"launch: {alone:.3f} s alone, {2.0 * wall:.3f} s of one of two cores in a sweep: {2.0 * wall / alone:.2f} times"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000)
