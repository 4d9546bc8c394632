"""Functions as numba lowers them: all of it is linked and optimised once, nothing is run.

Numba itself optimises every function anew with all that it calls, makes machine code of it and wraps it for
Python: two thirds of the time, for a text that is optimised as a whole in the end.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any
from unittest.mock import patch

import llvmlite.binding as llvm
from numba.core import event
from numba.core.base import BaseContext
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.registry import cpu_target
from numba.core.types import Record, Type
from numba.core.types.functions import BaseFunction

# passes of numba for what the kernel has not: closures, functions to be inlined, whole arrays, literals
NEEDLESS = (
    *("WithLifting", "InlineClosureLikes", "InlineInlinables", "InlineOverloads", "NopythonRewrites"),
    *("FindLiterallyCalls", "LiteralUnroll", "LiteralPropagationSubPipelinePass", "DumpParforDiagnostics"),
)
# what every evaluation of the equations of motion calls: made part of its callers, which then leave out
# the derivatives they do not want. The compiler by itself finds them too long.
INLINED = (
    *("equations.motion.equations", "equations.motion.accelerate_links", "events.stages.stages_of"),
    *("events.stages.rates_of", "events.stages.weighed_four"),
    *("inertia.reduced_inertia", "sine.sine_cosine", "sine.sines_cosines"),
)
# of all passes: what the first makes simple is short enough to become part of its callers in the second
ROUNDS = 2


class Passes(CompilerBase):  # type: ignore[misc]
    """Numba's passes over a function but the needless ones."""

    def define_pipelines(self) -> list[Any]:
        """The passes, in one row."""
        manager = DefaultPassBuilder.define_nopython_pipeline(self.state)  # type: ignore[no-untyped-call]
        manager.passes = [entry for entry in manager.passes if entry[0].__name__ not in NEEDLESS]
        manager.finalize()
        return [manager]


# of numba.njit, for functions that only others of them call; references of arrays are not counted (_nrt), for
# all arrays belong to the caller
OPTIONS: dict[str, Any] = {
    **{"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "_nrt": False},
    "pipeline_class": Passes,
}


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
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        return str(self._final_module)

    def _collect(self, called: dict[Any, None]) -> None:
        for library in self._linking_libraries:
            if library not in called:
                called[library] = None
                if isinstance(library, Lowered):
                    library._collect(called)


def _stand_in(library: Any, description: Any, environment: Any) -> Callable[..., Any]:
    """Stand-in by which numba knows a compiled function: a builtin of its own, never called."""
    return [].append


def operation_type(function: Callable[..., Any]) -> Callable[..., Any]:
    """Type of an operation of numba's, found once for arguments of the same types."""
    answers: dict[tuple[Any, ...], Any] = {}

    def answer(operation: Any, context: Any, arguments: Any, keywords: Any) -> Any:
        if keywords:
            return function(operation, context, arguments, keywords)
        asked = operation, arguments
        if asked not in answers:
            answers[asked] = function(operation, context, arguments, keywords)
        return answers[asked]

    return answer


@contextmanager
def only_lowered() -> Iterator[None]:
    """Within it numba's functions are lowered and kept, not compiled.

    What numba finds out anew for every function and operation is found out once: half of the time.
    """
    context = cpu_target.target_context
    codegen = context.codegen()
    with (
        patch.object(codegen, "_library_class", Lowered),
        patch.object(context, "get_executable", _stand_in),
        # numba writes down all types of arguments for each pass: field by field a tenth of the time
        patch.object(Record, "__repr__", Type.__repr__),
        patch.object(BaseFunction, "get_call_type", operation_type(BaseFunction.get_call_type)),
        patch.object(BaseContext, "get_abi_sizeof", functools.cache(BaseContext.get_abi_sizeof)),
        # timers that nobody reads
        patch.object(event, "broadcast", lambda happened: None),
    ):
        yield


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
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=3))
    for _ in range(ROUNDS):
        builder.getModulePassManager().run(module, builder)
    return str(module)
