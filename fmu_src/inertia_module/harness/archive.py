"""Archives of FMUs from unknown sources: their checks, and unpacking and reading within limits."""

from __future__ import annotations

import io
import os
import stat
import zipfile
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePosixPath
from xml.etree import ElementTree
from xml.parsers import expat

from ..common.errors import FmuError, cannot_read, must_be

# limits of an archive and of its content together, bytes
MAX_UNPACKED = 1_000_000_000
# limit of a table or a parameter set in an FMU, bytes
MAX_FILE = 100_000_000
MAX_ENTRIES = 100_000
# problems of the entries that are listed
MAX_PROBLEMS = 10
CHUNK = 1 << 20
ENCRYPTED = 0x1
# the methods of compression that the standard allows
METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
UNREADABLE_ARCHIVE = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError)
DESCRIPTION = "modelDescription.xml"
# files that fmpy parses
PARSED = (DESCRIPTION, "sources/buildDescription.xml")


class ArchiveError(FmuError):
    """An archive that is not unpacked.

    Attributes:
        problems: one sentence for each problem.
    """

    def __init__(self, problems: Sequence[str]) -> None:
        super().__init__("; ".join(problems))
        self.problems = list(problems)


def regular_file(path: Path) -> Path:
    """Return the path if it is a regular file of acceptable size.

    Raises:
        FmuError: it is missing, a folder, a device, a pipe or too large.
    """
    try:
        status = path.stat()
    except (OSError, ValueError) as error:
        raise FmuError(cannot_read(path, error)) from error
    if stat.S_ISDIR(status.st_mode):
        raise FmuError(must_be(str(path), "an FMU file", "a folder"))
    if not stat.S_ISREG(status.st_mode):
        raise FmuError(must_be(str(path), "an FMU file", "a device or a pipe"))
    if status.st_size > MAX_UNPACKED:
        allowed = f"an FMU of at most {_size(MAX_UNPACKED)}"
        raise FmuError(must_be(str(path), allowed, _size(status.st_size)))
    return path


def read_archive(path: Path) -> bytes:
    """Read the file of an FMU.

    Raises:
        FmuError: it is no regular file, or too large.
    """
    with regular_file(path).open("rb") as stream:
        return stream.read(path.stat().st_size)


def _size(number: float) -> str:
    """Write a number of bytes for people."""
    return f"{number / 1e9:.3g} GB" if number >= 1e9 else f"{number / 1e6:.3g} MB"


def open_archive(content: bytes) -> zipfile.ZipFile:
    """Open the content of an FMU's file.

    Raises:
        FmuError: it is no zip archive with a model description.
    """
    try:
        archive = zipfile.ZipFile(io.BytesIO(content))
    except UNREADABLE_ARCHIVE as error:
        raise FmuError(f"not a zip archive: {error}") from error
    if DESCRIPTION not in archive.namelist():
        raise FmuError(f"no {DESCRIPTION} at the top level of the archive")
    return archive


def checked_entries(archive: zipfile.ZipFile) -> list[zipfile.ZipInfo]:
    """Return the entries of an archive that stays in its folder and within its limits.

    Raises:
        ArchiveError: its problems, one sentence each.
    """
    entries = archive.infolist()
    if len(entries) > MAX_ENTRIES:
        raise ArchiveError([must_be("number of entries", f"at most {MAX_ENTRIES}", str(len(entries)))])
    problems = [f"entry {entry.orig_filename!r} {fault}" for entry in entries if (fault := _fault(entry))]
    problems += _collisions(entries)
    total = sum(entry.file_size for entry in entries)
    if total > MAX_UNPACKED:
        problems.insert(0, must_be("unpacked size", f"at most {_size(MAX_UNPACKED)}", _size(total)))
    if problems:
        more = len(problems) - MAX_PROBLEMS
        raise ArchiveError(problems[:MAX_PROBLEMS] + [f"and {more} more problems of entries"] * (more > 0))
    return entries


def _fault(entry: zipfile.ZipInfo) -> str:
    """Return the message about a name, a kind or a compression that is not allowed, or ""."""
    name, kind = entry.orig_filename, stat.S_IFMT(entry.external_attr >> 16)
    if "\\" in name:
        return "must have forward slashes (got a backslash)"
    if ":" in name or name.startswith("/"):
        return "must have a relative name (got an absolute one)"
    if ".." in name.split("/"):
        return "must lie in the archive (got '..' in its name)"
    if not PurePosixPath(name).parts or any(ord(letter) < ord(" ") for letter in name):
        return "must have a name of printable characters"
    if kind not in (0, stat.S_IFREG, stat.S_IFDIR):
        return f"must be a file or a folder (got a {'symbolic link' if kind == stat.S_IFLNK else 'device'})"
    if entry.flag_bits & ENCRYPTED:
        return "must not be encrypted"
    if entry.compress_type not in METHODS:
        return f"must be stored or deflated (got compression method {entry.compress_type})"
    return ""


def _collisions(entries: Sequence[zipfile.ZipInfo]) -> Iterator[str]:
    """Yield messages about entries that would overwrite another one; file systems may ignore case."""
    files: set[PurePosixPath] = set()
    for entry in entries:
        path = PurePosixPath(entry.filename.casefold())
        if not entry.is_dir():
            if path in files:
                yield f"entry {entry.filename!r} must be unique (letter case is ignored)"
            files.add(path)
    for entry in entries:
        path = PurePosixPath(entry.filename.casefold())
        if not files.isdisjoint(path.parents) or (entry.is_dir() and path in files):
            yield f"entry {entry.filename!r} must be a file or a folder (got both)"


def unpack(archive: zipfile.ZipFile, entries: Sequence[zipfile.ZipInfo], folder: Path) -> None:
    """Unpack checked entries to an empty folder.

    Raises:
        ArchiveError: an entry is damaged, or larger than the archive claims.
        FmuError: a description defines entities.
        OSError: they cannot be written.
    """
    for entry in entries:
        target = folder.joinpath(*PurePosixPath(entry.filename).parts)
        if entry.is_dir():
            target.mkdir(parents=True, exist_ok=True)
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        with target.open("wb") as stream:
            for chunk in _chunks(archive, entry):
                stream.write(chunk)
        if str(PurePosixPath(entry.filename)) in PARSED:
            reject_entities(target.read_bytes(), entry.filename)


def _chunks(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> Iterator[bytes]:
    """Yield the content of an entry, at most as many bytes as the archive claims."""
    left = entry.file_size
    try:
        with archive.open(entry) as packed:
            while chunk := packed.read(CHUNK):
                left -= len(chunk)
                if left < 0:
                    raise zipfile.BadZipFile("larger than the size in the archive")
                yield chunk
    except UNREADABLE_ARCHIVE as error:
        raise ArchiveError([f"entry {entry.filename!r} cannot be unpacked: {error}"]) from error


def is_unpacked(entries: Sequence[zipfile.ZipInfo], folder: Path) -> bool:
    """Return True if a folder has all files of an archive, with their sizes and checksums."""
    for entry in entries:
        path, checksum = folder.joinpath(*PurePosixPath(entry.filename).parts), 0
        if entry.is_dir():
            continue
        if not path.is_file() or path.stat().st_size != entry.file_size:
            return False
        with path.open("rb") as stream:
            while chunk := stream.read(CHUNK):
                checksum = zlib.crc32(chunk, checksum)
        if checksum != entry.CRC:
            return False
    return True


def read_inside(folder: Path, path: Path) -> bytes:
    """Read a file of an unpacked FMU.

    Args:
        folder: the unpacked FMU.
        path: of the file, as the FMU names it.

    Raises:
        FmuError: it lies outside the FMU, also by a link, is missing, no regular file or too large.
    """
    resolved, name = path.resolve(), os.path.relpath(os.path.normpath(path), folder)
    if not resolved.is_relative_to(folder.resolve()):
        raise FmuError(cannot_read(name, "not inside the FMU"))
    if not resolved.is_file():
        raise FmuError(cannot_read(name, "no such file in the FMU"))
    if resolved.stat().st_size > MAX_FILE:
        size = _size(resolved.stat().st_size)
        raise FmuError(cannot_read(name, must_be("its size", f"at most {_size(MAX_FILE)}", size)))
    return resolved.read_bytes()


def reject_entities(content: bytes, name: str) -> None:
    """Raise a FmuError if an XML file declares a document type, the only place that can define entities.

    Files of FMI have none. Entities may expand without bound, or name files outside the FMU.

    Args:
        content: of the XML file.
        name: of the file.
    """

    def reject(*_: object) -> None:
        raise FmuError(cannot_read(name, "a document type (DOCTYPE) is not allowed"))

    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = reject
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError) as error:
        # the reader of the file reports other faults
        if isinstance(error, FmuError):
            raise


def parse_inside(folder: Path, path: Path) -> ElementTree.Element:
    """Parse an XML file of an unpacked FMU.

    Args:
        folder: the unpacked FMU.
        path: of the file, as the FMU names it.

    Raises:
        FmuError: as of read_inside and reject_entities.
        SyntaxError: it is no XML.
    """
    content = read_inside(folder, path)
    reject_entities(content, path.name)
    return ElementTree.fromstring(content)
