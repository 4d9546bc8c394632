"""Co-simulation of connected FMUs, Jacobi or Gauss-Seidel, with a fixed communication step."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from ..common.errors import Named, must_be
from .fmu import Closing, Fmu, FmuError, read_description
from .results import TIME, Result
from .simulate import whole_steps
from .wires import Node, Wire, WiringError, check_wiring

__all__ = ["GAUSS_SEIDEL", "JACOBI", "Node", "WiredFmus"]

JACOBI = "Jacobi"
GAUSS_SEIDEL = "Gauss-Seidel"


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
