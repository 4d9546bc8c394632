"""Evaluations on the workers of dask.distributed: those of this machine, or of a cluster that exists.

What a worker needs goes there once, as a plugin, and to those that join or are started anew as well. Points
travel in batches of some tenths of a second. A batch whose worker dies is computed elsewhere; one that
kills several workers is taken apart, and the point that does it is refused.
"""

from __future__ import annotations

import contextlib
import logging
import math
import threading
import weakref
from collections import deque
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import dask
from distributed import Client, LocalCluster, Worker, WorkerPlugin, get_worker, wait
from distributed.scheduler import KilledWorker

from ..common.files import naming
from ..scene.run import SceneRunner
from .axes import Point
from .evaluation import Batch, Row, Task, evaluate

# a batch takes about so long, s, and has at most so many points
BATCH_TIME = 0.25
LARGEST_BATCH = 2000
# batches under way for each thread, so that none waits for the next
AHEAD = 3
# s without a result after which workers that are gone are looked for
PATIENCE = 5.0


class TaskPlugin(WorkerPlugin):  # type: ignore[misc]
    """A task on a worker: its FMU as a file, and what evaluates points, one for each thread."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self.name = task.identity

    def setup(self, worker: Worker) -> None:
        """Write the FMU to a file; it goes when no thread runs an instance any more."""
        self.closing = contextlib.ExitStack()
        self.path = Path(self.closing.enter_context(TemporaryDirectory())) / "Module.fmu"
        with naming(self.path):
            self.path.write_bytes(self.task.fmu)
        self.local = threading.local()
        # not teardown: where the client is gone a thread may still run an instance
        weakref.finalize(self, self.closing.close)

    def evaluate(self, points: list[Point]) -> Batch:
        """Evaluate points."""
        if not hasattr(self.local, "figures_of"):
            runner = self.closing.enter_context(SceneRunner(self.path))
            self.local.figures_of = self.task.prepare(self.task.settings, runner)
        return evaluate(self.local.figures_of, points)


def _evaluated_here(name: str, points: list[Point]) -> Batch:
    """Evaluate points on this worker."""
    plugin: TaskPlugin = get_worker().plugins[name]
    return plugin.evaluate(points)


@contextlib.contextmanager
def pool(task: Task, scheduler: str | None = None, workers: int | None = None) -> Iterator[Client]:
    """Connect a client whose workers know a task.

    Args:
        task: what is evaluated. scheduler: address of one that runs; without it a cluster of processes is
            started on this machine. workers: how many of them; by default one for each core.

    Raises:
        OSError: there is no scheduler at this address.
    """
    with contextlib.ExitStack() as stack:
        cluster: Any = scheduler
        if cluster is None:
            # the workers' own profiler, which nobody reads, costs a fifth of a short run
            stack.enter_context(dask.config.set({"distributed.worker.profile.enabled": False}))
            local = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                memory_limit=0,
                dashboard_address="127.0.0.1:0",
                silence_logs=logging.CRITICAL,
            )
            cluster = stack.enter_context(local)
        client = stack.enter_context(Client(cluster, timeout=10))
        client.register_plugin(TaskPlugin(task))
        try:
            yield client
        finally:
            client.unregister_worker_plugin(task.identity)


def evaluations(client: Client, name: str, points: Sequence[Point]) -> Iterator[Batch]:
    """Evaluate points on the workers of pool, by the name of its task; batches as they come, in no order."""
    # of those waiting, how many of the first may end their worker
    waiting, suspects, size = deque(points), 0, 1
    # batches, and whether alone
    under_way: dict[Any, tuple[list[Point], bool]] = {}
    while waiting or under_way:
        threads = max(sum(client.nthreads().values()), 1)
        fair = math.ceil(len(waiting) / (2 * threads))
        # a suspect is alone under way: Dask suspects all that wait on a worker that dies
        alone = suspects > 0 or any(alone for _, alone in under_way.values())
        most, number = (1, 1) if alone else (AHEAD * threads, min(size, max(fair, 1)))
        while waiting and len(under_way) < most:
            batch = [waiting.popleft() for _ in range(min(number, len(waiting)))]
            under_way[client.submit(_evaluated_here, name, batch, pure=False)] = batch, alone
            suspects = max(suspects - 1, 0)
        try:
            future = wait(list(under_way), timeout=PATIENCE, return_when="FIRST_COMPLETED").done.pop()
            found: Batch = future.result(timeout=PATIENCE)
            del under_way[future]
        except TimeoutError:
            if client.cluster is not None:
                # Dask gives up workers of this machine that die while they start: start them anew
                client.cluster.scale(len(client.cluster.worker_spec))
            continue
        except KilledWorker as error:
            batch, alone = under_way.pop(future)
            if not alone:
                waiting.extendleft(batch)
                suspects += len(batch)
                continue
            ended = f"its worker ended {error.allowed_failures + 1} times"
            found = Batch([Row(batch[0], {}, math.nan, ended)], {})
        mean = sum(row.cost for row in found.rows) / len(found.rows)
        if mean > 0.0:
            size = int(min(max(BATCH_TIME / mean, 1.0), LARGEST_BATCH))
        yield found
