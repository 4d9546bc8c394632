"""Files that are either whole or not there, a hash of them, and the folder where results are kept."""

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
# of the working directory: where FMUs are built, and where results go
BUILD_FOLDER = Path("build")
OUTPUT_FOLDER = Path("out")
# largest text file that is read, bytes: of a table about 10 million numbers
MAX_TEXT_SIZE = 100_000_000


def ready_made(name: str) -> Path | None:
    """A file that was built for the wheel; None in a clone, which builds its own."""
    path = PACKAGE_FOLDER / "ready" / name
    return path if path.is_file() else None


def cache_folder() -> Path:
    """Folder of the compiled kernels; the environment variable INERTIA_MODULE_CACHE overrides it."""
    chosen = os.environ.get("INERTIA_MODULE_CACHE")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", str(Path.home()))) / "inertia-module"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "inertia-module"
    # an empty one counts as none
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "inertia-module"


def sources(*patterns: str) -> dict[str, bytes]:
    """Files of this package by path within it; `*` in a pattern stands for any name, each finds a file."""
    found: dict[str, bytes] = {}
    for pattern in patterns:
        paths = [path for path in PACKAGE_FOLDER.glob(pattern) if path.is_file()]
        if not paths:
            raise FileNotFoundError(f"missing file of the package: {pattern}")
        found |= {path.relative_to(PACKAGE_FOLDER).as_posix(): path.read_bytes() for path in paths}
    return found


def content_hash(files: Mapping[str, bytes]) -> str:
    """Hash over names and contents, 32 hexadecimal digits."""
    digest = hashlib.sha256()
    for name, content in sorted(files.items()):
        digest.update(name.encode() + b"\0" + len(content).to_bytes(8, "little") + content)
    return digest.hexdigest()[:32]


def writable_folder(folder: Path) -> Path:
    """Return the folder if files can be written to it or it can be created; raise OSError otherwise."""
    failure = f"cannot write to {folder}"
    try:
        # a link to nothing is there too
        there = (one for one in (folder, *folder.absolute().parents) if one.exists() or one.is_symlink())
        place = next(there)
        if not place.is_dir():
            raise OSError(f"{failure}: {place} is not a folder")
        with tempfile.TemporaryFile(dir=place):
            pass
    except OSError as error:
        raise error if error.errno is None else OSError(f"{failure}: {error.strerror}") from error
    return folder


def read_file(path: Path, limit: int) -> bytes:
    """Read a file of the user.

    Args:
        path: the file.
        limit: largest size, bytes.

    Raises:
        OSError: it cannot be read, is a device or a pipe, or is larger.
    """
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise OSError(errno.EINVAL, "not a regular file (a device or a pipe)", str(path))
    with path.open("rb") as stream:
        content = stream.read(limit + 1)
    if len(content) > limit:
        raise OSError(errno.EFBIG, f"larger than {limit / 1e6:g} MB", str(path))
    return content


def read_text(path: Path, limit: int = MAX_TEXT_SIZE) -> str:
    """Read a text file of the user in UTF-8, with or without a byte-order mark; raises as read_file."""
    return io.TextIOWrapper(io.BytesIO(read_file(path, limit)), "utf-8-sig").read()


@contextlib.contextmanager
def naming(path: Path) -> Iterator[None]:
    """Put the path of a file into errors of the system: a full disk is reported without any."""
    try:
        yield
    except OSError as error:
        if error.errno is not None:  # otherwise the message has no place for a file
            error.filename, error.filename2 = str(path), None
        raise


def write_atomically(path: Path, content: bytes) -> Path:
    """Write a file so that it is either whole or not there, whoever else writes it.

    Raises:
        OSError: it cannot be written; with its path.
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
    """Write a text file, whole or not at all."""
    return write_atomically(path, text.encode())


def picture_of(figure: Any, ending: str) -> bytes:
    """Draw a matplotlib Figure in the format of a file's ending.

    The same figure gives the same bytes: no date, and names within an SVG that follow from what they name.
    """
    from matplotlib import rc_context

    stream = io.BytesIO()
    with rc_context({"svg.hashsalt": "inertia-module"}):
        figure.savefig(stream, format=ending.lstrip("."), metadata={"Date": None})
    return stream.getvalue()


def write_figure(path: Path, figure: Any) -> Path:
    """Write a matplotlib Figure in the format of the file's ending, whole or not at all."""
    return write_atomically(path, picture_of(figure, path.suffix))


def kept_file(name: str, made_from: Mapping[str, bytes], folder: Path | None = None) -> Path | None:
    """A whole file that kept has written for the same sources, or None.

    Args:
        name: name of the file, with its ending.
        made_from: all that the content depends on.
        folder: where it is; None for the cache folder.
    """
    stem, ending = _kept_name(name, made_from)
    for path in sorted((folder or cache_folder()).glob(f"{stem}-*.{ending}")):
        with contextlib.suppress(OSError):
            if path.name == _checked_name(stem, ending, path.read_bytes()):
                return path
    return None


def kept(
    name: str, made_from: Mapping[str, bytes], make: Callable[[], bytes], folder: Path | None = None
) -> Path:
    """A file of the cache folder, made if no whole one is there, whoever else makes it.

    Its name holds a hash of all that the content depends on and a hash of the content. So a file that is cut,
    empty or of another program is not used, and made again.

    Args:
        name: name of the file, with its ending.
        made_from: all that the content depends on.
        make: makes the content.
        folder: where it is; None for the cache folder.

    Raises:
        OSError: the folder cannot be written.
    """
    folder = folder or cache_folder()
    path = kept_file(name, made_from, folder)
    if path is not None:
        return path
    try:
        writable_folder(folder)
    except OSError as error:
        raise OSError(f"{error}; INERTIA_MODULE_CACHE names another cache folder") from error
    content = make()
    path = folder / _checked_name(*_kept_name(name, made_from), content)
    try:
        return write_atomically(path, content)
    except PermissionError:  # Windows, when another process has made it meanwhile and has it open
        if kept_file(name, made_from, folder) != path:
            raise
        return path


def _kept_name(name: str, made_from: Mapping[str, bytes]) -> tuple[str, str]:
    """Stem, with a hash of all that a content depends on, and ending of the name of a file of the cache."""
    stem, _, ending = name.partition(".")
    return f"{stem}-{content_hash(made_from)[:16]}", ending


def _checked_name(stem: str, ending: str, content: bytes) -> str:
    """Name of a file of the cache with this content."""
    return f"{stem}-{content_hash({stem: content})[:16]}.{ending}"
