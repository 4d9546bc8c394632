"""What shared libraries of Linux, Windows and macOS need, offer and leave to their loader; read by lief."""

import struct
from types import MappingProxyType
from typing import NamedTuple

import lief

lief.logging.disable()  # it tells of every table that is empty

# Apple's kern/cs_blobs.h
SIGNATURE, CODE_DIRECTORY, AD_HOC = 0xFADE0CC0, 0xFADE0C02, 2


class Library(NamedTuple):
    """A shared library.

    Attributes:
        needs: libraries. offers: names. fixups: names of the parts in which its loader writes addresses.
        versions: of the symbols it needs. minimum: version of the system. signed: ad hoc.
        asks: names of others that it uses. says: of itself, by heading.
    """

    needs: set[str]
    offers: set[str]
    fixups: set[str]
    versions: set[str] = frozenset()
    minimum: str = ""
    signed: bool = False
    asks: set[str] = frozenset()
    says: dict[str, str] = MappingProxyType({})


def read_elf(path):
    """A library of Linux."""
    binary = lief.ELF.parse(str(path))
    needed = [
        part for needed in binary.symbols_version_requirement for part in needed.get_auxiliary_symbols()
    ]
    return Library(
        {str(name) for name in binary.libraries},
        {symbol.name for symbol in binary.exported_symbols},
        {binary.section_from_virtual_address(found.address).name for found in binary.relocations},
        {version.name for version in needed},
        asks={symbol.name for symbol in binary.imported_symbols},
    )


def read_pe(path):
    """A library of Windows."""
    binary = lief.PE.parse(str(path))
    padding = lief.PE.RelocationEntry.BASE_TYPES.ABS
    fixups = [entry for block in binary.relocations for entry in block.entries if entry.type != padding]
    (version,) = binary.resources_manager.version
    (texts,) = version.string_file_info.children
    numbers = divmod(version.file_info.file_version_ms, 1 << 16)
    says = {entry.key: entry.value for entry in texts.entries} | {"numbers": ".".join(map(str, numbers))}
    return Library(
        {name.lower() for name in binary.libraries},
        {entry.name for entry in binary.get_export().entries},
        {binary.section_from_rva(entry.address).name for entry in fixups},
        says=says,
    )


def read_universal(path):
    """The libraries of macOS in one file, by processor."""
    parts = lief.MachO.parse(str(path))
    return {part.header.cpu_type.name: read_mach_o(part) for part in parts}


def read_mach_o(binary):
    """A library of macOS."""
    assert binary.header.file_type == lief.MachO.Header.FILE_TYPE.DYLIB
    laid_out, why = lief.MachO.check_layout(binary)
    assert laid_out, why
    own = lief.MachO.LoadCommand.TYPE.ID_DYLIB
    fixups = {binary.segment_from_virtual_address(found.address).name for found in binary.relocations}
    return Library(
        {library.name for library in binary.libraries if library.command != own},
        {symbol.name for symbol in binary.exported_symbols},
        fixups | {found.segment.name for found in binary.bindings},
        minimum=".".join(map(str, binary.build_version.minos[:2])),
        asks={symbol.name for symbol in binary.imported_symbols},
        signed=binary.has_code_signature and is_ad_hoc(bytes(binary.code_signature.content)),
    )


def is_ad_hoc(signature):
    """Whether a signature holds a directory of the code, marked as ad hoc."""
    magic, _, count = struct.unpack_from(">III", signature)
    assert magic == SIGNATURE
    blobs = dict(struct.unpack_from(">II", signature, 12 + 8 * n) for n in range(count))
    directory, _, _, flags = struct.unpack_from(">IIII", signature, blobs[0])
    return directory == CODE_DIRECTORY and bool(flags & AD_HOC)
