"""What shared libraries of ELF, PE and Mach-O files need and offer, read from their bytes.

Layouts: System V ABI, Microsoft's PE Format, Apple's mach-o/loader.h and kern/cs_blobs.h.
"""

import struct
from typing import NamedTuple


class Library(NamedTuple):
    """A shared library: libraries it needs, names it offers, and what its format has besides."""

    needs: set[str]
    offers: set[str]
    versions: set[str] = frozenset()
    minimum: str = ""
    signed: bool = False


def text_at(content, offset):
    """The text that ends with a zero byte."""
    return content[offset : content.index(b"\0", offset)].decode()


def read_elf(content):
    """A library of Linux, 64-bit; versions are those of symbols it needs."""
    assert content[:6] == b"\x7fELF\x02\x01"
    start, size, count = (
        struct.unpack_from("<Q10xHH", content, 40)[0],
        *struct.unpack_from("<HH", content, 58),
    )
    sections = [struct.unpack_from("<IIQQQQIIQQ", content, start + n * size) for n in range(count)]
    needs, offers, versions = set(), set(), set()
    for _, kind, _, _, offset, length, linked, info, _, _ in sections:
        texts = sections[linked][4] if linked < count else 0
        if kind == 6:  # dynamic
            pairs = struct.iter_unpack("<QQ", content[offset : offset + length])
            needs |= {text_at(content, texts + value) for tag, value in pairs if tag == 1}
        elif kind == 11:  # symbols for the linker at run time
            for name, _, _, section, _, _ in struct.iter_unpack("<IBBHQQ", content[offset : offset + length]):
                if section:
                    offers.add(text_at(content, texts + name))
        elif kind == 0x6FFFFFFE:  # versions needed, info of them
            for _ in range(info):
                _, parts, _, part, following = struct.unpack_from("<HHIII", content, offset)
                place = offset + part
                for _ in range(parts):
                    _, _, _, name, step = struct.unpack_from("<IHHII", content, place)
                    versions.add(text_at(content, texts + name))
                    place += step
                offset += following  # noqa: PLW2901
    return Library(needs, offers, versions)


def read_pe(content):
    """A library of Windows, 64-bit."""
    head = struct.unpack_from("<I", content, 0x3C)[0]
    assert content[head : head + 4] == b"PE\0\0"
    count, optional_size = struct.unpack_from("<H12xH", content, head + 6)
    optional = head + 24
    assert struct.unpack_from("<H", content, optional)[0] == 0x20B
    parts = [
        struct.unpack_from("<IIII", content, optional + optional_size + 40 * n + 8) for n in range(count)
    ]

    def place(address):
        for size, first, stored, offset in parts:
            if first <= address < first + max(size, stored):
                return address - first + offset
        raise AssertionError(f"address {address:#x} is in no section")

    exported, _, imported, _ = struct.unpack_from("<IIII", content, optional + 112)
    needs, offers = set(), set()
    names, table = struct.unpack_from("<I4xI", content, place(exported) + 24)
    for n in range(names):
        offers.add(text_at(content, place(struct.unpack_from("<I", content, place(table) + 4 * n)[0])))
    entry = place(imported)
    while name := struct.unpack_from("<I", content, entry + 12)[0]:
        needs.add(text_at(content, place(name)).lower())
        entry += 20
    return Library(needs, offers)


def read_universal(content):
    """The libraries of macOS in one file, by processor."""
    magic, count = struct.unpack_from(">II", content, 0)
    assert magic == 0xCAFEBABE
    names = {0x01000007: "x86_64", 0x0100000C: "arm64"}
    found = {}
    for n in range(count):
        kind, _, offset, size, alignment = struct.unpack_from(">IIIII", content, 8 + 20 * n)
        assert offset % (1 << alignment) == 0
        found[names[kind]] = read_mach_o(content[offset : offset + size])
    return found


def read_mach_o(content):
    """A library of macOS, 64-bit."""
    magic, _, _, kind, count = struct.unpack_from("<IIIII", content, 0)
    assert magic == 0xFEEDFACF
    assert kind == 6  # a shared library
    needs, offers, minimum, signed = set(), set(), "", False
    place = 32
    for _ in range(count):
        command, size = struct.unpack_from("<II", content, place)
        if command in (0xC, 0x80000018, 0x8000001F):  # another library
            needs.add(text_at(content, place + struct.unpack_from("<I", content, place + 8)[0]))
        elif command == 2:  # symbols
            symbols, number, texts, _ = struct.unpack_from("<IIII", content, place + 8)
            for n in range(number):
                name, flags, section = struct.unpack_from("<IBB", content, symbols + 16 * n)
                if section and flags & 0x11 == 0x01:  # defined and external, not private
                    offers.add(text_at(content, texts + name))
        elif command == 0x32:  # built for
            version = struct.unpack_from("<I", content, place + 12)[0]
            minimum = f"{version >> 16}.{version >> 8 & 255}"
        elif command == 0x1D:  # signature
            signed = is_signed_ad_hoc(content, *struct.unpack_from("<II", content, place + 8))
        place += size
    return Library(needs, offers, minimum=minimum, signed=signed)


def is_signed_ad_hoc(content, offset, size):
    """Whether a signature holds a directory of the code, marked as ad hoc."""
    magic, _, count = struct.unpack_from(">III", content, offset)
    assert magic == 0xFADE0CC0
    assert offset + size <= len(content)
    for n in range(count):
        kind, start = struct.unpack_from(">II", content, offset + 12 + 8 * n)
        if kind == 0:
            directory, _, _, flags = struct.unpack_from(">IIII", content, offset + start)
            return directory == 0xFADE0C02 and bool(flags & 2)
    return False
