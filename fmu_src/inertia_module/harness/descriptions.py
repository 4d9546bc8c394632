"""FMU files by their descriptions: reading them, and what their variables take for a value."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..common.errors import FmuError
from ..common.units import BOOLEANS, allowed_number, number_of

# ctypes cuts off what is more, silently
LARGEST_INTEGER = 2.0**31 - 1.0


def fmu_file(path: Path | str | None) -> Path:
    """The path of an FMU file; without one that of the module, as it comes with the package or is built.

    Raises:
        RuntimeError: it is to be compiled, and cannot be.
    """
    if path is not None:
        return Path(path)
    from ..fmu.builder import current_fmu

    return current_fmu()


def existing_fmu(path: Path) -> Path:
    """The path, if there is a file.

    Raises:
        FmuError: there is none, or it is a folder.
    """
    if path.is_dir():
        raise FmuError(f"{path} must be an FMU file, is a folder")
    if not path.is_file():
        raise FmuError(f"{path} must be an FMU file: there is no such file")
    return path


def read_description(path: Path) -> Any:
    """The description of an FMU file, as fmpy reads it; types of variables by their names in FMI 2.0.

    Raises:
        FmuError: there is no such file, or it is no FMU.
    """
    from fmpy import read_model_description

    from .fmi3 import TYPES

    try:
        description = read_model_description(str(existing_fmu(path)))
        for variable in description.modelVariables:
            variable.type = TYPES.get(variable.type, variable.type)
        return description
    except FmuError:
        raise
    except Exception as error:
        raise FmuError(f"{path} must be an FMU: {error}") from error


def _items(variable: Any) -> Mapping[str, float] | None:
    """Numbers by name of an enumeration or a Boolean."""
    if variable.type == "Boolean":
        return BOOLEANS
    items = getattr(variable.declaredType, "items", None)
    return {item.name: float(item.value) for item in items} if items else None


def number_for(variable: Any, value: Any) -> float:
    """The number that a variable of an FMU takes for a value; its range is for the FMU to check.

    Args:
        variable: fmpy's. value: a number, a string with a unit, or the name of an item.

    Raises:
        FmuError: the variable, the value, and what is allowed.
    """
    if variable.type == "Real":
        if isinstance(value, float):
            return value
        items, allowed = None, allowed_number(variable.unit or "1")
    else:
        items = _items(variable)
        allowed = f"one of {', '.join(items)}" if items else "a whole number of 32 bits"
    largest = 1.0 if variable.type == "Boolean" else LARGEST_INTEGER
    try:
        number = number_of(value, variable.unit or "1", items)
    except ValueError as error:
        raise FmuError(f"{variable.name} must be {allowed}, is {value!r}: {error}") from None
    if variable.type != "Real" and not (number.is_integer() and abs(number) <= largest):
        raise FmuError(f"{variable.name} must be {allowed}, is {value!r}")
    return number
