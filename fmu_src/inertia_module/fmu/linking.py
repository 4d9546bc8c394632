"""Parts of the libraries of FMUs: C files of the FMI functions, and the front library of the Python FMU."""

from __future__ import annotations

import importlib.resources
import re
import struct
from collections.abc import Callable, Sequence
from pathlib import Path

from .. import __version__
from ..common.files import cached, sources
from ..compiling.c_compiler import link
from ..compiling.targets import Target
from ..compiling.tools import tool_versions
from ..interface.models import Model
from .archive import TEMPLATES, render
from .tables import generated

# function that is called at the beginning of each stage of a build, with its description
Progress = Callable[[str], None]
SHELL_FOLDER = Path(__file__).parent / "shell"
# functions of kernel32.dll that the front library of the Python FMU calls
WINDOWS_FUNCTIONS = (
    *("CloseHandle", "CreateFileA", "GetModuleFileNameW", "GetModuleHandleExW", "GetProcAddress"),
    *("GetShortPathNameW", "LoadLibraryExW", "LoadLibraryW", "MultiByteToWideChar", "ReadFile"),
)
# magic number of a macOS file for several processors
FAT_MAGIC = 0xCAFEBABE
# type and subtype of each processor in this file
FAT_PROCESSORS = {"x86_64": (0x01000007, 3), "aarch64": (0x0100000C, 0)}
# alignment of the libraries in this file, as a power of 2
FAT_ALIGNMENT = 14


def header_folder() -> Path:
    """Return the folder with the headers of FMI 2.0 and 3.0, which are part of fmpy."""
    return Path(str(importlib.resources.files("fmpy"))) / "c-code"


def shell_sources(fmi: int) -> list[Path]:
    """Return the paths of the C files with the FMI functions, common ones included.

    Args:
        fmi: version of FMI, 2 or 3.
    """
    other = f"fmi{5 - fmi}"
    return sorted(path for path in SHELL_FOLDER.glob("*.c") if not path.name.startswith(other))


def shell_files(model: Model, guid: str, fmi: int) -> dict[str, bytes]:
    """Return the C files and headers of the FMI functions by name, with the files generated for a model.

    Args:
        model: the model.
        guid: GUID in modelDescription.xml.
        fmi: version of FMI, 2 or 3.
    """
    files = {
        path.name: path.read_bytes() for path in (*shell_sources(fmi), *sorted(SHELL_FOLDER.glob("*.h")))
    }
    files |= {Path(path).name: content for path, content in sources("compiling/*.h").items()}
    return files | {file: text.encode() for file, text in generated(model, guid, fmi).items()}


def version_file(target: Target, library: str, title: str) -> dict[str, bytes]:
    """Return the Windows resource file with the version of a library by name; empty for other systems.

    Args:
        target: the platform.
        library: name of the library.
        title: description of the library.
    """
    if target.system != "windows":
        return {}
    numbers = ",".join([*re.findall(r"\d+", __version__), "0", "0", "0"][:4])
    values = {"numbers": numbers, "title": title, "version": __version__, "library": library}
    return {"version.rc": render(TEMPLATES / "version.rc", values).encode()}


def link_front(target: Target, original: str) -> bytes:
    """Return the front library, which checks calls and passes them on to pythonfmu's library.

    The cache stores the result.

    Args:
        target: the platform.
        original: name of pythonfmu's library.
    """
    files = sources("fmu/front/*", "compiling/windows.c")
    hashed_parts = files | sources("__init__.py", "fmu/linking.py", "fmu/templates/version.rc")
    hashed_parts |= sources("compiling/c_compiler.py", "compiling/tools.py") | tool_versions(
        "ziglang", "fmpy"
    )
    hashed_parts[original] = target.label.encode()

    def linked() -> bytes:
        content = {Path(path).name: text for path, text in files.items()}
        content |= version_file(target, "front.dll", "Wrapper library of pythonfmu")
        flags = ("-std=c11", "-isystem", str(header_folder()), f'-DPYTHONFMU="{original}"')
        windows = {"kernel32.dll": WINDOWS_FUNCTIONS}
        needed = target._replace(libraries=("-ldl",))
        return link(needed, f"front{target.suffix}", content, *flags, imports=windows)

    return cached(f"front-{target.label}{target.suffix}", hashed_parts, linked).read_bytes()


def join_for_mac(libraries: Sequence[tuple[str, bytes]]) -> bytes:
    """Return one macOS file with code for several processors.

    Args:
        libraries: name of the processor and library for each.
    """
    offset = 1 << FAT_ALIGNMENT
    head = struct.pack(">II", FAT_MAGIC, len(libraries))
    body = b""
    for processor, library in libraries:
        kind, subkind = FAT_PROCESSORS[processor]
        head += struct.pack(">IIIII", kind, subkind, offset + len(body), len(library), FAT_ALIGNMENT)
        body += library + bytes(-len(library) % (1 << FAT_ALIGNMENT))
    return head.ljust(offset, b"\0") + body
