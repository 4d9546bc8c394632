"""Translates a kernel from Python to one file of C99: the same names, the same operations in the same order.

The language of the kernel is a small part of Python:

- Functions of modules with positional arguments, translated once for each combination of argument types.
- Numbers: `float` (double), `int` (int64_t), `bool`. Constants and tables (tuples of numbers) of modules.
- Records of doubles, arrays and records (kernel.fields), and `numbers`, all doubles of a record in a row.
- Tuples as results of functions and in assignments to as many names.
- `if`, `while`, `for name in range(...)`, `break`, `continue`, `return`, assignments also with operators.
- Arithmetic, comparisons, `and`, `or`, `not`, conditional expressions; `abs`, `max`, `min`, `int`, `float`,
  `len`, and functions of `math` with the same name in C. Small powers are written as products.

Everything else is rejected with file and line, also an expression that C may evaluate in another order
(evaluation_order). Constants can be computed, because the translator reads their values from the imported
modules.

Run: python -m inertia_module.compiling.translate InertiaModule > kernel.c
"""

from __future__ import annotations

import re
import sys
import textwrap
import types
from collections.abc import Mapping
from typing import Any

from .. import kernel
from ..interface.models import MODELS, Model
from ..kernel import fields
from .c_expression import HELPERS, PRIMARY, Expression
from .c_function import INDENT, FunctionTranslator, wrapped
from .c_types import DOUBLE, INT, Array, Record, TupleType, Type, declaration, member_declaration, type_name
from .python_source import Scope

# functions in each evaluation of the equations of motion; compilers would not inline such long functions
INLINED = frozenset(
    f"{kernel.__name__}.{name}"
    for name in (
        *("equations.motion.equations_of_motion", "equations.motion.solve_slipping"),
        *("equations.motion.solve_mesh_signs", "equations.motion.solve_links"),
        *("equations.choice.mode_violation", "equations.choice.set_mode"),
        *("equations.losses.applied_torques", "equations.losses.write_loss_powers"),
        *("inertia.reduced_inertia", "layout.bevel_imbalance_position"),
        *("sine.sine_cosine", "sine.sines_cosines"),
        *(
            "events.stages.store_rates",
            "events.stages.four_weighted_sums",
            "events.stages.write_weighted_sums",
        ),
    )
)
RECORDS = ("parameters", "constants", "inputs", "state", "outputs", "workspace")
HEAD = """\
/* The kernel of {name}, translated from Python function by function. */
#include "kernel.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

/* No fused multiplication and addition: all processors have to give the same results. */
#if defined __clang__ || !defined __GNUC__
#pragma STDC FP_CONTRACT OFF
#else
#pragma GCC optimize("-ffp-contract=off")
#endif

#if defined __GNUC__
#define INLINED static inline __attribute__((always_inline))
#else
#define INLINED static inline
#endif
/* all doubles of a record in a row */
#define NUMBERS(record) ((double *)(record))
"""


def c_name(module: str, name: str) -> str:
    """Return the name in C of a function or a constant of a module of the kernel.

    Args:
        module: module that defines the name.
        name: name in this module.
    """
    folder = module.removeprefix(kernel.__name__).lstrip(".").replace(".", "_")
    return f"{folder.upper() if name.isupper() else folder}_{name}".lstrip("_")


class KernelTranslator:
    """All definitions of one kernel in C, in the order of their dependencies.

    Args:
        record_names: names of records by the identity of their lists of fields.

    Attributes:
        records: records by their lists of fields.
        structs: definitions of structs by name.
        constants: definitions of constants by name.
        functions: definitions of functions by name.
        texts: different translations of each function.
        translations: name and type of the result of each function, by function and argument types.
        in_progress: functions that are being translated.
    """

    def __init__(self, record_names: Mapping[int, str]) -> None:
        self.record_names = record_names
        self.records: dict[Any, Record] = {}
        self.structs: dict[str, str] = {}
        self.constants: dict[str, str] = {}
        self.functions: dict[str, str] = {}
        self.texts: dict[types.FunctionType, list[str]] = {}
        self.translations: dict[tuple[types.FunctionType, tuple[Type, ...]], tuple[str, Type]] = {}
        self.in_progress: list[types.FunctionType] = []

    def record(self, field_list: Any) -> Record:
        """Return the record for a list of fields.

        Args:
            field_list: list of fields (see interface.records).
        """
        if field_list not in self.records:
            members: dict[str, Type] = {}
            size = 0
            for field in field_list:
                name, kind, *count = (field, None) if isinstance(field, str) else field
                element = DOUBLE if kind is None or isinstance(kind, int) else self.record(kind)
                length = kind if isinstance(kind, int) else count[0] if count else None
                members[name] = element if length is None else Array(element, length)
                size += (1 if isinstance(element, str) else element.size) * (1 if length is None else length)
            record = Record(f"kernel_{self.record_names[id(field_list)]}", members, size)
            lines = [f"{INDENT}{member_declaration(kind, name)};" for name, kind in members.items()]
            self.structs[record.name] = "\n".join([f"struct {record.name} {{", *lines, "};", ""])
            self.records[field_list] = record
        return self.records[field_list]

    def tuple_name(self, kind: TupleType) -> str:
        """Return the name of the struct of a tuple.

        Args:
            kind: type of the tuple.
        """
        name = type_name(kind)
        if name not in self.structs:
            lines = [f"{INDENT}{declaration(item, f'item{n}')};" for n, item in enumerate(kind.items)]
            self.structs[name] = "\n".join(["typedef struct {", *lines, f"}} {name};", ""])
        return name

    def constant(self, module: str, name: str, value: Any) -> Expression:
        """Return a constant or a table of a module.

        Args:
            module: module that defines the constant.
            name: name in this module.
            value: a number, or a tuple of numbers.
        """
        symbol = c_name(module, name)
        numbers = value if isinstance(value, tuple) else (value,)
        kind = INT if all(type(number) is int for number in numbers) else DOUBLE
        if not isinstance(value, tuple):
            self.constants[symbol] = (
                f"#define {symbol} {value!r}" if value >= 0 else f"#define {symbol} ({value!r})"
            )
            return Expression(symbol, PRIMARY, kind)
        rows = textwrap.fill(
            ", ".join(map(repr, value)), 106, initial_indent=INDENT, subsequent_indent=INDENT
        )
        self.constants[symbol] = f"static const {kind} {symbol}[{len(value)}] = {{\n{rows}\n}};"
        return Expression(symbol, PRIMARY, Array(kind, len(value), is_constant=True))

    def call(self, function: types.FunctionType, arguments: tuple[Type, ...]) -> tuple[str, Type]:
        """Return the name of a function in C, and the type of its result.

        Args:
            function: the function.
            arguments: types of its arguments.
        """
        key = function, arguments
        if None in arguments:  # the next pass determines the types
            return c_name(function.__module__, function.__name__), None
        if key not in self.translations:
            if function in self.in_progress:
                scope = Scope(function)
                raise scope.reject(scope.tree, f"{function.__name__} must not call itself")
            self.in_progress.append(function)
            translator = FunctionTranslator(self, function, arguments)
            translator.translate()
            self.translations[key] = self._add_function(function, translator), translator.result
            self.in_progress.pop()
        return self.translations[key]

    def _add_function(self, function: types.FunctionType, translator: FunctionTranslator) -> str:
        """Add a function, unless its text for other types is the same; return its name."""
        name = c_name(function.__module__, function.__name__)
        storage = "INLINED" if f"{function.__module__}.{function.__name__}" in INLINED else "static"
        texts = self.texts.setdefault(function, [])
        text = translator.text(storage, name)
        if text not in texts:
            texts.append(text)
        number = texts.index(text) + 1
        if number > 1:
            name = f"{name}_{number}"
        self.functions.setdefault(name, translator.text(storage, name))
        return name

    def definitions(self) -> str:
        """Return all definitions: helpers, constants, structs and functions."""
        functions = "\n".join(self.functions.values())
        helpers = [text for name, text in HELPERS.items() if re.search(rf"\b{name}\(", functions)]
        parts = [f"static inline {text}\n" for text in helpers]
        return "\n".join([*parts, *self.constants.values(), "", *self.structs.values(), functions])


def translate(model: Model) -> str:
    """Return the kernel of a model as a file of C99; the macro KERNEL is its entry (compiling/kernel.h).

    Args:
        model: model of the kernel.

    Raises:
        KernelLanguageError: the kernel contains a construct outside its language.
    """
    translator = KernelTranslator(record_names(model))
    records = [translator.record(record) for record in model.records]
    entry, _ = translator.call(model.call, (INT, *records, DOUBLE))  # type: ignore[arg-type]
    arguments = ", ".join(
        f"(struct {record.name} *){letter}" for record, letter in zip(records, "pduxyw", strict=True)
    )
    parameters = ", ".join(f"double *{letter}" for letter in "pduxyw")
    return "\n".join(
        [
            HEAD.format(name=model.name),
            translator.definitions(),
            f"int64_t KERNEL(int64_t operation, {parameters}, double h)",
            "{",
            *wrapped(f"{INDENT}return {entry}(operation, {arguments}, h);"),
            "}\n",
        ]
    )


def record_names(model: Model) -> dict[int, str]:
    """Return the names of all records of a model by the identity of their lists of fields.

    Args:
        model: the model.
    """
    names = dict(zip(map(id, model.records), RECORDS, strict=True))
    names |= {id(value): name.lower() for name, value in vars(fields).items() if isinstance(value, tuple)}
    pending = list(model.records)
    while pending:
        for field in pending.pop():
            if not isinstance(field, str) and not isinstance(field[1], int):
                names.setdefault(id(field[1]), field[0])  # a record that only this field names
                pending.append(field[1])
    return names


if __name__ == "__main__":
    sys.stdout.write(translate(MODELS[sys.argv[1]]))
