"""The numbered equations of Karetin over a period of the general case.

(1) to (18) in the stop mode, but for (1), the others in the dynamic mode.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..forms import Forms
from ..jets import Jet, rate, vector
from ..report import Equation, compared
from .as_printed import PRINTED, factors, position
from .cases import DYNAMIC, GENERAL, STOP, over_period
from .exact import turned

STOPPED, MOVING = over_period(GENERAL, STOP), over_period(GENERAL, DYNAMIC)


def position_in_time(e: Forms) -> Jet:
    """(2) with U5 U4 put right, turned by omega1 t, as a jet."""
    t, (U1, U2, U3, _, U5, U6) = Jet(e.t, 1.0, 0.0), factors(GENERAL)
    right = U1, U2, U3, U3 * np.cos(GENERAL.shaft_angle) / U5, U5, U6
    r = position(right, e.omega16 * t + GENERAL.gamma, e.omega6 * t + GENERAL.epsilon)
    sine, cosine = np.sin(e.motion.carrier * t), np.cos(e.motion.carrier * t)
    turned: Jet = vector(r[0], r[1] * cosine - r[2] * sine, r[1] * sine + r[2] * cosine)
    return turned


def angles_in_time(e: Forms) -> Jet:
    """(5) put right, as a jet; its quadrant does not count, for only its rates are asked for."""
    r = position_in_time(e)
    angles: Jet = vector(np.arctan(r[1] / r[0]), np.arctan(r[1] / r[2]), np.arctan(r[2] / r[0]))
    return angles


def _coefficient_v() -> tuple[Any, ...]:
    """As v x_D, which (20) and (22) use: v itself has no largest value."""
    x = MOVING.position_in_link1[0]
    return PRINTED["v"](MOVING) * x, MOVING.v * x


def _slope() -> tuple[Any, ...]:
    """As an angle: the slope has no largest value. The foot is as steep as OL."""
    return np.arctan(PRINTED["k1"](MOVING)), np.arctan(MOVING.foot_L[1] / MOVING.foot_L[0])


# with rates of the exact place and angles, for the equations that are sums of velocities or rates
STOPPED_RATE, MOVING_RATE = (rate(position_in_time(e)) for e in (STOPPED, MOVING))
SUM_IN_LINK1 = compared("velocity_in_link1", PRINTED, STOPPED.given(velocity_in_link1=STOPPED_RATE.value))
SUM_OF_THREE = turned(MOVING.given(sin_theta=-MOVING.sin_theta), MOVING_RATE.value)

IN_STOP_MODE = (
    *("position_in_link1", "radius", "projections", "angles", "angular_velocities", "velocity_in_link1"),
    *("arm_of_imbalance", "spin_of_satellite", "mu", "about_satellite", "speed_about_satellite"),
    *("spin_of_drive", "lambda_", "about_drive", "speed_about_drive", "velocity_in_link1", "speed_in_link1"),
)
IN_DYNAMIC_MODE = (
    *("alpha", "spin_of_link1", "v", "about_centre", "sum_of_three", "velocity", "speed"),
    *("foot_L", "k1", "arm_L", "speed_L", "foot_M", "foot_N", "acceleration", "acceleration_modulus"),
)
EQUATIONS = (
    {"(1)": compared("speeds", PRINTED, MOVING)}
    | {f"({n})": compared(name, PRINTED, STOPPED) for n, name in enumerate(IN_STOP_MODE, 2)}
    | {f"({n})": compared(name, PRINTED, MOVING) for n, name in enumerate(IN_DYNAMIC_MODE, 19)}
    | {
        "(6)": compared("angular_velocities", PRINTED, STOPPED.given(angles=angles_in_time(STOPPED))),
        "(7)": SUM_IN_LINK1,
        "(17)": SUM_IN_LINK1,
        "(21)": Equation("v", _coefficient_v),
        "(23)": compared("sum_of_three", PRINTED, MOVING.given(sum_of_three=SUM_OF_THREE)),
        "(27)": Equation("k1", _slope),
        "(32)": compared("acceleration", PRINTED, MOVING.given(velocity=MOVING_RATE)),
    }
)
