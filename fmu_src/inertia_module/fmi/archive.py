"""Archives of FMUs from unknown sources: checks, unpacking and reading within limits."""

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

# maximum size of an archive and of its unpacked content, bytes
MAX_UNPACKED = 1_000_000_000
# maximum size of a table or a parameter set in an FMU, bytes
MAX_FILE = 100_000_000
MAX_ENTRIES = 100_000
# maximum number of listed problems of the entries
MAX_PROBLEMS = 10
# number of bytes that are read together
CHUNK_SIZE = 1 << 20
# flag of an encrypted entry
ENCRYPTED = 0x1
# compression methods that the standard allows
COMPRESSION_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
# errors that an invalid archive can cause
ARCHIVE_ERRORS = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError)
DESCRIPTION = "modelDescription.xml"
# XML files that fmpy parses: they must not declare a document type
PARSED_FILES = (DESCRIPTION, "sources/buildDescription.xml")


class ArchiveError(FmuError):
    """An archive that is rejected before unpacking.

    Args:
        problems: one sentence for each problem.

    Attributes:
        problems: one sentence for each problem.
    """

    def __init__(self, problems: Sequence[str]) -> None:
        super().__init__("; ".join(problems))
        self.problems = list(problems)


def regular_file(path: Path) -> Path:
    """Return the path if it is a regular file of acceptable size.

    Args:
        path: path of the file.

    Raises:
        FmuError: the file is missing, a folder, a device, a pipe or too large.
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
    """Return the content of an FMU file.

    Args:
        path: path of the file.

    Raises:
        FmuError: the path is no regular file, or the file is too large.
    """
    with regular_file(path).open("rb") as stream:
        return stream.read(path.stat().st_size)


def _size(number: float) -> str:
    """Return a text for a number of bytes, in MB or GB."""
    return f"{number / 1e9:.3g} GB" if number >= 1e9 else f"{number / 1e6:.3g} MB"


def open_archive(content: bytes) -> zipfile.ZipFile:
    """Open the archive of an FMU.

    Args:
        content: content of the FMU file.

    Raises:
        FmuError: the content is no zip archive with a model description.
    """
    try:
        archive = zipfile.ZipFile(io.BytesIO(content))
    except ARCHIVE_ERRORS as error:
        raise FmuError(f"not a zip archive: {error}") from error
    if DESCRIPTION not in archive.namelist():
        raise FmuError(f"no {DESCRIPTION} at the top level of the archive")
    return archive


def checked_entries(archive: zipfile.ZipFile) -> list[zipfile.ZipInfo]:
    """Check the entries of an archive and return them.

    Args:
        archive: archive of an FMU.

    Raises:
        ArchiveError: an entry lies outside the folder, is not allowed, or exceeds the limits.
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
    """Return a message about an invalid name, kind or compression of an entry, or ""."""
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
    if entry.compress_type not in COMPRESSION_METHODS:
        return f"must be stored or deflated (got compression method {entry.compress_type})"
    return ""


def _collisions(entries: Sequence[zipfile.ZipInfo]) -> Iterator[str]:
    """Yield messages about entries that would overwrite each other; file systems may ignore case."""
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

    Args:
        archive: archive of an FMU.
        entries: its entries, checked.
        folder: the empty folder.

    Raises:
        ArchiveError: an entry is damaged, or larger than its size in the archive.
        FmuError: an XML file declares a document type.
        OSError: a file cannot be written.
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
        if str(PurePosixPath(entry.filename)) in PARSED_FILES:
            reject_entities(target.read_bytes(), entry.filename)


def _chunks(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> Iterator[bytes]:
    """Yield the content of an entry, limited to its size in the archive."""
    remaining = entry.file_size
    try:
        with archive.open(entry) as packed:
            while chunk := packed.read(CHUNK_SIZE):
                remaining -= len(chunk)
                if remaining < 0:
                    raise zipfile.BadZipFile("larger than the size in the archive")
                yield chunk
    except ARCHIVE_ERRORS as error:
        raise ArchiveError([f"entry {entry.filename!r} cannot be unpacked: {error}"]) from error


def is_unpacked(entries: Sequence[zipfile.ZipInfo], folder: Path) -> bool:
    """Return True if a folder contains all files of an archive with the same sizes and checksums.

    Args:
        entries: entries of the archive.
        folder: the folder.
    """
    for entry in entries:
        path, checksum = folder.joinpath(*PurePosixPath(entry.filename).parts), 0
        if entry.is_dir():
            continue
        if not path.is_file() or path.stat().st_size != entry.file_size:
            return False
        with path.open("rb") as stream:
            while chunk := stream.read(CHUNK_SIZE):
                checksum = zlib.crc32(chunk, checksum)
        if checksum != entry.CRC:
            return False
    return True


def read_inside(folder: Path, path: Path) -> bytes:
    """Read a file of an unpacked FMU.

    Args:
        folder: the unpacked FMU.
        path: path of the file, with the name from the FMU.

    Raises:
        FmuError: the file lies outside the FMU (also through a link), is missing, no regular file or too
            large.
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
    """Raise an error if an XML file declares a document type, which is the only way to define entities.

    Files of FMI do not declare one. Entities may expand without bound, or refer to files outside the FMU.

    Args:
        content: content of the XML file.
        name: name of the file.

    Raises:
        FmuError: the file declares a document type.
    """

    def reject(*_: object) -> None:
        raise FmuError(cannot_read(name, "a document type (DOCTYPE) is not allowed"))

    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = reject
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError) as error:
        # the caller parses the file again and reports other faults
        if isinstance(error, FmuError):
            raise


def parse_inside(folder: Path, path: Path) -> ElementTree.Element:
    """Return the root element of an XML file of an unpacked FMU.

    Args:
        folder: the unpacked FMU.
        path: path of the file, with the name from the FMU.

    Raises:
        FmuError: the file cannot be read (see read_inside), or declares a document type.
        SyntaxError: the file is no XML.
    """
    content = read_inside(folder, path)
    reject_entities(content, path.name)
    return ElementTree.fromstring(content)
