"""Parts of figures: one panel for a slide, the range of an oscillating signal, units in print."""

import numpy as np
import pytest

from inertia_module.common.units import printed_unit
from inertia_module.plots.panels import SLIDE, envelope, new_figure, single_panel


def figure_with_two_axes():
    """Return a figure: above a panel with a second axis, below a map with a colour bar, the same x axis."""
    figure = new_figure("title")
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.plot([0.0, 1.0], [0.0, 2.0])
    upper.twinx().set_ylabel("efficiency [%]")
    mesh = lower.pcolormesh(np.arange(3.0), np.arange(3.0), np.eye(3))
    figure.colorbar(mesh, ax=lower, label="amplitude")
    lower.set_xlabel("time [s]")
    return figure


@pytest.mark.parametrize("number, labels", [(1, {"", "efficiency [%]"}), (2, {"", "amplitude"})])
def test_single_panel_has_its_axes_and_the_size_of_a_slide(number, labels, tmp_path):
    figure = single_panel(figure_with_two_axes(), number)
    assert {axes.get_ylabel() for axes in figure.axes} == labels
    assert figure.axes[0].get_xlabel() == "time [s]"
    assert figure.get_size_inches() == pytest.approx(SLIDE)
    figure.savefig(tmp_path / "slide.svg")
    assert figure.axes[0].get_position().width > 0.7


def test_unknown_panel_is_rejected():
    with pytest.raises(ValueError, match=r"--panel must be between 1 and 2 \(got 3\)"):
        single_panel(figure_with_two_axes(), 3)


def test_envelope_contains_every_value():
    time = np.linspace(0.0, 1.0, 1003)
    values = np.sin(400.0 * time)
    times, low, high = envelope(time, values, 10)
    assert (times[0], times[-1], times.size) == (0.0, 1.0, 10)
    assert low.min() == values.min()
    assert high.max() == values.max()
    assert (low < -0.99).all()
    assert (high > 0.99).all()


@pytest.mark.parametrize(
    "unit, text", [("N.m", "N·m"), ("kg.m2", "kg·m²"), ("rad/s2", "rad/s²"), ("N.m.s/rad", "N·m·s/rad")]
)
def test_printed_unit(unit, text):
    assert printed_unit(unit) == text
