"""The models of the package: the models in memory, the FMUs and the documentation are made from them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

from ..common.errors import Named, must_be
from ..common.files import content_hash, sources
from ..kernel import codes, entry, fields
from ..kernel.driven_shaft import entry as shaft
from . import messages, variables
from .records import Field, place, size
from .variables import INPUT, LOCAL, OUTPUT, PARAMETER, Terminal, Variable, with_causality

# index of the kernel's record with the variables of a causality
RECORD_OF = {PARAMETER: 0, INPUT: 2, OUTPUT: 4, LOCAL: 4}


class Bound(NamedTuple):
    """Range of a number in a saved state that the kernel uses as an index or a choice.

    Attributes:
        record: record of the number: "d", the constants, or "x", the state.
        place: place of the number in the record, doubles.
        maximum: maximum; the number must be an integer from 0 to this.
    """

    record: str
    place: int
    maximum: int

    def accepts(self, value: float) -> bool:
        """Return True if the number may have a value.

        Args:
            value: the value.
        """
        return 0.0 <= value <= self.maximum and value % 1.0 == 0.0


def interface(table: Iterable[Variable]) -> tuple[tuple[str, ...], ...]:
    """Return the fields of the kernel's records p, u and y: names of variables, and of the rates of inputs.

    p begins with the parameters that the map of fidelity averaged depends on. u begins with a speed, followed
    by torques. y ends with the means and peaks of a step.

    Args:
        table: variables of the model.
    """
    rows = list(table)
    parameters = sorted(with_causality(PARAMETER, table=rows), key=lambda variable: not variable.in_map)
    outputs = sorted(with_causality(OUTPUT, LOCAL, table=rows), key=lambda variable: variable.of_step)
    inputs = with_causality(INPUT, table=rows)
    names, units = zip(*((variable.name, variable.unit) for variable in inputs), strict=True)
    assert units == ("rad/s", *["N.m"] * (len(units) - 1)), "kernel/inputs.py takes one speed, then torques"
    return (
        tuple(variable.name for variable in parameters),
        tuple(name + ending for ending in ("", "_rate", "_has_rate") for name in names),
        tuple(variable.name for variable in outputs),
    )


@dataclass(frozen=True, eq=False, repr=False)
class Model:
    """One model: its variables, its kernel and its messages.

    Attributes:
        name: name of the native FMU and of saved states.
        title: name in documentation and figures.
        description: one sentence without its full stop.
        variables: table of the variables.
        time: the variable time of FMI 3.0.
        call: the kernel as plain Python.
        records: fields of the kernel's records p, d, u, x, y and w.
        messages: messages for all statuses of the kernel except OK.
        warnings: messages for accepted parameters: an infeasible geometry, a deprecated value.
        traced: names of the variables in the log of every step.
        bounds: ranges of the indices and choices in d and x.
        terminals: the flanges.
    """

    name: str
    title: str
    description: str
    variables: tuple[Variable, ...]
    time: Variable
    call: Callable[..., int]
    records: tuple[tuple[Field, ...], ...]
    messages: Mapping[int, str]
    traced: tuple[str, ...]
    terminals: tuple[Terminal, ...]
    bounds: tuple[Bound, ...] = ()
    warnings: Mapping[int, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<model {self.name}>"

    @cached_property
    def by_name(self) -> dict[str, Variable]:
        """Variables by name."""
        return Named({variable.name: variable for variable in self.variables}, f"variable of {self.name}")

    @property
    def symbol(self) -> str:
        """Name of the kernel in machine code."""
        within_kernel = self.call.__module__.rpartition(".kernel.")[2]
        return f"inertia_module_{within_kernel.replace('.', '_')}"

    @property
    def sizes(self) -> tuple[int, ...]:
        """Numbers of doubles in p, d, u, x, y and w."""
        return tuple(size(record) for record in self.records)

    @property
    def source(self) -> dict[str, bytes]:
        """Source files of the kernel and fields of its records: they determine the results."""
        return sources("kernel/**/*.py") | {"records": repr(self.records).encode()}

    @cached_property
    def source_hash(self) -> str:
        """Hash of the source; a saved state contains it, so that another build rejects the state."""
        return content_hash(self.source)[:16]

    @property
    def switches(self) -> bool:
        """True for a model with freewheels, whose steps can end at a freewheel switching event."""
        return "event_pending" in self.records[3]

    def place(self, name: str) -> int:
        """Return the place of a field in its record, doubles.

        Args:
            name: name of a variable; or name of an input with "_rate" or "_has_rate" at its end.
        """
        variable = self.by_name.get(name)
        return place(self.records[RECORD_OF[variable.causality if variable else INPUT]], name)

    def in_fmu(self, fmi: int) -> tuple[Variable, ...]:
        """Return the variables of an FMU: the table and, in FMI 3.0, the time.

        Args:
            fmi: version of FMI, 2 or 3.
        """
        return (*self.variables, self.time) if fmi == 3 else self.variables

    def with_causality(self, *causalities: str) -> Iterator[Variable]:
        """Return the variables of these causalities in the order of the table.

        Args:
            causalities: INPUT, OUTPUT, LOCAL or PARAMETER.
        """
        return with_causality(*causalities, table=self.variables)

    def range_errors(self, parameters: Any) -> list[str]:
        """Return one message for each parameter out of its range.

        Args:
            parameters: record p.
        """
        numbers = [
            (variable, getattr(parameters, variable.name)) for variable in self.with_causality(PARAMETER)
        ]
        # start values need no check, and nearly all parameters have their start values
        return [
            must_be(variable.name, variable.allowed, number)
            for variable, number in numbers
            if number != variable.start and not variable.accepts(number)
        ]


_P, _U, _Y = interface(variables.VARIABLES)
_D = (*_P, *fields.CONSTANTS, ("map_key", len(variables.MAP_KEY)))
_RATED = tuple(name for name in _Y if not variables.BY_NAME[name].of_step)
assert _Y[: len(_RATED)] == _RATED, "kernel/entry.py differentiates the first outputs"
_W = (*fields.WORKSPACE, ("outputs_0", _RATED), ("outputs_1", _RATED))

INERTIA_MODULE = Model(
    name="InertiaModule",
    title="Inertia module",
    description=(
        "Inertia module: inertial torque transformer with unbalanced satellites on a bevel or planar"
        " differential and two freewheels (one-way clutches) that rectify the torque pulses"
    ),
    variables=variables.VARIABLES,
    time=variables.TIME,
    call=entry.call,
    records=(_P, _D, _U, fields.STATE, _Y, _W),
    messages=messages.MESSAGES,
    warnings=messages.WARNINGS,
    traced=("contact_mode", "contact_switches", "rhs_evaluations", "omega2", "omega_out"),
    bounds=(
        Bound("x", place(fields.STATE, "mode"), codes.HELD_DRIVING),
        # one bit for the sign of each satellite's spin
        Bound("x", place(fields.STATE, "tau6_signs"), 2 ** int(variables.BY_NAME["satellites"].ends[1])),
    ),
    terminals=variables.TERMINALS,
)

_P, _U, _Y = interface(variables.OF_SHAFT)

DRIVEN_SHAFT = Model(
    name="DrivenShaft",
    title="Driven shaft",
    description=(
        "Driven shaft: hub with prescribed speed, elastic shaft with damping, driven mass with friction and"
        " balancer; the elastic output of the inertia module as a separate model"
    ),
    variables=variables.OF_SHAFT,
    time=variables.TIME_OF_SHAFT,
    call=shaft.call,
    records=(_P, shaft.CONSTANTS, _U, shaft.STATE, _Y, shaft.WORKSPACE),
    messages=messages.input_messages(variables.OF_SHAFT),
    traced=("omega_out", "twist"),
    terminals=variables.TERMINALS_OF_SHAFT,
)

MODELS = {model.name: model for model in (INERTIA_MODULE, DRIVEN_SHAFT)}
