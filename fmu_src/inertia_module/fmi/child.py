"""A process for untrusted code: it is killed after a time limit, with all processes that it has started."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO, Any, NamedTuple

# time between two polls of the process, s
INTERVAL = 0.05
# waiting time for the last output after the end of the process, s
OUTPUT_WAIT = 1.0
# maximum length of the stored beginning of an output, bytes
MAX_OUTPUT = 2000


class End(NamedTuple):
    """End of a process.

    Attributes:
        code: exit code, negative for a signal, None after the time limit.
        output: beginning of the standard output.
        errors: beginning of the error output.
        memory: maximum memory of all child processes of this process, bytes, or 0 if unknown.
    """

    code: int | None
    output: str
    errors: str
    memory: int


def run_child(command: Sequence[str], folder: Path, timeout: float, watch: Callable[[], None]) -> End:
    """Run a program until it ends or exceeds its time limit.

    An interrupt of this process also ends the program: its standard input closes, and its group is killed.

    Args:
        command: the program and its arguments.
        folder: working directory of the program.
        timeout: time limit, s.
        watch: function that is called regularly.
    """
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path))}
    deadline = time.monotonic() + timeout
    child = subprocess.Popen(
        command,
        bufsize=0,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=folder,
        env=environment,
        start_new_session=True,
    )
    try:
        outputs = [_OutputReader(stream) for stream in (child.stdout, child.stderr)]
        code = child.poll()
        while code is None and time.monotonic() < deadline:
            time.sleep(INTERVAL)
            watch()
            code = child.poll()
    finally:
        _kill(child)
    output, errors = (reader.text() for reader in outputs)
    return End(code, output, errors, _memory())


def _kill(child: subprocess.Popen[bytes]) -> None:
    """Kill a process and its group, and wait for it."""
    with contextlib.suppress(OSError):
        if os.name == "posix":
            os.killpg(child.pid, signal.SIGKILL)
        else:
            child.kill()
    if child.stdin is not None:
        child.stdin.close()
    child.wait()


def _memory() -> int:
    """Return the maximum memory of all child processes of this process, bytes, or 0 if unknown."""
    try:
        import resource
    except ImportError:  # Windows
        return 0
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * unit


class _OutputReader:
    """Reads a stream to its end in a thread and stores its beginning.

    Args:
        stream: the stream.
    """

    def __init__(self, stream: IO[Any] | None) -> None:
        self._content = bytearray()
        self._descriptor = os.dup(stream.fileno()) if stream is not None else -1
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self) -> None:
        with contextlib.suppress(OSError):
            while part := os.read(self._descriptor, 1 << 16):
                self._content += part[: MAX_OUTPUT - len(self._content)]
        os.close(self._descriptor)

    def text(self) -> str:
        """Return the stored beginning; an escaped process that holds the stream open does not block."""
        self._thread.join(OUTPUT_WAIT)
        return bytes(self._content).decode("utf-8", "replace")
