"""The kernel compiled from its Python source, once per source and processor, kept in a cache.

Numba compiles the same files that run as plain Python into one object file an entry (a model); from
then on only llvmlite is needed to load it, in milliseconds. The object holds one function, the entry's
``call``, working on the addresses of arrays of doubles.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import importlib
import os
import re
import sys
import tempfile
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from . import kernel
from .kernel import driven_shaft_slots, slots

SIGNATURE = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64, *[ctypes.c_void_p] * 6, ctypes.c_double)
KERNEL_FOLDER = Path(kernel.__file__).parent
# what every evaluation of the equations of motion calls: made part of its callers, which then leave out
# the derivatives they do not want. The compiler by itself finds them too long.
INLINED = ("inertia.reduced_inertia", "circular.sine_cosine", "circular.sines_cosines")


class Entry(NamedTuple):
    """A kernel that can be called: the module of its call, and the module that sizes its arrays."""

    module: str
    slots: types.ModuleType

    @property
    def sizes(self) -> tuple[int, ...]:
        """Sizes of p, d, u, x, y and w."""
        return tuple(getattr(self.slots, f"{letter}_SIZE") for letter in "PDUXYW")

    @property
    def symbol(self) -> str:
        """Name of the function in the object file."""
        return f"inertia_module_{self.module}"


MODULE = "module"
DRIVEN_SHAFT = "driven_shaft"
ENTRIES = {MODULE: Entry("step", slots), DRIVEN_SHAFT: Entry("driven_shaft", driven_shaft_slots)}

_loaded: dict[str, Any] = {}


class CompilationUnavailable(RuntimeError):
    """Numba or llvmlite is not installed, or cannot compile the kernel here."""


@functools.cache
def source_hash() -> str:
    """Hash of the kernel's source files."""
    digest = hashlib.sha256()
    for path in sorted(KERNEL_FOLDER.glob("*.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Where compiled kernels are kept; the environment variable INERTIA_MODULE_CACHE overrides it."""
    chosen = os.environ.get("INERTIA_MODULE_CACHE")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", str(Path.home()))) / "inertia-module"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "inertia-module"
    return Path(os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))) / "inertia-module"


@functools.cache
def jitted_kernel(entry: str = "step") -> dict[str, types.ModuleType]:
    """A second copy of a kernel module and all it imports, by name, every function wrapped by numba.

    Raises:
        ImportError: numba is not installed.
    """
    numba: Any = importlib.import_module("numba")
    package = types.ModuleType(f"{kernel.__name__}_for_numba")
    package.__path__ = [str(KERNEL_FOLDER)]
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
    int64: Any = importlib.import_module("numpy").int64
    wrapped: dict[int, Any] = {}
    for module in modules.values():
        for name, value in list(vars(module).items()):
            if isinstance(value, types.FunctionType):
                if id(value) not in wrapped:
                    wrapped[id(value)] = numba.njit(error_model="numpy")(value)
                setattr(module, name, wrapped[id(value)])
            elif type(value) is int:
                # numba compiles a function anew for each Python constant it is called with, not for these
                setattr(module, name, int64(value))
    return modules


def _compile_to_ir(which: Entry) -> str:
    """LLVM IR of an entry, as numba makes it from the kernel's source."""
    numba: Any = importlib.import_module("numba")
    nt = numba.types
    carray = numba.carray
    call = jitted_kernel(which.module)[which.module].call
    n_p, n_d, n_u, n_x, n_y, n_w = which.sizes
    pointer = nt.CPointer(nt.float64)

    def entry(operation, p, d, u, x, y, w, h):  # type: ignore[no-untyped-def]
        return call(
            operation,
            carray(p, n_p),
            carray(d, n_d),
            carray(u, n_u),
            carray(x, n_x),
            carray(y, n_y),
            carray(w, n_w),
            h,
        )

    signature = nt.int64(nt.int64, *[pointer] * 6, nt.float64)
    function = numba.cfunc(signature, error_model="numpy")(entry)
    text: str = function.inspect_llvm()
    return text.replace(function.native_name, which.symbol)


def _without_error_path(ir: str) -> str:
    """Let numba's error path trap: the kernel raises nothing and allocates nothing, so it is never taken."""
    ir = re.sub(
        r"^declare ([^@\n]*)@((?:NRT|numba|Py|_Py)\w*)\(([^)]*)\)[^\n]*$",
        r"define internal \1@\2(\3) {\n  call void @llvm.trap()\n  unreachable\n}",
        ir,
        flags=re.M,
    )
    ir = re.sub(r"^@(Py\w+) = external global i8.*$", r"@\1 = internal global i8 0", ir, flags=re.M)
    return ir + "\ndeclare void @llvm.trap()\n"


def _without_aliases(ir: str) -> str:
    """Tell that no two of the arrays p, d, u, x, y, w overlap: a store to one leaves the others."""

    def marked(head: re.Match[str]) -> str:
        return re.sub(r"\bptr ((?:[\w()]+ )*%arg\.[pduxyw]\.4\b)", r"ptr noalias \1", head[0])

    return re.sub(r"^define .*$", marked, ir, flags=re.M)


def _is_inlined(symbol: str) -> bool:
    """Whether numba's symbol, in which each word of a name follows its length, is one of INLINED."""
    words = ("".join(f"{len(word)}{word}" for word in name.split(".")) for name in INLINED)
    return any(f"{word}B" in symbol for word in words)


def _target_machine(binding: Any) -> Any:
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    return binding.Target.from_default_triple().create_target_machine(
        cpu=binding.get_host_cpu_name(),
        features=binding.get_host_cpu_features().flatten(),
        opt=3,
        reloc="pic",
        # constants in reach of short addresses: the code for a compiler in memory would build long ones
        codemodel="small",
    )


def _compile_to_object(binding: Any, which: Entry) -> bytes:
    """Object file for this processor with the entry as its only visible function."""
    module = binding.parse_assembly(_without_aliases(_without_error_path(_compile_to_ir(which))))
    for function in module.functions:
        if not function.is_declaration and function.name != which.symbol:
            function.linkage = "internal"
        if _is_inlined(function.name):
            function.add_function_attribute("alwaysinline")
    for variable in module.global_variables:
        if not variable.is_declaration:
            variable.linkage = "internal"
    machine = _target_machine(binding)
    builder = binding.create_pass_builder(machine, binding.create_pipeline_tuning_options(speed_level=3))
    builder.getModulePassManager().run(module, builder)
    return bytes(machine.emit_object(module))


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file so that it is either whole or not there, whoever else writes it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=path.name)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def is_cached(name: str = MODULE) -> bool:
    """Whether the compiled kernel of this source and entry is in the cache already."""
    return name in _loaded or bool(list(cache_folder().glob(f"{name}-{source_hash()}-*.o")))


def load(name: str = MODULE) -> Callable[..., int]:
    """A compiled entry: entry(operation, p, d, u, x, y, w, h) with addresses of arrays of doubles.

    The first call ever on a machine compiles (a minute or two for the module), later ones load
    from the cache.

    Args:
        name: MODULE or DRIVEN_SHAFT.

    Raises:
        CompilationUnavailable: numba or llvmlite is not installed, or fails.
    """
    if name not in _loaded:
        which = ENTRIES[name]
        try:
            import llvmlite
            from llvmlite import binding

            machine = _target_machine(binding)
            processor = f"{binding.get_host_cpu_name()}-{binding.get_host_cpu_features().flatten()}"
            label = hashlib.sha256(f"{processor}-{llvmlite.__version__}".encode()).hexdigest()[:12]
            path = cache_folder() / f"{name}-{source_hash()}-{label}.o"
            if not path.exists():
                write_atomically(path, _compile_to_object(binding, which))
            engine = binding.create_mcjit_compiler(binding.parse_assembly(""), machine)
            engine.add_object_file(binding.ObjectFileRef.from_data(path.read_bytes()))
            engine.finalize_object()
        except Exception as error:
            raise CompilationUnavailable(f"{type(error).__name__}: {error}") from error
        # the engine owns the code
        _loaded[name] = SIGNATURE(engine.get_function_address(which.symbol)), engine
    entry: Callable[..., int] = _loaded[name][0]
    return entry
