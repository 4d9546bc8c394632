"""The models of the package, each described once: module, FMUs and documentation are made from this."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

from ..common.errors import Named
from ..compiling.kernels import DRIVEN_SHAFT as SHAFT_ENTRY
from ..compiling.kernels import ENTRIES
from ..compiling.kernels import MODULE as MODULE_ENTRY
from ..compiling.records import Field, place
from ..kernel import codes, entry, fields
from ..kernel.driven_shaft import entry as driven_shaft
from . import driven_shaft_messages, driven_shaft_variables, messages, variables
from .variable import INPUT, LOCAL, OUTPUT, PARAMETER, Variable
from .variables import with_causality

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


# what a positive torque at a flange does at positive speed: brings energy into the model, or takes it out
INFLOW, OUTFLOW = "inflow", "outflow"


class Terminal(NamedTuple):
    """A rotating flange where models are connected: its speed and its torque, of which one is an input.

    Attributes:
        name, description: for people. speed, torque: names of variables. flow: INFLOW or OUTFLOW.
        angle: name of the variable, or "".
    """

    name: str
    description: str
    speed: str
    torque: str
    flow: str
    angle: str = ""


@dataclass(frozen=True, eq=False)
class Model:
    """One model: its variables, its kernel, and what it says.

    Attributes:
        name: name in saved states. title: for people. description: one sentence without its full stop.
        variables: its table.
        entry: name of its kernel in kernels.ENTRIES. call: the same as plain Python.
        messages: what it says for each status of its kernel but OK (see messages.MESSAGES).
        warnings: what it says of a mechanism that is accepted but cannot be built (see messages.WARNINGS).
        zero_at_start: outputs that are zero at initialisation.
        given_at_start: outputs that depend at initialisation on these names alone. All other outputs
            depend on all inputs and parameters but idle_at_start.
        late: variables that the kernel's STEP_ONLY leaves out and OUTPUTS fills in.
        traced: variables that a log of every step shows.
        bounds: of the numbers in d and x that are used as an index or a choice.
        terminals: the flanges.
    """

    name: str
    title: str
    description: str
    variables: tuple[Variable, ...]
    entry: str
    call: Callable[..., int]
    messages: Mapping[int, str]
    idle_at_start: frozenset[str]
    zero_at_start: frozenset[str]
    given_at_start: Mapping[str, frozenset[str]] = field(default_factory=dict)
    late: frozenset[str] = frozenset()
    traced: tuple[str, ...] = ()
    bounds: tuple[Bound, ...] = ()
    warnings: Mapping[int, str] = field(default_factory=dict)
    terminals: tuple[Terminal, ...] = ()

    @cached_property
    def by_name(self) -> dict[str, Variable]:
        """The variables by their names."""
        return Named({variable.name: variable for variable in self.variables}, f"a variable of {self.name}")

    @property
    def records(self) -> tuple[tuple[Field, ...], ...]:
        """Fields of the kernel's records p, d, u, x, y and w."""
        return ENTRIES[self.entry].records

    @property
    def switches(self) -> bool:
        """Tell whether its steps can stop where a freewheel switches."""
        return "switching" in self.records[3]

    def place(self, name: str) -> int:
        """Place of a variable, of the rate of an input or of whether that is given in its record."""
        of = self.by_name.get(name)
        return place(self.records[RECORD_OF[of.causality if of else INPUT]], name)

    def with_causality(self, *causalities: str) -> Iterator[Variable]:
        """Variables of these causalities, in the order of the table."""
        return with_causality(*causalities, table=self.variables)

    def explain(self, status: int, parameters: Any, inputs: Any, step: float) -> str:
        """The message for a status of the kernel, not OK.

        Args:
            status: what the kernel answered. parameters, inputs: records. step: communication step, s.
        """
        return self._filled(self.messages[status], parameters, inputs, step)

    def warn(self, found: int, parameters: Any, inputs: Any) -> list[str]:
        """The sentences for a sum of warnings of the kernel.

        Args:
            found: what the kernel answered. parameters, inputs: records.
        """
        texts = [text for number, text in self.warnings.items() if found & number]
        return [self._filled(text, parameters, inputs, 0.0) for text in texts]

    def _filled(self, text: str, parameters: Any, inputs: Any, step: float) -> str:
        """A sentence with the values in their places."""
        values = {"step": f"{step:.16g}"}
        for record, names in ((parameters, self.records[0]), (inputs, self.records[2])):
            values |= {name: f"{getattr(record, name):.16g}" for name in names}
        return text.format_map(values)

    def known_at_start(self, output: str) -> frozenset[str]:
        """Inputs and parameters an output depends on at initialisation."""
        if output in self.zero_at_start:
            return frozenset()
        if output in self.given_at_start:
            return self.given_at_start[output]
        known = {variable.name for variable in self.with_causality(INPUT, PARAMETER)}
        return frozenset(known - self.idle_at_start)


INERTIA_MODULE = Model(
    name="InertiaModule",
    title="Inertia module",
    description=(
        "Inertia module: inertial torque transformer, unbalanced satellites on a bevel or planar"
        " differential, rectified by freewheels"
    ),
    variables=variables.VARIABLES,
    entry=MODULE_ENTRY,
    call=entry.call,
    messages=messages.MESSAGES,
    warnings=messages.WARNINGS,
    idle_at_start=frozenset(
        {"tolerance", "max_step", "method", "input_hold", "shaft_stiffness", "shaft_damping"}
    ),
    zero_at_start=frozenset(
        {
            *("input_torque_mean", "output_torque_mean", "mesh_torque_mean", "housing_torque_mean"),
            *("loss_power_mean", "output_angle", "output_turns"),
            *("input_flange_angle", "output_flange_angle"),
        }
    ),
    given_at_start={
        "input_speed": frozenset({"omega1"}),
        "omega_out": frozenset({"omega1", "fidelity", "kinematic_ratio", "omega_out_start"}),
    },
    late=frozenset(fields.LATE),
    traced=("contact_mode", "contact_switches", "rhs_evaluations", "omega2", "omega_out"),
    bounds=(
        Bound("d", place(fields.CONSTANTS, "forward.count"), fields.KNOTS),
        Bound("d", place(fields.CONSTANTS, "backward.count"), fields.KNOTS),
        Bound("x", place(fields.STATE, "mode"), codes.HELD_DRIVING),
        Bound("x", place(fields.STATE, "map_knot"), fields.KNOTS - 1),
    ),
    terminals=(
        Terminal(
            "input_flange",
            "input shaft, its speed given (drive = speed): the torque it takes from the shaft in front",
            "omega1",
            "input_torque_mean",
            INFLOW,
            "input_flange_angle",
        ),
        Terminal(
            "input_flange_by_torque",
            "input shaft, its torque given (drive = torque)",
            "input_speed",
            "drive_torque",
            INFLOW,
            "input_flange_angle",
        ),
        Terminal(
            "output_flange",
            "output shaft (driven mass if elastic): the torque that the shaft behind takes from it is given",
            "omega_out",
            "load_torque",
            OUTFLOW,
            "output_flange_angle",
        ),
        Terminal(
            "load",
            "the output flange for a load that needs no angle, as the driven shaft has it",
            "omega_out",
            "load_torque",
            OUTFLOW,
        ),
    ),
)

_SHAFT = frozenset({"hub_speed", "shaft_stiffness", "shaft_damping", "omega_out_start", "twist_start"})

DRIVEN_SHAFT = Model(
    name="DrivenShaft",
    title="Driven shaft",
    description=(
        "Driven shaft: hub of given speed, elastic shaft with damping, driven mass with friction and"
        " balancer; the elastic output of the inertia module alone"
    ),
    variables=driven_shaft_variables.VARIABLES,
    entry=SHAFT_ENTRY,
    call=driven_shaft.call,
    messages=driven_shaft_messages.MESSAGES,
    idle_at_start=frozenset({"balancer", "input_hold"}),
    zero_at_start=frozenset({"shaft_torque_mean"}),
    given_at_start={
        "shaft_torque": _SHAFT,
        "omega_out": frozenset({"omega_out_start"}),
        "twist": frozenset({"twist_start"}),
    },
    traced=("omega_out", "twist"),
    terminals=(
        Terminal(
            "hub",
            "hub of the shaft, its speed given: the torque it takes from the shaft in front",
            "hub_speed",
            "shaft_torque_mean",
            INFLOW,
        ),
        Terminal(
            "load",
            "driven mass: the torque that the load takes from it is given",
            "omega_out",
            "load_torque",
            OUTFLOW,
        ),
    ),
)
