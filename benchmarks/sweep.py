"""Speed of sweeps.

Of examples/reference.toml as it comes (one second in 2,000 steps, ten outputs, tolerance 1e-9) and of the same machine in
one step (one output, tolerance 1e-6) runs a second with one worker and with two, and the time of a run in this process
against that of its kernel; of a launch with engine, vehicle and closed loop the time of a run with two workers against
that alone in this process.

Run: python -m benchmarks.sweep
"""

import os
import statistics
import time

from inertia_module import current_fmu, example, load_scene
from inertia_module.driveline.closed_loop import PLANT_INPUTS
from inertia_module.fidelity.trials import kernel_time
from inertia_module.fmi.simulate import whole_steps
from inertia_module.model import Module
from inertia_module.scene.run import SceneRunner, start_of
from inertia_module.studies.axes import axes_of, grid
from inertia_module.studies.evaluation import Task, evaluate, summaries
from inertia_module.studies.workers import evaluations, pool

RUNS, LAUNCHES, ALONE = 10_000, 40, 5


def task_and_points(scene, runs):
    """The task of a scene and its points: imbalances of 0.5 to 2 kg."""
    points = grid(axes_of({"imbalance_mass": f"0.5:2:{runs}"}, scene))
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
    """Time of a run in this process, s: the median of some."""
    with SceneRunner(current_fmu()) as runner:
        figures_of = task.prepare(task.settings, runner)
        return statistics.median(row.cost for row in evaluate(figures_of, points).rows)


def time_of_kernel(scene):
    """Time that the kernel alone takes for the steps of a run with constant inputs, s: the median of some."""
    values, inputs = start_of(scene)
    module, step = Module().start(**values, **inputs), scene.run.communication_step
    given = tuple(inputs.get(name, 0.0) for name in PLANT_INPUTS)
    steps = whole_steps(scene.run.stop_time, step)
    return kernel_time(module, module.save(), [given] * steps, step)


def main():
    print(f"load average {os.getloadavg()[0]:.1f}")
    reference = load_scene(example("reference"))
    one_step = {
        "run": {"communication_step": "1 s", "outputs": ["omega_out"]},
        "accuracy": {"tolerance": 1e-6},
    }
    scenes = {
        "R1 in one step, tolerance 1e-6": (reference.replaced(**one_step), RUNS),
        "reference.toml as it comes, 2,000 steps": (reference, RUNS // 10),
    }
    for name, (scene, number) in scenes.items():
        task, points = task_and_points(scene, number)
        alone, kernel = own_time(task, points), time_of_kernel(scene)
        one, two = (measure(task, points, workers) for workers in (1, 2))
        print(
            f"{name}: {1.0 / one:.0f} runs/s with one worker, {1.0 / two:.0f} with two, {one / two:.2f} times"
            f" as many; a run alone {1e3 * alone:.2f} ms, of which the kernel {1e3 * kernel:.2f} ms"
        )
    task, points = task_and_points(load_scene(example("engine_launch")), LAUNCHES)
    alone, shared = own_time(task, points[:: LAUNCHES // ALONE]), 2.0 * measure(task, points, 2)
    print(
        f"launch: {alone:.3f} s alone, {shared:.3f} s of one of two cores in a sweep: {shared / alone:.2f} times"
    )


if __name__ == "__main__":
    main()
