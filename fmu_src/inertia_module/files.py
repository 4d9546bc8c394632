"""Files that are either whole or not there, and the folder where results worth keeping are kept."""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path


def cache_folder() -> Path:
    """Where compiled kernels are kept; the environment variable INERTIA_MODULE_CACHE overrides it."""
    chosen = os.environ.get("INERTIA_MODULE_CACHE")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", str(Path.home()))) / "inertia-module"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "inertia-module"
    return Path(os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))) / "inertia-module"


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file so that it is either whole or not there, whoever else writes it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=path.name)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise
