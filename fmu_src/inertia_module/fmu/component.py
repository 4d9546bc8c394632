"""The WebAssembly component of an FMU of FMI 3.0 (FMI-LS-WASM, a draft), for any machine and browser.

It is the shell, with the functions of wasm/component.c on it, and the kernel as one module, within the world
of the standard. That world is the same for every FMU: wasm/world.wasm, made from the standard's WIT by
component/make.py, with an empty module where this one goes.
"""

from __future__ import annotations

from pathlib import Path

from ..common.files import sources
from ..compiling.c_compiler import link, object_file
from ..compiling.targets import BROWSERS
from ..contract.models import Model
from .linking import header_folder, shell_files

FOLDER = Path(__file__).parent / "wasm"
PLATFORM = "wasm32-wasip2"
# section of a component: a module with nothing in it
EMPTY_MODULE = b"\x01\x08\0asm\x01\0\0\0"
MANIFEST = "extra/org.modelica.fmi-ls-wasm/manifest.xml"


def module(model: Model, guid: str) -> bytes:
    """Shell and kernel as a module of WebAssembly; of its host it needs what the world imports."""
    content = shell_files(model, guid, 3) | {"kernel.o": object_file(model, BROWSERS)}
    content |= {Path(path).name: text for path, text in sources("fmu/wasm/*.c").items()}
    return link(BROWSERS, "module.wasm", content, "-isystem", str(header_folder()))


def length(number: int) -> bytes:
    """A number as WebAssembly writes it: seven bits a byte, the lowest first."""
    return bytes([number]) if number < 128 else bytes([number % 128 + 128]) + length(number // 128)


def component(model: Model, guid: str) -> bytes:
    """The component of a model, for binaries/wasm32-wasip2; guid: of modelDescription.xml."""
    own = module(model, guid)
    world = (FOLDER / "world.wasm").read_bytes()
    return world.replace(EMPTY_MODULE, b"\x01" + length(len(own)) + own, 1)
