"""The sentences for what the kernel of DrivenShaft refuses (see :mod:`.messages`)."""

from __future__ import annotations

from collections.abc import Mapping

from ..kernel import codes
from .driven_shaft_variables import BY_NAME
from .messages import BAD_STEP, bad_input, bad_rate, not_finite

MESSAGES: Mapping[int, str] = {
    codes.BAD_HUB_SPEED: bad_input(BY_NAME["hub_speed"]),
    codes.BAD_LOAD_TORQUE: bad_input(BY_NAME["load_torque"]),
    codes.BAD_HUB_SPEED_RATE: bad_rate(BY_NAME["hub_speed"]),
    codes.BAD_LOAD_TORQUE_RATE: bad_rate(BY_NAME["load_torque"]),
    codes.BAD_STEP: BAD_STEP,
    codes.NOT_FINITE: not_finite(BY_NAME["hub_speed"], BY_NAME["load_torque"]),
}
