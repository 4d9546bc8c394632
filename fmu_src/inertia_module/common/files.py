"""Files: written atomically, hashed by content, and stored in the cache folder."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import io
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

PACKAGE_FOLDER = Path(__file__).parent.parent
# folders within the working directory for built FMUs and for results
BUILD_FOLDER = Path("build")
OUTPUT_FOLDER = Path("out")
# maximum size of a text file, bytes: a table of about 10 million numbers
MAX_TEXT_SIZE = 100_000_000


def ready_made(name: str) -> Path | None:
    """Return the path of a file that was built for the wheel; None in a clone, which builds the file itself.

    Args:
        name: name of the file.
    """
    path = PACKAGE_FOLDER / "ready" / name
    return path if path.is_file() else None


def cache_folder() -> Path:
    """Return the cache folder; the environment variable INERTIA_MODULE_CACHE overrides the default."""
    chosen = os.environ.get("INERTIA_MODULE_CACHE")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", str(Path.home()))) / "inertia-module"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "inertia-module"
    # an empty variable means the same as an undefined one
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "inertia-module"


def sources(*patterns: str) -> dict[str, bytes]:
    """Return the contents of files of this package by path within the package.

    Args:
        patterns: glob patterns; each must match a file.

    Raises:
        FileNotFoundError: a pattern matches no file.
    """
    contents: dict[str, bytes] = {}
    for pattern in patterns:
        paths = [path for path in PACKAGE_FOLDER.glob(pattern) if path.is_file()]
        if not paths:
            raise FileNotFoundError(f"missing file of the package: {pattern}")
        contents |= {path.relative_to(PACKAGE_FOLDER).as_posix(): path.read_bytes() for path in paths}
    return contents


def content_hash(files: Mapping[str, bytes]) -> str:
    """Return a hash of names and contents, 32 hexadecimal digits.

    Args:
        files: contents by name.
    """
    digest = hashlib.sha256()
    for name, content in sorted(files.items()):
        digest.update(name.encode() + b"\0" + len(content).to_bytes(8, "little") + content)
    return digest.hexdigest()[:32]


def writable_folder(folder: Path) -> Path:
    """Return the folder if it can be created and files can be written to it; raise OSError otherwise.

    Args:
        folder: path of the folder.

    Raises:
        OSError: the folder cannot be created or written.
    """
    failure = f"cannot write to {folder}"
    try:
        parents = (folder, *folder.absolute().parents)
        # a broken link counts as an existing path: it prevents the creation of the folder
        existing = next(path for path in parents if path.exists() or path.is_symlink())
        if not existing.is_dir():
            raise OSError(f"{failure}: {existing} is not a folder")
        with tempfile.TemporaryFile(dir=existing):
            pass
    except OSError as error:
        raise error if error.errno is None else OSError(f"{failure}: {error.strerror}") from error
    return folder


def read_file(path: Path, limit: int) -> bytes:
    """Read a file of the user.

    Args:
        path: path of the file.
        limit: maximum size, bytes.

    Raises:
        OSError: the file cannot be read, is a device or a pipe, or is larger.
    """
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise OSError(errno.EINVAL, "not a regular file (a device or a pipe)", str(path))
    with path.open("rb") as stream:
        content = stream.read(limit + 1)
    if len(content) > limit:
        raise OSError(errno.EFBIG, f"larger than {limit / 1e6:g} MB", str(path))
    return content


def read_text(path: Path, limit: int = MAX_TEXT_SIZE) -> str:
    """Read a text file of the user in UTF-8, with or without a byte-order mark.

    Args:
        path: path of the file.
        limit: maximum size, bytes.

    Raises:
        OSError: the file cannot be read, is a device or a pipe, or is larger.
    """
    return io.TextIOWrapper(io.BytesIO(read_file(path, limit)), "utf-8-sig").read()


@contextlib.contextmanager
def naming(path: Path) -> Iterator[None]:
    """Add the path of a file to the system errors of a block: the error of a full disk has no path.

    Args:
        path: path of the file.
    """
    try:
        yield
    except OSError as error:
        if error.errno is not None:  # without a number, Python does not print the path in the message
            error.filename, error.filename2 = str(path), None
        raise


def write_atomically(path: Path, content: bytes) -> Path:
    """Write a file atomically: it is complete or missing, also if other processes write it.

    Args:
        path: path of the file; its folder is created if missing.
        content: content of the file.

    Returns:
        The path.

    Raises:
        OSError: the file cannot be written; the message contains the path.
    """
    writable_folder(path.parent).mkdir(parents=True, exist_ok=True)
    with naming(path):
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=path.name)
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(content)
            os.chmod(name, 0o644)
            os.replace(name, path)
        except BaseException:
            os.unlink(name)
            raise
    return path


def write_text(path: Path, text: str) -> Path:
    """Write a text file in UTF-8 atomically; return its path.

    Args:
        path: path of the file.
        text: content of the file.
    """
    return write_atomically(path, text.encode())


def picture_of(figure: Any, ending: str) -> bytes:
    """Draw a matplotlib Figure and return the image file.

    The same figure gives the same bytes: the file has no date, and names within an SVG are hashes.

    Args:
        figure: the matplotlib Figure; its label, if it has one, becomes the description in a PNG or SVG file.
        ending: ending of a file name, which selects the format: ".png" or ".svg", for example.
    """
    from matplotlib import rc_context

    stream = io.BytesIO()
    metadata = {"Date": None} | ({"Description": figure.get_label()} if figure.get_label() else {})
    with rc_context({"svg.hashsalt": "inertia-module"}):
        figure.savefig(stream, format=ending.lstrip("."), metadata=metadata)
    return stream.getvalue()


def write_figure(path: Path, figure: Any) -> Path:
    """Write a matplotlib Figure to a file atomically; return its path.

    Args:
        path: path of the file; its ending selects the format.
        figure: the matplotlib Figure.
    """
    return write_atomically(path, picture_of(figure, path.suffix))


def cached_file(name: str, hashed_parts: Mapping[str, bytes], folder: Path | None = None) -> Path | None:
    """Return the path of an undamaged cache file for the same sources, or None.

    Args:
        name: name of the file with its ending.
        hashed_parts: contents by name of everything that the file depends on.
        folder: folder of the file; None for the cache folder.
    """
    stem, ending = _cache_name(name, hashed_parts)
    for path in sorted((folder or cache_folder()).glob(f"{stem}-*.{ending}")):
        with contextlib.suppress(OSError):
            if path.name == _name_with_hash(stem, ending, path.read_bytes()):
                return path
    return None


def cached(
    name: str, hashed_parts: Mapping[str, bytes], make: Callable[[], bytes], folder: Path | None = None
) -> Path:
    """Return the path of a cache file; create it if there is no undamaged one.

    The name of the file contains a hash of its sources and a hash of its content. Therefore a truncated,
    empty or foreign file is not used, and the content is made again. Several processes may create the same
    file.

    Args:
        name: name of the file with its ending.
        hashed_parts: contents by name of everything that the file depends on.
        make: function that returns the content.
        folder: folder of the file; None for the cache folder.

    Raises:
        OSError: the folder cannot be written.
    """
    folder = folder or cache_folder()
    path = cached_file(name, hashed_parts, folder)
    if path is not None:
        return path
    try:
        writable_folder(folder)
    except OSError as error:
        raise OSError(f"{error}; INERTIA_MODULE_CACHE names another cache folder") from error
    content = make()
    path = folder / _name_with_hash(*_cache_name(name, hashed_parts), content)
    try:
        return write_atomically(path, content)
    except PermissionError:  # Windows: another process has created the file in the meantime and has it open
        if cached_file(name, hashed_parts, folder) != path:
            raise
        return path


def _cache_name(name: str, hashed_parts: Mapping[str, bytes]) -> tuple[str, str]:
    """Return the stem of a cache file, with a hash of its sources, and its ending."""
    stem, _, ending = name.partition(".")
    return f"{stem}-{content_hash(hashed_parts)[:16]}", ending


def _name_with_hash(stem: str, ending: str, content: bytes) -> str:
    """Return the name of a cache file: its stem, a hash of its content, its ending."""
    return f"{stem}-{content_hash({stem: content})[:16]}.{ending}"
