"""The [mechanism] of a scene: any parameter of the table of variables, in SI or with a unit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal

from pydantic import BaseModel, create_model

from ..common.units import number_of
from ..contract.variable import PARAMETER, Variable
from ..contract.variables import BY_NAME, with_causality
from ..kernel.codes import ELASTIC
from .fields import InUnit, Strict

FIDELITY = "fidelity"
DRIVE = "drive"
# the fidelity is to be chosen from measurements
AUTO = "auto"


def _validator(variable: Variable) -> InUnit:
    def check(value: Any) -> float | str:
        if variable.name == FIDELITY and value == AUTO:
            return AUTO
        also = f", or {AUTO}" if variable.name == FIDELITY else ""
        sentence = f"must be {variable.allowed}{also}, is {value!r}"
        try:
            number = number_of(value, variable.unit or "1", variable.items)
        except ValueError as error:
            raise ValueError(f"{sentence}: {error}") from None
        if not variable.accepts(number):
            raise ValueError(sentence)
        return number

    return InUnit(check, unit=variable.unit)


def _type(variable: Variable) -> Any:
    """Type and range of a key of the table."""
    number: Any = float | None
    return Annotated[number | Literal["auto"] if variable.name == FIDELITY else number, _validator(variable)]


def keys_of(variables: Iterable[Variable]) -> Any:
    """Keys of a table for variables: each may be given, as a number in SI, with a unit, or by name."""
    return {variable.name: (_type(variable), None) for variable in variables}


# tolerance has a table of its own: [accuracy]
Mechanism: type[BaseModel] = create_model(
    "Mechanism",
    __base__=Strict,
    __doc__="Parameters of the module that differ from the defaults (scene R1).",
    **keys_of(variable for variable in with_causality(PARAMETER) if variable.name != "tolerance"),
)


def parameters(mechanism: BaseModel) -> dict[str, float]:
    """The parameters that the scene gives, as numbers for the FMU, without a fidelity still to be chosen."""
    given = mechanism.model_dump(exclude_none=True)
    return {name: value for name, value in given.items() if value != AUTO}


def is_auto(mechanism: BaseModel) -> bool:
    """Tell whether the fidelity is to be chosen."""
    return getattr(mechanism, FIDELITY, None) == AUTO


# the parameters that say there is an elastic output
ELASTIC_PARAMETERS = (
    "driven_inertia",
    "shaft_stiffness",
    "shaft_damping",
    "driven_friction",
    "balancer",
    "housing_stiffness",
    "housing_damping",
    "freewheel_stiffness",
    "freewheel_damping",
)


def is_elastic(values: Mapping[str, float]) -> bool:
    """Tell whether parameters describe an elastic output."""
    return any(name in values for name in ELASTIC_PARAMETERS)


def at_fidelity(values: Mapping[str, float], fidelity: float) -> dict[str, float]:
    """Parameters for another fidelity: without an elastic output the driven mass is rigid with the hub.

    Args:
        values: parameters by name, those that differ from the defaults. fidelity: its number.
    """
    changed = {**values, FIDELITY: float(fidelity)}
    if fidelity != ELASTIC and is_elastic(values):
        inertia = (
            values.get(name, BY_NAME[name].start or 0.0) for name in ("output_inertia", "driven_inertia")
        )
        changed["output_inertia"] = sum(inertia)
    return changed
