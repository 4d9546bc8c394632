"""Evaluations on the workers of dask.distributed: those of this machine, or of a cluster that exists.

What a worker needs goes there once, as a plugin, and to those that join or are started anew as well. Points
travel in batches of some tenths of a second. A batch whose worker dies is computed elsewhere; one that
kills several workers is taken apart, and the point that does it is refused.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import math
import signal
import sys
import threading
import warnings
import weakref
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import resource_tracker
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import dask
import distributed
from distributed import Client, LocalCluster, Worker, WorkerPlugin, get_worker, wait
from distributed.core import rpc
from distributed.scheduler import KilledWorker
from distributed.versions import VersionMismatchWarning

from .. import __version__
from ..common.errors import Refused, must_be
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


LOG = logging.getLogger(__name__)


class ClusterError(RuntimeError):
    """The scheduler or its workers cannot do the work."""


class TaskPlugin(WorkerPlugin):  # type: ignore[misc]
    """A task on a worker: its FMU as a file, and what evaluates points, one for each thread."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self.name = task.identity
        self.version = __version__

    def setup(self, worker: Worker) -> None:
        """Write the FMU to a file; it goes when no thread runs an instance any more."""
        if self.version != __version__:
            raise ClusterError(must_be("version of inertia-module on the worker", self.version, __version__))
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
def _interrupts_held() -> Iterator[None]:
    """Hold back Ctrl-C until the end; threads and processes that are started meanwhile never receive it."""
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "pthread_sigmask"):
        yield
        return
    held: list[int] = []
    handler = signal.signal(signal.SIGINT, lambda number, _: held.append(number))
    resource_tracker.ensure_running()  # its start unblocks Ctrl-C in the thread that starts the first worker
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        signal.signal(signal.SIGINT, handler)
        if held:
            signal.raise_signal(signal.SIGINT)


@contextlib.contextmanager
def _without_main() -> Iterator[None]:
    """Hide the file of the running script: otherwise each worker imports it, and it needs a guard.

    Workers take nothing from it.
    """
    main: dict[str, Any] = vars(sys.modules["__main__"])
    hidden: dict[str, Any] = {name: main.pop(name) for name in ("__file__", "__spec__") if name in main}
    main["__spec__"] = None
    try:
        yield
    finally:
        main.update(hidden)


@contextlib.contextmanager
def _local_cluster(workers: int | None) -> Iterator[LocalCluster]:
    """Start worker processes on this machine, by default one for each core."""
    # the workers' own profiler, which nobody reads, costs a fifth of a short run
    settings = dask.config.set({"distributed.worker.profile.enabled": False})
    with contextlib.ExitStack() as stack:
        stack.enter_context(settings)
        stack.enter_context(_without_main())
        with _interrupts_held():
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                memory_limit=0,
                dashboard_address="127.0.0.1:0",
                silence_logs=logging.CRITICAL,
            )
            stack.enter_context(cluster)
        yield cluster


def _connected(cluster: LocalCluster | str) -> Client:
    """Connect a client.

    Raises:
        OSError: there is no scheduler at this address.
        ClusterError: the scheduler is of another version.
    """
    try:
        with warnings.catch_warnings():
            # its table lists every package that differs: versions that do not work together fail below
            warnings.simplefilter("ignore", VersionMismatchWarning)
            return Client(cluster, timeout=10)
    except OSError:
        raise
    except Exception as error:
        with ThreadPoolExecutor(1) as thread:  # a notebook has an event loop in this one
            version = thread.submit(asyncio.run, _version_at(str(cluster))).result()
        demand = must_be(f"version of distributed at {cluster}", distributed.__version__, version)
        raise ClusterError(f"{demand}: {error}") from None


async def _version_at(scheduler: str) -> str:
    """Return the version of distributed that the scheduler at an address runs, or "another version"."""
    with contextlib.suppress(Exception):
        async with rpc(scheduler) as remote:
            versions = await remote.versions(packages=[])
            return str(versions["packages"]["distributed"])
    return "another version"


@contextlib.contextmanager
def pool(task: Task, scheduler: str | None = None, workers: int | None = None) -> Iterator[Client]:
    """Connect a client whose workers know a task.

    Args:
        task: the task.
        scheduler: address of a running one; without it a cluster of processes is started on this machine.
        workers: number of these processes; by default one for each core.

    Raises:
        OSError: there is no scheduler at this address.
        ClusterError: the scheduler or its workers cannot do the task.
    """
    with contextlib.ExitStack() as stack:
        cluster = scheduler or stack.enter_context(_local_cluster(workers))
        client = stack.enter_context(_connected(cluster))
        try:
            client.register_plugin(TaskPlugin(task))
        except Exception as error:
            place = scheduler or "this machine"
            raise ClusterError(f"the workers of {place} cannot do the task: {error}") from None
        try:
            yield client
        finally:
            client.unregister_worker_plugin(task.identity)


def evaluations(client: Client, name: str, points: Sequence[Point]) -> Iterator[Batch]:
    """Evaluate points on the workers of pool; return batches as they come, in no order.

    Args:
        client: client of pool.
        name: name of its task.
        points: points.

    Raises:
        ClusterError: a worker cannot do the task: it has not this package, say.
    """
    # of those waiting, how many of the first may end their worker
    waiting, suspects, size = deque(points), 0, 1
    # batches, and whether alone
    under_way: dict[Any, tuple[list[Point], bool]] = {}
    has_workers = True
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
            elif has_workers and not client.nthreads():
                LOG.warning("the scheduler at %s has no workers: waiting for some", client.scheduler.address)
            has_workers = bool(client.nthreads())
            continue
        except KilledWorker as error:
            batch, alone = under_way.pop(future)
            if not alone:
                waiting.extendleft(batch)
                suspects += len(batch)
                continue
            ended = f"its worker ended {error.allowed_failures + 1} times"
            found = Batch([Row(batch[0], {}, math.nan, ended)], {})
        except Refused:
            raise
        except Exception as error:
            raise ClusterError(f"a worker cannot do the task: {type(error).__name__}: {error}") from error
        mean = sum(row.cost for row in found.rows) / len(found.rows)
        if mean > 0.0:
            size = int(min(max(BATCH_TIME / mean, 1.0), LARGEST_BATCH))
        yield found
