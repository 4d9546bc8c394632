"""The WebAssembly component of an FMU of FMI 3.0 (FMI-LS-WASM, a draft), for any machine and browser.

One module contains the FMI functions, the adapter wasm/component.c and the kernel. The component is this
module within the world of the standard. The file wasm/world.wasm is the same for every FMU: component/make.py
makes it from the standard's WIT, with an empty module as a placeholder.
"""

from __future__ import annotations

from pathlib import Path

from ..common.files import sources
from ..compiling.c_compiler import link, object_file
from ..compiling.targets import BROWSERS
from ..interface.models import Model
from .linking import header_folder, shell_files

FOLDER = Path(__file__).parent / "wasm"
PLATFORM = "wasm32-wasip2"
# section of a component with an empty module
EMPTY_MODULE = b"\x01\x08\0asm\x01\0\0\0"
MANIFEST = "extra/org.modelica.fmi-ls-wasm/manifest.xml"


def module(model: Model, guid: str) -> bytes:
    """Return the FMI functions and the kernel as a WebAssembly module; it imports only from the world.

    Args:
        model: model of the kernel.
        guid: GUID in modelDescription.xml.
    """
    content = shell_files(model, guid, 3) | {"kernel.o": object_file(model, BROWSERS)}
    content |= {Path(path).name: text for path, text in sources("fmu/wasm/*.c").items()}
    return link(BROWSERS, "module.wasm", content, "-isystem", str(header_folder()))


def length(number: int) -> bytes:
    """Return a number in the encoding of WebAssembly (LEB128): seven bits per byte, the lowest first.

    Args:
        number: non-negative integer.
    """
    return bytes([number]) if number < 128 else bytes([number % 128 + 128]) + length(number // 128)


def component(model: Model, guid: str) -> bytes:
    """Return the component of a model for binaries/wasm32-wasip2.

    Args:
        model: model of the kernel.
        guid: GUID in modelDescription.xml.
    """
    core_module = module(model, guid)
    world = (FOLDER / "world.wasm").read_bytes()
    return world.replace(EMPTY_MODULE, b"\x01" + length(len(core_module)) + core_module, 1)
