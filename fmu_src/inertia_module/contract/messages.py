"""The sentences for what the kernels refuse: names, values and what is allowed.

Each status and each warning has one; {name} in it stands for the value of that parameter or input,
{omega1_rate} and the like for the rates given, {step} for the communication step. Python and the native
FMU fill them in.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..common.errors import must_be
from ..kernel import codes
from ..kernel.inputs import SMALLEST_STEP
from .variables import INPUT, LARGEST_STEP, VARIABLES, Group, Variable, with_causality

_STEPS = f"between {SMALLEST_STEP:g} and {LARGEST_STEP:g} s"
_ABANDONED = "communication step = {step} s is abandoned: "


def named(*names: str) -> str:
    """Names and values, separated by commas."""
    return ", ".join(f"{name} = {{{name}}}" for name in names)


def of_inputs(table: Iterable[Variable]) -> dict[int, str]:
    """Sentences for inputs, rates and steps that are not finite or absurd, and for an overflow."""
    sentences = {codes.BAD_STEP: must_be("communication step", _STEPS, "{step}")}
    inputs = list(with_causality(INPUT, table=table))
    for n, variable in enumerate(inputs):
        name, allowed = variable.name, variable.allowed
        sentences[codes.BAD_INPUT + n] = must_be(name, allowed, f"{{{name}}}")
        sentences[codes.BAD_RATE + n] = (
            f"the rate of {name} must keep it {allowed} over {{step}} s, is {{{name}_rate}} {variable.unit}/s"
            f" from {named(name)}"
        )
    speed = inputs[0]
    sentences[codes.BAD_HOLD] = (
        f"with {named('input_hold')} (linear) {speed.name} must stay {speed.allowed} over {{step}} s, does"
        f" not: it has changed to {{{speed.name}}} over a far shorter step"
    )
    *others, last = (f"{named(variable.name)} {variable.unit}" for variable in inputs)
    sentences[codes.NOT_FINITE] = (
        f"{_ABANDONED}the motion leaves the range of doubles with {', '.join(others)} and {last}; it must"
        " stay below 1e300"
    )
    return sentences


_FRICTION = ("input_friction", "drive_friction", "link2_friction", "output_friction")
_LOSSES = [v.name for v in VARIABLES if v.group == Group.LOSSES and v.name not in _FRICTION]

MESSAGES: Mapping[int, str] = {
    codes.NO_RECTIFIER: (
        f"with {named('fidelity')} (averaged) housing_freewheel and output_freewheel must both be 1, are"
        " {housing_freewheel} and {output_freewheel}: without both freewheels nothing rectifies the pulses"
        " and there is no mean torque"
    ),
    codes.WIND_UP_STEPPED: (
        f"with {named('method')} (timestepping) housing_stiffness and freewheel_stiffness must be 0, are"
        " {housing_stiffness} and {freewheel_stiffness}: only the event method winds freewheels up"
    ),
    codes.NO_PLAY: (
        f"with {named('fidelity')} (kinematic) housing_engagement_angle and output_engagement_angle must be"
        " 0, are {housing_engagement_angle} and {output_engagement_angle}: the motion is prescribed, so no"
        " freewheel engages"
    ),
    codes.EVENTS_ONLY: (
        f"with {named('fidelity', 'method')} windage must be 0, is {{windage}}: fidelity 0 (kinematic),"
        " 2 (rigid) and 3 (elastic) have it, with method 0 (event)"
    ),
    codes.JAMMED: (
        f"the meshes jam with {named('link2_inertia', 'input_inertia', 'drive_inertia')}: mesh_efficiency and"
        " satellite_mesh_efficiency must be higher, are {mesh_efficiency} and {satellite_mesh_efficiency}, or"
        " these inertias larger"
    ),
    codes.SINGULAR: (
        f"with {named('drive_inertia', 'a', 'b', 'eccentricity', 'imbalance_mass')} link2_inertia must be"
        " above 0 by more than rounding, is {link2_inertia}: the inertia behind link 2 vanishes where the"
        " imbalance rests in link 1 (a = b, or no eccentricity); drive_inertia or satellite_inertia above 0"
        " or a different from b helps too"
    ),
    codes.BAD_START_HOUSING: "with the housing freewheel omega2_start must be at least 0, is {omega2_start}",
    codes.BAD_START_OUTPUT: (
        f"with the output freewheel omega_out_start must be at least {named('omega2_start')}, is"
        " {omega_out_start}"
    ),
    codes.BAD_START_RIGID: (
        f"without the output freewheel omega_out_start must be {named('omega2_start')}, is"
        " {omega_out_start}"
    ),
    codes.NO_INPUT_INERTIA: (
        f"with {named('drive')} (torque) input_inertia, with that of the engine or motor, must be above 0 by"
        " more than rounding, is {input_inertia}: the speed of link 1 follows from a torque only where it has"
        " inertia"
    ),
    codes.PRESCRIBED: (
        f"with {named('drive')} (torque) fidelity must be 1 (averaged), 2 (rigid) or 3 (elastic), is"
        " {fidelity} (kinematic): the motion is prescribed, so no torque can make it"
    ),
    **of_inputs(VARIABLES),
    codes.TOO_MANY_SWITCHES: (
        f"{_ABANDONED}the freewheels switch too often; they must switch at most 1000 times and 64 more a"
        " pulse"
    ),
    codes.TOO_MUCH_WORK: (
        f"{_ABANDONED}it takes more than 5e7 evaluations of the mechanism; the communication step must be"
        " shorter or tolerance larger"
    ),
    codes.STEP_TOO_SMALL: (
        f"{_ABANDONED}no internal step meets {named('tolerance')}; tolerance or link2_inertia must be larger"
    ),
    codes.NOT_BALANCED: (
        f"{_ABANDONED}its energies do not balance with {named('tolerance', 'max_step')}; tolerance or"
        " max_step must be smaller"
    ),
    codes.NOT_STEADY: (
        f"with {named('fidelity')} (averaged) pulses with losses must become steady behind an output of"
        f" constant speed, do not with {named('link2_inertia', 'drive_friction', 'link2_friction')},"
        f" {named(*_LOSSES)}: link2_inertia must be larger, or fidelity 2 (rigid)"
    ),
}

# what a mechanism that is accepted is warned of, by the numbers of kernel.clearance
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
        "the imbalance is outside its satellite: eccentricity must be at most satellite_radius ="
        " {satellite_radius} m, is {eccentricity} m"
    ),
    codes.BEVEL_OUTSIDE: (
        "the imbalance is outside the pitch cone of its satellite: a must be at most 1 and at most b = {b},"
        " is {a}"
    ),
    codes.GEAR_TOO_FLAT: (
        "no body has such inertias: satellite_inertia must be at most twice satellite_transverse_inertia ="
        " {satellite_transverse_inertia} kg.m2, is {satellite_inertia} kg.m2"
    ),
}
