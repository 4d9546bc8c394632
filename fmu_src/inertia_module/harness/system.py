"""Systems of FMUs: wires checked before anything runs, then stepped together, Jacobi or Gauss-Seidel."""

from __future__ import annotations

import contextlib
import graphlib
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..common.errors import Named, Refused, did_you_mean, must_be
from ..contract.variables import ENUMERATIONS
from ..kernel.codes import DRIVE_SPEED, DRIVE_TORQUE
from .fmu import Closing, Fmu, FmuError, read_description
from .results import TIME, Result
from .simulate import whole_steps

JACOBI = "Jacobi"
GAUSS_SEIDEL = "Gauss-Seidel"
# inputs of the module by its parameter drive: the one that drives it, the one without effect once it runs
_DRIVEN_BY = {DRIVE_SPEED: ("omega1", "drive_torque"), DRIVE_TORQUE: ("drive_torque", "omega1")}
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


class Node(NamedTuple):
    """One FMU of a system.

    Attributes:
        path: the .fmu file. parameters: by name. inputs: by name, those that no wire drives, and start
            values of those that one does. tolerance: for its experiment, or None.
    """

    path: Path | str
    parameters: Mapping[str, float | bool | str] = {}
    inputs: Mapping[str, float] = {}
    tolerance: float | None = None


def _end(descriptions: Mapping[str, Any], wire: Wire, instance: str, name: str, causality: str) -> Any:
    """The variable at one end of a wire, refused where there is none of this causality."""
    if instance not in descriptions:
        hint = did_you_mean(instance, descriptions)
        raise WiringError(f"{wire}: {instance} must be an FMU of the system {hint}")
    there = {v.name: v for v in descriptions[instance].modelVariables if v.causality == causality}
    if name not in there:
        raise WiringError(f"{wire}: {name} must be an {causality} of {instance} {did_you_mean(name, there)}")
    return there[name]


def _driven_by(description: Any, parameters: Mapping[str, Any]) -> tuple[str, str]:
    """Names (input in use, input without effect) of a module by its parameter drive; else ("", "")."""
    known = {variable.name: variable for variable in description.modelVariables}
    if not {"drive", "omega1", "drive_torque"} <= known.keys():
        return "", ""
    drive = parameters.get("drive", int(known["drive"].start))
    return _DRIVEN_BY.get(_DRIVES.get(drive, drive), ("", ""))


def _not_driven_once(
    nodes: Mapping[str, Node], descriptions: Mapping[str, Any], wires: Sequence[Wire]
) -> list[str]:
    """List inputs driven never or more than once, by wires or the user, and wires to one without effect."""
    problems = []
    for instance, node in nodes.items():
        needed, idle = _driven_by(descriptions[instance], node.parameters)
        inputs = (v.name for v in descriptions[instance].modelVariables if v.causality == "input")
        for name in inputs:
            found = [wire for wire in wires if (wire.sink, wire.input) == (instance, name)]
            if name == idle:
                why = f"the input must be {needed}, {idle} has no effect with that drive"
                problems += [f"{wire}: {why}" for wire in found]
            elif len(found) > 1:
                drivers = " and by ".join(f"{wire.source}.{wire.output}" for wire in found)
                problems.append(f"{instance}.{name} must be driven by one of them, is driven by {drivers}")
            elif not found and name not in node.inputs:
                problems.append(
                    f"{instance}.{name} must be driven by a wire or a given value, nothing drives it"
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
    nodes: Mapping[str, Node], descriptions: Mapping[str, Any], wires: Sequence[Wire], step: float
) -> None:
    """Refuse wires that cannot work, before anything runs.

    That is an unknown name, another kind or unit, an input driven twice or not at all, an algebraic loop, or
    a step, s, that is none. The descriptions are fmpy's.
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
    for instance, node in nodes.items():
        for name in node.inputs:
            _end(descriptions, Wire("given", name, instance, name), instance, name, "input")
    problems = _not_driven_once(nodes, descriptions, wires)
    if problems:
        raise WiringError("; ".join(problems))
    _check_loops(descriptions, wires)


class WiredFmus(Closing):
    """FMUs wired to one system; a context manager.

    All step by the same communication step. Jacobi: all with the outputs of its beginning, as hosts that
    step side by side do. Gauss-Seidel: one after the other in the order given, each with the newest.

    Args:
        nodes: FMUs by their names, in the order in which they are stepped. wires: between them.
        step: communication step, s. order: JACOBI or GAUSS_SEIDEL.

    Attributes:
        time: reached, s. fmus: instances by name.

    Raises:
        WiringError: the wires cannot work; nothing has been started. Or by its methods: a wire drives what is
            set, or a stop time is no whole number of steps away.
        FmuError: an FMU cannot be loaded, or refuses something: which, and why. UnknownName: there is none.
    """

    def __init__(
        self, nodes: Mapping[str, Node], wires: Sequence[Wire], step: float, order: str = JACOBI
    ) -> None:
        if order not in (JACOBI, GAUSS_SEIDEL):
            raise WiringError(must_be("order", f"{JACOBI} or {GAUSS_SEIDEL}", repr(order)))
        described = {name: read_description(Path(node.path)) for name, node in nodes.items()}
        check_wiring(nodes, described, wires, step)
        self.step = step
        self.order = order
        self.time = 0.0
        self._wires = tuple(wires)
        self.fmus: Named[Fmu] = Named({}, "an FMU of the system")
        try:
            for name, node in nodes.items():
                self.fmus[name] = Fmu(node.path, node.parameters, node.inputs, node.tolerance)
        except BaseException:
            self.close()
            raise

    def set(self, name: str, **values: float | str) -> None:
        """Set inputs of one FMU that no wire drives."""
        for wire in self._wires:
            if wire.sink == name and wire.input in values:
                raise WiringError(
                    f"{name}.{wire.input} must be an input that no wire drives:"
                    f" {wire.source}.{wire.output} drives it"
                )
        self.fmus[name].set(**values)

    def _pass_on(self, wires: Iterable[Wire]) -> None:
        values = [(wire, self.fmus[wire.source][wire.output]) for wire in wires]
        for wire, value in values:
            self.fmus[wire.sink].set(**{wire.input: value})

    def advance(self) -> None:
        """Advance all by the communication step; where one refuses it, those before it have been stepped."""
        if self.order == JACOBI:
            self._pass_on(self._wires)
        for name, fmu in self.fmus.items():
            if self.order == GAUSS_SEIDEL:
                self._pass_on(wire for wire in self._wires if wire.sink == name)
            try:
                fmu.advance(self.step)
            except FmuError as error:
                raise FmuError(f"{name}: {error}") from error
        self.time += self.step

    def run(self, stop_time: float, outputs: Sequence[tuple[str, str]]) -> Result:
        """Run to stop_time, s, a whole number of steps.

        Args:
            stop_time: s. outputs: (name of the FMU, variable) each.

        Returns:
            Table of the outputs, named name.variable, shape (steps + 1,) each.
        """
        steps = whole_steps(stop_time - self.time, self.step)
        if not steps:
            raise WiringError(
                f"stop_time must be a whole number of steps of {self.step:g} s after {self.time:g} s, is"
                f" {stop_time:g} s"
            )
        read = [(f"{name}.{output}", self.fmus[name], output) for name, output in outputs]
        times = self.time + self.step * np.arange(steps + 1)
        rows = np.empty((times.size, 1 + len(read)))
        for n, time in enumerate(times):
            if n > 0:
                self.advance()
            rows[n] = [time, *(fmu[output] for _, fmu, output in read)]
        units = {name: fmu.units[output] for name, fmu, output in read if output in fmu.units}
        return Result.from_rows((TIME, *(name for name, _, _ in read)), rows, units)

    def close(self) -> None:
        """Close all FMUs."""
        with contextlib.ExitStack() as stack:
            for fmu in self.fmus.values():
                stack.callback(fmu.close)
        self.fmus = Named({}, "an FMU of a system that is open")
