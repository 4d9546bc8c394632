"""The axes of the map, and all cases on them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from . import axes_input, axes_mechanism
from .case import RUNGS, Case, Extreme
from .mechanisms import MECHANISMS, Mechanism

AXES: dict[str, Callable[[Mechanism], Iterator[Extreme]]] = {
    "input speed": axes_input.input_speed,
    "input speed under load": axes_input.speed_under_load,
    "reversal": axes_input.reversal,
    "load": axes_input.load,
    "stall torque": axes_input.stall,
    "grazing": axes_input.grazing,
    "output locked": axes_input.locked,
    "communication step": axes_input.communication_step,
    "fixed step": axes_input.fixed_steps,
    "turns": axes_input.turns,
    "tolerance": axes_input.tolerance,
    "inertia ratio": axes_mechanism.inertia_ratio,
    "mass": axes_mechanism.mass,
    "no inertia of link 2": axes_mechanism.no_link2_inertia,
    "teeth": axes_mechanism.teeth,
    "satellites": axes_mechanism.satellites,
    "freewheels": axes_mechanism.freewheels,
    "shaft": axes_mechanism.shaft,
}


def cases(axis: str, quick: bool = False) -> list[Case]:
    """All cases of an axis: value by value, layout by layout, rung by rung.

    Args:
        quick: leave out those that take long.
    """
    return [
        Case(axis, mechanism.layout, rung, extreme)
        for mechanism in MECHANISMS
        for extreme in AXES[axis](mechanism)
        if not (quick and extreme.slow)
        for rung in extreme.rungs
        if rung in RUNGS
    ]
