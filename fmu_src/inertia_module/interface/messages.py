"""Messages for invalid values, rejected steps and warnings: names, values and allowed values.

Each status of the kernels and each warning has one message. {name} is replaced by the value of the parameter
or input, {omega1_rate} by the rate of the input omega1, {step} by the communication step. Python, the native
FMU and the viewer insert the values.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..common.errors import must_be
from ..kernel import codes
from ..kernel.inputs import MIN_STEP
from .variables import INPUT, LARGEST_STEP, VARIABLES, Group, Variable, with_causality

_STEPS = f"between {MIN_STEP:g} and {LARGEST_STEP:g} s"
_REJECTED_STEP = "communication step = {step} s is rejected: "


def with_values(*names: str) -> str:
    """Return names with placeholders for their values, separated by commas: "a = {a}, b = {b}".

    Args:
        names: names of parameters or inputs.
    """
    return ", ".join(f"{name} = {{{name}}}" for name in names)


def input_messages(table: Iterable[Variable]) -> dict[int, str]:
    """Return the messages for inputs, rates and steps out of range and for an overflow, by status.

    Args:
        table: variables of the model.
    """
    messages = {codes.BAD_STEP: must_be("communication step", _STEPS, "{step}")}
    inputs = list(with_causality(INPUT, table=table))
    for n, variable in enumerate(inputs):
        name, allowed = variable.name, variable.allowed
        messages[codes.BAD_INPUT + n] = must_be(name, allowed, f"{{{name}}}")
        messages[codes.BAD_RATE + n] = (
            f"the rate of {name} must keep {name} {allowed} over {{step}} s (got {{{name}_rate}}"
            f" {variable.unit}/s from {with_values(name)})"
        )
    speed = inputs[0]
    messages[codes.BAD_HOLD] = (
        f"{speed.name} must stay {speed.allowed} over {{step}} s with input_hold = linear (got"
        f" {{{speed.name}}}). The extrapolation of its change in a far shorter step leaves this range. Use"
        " steps of similar length, or input_hold = zero_order."
    )
    *others, last = (f"{with_values(variable.name)} {variable.unit}" for variable in inputs)
    messages[codes.NOT_FINITE] = (
        f"{_REJECTED_STEP}numerical overflow (magnitude above 1e300) with {', '.join(others)} and {last}"
    )
    return messages


_LINK_INERTIAS = ("link2_inertia", "input_inertia", "drive_inertia")
_FRICTION = ("input_friction", "drive_friction", "link2_friction", "output_friction")
_LOSSES = [v.name for v in VARIABLES if v.group == Group.LOSSES and v.name not in _FRICTION]

MESSAGES: Mapping[int, str] = {
    codes.FREEWHEELS_REQUIRED: (
        "housing_freewheel and output_freewheel must both be 1 (true) with fidelity = averaged (got"
        " {housing_freewheel} and {output_freewheel}). Without both freewheels nothing rectifies the pulses"
        " and there is no mean torque."
    ),
    codes.SOFT_FREEWHEEL: (
        "housing_stiffness and freewheel_stiffness must each be 0 (rigid) or between 0.01 and 1e+08 N.m/rad"
        " (got {housing_stiffness} and {freewheel_stiffness})"
    ),
    codes.BACKLASH_UNSUPPORTED: (
        "housing_engagement_angle and output_engagement_angle must be 0 with fidelity = kinematic (got"
        " {housing_engagement_angle} and {output_engagement_angle}). With prescribed motion no freewheel"
        " engages."
    ),
    codes.WINDAGE_UNSUPPORTED: (
        "windage must be 0 with fidelity = averaged (got {windage}). Windage requires fidelity 0"
        " (kinematic), 2 (rigid) or 3 (elastic)."
    ),
    codes.SELF_LOCKING: (
        f"mesh_efficiency and satellite_mesh_efficiency must be higher with {with_values(*_LINK_INERTIAS)}"
        " (got {mesh_efficiency} and {satellite_mesh_efficiency}). The gear meshes are self-locking."
        " Increase the efficiencies or these inertias."
    ),
    codes.SINGULAR: (
        "link2_inertia must be above 1e-12 of the maximum inertia at link 2 with"
        f" {with_values('drive_inertia', 'a', 'b', 'eccentricity', 'imbalance_mass')}"
        " (got {link2_inertia}). The inertia at link 2 vanishes where the unbalanced mass is at rest relative"
        " to the carrier (a = b or eccentricity = 0). Alternatively set drive_inertia or satellite_inertia"
        " above 0, or use different values for a and b."
    ),
    codes.BAD_START_HOUSING: "omega2_start must be at least 0 with a housing freewheel (got {omega2_start})",
    codes.BAD_START_OUTPUT: (
        f"omega_out_start must be at least {with_values('omega2_start')} with an output freewheel (got"
        " {omega_out_start})"
    ),
    codes.BAD_START_RIGID: (
        f"omega_out_start must be equal to {with_values('omega2_start')} without an output freewheel (got"
        " {omega_out_start})"
    ),
    codes.INPUT_INERTIA_TOO_SMALL: (
        "input_inertia must be above 1e-12 of the maximum inertia of the mechanism at the input with"
        " drive = torque (got {input_inertia}). It must include the inertia of the engine or motor."
    ),
    codes.TORQUE_DRIVE_UNSUPPORTED: (
        "fidelity must be 1 (averaged), 2 (rigid) or 3 (elastic) with drive = torque (got {fidelity},"
        " kinematic). With prescribed motion the input torque is an output."
    ),
    **input_messages(VARIABLES),
    codes.TOO_MUCH_WORK: (
        f"{_REJECTED_STEP}it requires more than 5e7 right-hand-side evaluations. Use a shorter communication"
        " step or increase the parameter tolerance."
    ),
    codes.STEP_TOO_SMALL: (
        f"{_REJECTED_STEP}no internal step meets {with_values('tolerance')}."
        " Increase tolerance or link2_inertia."
    ),
    codes.NOT_BALANCED: (
        f"{_REJECTED_STEP}the energy balance check failed with {with_values('tolerance', 'max_step')}. Reduce"
        " the parameter tolerance or max_step."
    ),
    codes.NO_CYCLIC_STEADY_STATE: (
        "fidelity = averaged is rejected: no periodic steady state was found at constant output speed with"
        f" {with_values('link2_inertia', 'drive_friction', 'link2_friction')}, {with_values(*_LOSSES)}."
        " Increase link2_inertia or use fidelity = rigid."
    ),
    codes.LIGHT_INPUT: (
        "input_inertia must be at least 5 times the largest inertia I of the unbalanced masses with"
        " fidelity = averaged and drive = torque (got {input_inertia}). Otherwise the input speed oscillates"
        " too much; use fidelity = rigid."
    ),
}

# warnings about accepted parameters, by their numbers in kernel.codes
WARNINGS: Mapping[int, str] = {
    codes.PLANAR_OVERLAP: (
        "the {satellites} satellites of a module overlap: (sun_radius + satellite_radius) sin(pi/satellites)"
        " must be at least satellite_radius = {satellite_radius} m, with sun_radius = {sun_radius} m"
    ),
    codes.BEVEL_OVERLAP: (
        "the {satellites} satellites of a module overlap: sin(pi/satellites) sqrt(1 + 2 s cos(shaft_angle) +"
        " s^2) must be at least 1, with s = z17/z6 = {z17}/{z6} and shaft_angle = {shaft_angle} rad"
    ),
    codes.PLANAR_OUTSIDE: (
        "the unbalanced mass is outside its satellite: eccentricity must be at most satellite_radius ="
        " {satellite_radius} m (got {eccentricity} m)"
    ),
    codes.BEVEL_OUTSIDE: (
        "the unbalanced mass is outside the pitch cone of its satellite: a must be at most 1 and at most"
        " b = {b} (got {a})"
    ),
    codes.GEAR_TOO_FLAT: (
        "physically impossible inertia: satellite_inertia must be at most twice satellite_transverse_inertia"
        " = {satellite_transverse_inertia} kg.m2 (got {satellite_inertia} kg.m2)"
    ),
    codes.METHOD_DEPRECATED: (
        "method = timestepping is no longer available. The module uses method = event; tolerance controls"
        " the accuracy."
    ),
}
