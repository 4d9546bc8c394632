"""What refusals by the kernel of the module say to a person: names, values and what is allowed.

Each status and each warning has a sentence; {name} in it stands for the value of that parameter or
input, {omega1_rate} and the like for the rates given, {step} for the communication step. Python and the
native FMU fill them in.
"""

from __future__ import annotations

from collections.abc import Mapping

from .kernel import codes
from .variables import BY_NAME, LARGEST_STEP, Variable, refusal


def named(*names: str) -> str:
    """Names and values, separated by commas."""
    return ", ".join(f"{name} = {{{name}}}" for name in names)


def bad_input(variable: Variable) -> str:
    """Sentence for an input that is not finite or absurd."""
    return refusal(variable, f"{{{variable.name}}}")


def bad_rate(variable: Variable) -> str:
    """Sentence for a rate that makes an input absurd within the step."""
    name = variable.name
    return (
        f"the rate {{{name}_rate}} {variable.unit}/s of {name} is refused with {named(name)} over"
        f" {{step}} s: allowed is what keeps {name} {variable.allowed}"
    )


BAD_STEP = f"communication step = {{step}} s is refused: allowed is above 0 up to {LARGEST_STEP:g} s"
_GIVEN_UP = "communication step = {step} s is given up: "


def not_finite(*inputs: Variable) -> str:
    """Sentence for a motion that overflows with these inputs."""
    *others, last = (f"{named(variable.name)} {variable.unit}" for variable in inputs)
    listed = f"{', '.join(others)} and {last}"
    return (
        f"{_GIVEN_UP}the motion leaves the range of doubles with {listed}; allowed is what stays below 1e300"
    )


def _bad_start_output(word: str, sign: str) -> str:
    return (
        f"{named('omega_out_start', 'omega2_start')} are refused together: {word} the output freewheel"
        f" allowed is omega_out_start {sign} omega2_start"
    )


MESSAGES: Mapping[int, str] = {
    codes.NO_RECTIFIER: (
        f"{named('fidelity', 'housing_freewheel', 'output_freewheel')} are refused together: without both"
        " freewheels nothing rectifies the pulses and there is no mean torque; allowed is fidelity = 1"
        " (averaged) with both freewheels"
    ),
    codes.SINGULAR: (
        f"{named('link2_inertia', 'drive_inertia', 'a', 'b', 'eccentricity', 'imbalance_mass')} are refused"
        " together: the inertia behind link 2 vanishes where the imbalance rests in link 1 (a = b, or no"
        " eccentricity); allowed is link2_inertia > 0, drive_inertia > 0, or a different from b"
    ),
    codes.BAD_START_HOUSING: (
        f"{named('omega2_start')} is refused: with the housing freewheel allowed is omega2_start >= 0"
    ),
    codes.BAD_START_OUTPUT: _bad_start_output("with", ">="),
    codes.BAD_START_RIGID: _bad_start_output("without", "="),
    codes.NO_INPUT_INERTIA: (
        f"{named('input_inertia', 'drive')} are refused together: the speed of link 1 follows from a torque"
        " only where it has inertia; allowed is drive = 0 (speed), or input_inertia > 0 with that of the"
        " engine or motor"
    ),
    codes.PRESCRIBED: (
        f"{named('fidelity', 'drive')} are refused together: the motion is prescribed, so no torque can make"
        " it; allowed is drive = 0 (speed), or fidelity = 1 (averaged), 2 (rigid) or 3 (elastic)"
    ),
    codes.BAD_OMEGA1: bad_input(BY_NAME["omega1"]),
    codes.BAD_LOAD_TORQUE: bad_input(BY_NAME["load_torque"]),
    codes.BAD_OMEGA1_RATE: bad_rate(BY_NAME["omega1"]),
    codes.BAD_LOAD_TORQUE_RATE: bad_rate(BY_NAME["load_torque"]),
    codes.BAD_DRIVE_TORQUE: bad_input(BY_NAME["drive_torque"]),
    codes.BAD_DRIVE_TORQUE_RATE: bad_rate(BY_NAME["drive_torque"]),
    codes.BAD_STEP: BAD_STEP,
    codes.TOO_MANY_SWITCHES: (
        f"{_GIVEN_UP}the freewheels switch without end; allowed is 1000 switches and 64 more a pulse"
    ),
    codes.TOO_MUCH_WORK: (
        f"{_GIVEN_UP}it takes more than 5e7 evaluations of the mechanism; allowed is a shorter"
        " communication step or a larger tolerance"
    ),
    codes.STEP_TOO_SMALL: (
        f"{_GIVEN_UP}no internal step meets {named('tolerance')}; allowed is a larger tolerance, or more"
        " link2_inertia"
    ),
    codes.NOT_FINITE: not_finite(BY_NAME["omega1"], BY_NAME["load_torque"], BY_NAME["drive_torque"]),
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
}
