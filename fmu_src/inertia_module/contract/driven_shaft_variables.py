"""The table of variables of DrivenShaft; what the module has too is taken from its table."""

from __future__ import annotations

from dataclasses import replace

from .variable import FIXED, OUTPUT, PARAMETER, REAL, Variable
from .variables import BY_NAME as OF_MODULE

_LOST = "energy turned to heat by damping and friction since the start, less the work of the balancer"


def _as_in_module(of_module: str, text: str = "", name: str = "") -> Variable:
    """A variable of the module; without "(elastic)", for here nothing else is."""
    known = OF_MODULE[of_module]
    own = text or known.description.replace(" (elastic)", "")
    return replace(known, description=own, name=name or known.name)


def _output(name: str, unit: str, nominal: float, text: str) -> Variable:
    return Variable(name, REAL, OUTPUT, "continuous", unit, None, None, None, nominal, text)


def _input(of_module: str, name: str, text: str) -> Variable:
    """An input of the module; at rest unless it is set, as the driven mass is: a hub that jumps is a shock."""
    return replace(_as_in_module(of_module, text, name), start=0.0)


VARIABLES: tuple[Variable, ...] = (
    _input("omega1", "hub_speed", "speed of the hub, where the shaft is driven"),
    _input("load_torque", "load_torque", "torque of the load on the driven mass, positive against positive speed"),
    _output("shaft_torque", "N.m", 100.0, "torque of spring and damper at this instant: Ts, drives the driven mass, brakes the hub"),
    _output("shaft_torque_mean", "N.m", 100.0, "mean torque of spring and damper over the last communication step: Ts"),
    _as_in_module("omega_out", "speed omega4 of the driven mass"),
    _output("driven_acceleration", "rad/s2", 100.0, "angular acceleration of the driven mass at this instant"),
    _output("twist", "rad", 1e-2, "twist of the shaft: angle of the hub less that of the driven mass"),
    _as_in_module("energy_in", "work of the hub on the shaft since the start"),
    _as_in_module("energy_out", "work done on the load since the start"),
    _as_in_module("energy_stored", "kinetic energy of the driven mass and energy of the twist now"),
    _as_in_module("energy_lost", _LOST),
    _as_in_module("energy_residual", "energy audit: in - out - lost - gain of stored, rounding only"),
    _as_in_module("driven_inertia"),
    _as_in_module("shaft_stiffness", "stiffness c of the shaft"),
    _as_in_module("shaft_damping", "damping d of the shaft"),
    _as_in_module("driven_friction"),
    _as_in_module("balancer", "gain beta of the balancer: the driven mass is pushed by beta J4 times the hub's acceleration"),
    _as_in_module("input_hold", "speed of the hub between communication points"),
    _as_in_module("omega_out_start", "speed of the driven mass at the start"),
    Variable("twist_start", REAL, PARAMETER, FIXED, "rad", 0.0, -1e6, 1e6, None, "twist of the shaft at the start"),
)  # fmt: skip

BY_NAME: dict[str, Variable] = {variable.name: variable for variable in VARIABLES}
