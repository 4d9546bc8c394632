"""The table of variables of DrivenShaft and the sentences for what its kernel refuses.

What the module has too is taken from its table.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from .messages import of_inputs
from .variable import FIXED, OUTPUT, PARAMETER, REAL, Group, Variable
from .variables import BY_NAME as OF_MODULE
from .variables import signal


def _as_in_module(of_module: str, text: str = "", **columns: Any) -> Variable:
    """A variable of the module; without "(elastic)", for here nothing else is."""
    known = OF_MODULE[of_module]
    own: dict[str, Any] = {"late": False, "in_map": False, "idle": False, "needs": ()} | columns
    return replace(known, description=text or known.description.replace(" (elastic)", ""), **own)


# inputs are at rest unless they are set, as the driven mass is: a hub that jumps is a shock
VARIABLES: tuple[Variable, ...] = (
    _as_in_module("omega1", "speed of the hub, where the shaft is driven", name="hub_speed", start=0.0),
    _as_in_module("load_torque", "torque of the load on the driven mass, positive against positive speed", start=0.0),
    signal(OUTPUT, Group.INSTANT, "shaft_torque", "N.m", 100.0, "torque of spring and damper at this instant: Ts, drives the driven mass, brakes the hub", at_start=("hub_speed", "shaft_stiffness", "shaft_damping", "omega_out_start", "twist_start")),
    signal(OUTPUT, Group.MEANS, "shaft_torque_mean", "N.m", 100.0, "mean torque of spring and damper over the last communication step: Ts", at_start=()),
    _as_in_module("omega_out", "speed omega4 of the driven mass", at_start=("omega_out_start",)),
    signal(OUTPUT, Group.MOTION, "driven_acceleration", "rad/s2", 100.0, "angular acceleration of the driven mass at this instant"),
    signal(OUTPUT, Group.MOTION, "twist", "rad", 1e-2, "twist of the shaft: angle of the hub less that of the driven mass", at_start=("twist_start",)),
    _as_in_module("energy_in", "work of the hub on the shaft since the start"),
    _as_in_module("energy_out", "work done on the load since the start"),
    _as_in_module("energy_stored", "kinetic energy of the driven mass and energy of the twist now"),
    _as_in_module("energy_lost", "energy turned to heat by damping and friction since the start, less the work of the balancer"),
    _as_in_module("energy_residual", "energy audit: in - out - lost - gain of stored, rounding only"),
    _as_in_module("driven_inertia"),
    _as_in_module("shaft_stiffness", "stiffness c of the shaft"),
    _as_in_module("shaft_damping", "damping d of the shaft"),
    _as_in_module("driven_friction"),
    _as_in_module("balancer", "gain beta of the balancer: the driven mass is pushed by beta J4 times the hub's acceleration", idle=True),
    _as_in_module("input_hold", "speed of the hub between communication points", idle=True),
    _as_in_module("omega_out_start", "speed of the driven mass at the start"),
    Variable("twist_start", Group.START, REAL, PARAMETER, FIXED, "rad", 0.0, -1e6, 1e6, "twist of the shaft at the start"),
)  # fmt: skip

BY_NAME: dict[str, Variable] = {variable.name: variable for variable in VARIABLES}

MESSAGES = of_inputs(VARIABLES)
