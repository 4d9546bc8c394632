"""The table of variables of DrivenShaft; what the module has too is taken from its table."""

from __future__ import annotations

from dataclasses import replace

from .kernel import driven_shaft_slots as slots
from .variables import BY_NAME as OF_MODULE
from .variables import OUTPUT, PARAMETER, REAL, Variable

_LOST = "energy turned to heat by damping and friction since the start, less the work of the balancer"


def _as_in_module(of_module: str, slot: int, text: str = "", name: str = "") -> Variable:
    """A variable of the module in another slot; without "(elastic)", for here nothing else is."""
    known = OF_MODULE[of_module]
    own = text or known.description.replace(" (elastic)", "")
    return replace(known, slot=slot, description=own, name=name or known.name)


def _output(name: str, unit: str, nominal: float, text: str, slot: int) -> Variable:
    return Variable(name, REAL, OUTPUT, "continuous", unit, None, None, None, nominal, text, slot)


VARIABLES: tuple[Variable, ...] = (
    _as_in_module("omega1", slots.U_HUB_SPEED, "speed of the hub, where the shaft is driven", name="hub_speed"),
    _as_in_module("load_torque", slots.U_LOAD_TORQUE, "torque of the load on the driven mass, positive against the motion"),
    _output("shaft_torque", "N.m", 100.0, "torque Ts of spring and damper at this instant: drives the driven mass, brakes the hub", slots.Y_SHAFT_TORQUE),
    _output("shaft_torque_mean", "N.m", 100.0, "mean of Ts over the last communication step", slots.Y_SHAFT_TORQUE_MEAN),
    _as_in_module("omega_out", slots.Y_OMEGA_OUT, "speed omega4 of the driven mass"),
    _output("driven_acceleration", "rad/s2", 100.0, "angular acceleration of the driven mass at this instant", slots.Y_ACCELERATION),
    _output("twist", "rad", 1e-2, "twist of the shaft: angle of the hub less that of the driven mass", slots.Y_TWIST),
    _as_in_module("energy_in", slots.Y_ENERGY_IN, "work of the hub on the shaft since the start"),
    _as_in_module("energy_out", slots.Y_ENERGY_OUT, "work done on the load since the start"),
    _as_in_module("energy_stored", slots.Y_ENERGY_STORED, "kinetic energy of the driven mass and energy of the twist now"),
    _as_in_module("energy_lost", slots.Y_ENERGY_LOST, _LOST),
    _as_in_module("energy_residual", slots.Y_ENERGY_RESIDUAL, "energy audit: in - out - lost - gain of stored, rounding only"),
    _as_in_module("driven_inertia", slots.P_DRIVEN_INERTIA),
    _as_in_module("shaft_stiffness", slots.P_STIFFNESS, "stiffness c of the shaft"),
    _as_in_module("shaft_damping", slots.P_DAMPING, "damping d of the shaft"),
    _as_in_module("driven_friction", slots.P_FRICTION),
    _as_in_module("balancer", slots.P_BALANCER, "gain beta of the balancer: the driven mass is pushed by beta J4 times the hub's acceleration"),
    _as_in_module("input_hold", slots.P_INPUT_HOLD, "hub_speed between communication points"),
    _as_in_module("omega_out_start", slots.P_OMEGA_OUT_START, "speed of the driven mass at the start"),
    Variable("twist_start", REAL, PARAMETER, "fixed", "rad", 0.0, -1e6, 1e6, None, "twist of the shaft at the start", slots.P_TWIST_START),
)  # fmt: skip

BY_NAME: dict[str, Variable] = {variable.name: variable for variable in VARIABLES}
