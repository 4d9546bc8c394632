"""Writes kernel/records.pyi: the fields of the kernel's records, with which mypy checks the kernel.

Run: python -m inertia_module.compiling.stubs (after each change of the fields or of the table of variables)
"""

from __future__ import annotations

from ..common.files import PACKAGE_FOLDER, write_text
from ..interface.models import DRIVEN_SHAFT, INERTIA_MODULE, Model
from .c_types import Array, Record, Type
from .translate import KernelTranslator, record_names

PATH = PACKAGE_FOLDER / "kernel" / "records.pyi"
HEAD = """\
# Made by python -m inertia_module.compiling.stubs from kernel/fields.py and the table of variables.
from typing import Generic, TypeVar

_Record = TypeVar("_Record")
Position = tuple[float, float, float, float, float, float, float, float, float]
ReducedInertia = tuple[float, float, float, float, float, float]

class Doubles:
    def __len__(self) -> int: ...
    def __getitem__(self, place: int) -> float: ...
    def __setitem__(self, place: int, value: float) -> None: ...

class Records(Generic[_Record]):
    def __len__(self) -> int: ...
    def __getitem__(self, place: int) -> _Record: ...
    def __setitem__(self, place: int, value: _Record) -> None: ...
"""
# prefixes of the names of records
PREFIXES = {INERTIA_MODULE: "", DRIVEN_SHAFT: "Shaft"}


def class_name(record: Record, model: Model) -> str:
    """Return the name of a record in annotations.

    Args:
        record: the record.
        model: model of the record.
    """
    words = record.name.removeprefix("kernel_").split("_")
    return PREFIXES[model] + "".join(word.capitalize() for word in words)


def annotation(kind: Type, model: Model) -> str:
    """Return the annotation of a field.

    Args:
        kind: type of the field.
        model: model of its record.
    """
    match kind:
        case Record():
            return class_name(kind, model)
        case Array(element=Record() as element):
            return f"Records[{class_name(element, model)}]"
        case Array():
            return "Doubles"
    return "float"


def stub() -> str:
    """Return the text of the stub file."""
    lines = [HEAD]
    for model in PREFIXES:
        translator = KernelTranslator(record_names(model))
        for fields in model.records:
            translator.record(fields)
        for record in translator.records.values():
            lines.append(f"class {class_name(record, model)}:")
            lines.append("    numbers: Doubles")
            lines += [f"    {name}: {annotation(kind, model)}" for name, kind in record.fields.items()]
            lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    write_text(PATH, stub())
