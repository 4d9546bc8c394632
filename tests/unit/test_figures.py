"""Pictures show the numbers that they name."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from inertia_module.figures.chart import chart_figure
from inertia_module.figures.scenes import end_of_run, plot_all
from inertia_module.harness.chart import torque_converter_chart
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


@pytest.mark.parametrize(("largest", "unit", "factor"), [(1999.0, "W", 1.0), (5000.0, "kW", 1e3)])
def test_large_powers_are_drawn_in_thousands_and_say_so(largest, unit, factor):
    axes, time = Figure().subplots(), np.arange(3.0)
    power = np.array([1.0, -largest, 2.0])
    assert plot_all(axes, time, {"in": (power, "black"), "lost": (0.1 * power, "red")}, "W") == unit
    assert [line.get_label() for line in axes.lines] == ["in", "lost"]
    assert axes.lines[0].get_ydata() == pytest.approx(power / factor)


def test_chart_without_losses_multiplies_torque_by_what_the_speed_is_divided(compiled):
    ratio, output, taken, _ = chart_figure({"ideal": torque_converter_chart({}, kernel=compiled)}).axes
    speeds, ratios = ratio.lines[0].get_data()
    assert ratios == pytest.approx(1.0 / speeds, rel=1e-9)
    assert ratios.max() > 5.0
    assert (ratio.lines[1].get_ydata() == 1.0).all()
    torques = [axes.lines[0].get_ydata() for axes in (output, taken)]
    assert torques[0] * output.lines[0].get_xdata() == pytest.approx(torques[1])
