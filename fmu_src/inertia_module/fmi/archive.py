"""Archives of FMUs: checks of their entries, unpacking, and reading of unpacked files."""

from __future__ import annotations

import io
import os
import zipfile
import zlib
from collections.abc import Sequence
from pathlib import Path, PurePosixPath
from xml.etree import ElementTree

from ..common.errors import FmuError, cannot_read, must_be
from ..common.files import read_file

# maximum size of an archive and of its unpacked content, bytes
MAX_UNPACKED = 1_000_000_000
# number of bytes that are read together
CHUNK_SIZE = 1 << 20
# errors that an invalid archive can cause
ARCHIVE_ERRORS = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError)
DESCRIPTION = "modelDescription.xml"


class ArchiveError(FmuError):
    """An archive with entries that are rejected or damaged."""


def read_archive(path: Path) -> bytes:
    """Return the content of an FMU file.

    Args:
        path: path of the file.

    Raises:
        FmuError: the path is no regular file, or the file is too large.
    """
    try:
        return read_file(path, MAX_UNPACKED)
    except (OSError, ValueError) as error:
        raise FmuError(cannot_read(path, error)) from error


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
    """Check the paths and the total size of the entries of an archive and return the entries.

    Args:
        archive: archive of an FMU.

    Raises:
        ArchiveError: a path is outside the folder, or the unpacked size exceeds the limit.
    """
    entries = archive.infolist()
    for entry in entries:
        name = entry.orig_filename
        if "\\" in name or ":" in name or name.startswith("/") or ".." in name.split("/"):
            allowed = "a relative path with forward slashes and without '..'"
            raise ArchiveError(must_be("the path of an entry", allowed, repr(name)))
    total = sum(entry.file_size for entry in entries)
    if total > MAX_UNPACKED:
        size = f"{total / 1e9:.3g} GB"
        raise ArchiveError(must_be("unpacked size", f"at most {MAX_UNPACKED / 1e9:g} GB", size))
    return entries


def unpack(archive: zipfile.ZipFile, folder: Path) -> None:
    """Unpack an archive with checked entries to an empty folder.

    Args:
        archive: archive of an FMU.
        folder: the empty folder.

    Raises:
        ArchiveError: an entry is damaged, or encrypted.
        OSError: a file cannot be written.
    """
    try:
        archive.extractall(folder)
    except ARCHIVE_ERRORS as error:
        raise ArchiveError(f"the archive cannot be unpacked: {error}") from error


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
        FmuError: the file lies outside the FMU (also through a link), is missing, or no regular file.
    """
    resolved, name = path.resolve(), os.path.relpath(os.path.normpath(path), folder)
    if not resolved.is_relative_to(folder.resolve()):
        raise FmuError(cannot_read(name, "not inside the FMU"))
    if not resolved.is_file():
        raise FmuError(cannot_read(name, "no such file in the FMU"))
    return resolved.read_bytes()


def parse_inside(folder: Path, path: Path) -> ElementTree.Element:
    """Return the root element of an XML file of an unpacked FMU.

    Args:
        folder: the unpacked FMU.
        path: path of the file, with the name from the FMU.

    Raises:
        FmuError: the file cannot be read (see read_inside).
        SyntaxError: the file is no XML.
    """
    return ElementTree.fromstring(read_inside(folder, path))
