"""A kernel translated by numba: functions as they are lowered, linked and optimised once, nothing is run.

Numba translates the same files that run as plain Python. By itself it optimises every function anew with all
that it calls, makes machine code of it and wraps it for Python: two thirds of the time, for a text that is
optimised as a whole in the end.
"""

from __future__ import annotations

import ctypes
import gc
import lzma
import re
import sys
import types
from pathlib import Path
from typing import Any
from unittest.mock import patch

import llvmlite.binding as llvm
import numba
import numpy
from numba.core.codegen import JITCodeLibrary
from numba.core.dispatcher import Dispatcher
from numba.core.registry import cpu_target
from numba.core.types import Record, Type

from .. import kernel
from ..common.files import write_atomically
from ..contract.models import MODELS, Model
from ..contract.records import record_type

# what every evaluation of the equations of motion calls: made part of its callers, which then leave out
# the derivatives they do not want. The compiler by itself finds them too long.
INLINED = (
    *("equations.motion.equations", "equations.motion.accelerate_links", "events.stages.stages_of"),
    *("events.stages.rates_of", "events.stages.weighed_four", "events.stages.weigh"),
    *("equations.choice.violation", "equations.choice.try_combination"),
    *("equations.losses.outer_torques", "equations.losses.write_powers_lost"),
    *("inertia.reduced_inertia", "layout.imbalance_at", "sine.sine_cosine", "sine.sines_cosines"),
)
# of all passes: what the first makes simple is short enough to become part of its callers in the second
ROUNDS = 2
# of numba.njit, for functions that only others of them call; references of arrays are not counted (_nrt), for
# all arrays belong to the caller
OPTIONS: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "_nrt": False}


class Lowered(JITCodeLibrary):  # type: ignore[misc]
    """Library of one function as it is lowered, and those of the functions it calls."""

    def _optimize_functions(self, module: Any) -> None:
        """Nothing to do before all are linked."""

    def finalize(self) -> None:
        """Likewise."""
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """There is no machine code."""
        return 0

    def get_llvm_str(self) -> str:
        """Text of this function and of all that it calls."""
        called: dict[Any, None] = {}
        self._collect(called)
        for library in called:
            self._final_module.link_in(library._get_module_for_linking())
        return str(self._final_module)

    def _collect(self, called: dict[Any, None]) -> None:
        for library in self._linking_libraries:
            if library not in called:
                called[library] = None
                if isinstance(library, Lowered):
                    library._collect(called)


def is_inlined(symbol: str) -> bool:
    """Tell whether numba's symbol, in which each part of a name follows its length, is one of INLINED."""
    names = ("".join(f"{len(part)}{part}" for part in name.split(".")) for name in INLINED)
    return any(f"{name}B" in symbol for name in names)


def optimised(text: str, entry: str) -> str:
    """LLVM text of a whole program after all passes; only the entry can be called from outside."""
    module = llvm.parse_assembly(text)
    for function in module.functions:
        if function.name != entry and not function.is_declaration:
            function.linkage = "internal"
        if is_inlined(function.name):
            function.add_function_attribute("alwaysinline")
    for variable in module.global_variables:
        if not variable.is_declaration:
            variable.linkage = "internal"
    machine = cpu_target.target_context.codegen()._tm
    tuning = llvm.create_pipeline_tuning_options(speed_level=3)
    tuning.loop_vectorization = False  # it gains nothing here, and fmu/c_source.py knows no vectors
    builder = llvm.create_pass_builder(machine, tuning)
    for _ in range(ROUNDS):
        builder.getModulePassManager().run(module, builder)
    return str(module)


def wrap_kernel() -> None:
    """Wrap every function of the kernel by numba, where it stands: this process runs none of them."""
    wrapped: dict[int, Any] = {}
    for module in [one for name, one in sys.modules.items() if name.startswith(kernel.__name__)]:
        for name, value in list(vars(module).items()):
            if isinstance(value, types.FunctionType):
                if id(value) not in wrapped:
                    wrapped[id(value)] = numba.njit(error_model="numpy", **OPTIONS)(value)
                setattr(module, name, wrapped[id(value)])
            elif type(value) is int:
                # numba gives each Python constant a type of its own, but not these
                setattr(module, name, numpy.int64(value))
            elif type(value) is tuple and value and all(type(number) in (int, float) for number in value):
                # a table: a constant in the code, indexed at run time
                setattr(module, name, numpy.array(value))


def data_type(kind: Any) -> Any:
    """NumPy's type, which numba takes, of a record (records.record_type), of doubles or records in a row."""
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
    nt, carray = numba.types, numba.carray  # type: ignore[attr-defined]
    wrap_kernel()
    call = sys.modules[model.call.__module__].call

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

    for_types = Dispatcher.get_call_template

    def for_any_constant(function: Any, arguments: Any, keywords: Any) -> Any:
        plain = [nt.unliteral(one) for one in arguments]  # type: ignore[no-untyped-call]
        return for_types(function, plain, keywords)

    types_of = (numba.from_dtype(data_type(record_type(fields))) for fields in model.records)
    pointers = [nt.CPointer(record) for record in types_of]  # type: ignore[no-untyped-call]
    signature = nt.int64(nt.int64, *pointers, nt.float64)
    context = cpu_target.target_context
    with (
        patch.object(context.codegen(), "_library_class", Lowered),
        # numba lowers a function anew for each constant it is called with; what is inlined has it anyway
        patch.object(Dispatcher, "get_call_template", for_any_constant),
        # numba knows a compiled function by a builtin of its own, here never called
        patch.object(context, "get_executable", lambda *_: [].append),
        # numba writes down all types of arguments for each pass: field by field a fifth of the time
        patch.object(Record, "__repr__", Type.__repr__),
    ):
        function = numba.cfunc(signature, error_model="numpy")(entry)
        text: str = function.inspect_llvm()
    text = for_any_processor(text.replace(function.native_name, model.symbol))
    return optimised(text, model.symbol)


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


if __name__ == "__main__":
    gc.disable()  # numba keeps nearly all it makes: a seventh of the time went into looking for what it drops
    # a quarter larger than the best, in a tenth of its time
    write_atomically(Path(sys.argv[2]), lzma.compress(translate(MODELS[sys.argv[1]]).encode(), preset=1))
