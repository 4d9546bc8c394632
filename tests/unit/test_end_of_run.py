"""The close-up of a plot says what it shows: pulses, or what came after the last of them."""

import numpy as np
import pytest

from inertia_module.figures.scenes import end_of_run
from inertia_module.harness.results import Result

PULSES = np.tile([0.0, 0.0, 5.0, 9.0, 5.0], 6)
LOCKED, COASTING = np.full(200, 3.0), np.zeros(200)


@pytest.mark.parametrize(
    "torque, shown",
    [
        (PULSES, "the last 4 pulses"),
        (np.concatenate([PULSES, LOCKED[:8]]), "the last 4 pulses"),
        (np.concatenate([PULSES, LOCKED]), "lock-up from 0.026 s on"),
        (np.concatenate([PULSES, COASTING]), "no more pulses from 0.029 s on"),
        (PULSES[:15], "the end"),
        (LOCKED, "the end"),
        (COASTING, "the end"),
    ],
)
def test_close_up_is_called_what_it_is(torque, shown):
    table = Result.from_columns({"time": 1e-3 * np.arange(torque.size), "output_torque_mean": torque})
    first, heading = end_of_run(table)
    assert heading == shown
    if "pulses" in heading or "lock-up" in heading:
        assert first == 11
    assert 0 <= first < torque.size
