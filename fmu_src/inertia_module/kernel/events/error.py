"""Error of a step: one weighted root mean square of all integrated quantities.

Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section II.4. Each error is
divided by the tolerance and by one of six scales: an angle of 1 rad, speeds of link 1, of link 2 and of the
output, angle of shaft and springs, and impulse (times speed: work).
"""

import math

from ..accumulate import clear
from ..equations.losses import JOURNAL, MESH
from ..equations.states import ENGAGED_COMPLIANT, LOCKED, has_engaged_spring
from ..links import response, shaft_frequency
from ..records import Constants, Integrated, State, Workspace
from ..tableau import (
    DOP853_E3_ROW,
    DOP853_E5_ROW,
    DOP853_LAST_STAGE,
    DOP853_ROW,
    DOPRI5_E_ROW,
    DOPRI5_LAST_STAGE,
    FIRST_ERROR_STAGE,
)
from .stages import weighted_rate

OVERFLOW = 1e300


def fastest_link(x: State, change: Integrated) -> float:
    """Return the largest speed of links 1 and 2 at the ends of the step, rad/s."""
    speed1 = max(abs(x.omega1), abs(x.omega1 + change.omega1))
    return max(speed1, abs(x.omega2), abs(x.omega2 + change.omega2))


def fastest_output(d: Constants, x: State, change: Integrated) -> float:
    """Return the largest speed of the output in the step, or the speed that its twist can drive, rad/s."""
    speed = max(abs(x.omega3), abs(x.omega3 + change.omega3))
    if d.elastic != 0.0:
        driven = max(abs(x.omega3 - x.relative), abs(x.omega3 + change.omega3 - x.relative - change.relative))
        twist = max(abs(x.twist), abs(x.twist + change.twist))
        speed = max(speed, driven, shaft_frequency(d, 1.0 / d.J3) * twist)
    return speed


def damped_scale(d: Constants, x: State, links: float, scale: float) -> float:
    """Return the scale of the speed of link 2 while dampers of freewheels act on it, rad/s.

    An error of the speed causes an error of the damping torque. It is limited to the tolerance times the
    torque of the pulses, because a larger one would open a freewheel.

    Args:
        d: Constants.
        x: State at the beginning of the step.
        links: Largest speed of links 1 and 2, rad/s.
        scale: Scale without dampers, rad/s.
    """
    damping = d.housing_damping if x.housing_state == ENGAGED_COMPLIANT else 0.0
    if x.output_state == ENGAGED_COMPLIANT:
        damping = max(damping, d.freewheel_damping)
    torque = d.F_by_speed * links * links
    return torque / damping if damping * scale > torque else scale


def write_scales(d: Constants, x: State, w: Workspace) -> None:
    """Write the scale of each integrated quantity into w.scale, 0 for a quantity whose error does not count.

    A heavy link hardly changes its speed, but these small changes are its torque. The scale of a speed is
    therefore the fraction that the imbalances can impart to the inertia of the link (links.response). If load
    or shaft cause a larger change in the step, the scale is this change.
    """
    scale, change = w.scale, w.change
    clear(scale.numbers)
    links = fastest_link(x, change)
    output = max(links, fastest_output(d, x, change))
    if has_engaged_spring(x):
        links = output
    scale.q = 1.0
    if d.by_torque != 0.0:
        scale.omega1 = response(d, d.J1) * links
    carried = d.J3 if x.output_state == LOCKED else 0.0
    scale.omega2 = response(d, d.J2 + carried) * links
    if has_engaged_spring(x):
        scale.omega2 = damped_scale(d, x, links, scale.omega2)
    scale.omega2 = max(scale.omega2, abs(change.omega2))
    output_scale = max(response(d, d.J2 + d.J3) * output, abs(change.omega3))
    if d.elastic != 0.0:
        output_scale = max(output_scale, abs(change.relative))
        scale.relative = output_scale
        scale.twist = max(output_scale / shaft_frequency(d, 1.0 / d.J3), abs(change.twist))
    if x.output_state != LOCKED:
        scale.omega3 = output_scale
    if d.losses != 0.0:
        stiffness = max(d.housing_stiffness, d.freewheel_stiffness)
        angle = links * math.sqrt(d.J2 / stiffness) if stiffness > 0.0 else 1.0
        scale.wound_housing = scale.wound_output = angle
    has_quadratures = d.losses != 0.0 or w.prescribed != 0.0
    if d.by_torque == 0.0 or d.losses != 0.0:
        inertia = (d.F_by_alpha1 + 0.5 * d.F_by_speed) / d.k + d.J2 * response(d, d.J2)
        impulse = inertia * links if has_quadratures else 0.0
        work = impulse * links + (d.J3 * output * output if has_quadratures else 0.0)
        scale.drive = impulse if d.by_torque == 0.0 else 0.0
        scale.work_in = work
        if d.losses != 0.0:
            scale.housing = impulse
            scale.lost[MESH] = scale.lost[JOURNAL] = work


def error_norm(w: Workspace) -> float:
    """Return the estimated error of the present step over the allowed error.

    For the pair 8(5,3) it combines the errors of orders 5 and 3 (Hairer, Norsett and Wanner, II.10).
    """
    sum5 = 0.0
    sum3 = 0.0
    count = 0.0
    for n in range(len(w.scale.numbers)):
        scale = w.tolerance * w.scale.numbers[n]
        if scale > 0.0:
            count += 1.0
            if w.pair == DOP853_ROW:
                error5 = (
                    w.step * weighted_rate(w, DOP853_E5_ROW, DOP853_LAST_STAGE, n, FIRST_ERROR_STAGE) / scale
                )
                error3 = (
                    w.step * weighted_rate(w, DOP853_E3_ROW, DOP853_LAST_STAGE, n, FIRST_ERROR_STAGE) / scale
                )
                sum5 += error5 * error5
            else:
                error3 = w.step * weighted_rate(w, DOPRI5_E_ROW, DOPRI5_LAST_STAGE + 1, n, 1) / scale
            sum3 += error3 * error3
    if not sum3 + sum5 < OVERFLOW:
        return OVERFLOW
    if w.pair != DOP853_ROW:
        return math.sqrt(sum3 / count)
    mix = sum5 + 0.01 * sum3
    return sum5 / math.sqrt(count * mix) if mix > 0.0 else 0.0
