"""Properties of a library that Windows shows: a resource file with its version, as linkers take it.

Source: Microsoft, "VS_VERSIONINFO structure" and "RESOURCEHEADER structure".
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence

SIGNATURE, STRUCTURE, ALL_FLAGS, WINDOWS, LIBRARY = 0xFEEF04BD, 0x10000, 0x3F, 0x40004, 2
ENGLISH, UNICODE = 0x0409, 0x04B0
VERSION_INFO, ITS_NAME, SHARED = 16, 1, 0x30


def _padded(content: bytes) -> bytes:
    return content + bytes(-len(content) % 4)


def _block(key: str, value: bytes = b"", children: Sequence[bytes] = (), *, text: bool = True) -> bytes:
    """Length, length of the value (of text in letters), whether that is text, key, value, children."""
    body = _padded(bytes(6) + key.encode("utf-16-le") + bytes(2)) + value
    for child in children:
        body = _padded(body) + child
    return struct.pack("<HHH", len(body), len(value) // 2 if text else len(value), text) + body[6:]


def _entry(kind: int, name: int, flags: int, language: int, content: bytes) -> bytes:
    header = struct.pack("<8HI", 0xFFFF, kind, 0xFFFF, name, 0, 0, flags, language, 0)
    return struct.pack("<II", len(content), 12 + len(header)) + header + bytes(4) + _padded(content)


def version_resource(version: str, texts: Mapping[str, str]) -> bytes:
    """The content of a .res file.

    Args:
        version: up to four whole numbers with points between. texts: such as FileDescription.
    """
    numbers = (*map(int, version.split(".")), 0, 0, 0)[:4]
    most, least = (numbers[n] << 16 | numbers[n + 1] for n in (0, 2))
    fixed = (SIGNATURE, STRUCTURE, most, least, most, least, ALL_FLAGS, 0, WINDOWS, LIBRARY, 0, 0, 0)
    shown = [_block(key, text.encode("utf-16-le") + bytes(2)) for key, text in texts.items()]
    children = (
        _block("StringFileInfo", children=[_block(f"{ENGLISH:04x}{UNICODE:04x}", children=shown)]),
        _block(
            "VarFileInfo",
            children=[_block("Translation", struct.pack("<HH", ENGLISH, UNICODE), text=False)],
        ),
    )
    content = _block("VS_VERSION_INFO", struct.pack("<13I", *fixed), children, text=False)
    return _entry(0, 0, 0, 0, b"") + _entry(VERSION_INFO, ITS_NAME, SHARED, ENGLISH, content)
