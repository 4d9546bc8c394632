"""FMUs unpacked into the temporary folder: one copy for all instances of a process, none after its end."""

from __future__ import annotations

import hashlib
import io
import shutil
import tempfile
import threading
from multiprocessing.util import Finalize
from pathlib import Path

_lock = threading.Lock()
# by the content of the FMU's file
_copies: dict[str, Unpacked] = {}


class Unpacked:
    """The folder of an FMU's content, which goes when its last user has released it or the process ends.

    Args:
        content: of the FMU's file.
    """

    def __init__(self, content: bytes) -> None:
        from fmpy import extract

        self.users = 0
        self.folder = tempfile.mkdtemp(prefix="fmu-")
        # also at the end of processes that multiprocessing has forked, which atexit knows nothing of; after
        # those that this one has forked, which leave the folder to it
        self.remove = Finalize(None, shutil.rmtree, args=(self.folder, True), exitpriority=-1)
        try:
            extract(io.BytesIO(content), self.folder)
        except BaseException:
            self.remove()
            raise

    def release(self) -> None:
        """Be used by one less."""
        with _lock:
            self.users -= 1
            if not self.users:
                _copies.pop(next(key for key, copy in _copies.items() if copy is self))
                self.remove()


def unpacked(path: Path) -> Unpacked:
    """An FMU's content as a folder, for one user more."""
    content = path.read_bytes()
    key = hashlib.sha256(content).hexdigest()
    with _lock:
        if key not in _copies:
            _copies[key] = Unpacked(content)
        _copies[key].users += 1
        return _copies[key]
