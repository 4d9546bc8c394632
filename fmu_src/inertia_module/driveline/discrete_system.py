"""Discrete-time system of python-control that is defined by a law: loads, controllers, engines and sources.

This module imports python-control, which takes about 1 s of CPU time. Import it only where a system is made.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import Self

import control as ct

__all__ = ["DiscreteSystem", "Law"]

Numbers = Sequence[float]
# function of time, s, states and inputs that returns outputs and next states
Law = Callable[[float, Numbers, Numbers], tuple[Numbers, Numbers]]


class DiscreteSystem(ct.NonlinearIOSystem):  # type: ignore[misc]
    """Discrete-time system defined by a law.

    ClosedLoop evaluates the law directly, without the functions of python-control around it.

    Args:
        name: Name of the system.
        step: Step, s.
        inputs: Names of the inputs.
        outputs: Names of the outputs.
        law: Function of time, s, states and inputs that returns outputs and next states.
        states: Names of the states.

    Attributes:
        law: Function of time, s, states and inputs that returns outputs and next states.

    Example:
        A load torque of 2 N.m per rad/s:

        >>> def law(time, x, u):
        ...     return [2.0 * u[0]], []
        >>> friction = DiscreteSystem("friction", 0.01, ["omega_out"], ["load_torque"], law)
        >>> float(friction.output(0.0, [], [3.0])[0])
        6.0
    """

    def __init__(
        self,
        name: str,
        step: float,
        inputs: Sequence[str],
        outputs: Sequence[str],
        law: Law,
        states: Sequence[str] = (),
    ) -> None:
        self.law = law
        super().__init__(
            (lambda time, x, u, _: law(time, x, u)[1]) if states else None,
            lambda time, x, u, _: law(time, x, u)[0],
            inputs=list(inputs),
            outputs=list(outputs),
            states=list(states) or None,
            dt=step,
            name=name,
        )

    def to_control(self) -> Self:
        """Return the system itself (deprecated: it already is a system of python-control)."""
        message = "to_control() is deprecated: loads, controllers and sources are systems of python-control"
        warnings.warn(message, DeprecationWarning, stacklevel=2)
        return self
