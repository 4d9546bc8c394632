"""A kernel as LLVM IR for no processor in particular: machine code for every platform is made from it.

Numba translates the same files that run as plain Python. It does so in a process of its own, whose
environment leaves nothing to chance: the same source gives the same text.
"""

from __future__ import annotations

import ctypes
import functools
import gc
import importlib
import importlib.metadata
import importlib.util
import lzma
import os
import platform
import re
import subprocess
import sys
import types
from pathlib import Path
from typing import Any

from .. import kernel
from ..common.files import PACKAGE_FOLDER, cache_folder, content_hash, sources, write_atomically
from ..contract.models import MODELS, Model
from ..contract.records import record_type
from . import CompilationUnavailable

# order of numba's sets, and the processor it takes for the host: what the text would depend on
ENVIRONMENT = {
    **{"PYTHONHASHSEED": "0", "NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
    "NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING": "1",  # it colours what it then does not say
}
NEEDED = ("numba", "llvmlite")


@functools.cache
def jitted_kernel(entry: str = "entry", **options: Any) -> dict[str, types.ModuleType]:
    """A second copy of a kernel module and all it imports, by name, every function wrapped by numba.

    Args:
        options: of numba.njit.

    Raises:
        ImportError: numba is not installed.
    """
    import numpy

    numba: Any = importlib.import_module("numba")
    package = types.ModuleType(f"{kernel.__name__}_for_numba")
    package.__path__ = [str(PACKAGE_FOLDER / "kernel")]
    prefix = package.__name__ + "."
    sys.modules[package.__name__] = package
    try:
        importlib.import_module(prefix + entry)
        modules = {
            name.removeprefix(prefix): module
            for name, module in sys.modules.items()
            if name.startswith(prefix)
        }
    finally:
        for name in [name for name in sys.modules if name.startswith(package.__name__)]:
            del sys.modules[name]
    wrapped: dict[int, Any] = {}
    for module in modules.values():
        for name, value in list(vars(module).items()):
            if isinstance(value, types.FunctionType):
                if id(value) not in wrapped:
                    wrapped[id(value)] = numba.njit(error_model="numpy", **options)(value)
                setattr(module, name, wrapped[id(value)])
            elif type(value) is int:
                # numba compiles a function anew for each Python constant it is called with, not for these
                setattr(module, name, numpy.int64(value))
            elif type(value) is tuple and value and all(type(number) in (int, float) for number in value):
                # a table: a constant in the code, indexed at run time
                setattr(module, name, numpy.array(value))
    return modules


def data_type(kind: Any) -> Any:
    """NumPy's type, which numba takes, of a record (records.record_type), of doubles or records in a row."""
    import numpy

    if kind is ctypes.c_double:
        return numpy.float64
    if issubclass(kind, ctypes.Array):
        return numpy.dtype((data_type(kind._type_), (kind._length_,)))
    (_, inner), numbers = kind._fields_
    members = [*inner._fields_, numbers]
    return numpy.dtype(
        {
            "names": [name for name, _ in members],
            "formats": [data_type(member) for _, member in members],
            "offsets": [getattr(kind, name).offset for name, _ in members],
        }
    )


def translate(model: Model) -> str:
    """LLVM IR of a kernel's entry, as numba makes it from the kernel's source."""
    from . import lowered

    numba: Any = importlib.import_module("numba")
    nt = numba.types
    carray = numba.carray
    call = jitted_kernel(model.module, **lowered.OPTIONS)[model.module].call

    def entry(operation, p, d, u, x, y, w, h):  # type: ignore[no-untyped-def]
        return call(
            operation,
            carray(p, 1)[0],
            carray(d, 1)[0],
            carray(u, 1)[0],
            carray(x, 1)[0],
            carray(y, 1)[0],
            carray(w, 1)[0],
            h,
        )

    pointers = [nt.CPointer(numba.from_dtype(data_type(record_type(fields)))) for fields in model.records]
    signature = nt.int64(nt.int64, *pointers, nt.float64)
    with lowered.only_lowered():
        function = numba.cfunc(signature, error_model="numpy")(entry)
        text: str = function.inspect_llvm()
    text = for_any_processor(text.replace(function.native_name, model.symbol))
    return lowered.optimised(text, model.symbol)


def for_any_processor(ir: str) -> str:
    """Text without processor and system, numba's error path trapping, and arrays that do not overlap.

    The kernel raises nothing and allocates nothing, so that path is never taken. A store to one of p, d, u,
    x, y, w leaves the others.
    """

    def trapping(found: re.Match[str]) -> str:
        head = f"define internal {found[1]}@{found[2]}({found[3].replace('immarg', '')})"
        return f"{head} {{\n  call void @llvm.trap()\n  unreachable\n}}"

    def apart(head: re.Match[str]) -> str:
        return re.sub(r"\bptr ((?:[\w()]+ )*%arg\.[pduxyw]\b)", r"ptr noalias \1", head[0])

    ir = re.sub(r"^target (datalayout|triple) = .*\n", "", ir, flags=re.M)
    ir = re.sub(r"^declare ([^@\n]*)@((?:numba|Py|_Py)\w*)\(([^)]*)\)[^\n]*$", trapping, ir, flags=re.M)
    ir = re.sub(r"^@(Py\w+) = external global i8.*$", r"@\1 = internal global i8 0", ir, flags=re.M)
    return re.sub(r"^define .*$", apart, ir, flags=re.M) + "\ndeclare void @llvm.trap()\n"


def tool_versions(*packages: str) -> dict[str, bytes]:
    """Versions of Python and of packages, by name.

    Raises:
        CompilationUnavailable: one of them is not installed.
    """
    versions = {platform.python_implementation(): platform.python_version()}
    for package in packages:
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            raise CompilationUnavailable(
                f"{package} is not installed; it comes with the extra inertia-module[fast]"
            ) from None
    return {name: version.encode() for name, version in versions.items()}


def made_from(model: Model) -> dict[str, bytes]:
    """All that the text depends on: source of the kernel, what translates it, versions of the tools.

    Raises:
        CompilationUnavailable: a tool is not installed.
    """
    translator = sources("contract/records.py", "compiling/lowered.py", "compiling/ir.py")
    return model.source | translator | tool_versions(*NEEDED)


def _path(model: Model) -> Path:
    return cache_folder() / f"{model.name}-{content_hash(made_from(model))[:16]}.ll.xz"


def is_cached(model: Model) -> bool:
    """Tell whether llvm_text will find the text of this source in the cache."""
    return _path(model).exists()


def llvm_text(model: Model) -> str:
    """LLVM IR of a kernel, from the cache or, the first time ever, translated: about a minute.

    Raises:
        CompilationUnavailable: numba is not installed, or fails.
    """
    path = _path(model)
    if not path.exists():
        environment = {key: value for key, value in os.environ.items() if not key.startswith("NUMBA_")}
        # the package of this file, wherever it lies
        environment |= ENVIRONMENT | {"PYTHONPATH": str(PACKAGE_FOLDER.parent)}
        command = [sys.executable, "-m", __name__, model.name, str(path)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise CompilationUnavailable(f"numba fails: {done.stderr.strip()[-2000:]}")
    return lzma.decompress(path.read_bytes()).decode()


if __name__ == "__main__":
    gc.disable()  # numba keeps nearly all it makes: a seventh of the time went into looking for what it drops
    # a quarter larger than the best, in a tenth of its time
    write_atomically(Path(sys.argv[2]), lzma.compress(translate(MODELS[sys.argv[1]]).encode(), preset=1))
