"""Speed of sweeps.

Of scene R1 (one second, constant inputs, tolerance 1e-6) runs a second with one worker and with two; of a launch with
engine, vehicle and closed loop the time of a run with two workers against that alone in this process.

Run: python -m studies.benchmarks.sweep [RUNS]
"""

import os
import sys
import time

from inertia_module import current_fmu, example, load_scene
from inertia_module.jobs.axes import axes_of, grid
from inertia_module.jobs.evaluation import Task, evaluate, summaries
from inertia_module.jobs.workers import evaluations, pool
from inertia_module.scene.run import SceneRunner

LAUNCHES, ALONE = 40, 5


def task_and_points(scene, runs):
    """The task of a scene and its points: imbalances of 0.5 to 2 kg."""
    points = grid(axes_of([f"imbalance_mass=0.5:2:{runs}"], scene))
    return Task(current_fmu().read_bytes(), scene.tables, summaries), points


def measure(task, points, workers):
    """Wall time of a run, s."""
    with pool(task, workers=workers) as client:
        # instances are there then, and batches large
        list(evaluations(client, task.identity, points[: len(points) // 10]))
        began = time.perf_counter()
        rows = [row for batch in evaluations(client, task.identity, points) for row in batch.rows]
        passed = time.perf_counter() - began
    assert not any(row.refused for row in rows)
    return passed / len(rows)


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
    settings = {
        "run": {"communication_step": "1 s", "outputs": ["omega_out"]},
        "accuracy": {"tolerance": 1e-6},
    }
    task, points = task_and_points(load_scene(example("reference")).replaced(**settings), runs)
    one, two = (measure(task, points, workers) for workers in (1, 2))
    print(
        f"R1: {1.0 / one:.0f} runs/s with one worker, {1.0 / two:.0f} with two, {one / two:.2f} times as many"
    )
    task, points = task_and_points(load_scene(example("engine_launch")), LAUNCHES)
    alone, shared = own_time(task, points[:: LAUNCHES // ALONE]), 2.0 * measure(task, points, 2)
    print(
        f"launch: {alone:.3f} s alone, {shared:.3f} s of one of two cores in a sweep: {shared / alone:.2f} times"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000)
