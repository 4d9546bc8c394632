"""Unpacked copies of FMUs: one folder for each content, shared by all processes of a user.

A copy is in the cache folder; its name is a hash of the archive. It is unpacked elsewhere and renamed. A
process does not remove its own copies at its end, so a crash needs no cleanup. Instead a process that makes
a new copy removes all copies that were not opened for days.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import shutil
import tempfile
import threading
import time
import zipfile
from collections.abc import Sequence
from pathlib import Path

from ..common.errors import FmuError
from ..common.files import cache_folder
from .archive import checked_entries, is_unpacked, open_archive, unpack

# time since the last opening after which a copy is removed, s
MAX_AGE = 3 * 86400.0
# beginnings of the names of incomplete copies and of copies during their removal
UNFINISHED, REMOVED = "new-", "old-"

# copies that this process has already compared with their archives
_checked: set[Path] = set()
_lock = threading.Lock()


def unpacked(content: bytes) -> str:
    """Return the path of the folder with the unpacked content of an FMU; unpack it if there is no copy.

    Args:
        content: content of the FMU file.

    Raises:
        FmuError: the content is no FMU, or cannot be unpacked (see archive).
    """
    folder = cache_folder().absolute() / "unpacked" / hashlib.sha256(content).hexdigest()[:32]
    with _lock:
        if not (folder in _checked and folder.is_dir()):
            try:
                _complete(folder, content)
            except OSError as error:
                reason = f"{folder.parent}: {error.strerror or error}"
                remedy = "INERTIA_MODULE_CACHE names another cache folder"
                raise FmuError(f"the FMU cannot be unpacked: {reason}; {remedy}") from error
            _checked.add(folder)
        with contextlib.suppress(OSError):  # the cache may be read-only
            os.utime(folder)
    return str(folder)


def _complete(folder: Path, content: bytes) -> None:
    """Make a copy complete: unpack it if it is missing or damaged."""
    with open_archive(content) as archive:
        entries = checked_entries(archive)
        if not is_unpacked(entries, folder):
            folder.parent.mkdir(parents=True, exist_ok=True)
            _prune(folder.parent)
            _make_copy(archive, entries, folder)


def _make_copy(archive: zipfile.ZipFile, entries: Sequence[zipfile.ZipInfo], folder: Path) -> None:
    """Unpack a copy next to its place and move it there; another process may do the same at the same time."""
    fresh = Path(tempfile.mkdtemp(prefix=UNFINISHED, dir=folder.parent))
    try:
        unpack(archive, fresh)
        if folder.exists() and not is_unpacked(entries, folder):
            _remove_copy(folder)
        try:
            os.rename(fresh, folder)
        except OSError:
            if not is_unpacked(entries, folder):
                raise
    finally:
        shutil.rmtree(fresh, ignore_errors=True)


def _remove_copy(folder: Path) -> None:
    """Remove a copy; a rename comes first, so that no process uses an incomplete copy."""
    trash = Path(tempfile.mkdtemp(prefix=REMOVED, dir=folder.parent))
    os.rename(folder, trash / folder.name)
    shutil.rmtree(trash, ignore_errors=True)


def _prune(place: Path) -> None:
    """Remove copies that were not opened for MAX_AGE, and incomplete copies of interrupted processes."""
    oldest = time.time() - MAX_AGE
    for folder in place.iterdir():
        with contextlib.suppress(OSError):  # another process removes it, or Windows has it open
            if folder.stat().st_mtime < oldest:
                _remove_copy(folder)
