"""Evaluations on workers of dask.distributed, on this machine or on a running cluster.

A plugin sends the task to each worker once, also to workers that join or restart later. Points are sent in
batches of some tenths of a second. If a worker dies, another worker computes its batch. If a batch ends
several workers, its points run alone, and the point that ends workers counts as a failed run.
"""

from __future__ import annotations

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
from multiprocessing import resource_tracker
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import dask
import distributed
from distributed import Client, LocalCluster, Worker, WorkerPlugin, get_worker, wait
from distributed.scheduler import KilledWorker
from distributed.versions import VersionMismatchWarning

from .. import __version__
from ..common.errors import InertiaModuleError, must_be, sentence_of
from ..common.files import naming
from ..scene.run import SceneRunner
from .axes import Point
from .evaluation import Batch, Row, Task, evaluate

# target run time of a batch, s, and maximum number of points
BATCH_TIME = 0.25
MAX_BATCH = 2000
# submitted batches per thread, so that no thread waits
BATCHES_PER_THREAD = 3
# time without a result after which missing workers are replaced, s
TIMEOUT = 5.0
# time within which the scheduler must accept the client, s: of another machine, of this one
REMOTE_TIMEOUT, LOCAL_TIMEOUT = 10.0, 120.0


LOG = logging.getLogger(__name__)


class ClusterError(InertiaModuleError, RuntimeError):
    """Failure of the scheduler or its workers."""


class TaskPlugin(WorkerPlugin):  # type: ignore[misc]
    """Task on a worker, with its FMU as a file and an FMU instance for each thread.

    Args:
        task: The task.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        self.name = task.identity
        self.version = __version__

    def setup(self, worker: Worker) -> None:
        """Write the FMU to a file, which is deleted when no thread uses the plugin.

        Args:
            worker: The worker.

        Raises:
            ClusterError: The worker has another version of this package.
        """
        if self.version != __version__:
            raise ClusterError(must_be("version of inertia-module on the worker", self.version, __version__))
        self.closing = contextlib.ExitStack()
        self.path = Path(self.closing.enter_context(TemporaryDirectory())) / "Module.fmu"
        with naming(self.path):
            self.path.write_bytes(self.task.fmu)
        self.local = threading.local()
        # teardown would be too early: a thread can still run an instance after the client has gone.
        weakref.finalize(self, self.closing.close)

    def evaluate(self, points: list[Point]) -> Batch:
        """Evaluate points in this thread.

        Args:
            points: The points.
        """
        if not hasattr(self.local, "metrics_of"):
            runner = self.closing.enter_context(SceneRunner(self.path))
            self.local.metrics_of = self.task.prepare(self.task.settings, runner)
        return evaluate(self.local.metrics_of, points)


def _evaluate_on_worker(name: str, points: list[Point]) -> Batch:
    """Evaluate points on this worker."""
    plugin: TaskPlugin = get_worker().plugins[name]
    return plugin.evaluate(points)


@contextlib.contextmanager
def _defer_interrupts() -> Iterator[None]:
    """Defer Ctrl-C until the end; threads and processes that start within never receive it."""
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "pthread_sigmask"):
        yield
        return
    signals: list[int] = []
    handler = signal.signal(signal.SIGINT, lambda number, _: signals.append(number))
    resource_tracker.ensure_running()  # its start would unblock Ctrl-C in the thread of the first worker
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        signal.signal(signal.SIGINT, handler)
        if signals:
            signal.raise_signal(signal.SIGINT)


@contextlib.contextmanager
def _hide_main() -> Iterator[None]:
    """Hide the file of the running script, because workers do not need it.

    Otherwise each worker would import the script, and the script would require a guard.
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
    """Start worker processes on this machine, by default one per core."""
    # The profiler of the workers is not used and takes a fifth of the time of a short run.
    settings = dask.config.set({"distributed.worker.profile.enabled": False})
    with settings, _hide_main(), contextlib.ExitStack() as stack:
        with _defer_interrupts():
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                memory_limit=0,
                dashboard_address="127.0.0.1:0",
                silence_logs=logging.CRITICAL,
            )
            stack.enter_context(cluster)
        yield cluster


def _connect(cluster: LocalCluster | str) -> Client:
    """Connect a client.

    Args:
        cluster: Cluster, or address of a scheduler.

    Raises:
        OSError: There is no scheduler at this address.
        ClusterError: The scheduler does not respond or has another version.
    """
    if isinstance(cluster, str):
        address, timeout = cluster, REMOTE_TIMEOUT
    else:
        address, timeout = cluster.scheduler_address, LOCAL_TIMEOUT
    try:
        with warnings.catch_warnings():
            # The warning lists all packages that differ. Incompatible versions fail below.
            warnings.simplefilter("ignore", VersionMismatchWarning)
            return Client(cluster, timeout=timeout)
    except TimeoutError:  # it has no message
        raise ClusterError(f"no response from the scheduler at {address} within {timeout:g} s") from None
    except OSError:
        raise
    except Exception as error:
        version = f"it must have version {distributed.__version__} of distributed, like this client"
        raise ClusterError(
            f"cannot use the scheduler at {address} ({version}): {sentence_of(error)}"
        ) from None


@contextlib.contextmanager
def pool(task: Task, scheduler: str | None = None, workers: int | None = None) -> Iterator[Client]:
    """Connect a client whose workers have a task.

    Args:
        task: The task.
        scheduler: Address of a running Dask scheduler; None for worker processes on this machine.
        workers: Number of these processes; None for one per core.

    Raises:
        OSError: There is no scheduler at this address.
        ClusterError: The scheduler or its workers cannot run the task.
    """
    with contextlib.ExitStack() as stack:
        cluster = scheduler or stack.enter_context(_local_cluster(workers))
        client = stack.enter_context(_connect(cluster))
        try:
            client.register_plugin(TaskPlugin(task))
        except Exception as error:
            place = scheduler or "this machine"
            raise ClusterError(f"the workers of {place} cannot run the task: {sentence_of(error)}") from None
        try:
            yield client
        finally:
            with contextlib.suppress(OSError):  # the scheduler has ended: the results are complete
                client.unregister_worker_plugin(task.identity)


def evaluations(client: Client, name: str, points: Sequence[Point]) -> Iterator[Batch]:
    """Evaluate points on workers, and yield batches in the order of completion.

    Args:
        client: Client of pool.
        name: Identity of its task.
        points: The points.

    Raises:
        ClusterError: A worker cannot run the task, for example because this package is missing.
    """
    # The first `suspects` waiting points can end their worker.
    waiting, suspects, size = deque(points), 0, 1
    # submitted batches, and True for a batch that runs alone
    submitted: dict[Any, tuple[list[Point], bool]] = {}
    has_workers = True
    while waiting or submitted:
        threads = max(sum(client.nthreads().values()), 1)
        fair = math.ceil(len(waiting) / (2 * threads))
        # A suspect runs alone, because Dask suspects all batches on a worker that dies.
        is_alone = suspects > 0 or any(is_alone for _, is_alone in submitted.values())
        max_batches, number = (1, 1) if is_alone else (BATCHES_PER_THREAD * threads, min(size, max(fair, 1)))
        while waiting and len(submitted) < max_batches:
            batch = [waiting.popleft() for _ in range(min(number, len(waiting)))]
            submitted[client.submit(_evaluate_on_worker, name, batch, pure=False)] = batch, is_alone
            suspects = max(suspects - 1, 0)
        try:
            future = wait(list(submitted), timeout=TIMEOUT, return_when="FIRST_COMPLETED").done.pop()
            result: Batch = future.result(timeout=TIMEOUT)
            del submitted[future]
        except TimeoutError:
            if client.cluster is not None:
                # Dask does not replace workers of this machine that die while they start.
                client.cluster.scale(len(client.cluster.worker_spec))
            elif has_workers and not client.nthreads():
                LOG.warning("the scheduler at %s has no workers: waiting for some", client.scheduler.address)
            has_workers = bool(client.nthreads())
            continue
        except KilledWorker as error:
            batch, is_alone = submitted.pop(future)
            if not is_alone:
                waiting.extendleft(batch)
                suspects += len(batch)
                continue
            message = f"its worker ended {error.allowed_failures + 1} times"
            result = Batch([Row(batch[0], {}, math.nan, message)], {})
        except InertiaModuleError:
            raise
        except Exception as error:
            raise ClusterError(
                f"a worker cannot run the task: {type(error).__name__}: {sentence_of(error)}"
            ) from error
        mean = sum(row.cost for row in result.rows) / len(result.rows)
        if mean > 0.0:
            size = int(min(max(BATCH_TIME / mean, 1.0), MAX_BATCH))
        yield result
