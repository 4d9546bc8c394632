"""Speed of sweeps: runs per second with one and with two workers, and the time of a single run.

- examples/reference.toml (1 s in 2,000 steps, ten outputs, tolerance 1e-9), and the same machine in one step
  with one output and tolerance 1e-6: runs per second, and run time in this process compared with the kernel
  time.
- A launch with engine, vehicle and closed loop: run time with two workers, and in this process.

Run: python -m benchmarks.sweep
"""

import os
import statistics
import time
from typing import Any

from inertia_module import current_fmu, example, load_scene
from inertia_module.driveline.closed_loop import PLANT_INPUTS
from inertia_module.fidelity.timing import kernel_time
from inertia_module.fmi.simulate import whole_steps
from inertia_module.model import Module
from inertia_module.scene.run import SceneRunner, initial_values
from inertia_module.studies.axes import axes_of, grid
from inertia_module.studies.evaluation import Task, evaluate, summaries
from inertia_module.studies.workers import evaluations, pool

# number of runs, of launches, and of launches in this process
N_RUNS, N_LAUNCHES, N_SINGLE_LAUNCHES = 10_000, 40, 5


def task_and_points(scene, runs):
    """Return the task of a scene and its points, imbalance masses from 0.5 to 2 kg.

    Args:
        scene: The scene.
        runs: Number of points.
    """
    points = grid(axes_of({"imbalance_mass": f"0.5:2:{runs}"}, scene))
    return Task(current_fmu().read_bytes(), scene.tables, summaries), points


def measure(task, points, workers):
    """Return the wall time per run of a sweep, s.

    Args:
        task: Task of the sweep.
        points: Points of the sweep.
        workers: Number of worker processes.
    """
    with pool(task, workers=workers) as client:
        # first a tenth of the points: afterwards the instances exist and batches are large
        list(evaluations(client, task.identity, points[: len(points) // 10]))
        start = time.perf_counter()
        rows = [row for batch in evaluations(client, task.identity, points) for row in batch.rows]
        duration = time.perf_counter() - start
    assert not any(row.refused for row in rows)
    return duration / len(rows)


def single_run_time(task, points):
    """Return the median time of a run in this process, s.

    Args:
        task: Task of the sweep.
        points: Points of the sweep.
    """
    with SceneRunner(current_fmu()) as runner:
        metrics_of = task.prepare(task.settings, runner)
        return statistics.median(row.cost for row in evaluate(metrics_of, points).rows)


def time_of_kernel(scene):
    """Return the median kernel time of a run with constant inputs, s.

    Args:
        scene: The scene.
    """
    parameters, inputs = initial_values(scene)
    module, step = Module().start(**parameters, **inputs), scene.run.communication_step
    values = tuple(inputs.get(name, 0.0) for name in PLANT_INPUTS)
    steps = whole_steps(scene.run.stop_time, step)
    return kernel_time(module, module.save(), [values] * steps, step)


def main():
    """Measure and print the speed of sweeps."""
    print(f"load average {os.getloadavg()[0]:.1f}")
    reference = load_scene(example("reference"))
    one_step: dict[str, Any] = {
        "run": {"communication_step": "1 s", "outputs": ["omega_out"]},
        "accuracy": {"tolerance": 1e-6},
    }
    scenes = {
        "R1 in one step, tolerance 1e-6": (reference.replaced(**one_step), N_RUNS),
        "reference.toml, 2,000 steps": (reference, N_RUNS // 10),
    }
    for name, (scene, number) in scenes.items():
        task, points = task_and_points(scene, number)
        single, kernel = single_run_time(task, points), time_of_kernel(scene)
        one_worker, two_workers = (measure(task, points, workers) for workers in (1, 2))
        print(
            f"{name}: {1.0 / one_worker:.0f} runs/s with one worker, {1.0 / two_workers:.0f} with two,"
            f" {one_worker / two_workers:.2f} times as many; a single run {1e3 * single:.2f} ms, of which the"
            f" kernel {1e3 * kernel:.2f} ms"
        )
    task, points = task_and_points(load_scene(example("engine_launch")), N_LAUNCHES)
    single, shared = (
        single_run_time(task, points[:: N_LAUNCHES // N_SINGLE_LAUNCHES]),
        2.0 * measure(task, points, 2),
    )
    print(
        f"launch: {single:.3f} s alone, {shared:.3f} s per core in a sweep with two workers:"
        f" {shared / single:.2f} times"
    )


if __name__ == "__main__":
    main()
