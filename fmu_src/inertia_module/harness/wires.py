"""Wires between co-simulation FMUs, checked before anything runs: names, kinds, units, loops."""

from __future__ import annotations

import graphlib
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from ..common.errors import Refused, did_you_mean, must_be
from ..contract.variables import ENUMERATIONS
from ..kernel.codes import DRIVE_SPEED, DRIVE_TORQUE

# inputs of the module without effect once it runs, by its parameter drive
_IDLE = {DRIVE_SPEED: "drive_torque", DRIVE_TORQUE: "omega1"}
_DRIVES: Mapping[Any, int] = {name: number for name, number, _ in ENUMERATIONS["Drive"]}


class WiringError(Refused):
    """Wires that cannot work: one line for each, naming the signals and what is allowed."""


class Wire(NamedTuple):
    """A connection: an output of one FMU drives an input of another.

    Attributes:
        source, output: name of the FMU instance and of its output. sink, input: likewise.
    """

    source: str
    output: str
    sink: str
    input: str

    def __str__(self) -> str:
        return f"{self.source}.{self.output} -> {self.sink}.{self.input}"


def _end(descriptions: Mapping[str, Any], wire: Wire, instance: str, name: str, causality: str) -> Any:
    """The variable at one end of a wire, refused where there is none of this causality."""
    if instance not in descriptions:
        hint = did_you_mean(instance, descriptions)
        raise WiringError(f"{wire}: {instance} must be an FMU of the system {hint}")
    there = {v.name: v for v in descriptions[instance].modelVariables if v.causality == causality}
    if name not in there:
        raise WiringError(f"{wire}: {name} must be an {causality} of {instance} {did_you_mean(name, there)}")
    return there[name]


def _idle_input(description: Any, parameters: Mapping[str, Any]) -> str | None:
    """The input of a module that has no effect with its drive; None of any other FMU."""
    known = {variable.name: variable for variable in description.modelVariables}
    if not {"drive", *_IDLE.values()} <= known.keys():
        return None
    drive = parameters.get("drive", int(known["drive"].start))
    return _IDLE.get(_DRIVES.get(drive, drive))


def _check_driven(
    descriptions: Mapping[str, Any],
    wires: Sequence[Wire],
    given: Mapping[str, Iterable[str]],
    parameters: Mapping[str, Mapping[str, Any]],
) -> list[str]:
    """List inputs that are not driven once, by a wire or by the user, and wires to one without effect."""
    problems = []
    idle = {name: _idle_input(found, parameters.get(name, {})) for name, found in descriptions.items()}
    for wire in wires:
        if wire.input == idle[wire.sink]:
            other = next(name for name in _IDLE.values() if name != wire.input)
            problems.append(f"{wire}: the input must be {other}, {wire.input} has no effect with that drive")
    drivers: dict[tuple[str, str], list[str]] = {}
    for wire in wires:
        drivers.setdefault((wire.sink, wire.input), []).append(f"{wire.source}.{wire.output}")
    for (instance, name), found in drivers.items():
        if len(found) > 1:
            problems.append(
                f"{instance}.{name} must be driven by one of them, is driven by {' and by '.join(found)}"
            )
    for instance, description in descriptions.items():
        for variable in description.modelVariables:
            needed = variable.causality == "input" and variable.name != idle[instance]
            has = (instance, variable.name) in drivers or variable.name in given.get(instance, ())
            if needed and not has:
                problems.append(
                    f"{instance}.{variable.name} must be driven by a wire or a given value, nothing drives it"
                )
    return problems


def _check_loops(descriptions: Mapping[str, Any], wires: Sequence[Wire]) -> None:
    """Refuse a loop of signals that all follow from each other at one communication point."""
    graph: graphlib.TopologicalSorter[str] = graphlib.TopologicalSorter()
    for instance, description in descriptions.items():
        inputs = {v.name for v in description.modelVariables if v.causality == "input"}
        for unknown in description.outputs:
            # an output depends on all inputs where the FMU does not say on which
            known = unknown.dependencies
            found = inputs if known is None else {v.name for v in known} & inputs
            graph.add(
                f"{instance}.{unknown.variable.name}", *(f"{instance}.{name}" for name in sorted(found))
            )
    for wire in wires:
        graph.add(f"{wire.sink}.{wire.input}", f"{wire.source}.{wire.output}")
    try:
        graph.prepare()
    except graphlib.CycleError as error:
        around = " <- ".join(error.args[1])
        raise WiringError(
            "an algebraic loop must hold an output that does not depend on its inputs at a communication"
            f" point, holds none: {around}"
        ) from None


def check_wiring(
    descriptions: Mapping[str, Any],
    wires: Sequence[Wire],
    given: Mapping[str, Iterable[str]],
    step: float,
    parameters: Mapping[str, Mapping[str, Any]] | None = None,
) -> None:
    """Refuse wires that cannot work, before anything runs.

    Args:
        descriptions: fmpy's model description of each FMU instance by its name.
        wires: between them. given: names of the inputs that have values, by instance; those of driven ones
            are start values.
        step: at which values are exchanged, s.
        parameters: by name, by instance; what drives a module is one of them.

    Raises:
        WiringError: an unknown name, another kind or unit, an input driven twice or not at all, an algebraic
            loop, or a step that is none.
    """
    if not (math.isfinite(step) and step > 0.0):
        raise WiringError(must_be("step", "a positive number of seconds", step))
    for wire in wires:
        start = _end(descriptions, wire, wire.source, wire.output, "output")
        end = _end(descriptions, wire, wire.sink, wire.input, "input")
        if start.type != end.type:
            raise WiringError(f"{wire}: both ends must be of one kind, are {start.type} and {end.type}")
        units = (start.unit or "1", end.unit or "1")
        if units[0] != units[1]:
            raise WiringError(f"{wire}: both ends must be in one unit, are in {units[0]} and {units[1]}")
    for instance, names in given.items():
        for name in names:
            _end(descriptions, Wire("given", name, instance, name), instance, name, "input")
    problems = _check_driven(descriptions, wires, given, parameters or {})
    if problems:
        raise WiringError("; ".join(problems))
    _check_loops(descriptions, wires)
