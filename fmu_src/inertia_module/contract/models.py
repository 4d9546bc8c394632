"""The models of the package, each described once: module, FMUs and documentation are made from this."""

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
from .variables import INPUT, LOCAL, LOSSES, OUTPUT, PARAMETER, Terminal, Variable, with_causality

# which record of the kernel holds the variables of a causality
RECORD_OF = {PARAMETER: 0, INPUT: 2, OUTPUT: 4, LOCAL: 4}


class Bound(NamedTuple):
    """A number of a state that the kernel takes for an index or a choice.

    Attributes:
        record: "d", the constants, or "x", the state. place: of the number in it, in doubles.
        most: it must be a whole number from 0 to this.
    """

    record: str
    place: int
    most: int

    def accepts(self, value: float) -> bool:
        """Tell whether it may have this value."""
        return 0.0 <= value <= self.most and value % 1.0 == 0.0


def interface(table: Iterable[Variable]) -> tuple[tuple[str, ...], ...]:
    """Fields of the kernel's records p, u and y: variables by name, inputs with their rates.

    What the map of fidelity averaged depends on comes first in p. In y what is lost by cause is first, what
    holds for a step last.
    """
    rows = list(table)
    parameters = sorted(with_causality(PARAMETER, table=rows), key=lambda variable: not variable.in_map)
    outputs = sorted(with_causality(OUTPUT, LOCAL, table=rows), key=lambda variable: variable.of_step)
    lost = [name for name in LOSSES if name in {variable.name for variable in outputs}]
    inputs = [variable.name for variable in with_causality(INPUT, table=rows)]
    return (
        tuple(variable.name for variable in parameters),
        tuple(name + ending for ending in ("", "_rate", "_rate_given") for name in inputs),
        (*lost, *(variable.name for variable in outputs if variable.name not in LOSSES)),
    )


@dataclass(frozen=True, eq=False, repr=False)
class Model:
    """One model: its variables, its kernel, and what it says.

    Attributes:
        name: of the native FMU, of saved states. title: for people.
        description: one sentence without its full stop. variables: its table. time: the time of FMI 3.0.
        call: its kernel as plain Python. records: fields of the kernel's p, d, u, x, y and w.
        messages: what it says for each status of its kernel but OK.
        warnings: messages on accepted parameters: a mechanism that cannot be built, a deprecated value.
        traced: variables that a log of every step shows. bounds: of d and x. terminals: the flanges.
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
        """The variables by their names."""
        return Named({variable.name: variable for variable in self.variables}, f"variable of {self.name}")

    @property
    def symbol(self) -> str:
        """Name of its kernel in machine code."""
        within_kernel = self.call.__module__.rpartition(".kernel.")[2]
        return f"inertia_module_{within_kernel.replace('.', '_')}"

    @property
    def sizes(self) -> tuple[int, ...]:
        """Doubles in p, d, u, x, y and w."""
        return tuple(size(record) for record in self.records)

    @property
    def source(self) -> dict[str, bytes]:
        """Source files of the kernel and fields of its records: all that its results follow from."""
        return sources("kernel/**/*.py") | {"records": repr(self.records).encode()}

    @cached_property
    def source_hash(self) -> str:
        """Hash of that: by it a saved state knows its build."""
        return content_hash(self.source)[:16]

    @property
    def switches(self) -> bool:
        """Tell whether its steps can stop where a freewheel switches."""
        return "switching" in self.records[3]

    def place(self, name: str) -> int:
        """Place of a variable, of the rate of an input or of whether that is given in its record."""
        of = self.by_name.get(name)
        return place(self.records[RECORD_OF[of.causality if of else INPUT]], name)

    def in_fmu(self, fmi: int) -> tuple[Variable, ...]:
        """Variables that an FMU of this version of FMI has: the table and, in FMI 3.0, the time."""
        return (*self.variables, self.time) if fmi == 3 else self.variables

    def with_causality(self, *causalities: str) -> Iterator[Variable]:
        """Variables of these causalities, in the order of the table."""
        return with_causality(*causalities, table=self.variables)

    def refused(self, parameters: Any) -> list[str]:
        """One message for each parameter of a record that is out of its own range."""
        given = [(one, getattr(parameters, one.name)) for one in self.with_causality(PARAMETER)]
        # start values are allowed, and most parameters have theirs
        return [
            must_be(one.name, one.allowed, number)
            for one, number in given
            if number != one.start and not one.accepts(number)
        ]


_P, _U, _Y = interface(variables.VARIABLES)
_D = (*_P, *fields.CONSTANTS, ("map_key", len(variables.MAP_KEY)))
_RATED = tuple(name for name in _Y if not variables.BY_NAME[name].of_step)
_W = (*fields.WORKSPACE, ("held", _D), ("outputs_0", _RATED), ("outputs_1", _RATED))

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
        Bound("d", place(_D, "forward.count"), fields.KNOTS),
        Bound("d", place(_D, "backward.count"), fields.KNOTS),
        Bound("x", place(fields.STATE, "mode"), codes.HELD_DRIVING),
        Bound("x", place(fields.STATE, "map_knot"), fields.KNOTS - 1),
        # moments that were seen in the last step; signs of all satellites, a bit each
        Bound("x", place(fields.STATE, "seen"), 2**53),
        Bound("x", place(fields.STATE, "spin_signs"), 2 ** int(variables.BY_NAME["satellites"].ends[1])),
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
    messages=messages.of_inputs(variables.OF_SHAFT),
    traced=("omega_out", "twist"),
    terminals=variables.TERMINALS_OF_SHAFT,
)

MODELS = {model.name: model for model in (INERTIA_MODULE, DRIVEN_SHAFT)}
