"""Libraries of FMUs beside the kernel: linked of C and objects; the library in front of pythonfmu's."""

from __future__ import annotations

import importlib.resources
import re
import struct
from collections.abc import Callable, Sequence
from pathlib import Path

from .. import __version__
from ..common.files import kept, sources
from ..compiling import CompilationUnavailable
from ..compiling.c_compiler import link
from ..compiling.targets import Target
from ..compiling.tools import tool_versions
from ..contract.models import Model
from .archive import TEMPLATES, filled
from .tables import generated

# what is told each stage of a build as it begins
Progress = Callable[[str], None]
SHELL_FOLDER = Path(__file__).parent / "shell"
# functions of kernel32.dll that the front of the Python FMU needs
WINDOWS_FUNCTIONS = (
    *("CloseHandle", "CreateFileA", "GetModuleFileNameW", "GetModuleHandleExW", "GetProcAddress"),
    *("GetShortPathNameW", "LoadLibraryExW", "LoadLibraryW", "MultiByteToWideChar", "ReadFile"),
)
# a file of macOS for several processors: magic number, and by processor its number
FAT_MAGIC = 0xCAFEBABE
FAT_PROCESSORS = {"x86_64": (0x01000007, 3), "aarch64": (0x0100000C, 0)}
FAT_ALIGNMENT = 14


def header_folder() -> Path:
    """Folder with the headers of FMI 2.0 and 3.0, which fmpy brings along."""
    folder = Path(str(importlib.resources.files("fmpy"))) / "c-code"
    for version in (2, 3):
        if not (folder / f"fmi{version}Functions.h").is_file():
            raise CompilationUnavailable(f"the installed fmpy has no headers of FMI {version}.0")
    return folder


def shell_sources(fmi: int) -> list[Path]:
    """The C files of the shell for a version of FMI, 2 or 3: what both share and its own functions."""
    other = f"fmi{5 - fmi}"
    return sorted(path for path in SHELL_FOLDER.glob("*.c") if not path.name.startswith(other))


def shell_files(model: Model, guid: str, fmi: int) -> dict[str, bytes]:
    """The C files and headers of the shell by name, those made for a model too.

    Args:
        model: what it computes. guid: of modelDescription.xml. fmi: version of FMI, 2 or 3.
    """
    files = {
        path.name: path.read_bytes() for path in (*shell_sources(fmi), *sorted(SHELL_FOLDER.glob("*.h")))
    }
    files |= {Path(path).name: content for path, content in sources("compiling/*.h").items()}
    return files | {file: text.encode() for file, text in generated(model, guid, fmi).items()}


def version_file(target: Target, library: str, title: str) -> dict[str, bytes]:
    """Resource with the version of a library, which Windows shows, by the name of its file; else none."""
    if target.system != "windows":
        return {}
    numbers = ",".join([*re.findall(r"\d+", __version__), "0", "0", "0"][:4])
    values = {"numbers": numbers, "title": title, "version": __version__, "library": library}
    return {"version.rc": filled(TEMPLATES / "version.rc", values).encode()}


def link_front(target: Target, behind: str) -> bytes:
    """The library in front of pythonfmu's, from the cache if it was built before; behind: name of that."""
    files = sources("fmu/front/*", "compiling/windows.c")
    made_from = files | sources("__init__.py", "fmu/linking.py", "fmu/templates/version.rc")
    made_from |= sources("compiling/c_compiler.py", "compiling/tools.py") | tool_versions("ziglang", "fmpy")
    made_from[behind] = target.label.encode()

    def linked() -> bytes:
        content = {Path(path).name: text for path, text in files.items()}
        content |= version_file(target, "front.dll", "Wrapper library of pythonfmu")
        flags = ("-std=c11", "-isystem", str(header_folder()), f'-DPYTHONFMU="{behind}"')
        windows = {"kernel32.dll": WINDOWS_FUNCTIONS}
        needed = target._replace(libraries=("-ldl",))
        return link(needed, f"front{target.suffix}", content, *flags, imports=windows)

    return kept(f"front-{target.label}{target.suffix}", made_from, linked).read_bytes()


def join_for_mac(libraries: Sequence[tuple[str, bytes]]) -> bytes:
    """One file of macOS with code for several processors, from (processor, library) of each."""
    offset = 1 << FAT_ALIGNMENT
    head = struct.pack(">II", FAT_MAGIC, len(libraries))
    body = b""
    for processor, library in libraries:
        kind, subkind = FAT_PROCESSORS[processor]
        head += struct.pack(">IIIII", kind, subkind, offset + len(body), len(library), FAT_ALIGNMENT)
        body += library + bytes(-len(library) % (1 << FAT_ALIGNMENT))
    return head.ljust(offset, b"\0") + body
