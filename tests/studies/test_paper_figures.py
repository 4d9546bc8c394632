"""Figures of the papers: drawn without a window, with the numbers that were drawn."""

import io

import numpy as np
import pytest

from studies.papers.figures import all_figures
from studies.papers.figures.sketches import pitch_cones
from studies.papers.karetin import Geometry
from studies.papers.stelmashchuk.exact import Criteria, response


@pytest.mark.parametrize("name", all_figures())
def test_figure_comes_with_columns_of_one_length(name):
    figure, columns = all_figures()[name]()
    assert len({values.shape for values in columns.values()}) == 1
    assert all(np.isfinite(values).all() for values in columns.values())
    written = io.BytesIO()
    figure.savefig(written, format="svg")
    assert written.tell() > 10_000
    # the parameters, below the figure
    assert "=" in figure.get_supxlabel()
    # a unit, or a number of turns
    assert all("[" in name or "turns" in name for name in columns)


def test_trajectories_close_after_a_period():
    _, columns = all_figures()["karetin_2"]()
    for name, values in columns.items():
        assert values[-1] == pytest.approx(values[0], abs=1e-12), name


def test_columns_of_figure_3_hold_moduli_and_their_components():
    _, columns = all_figures()["karetin_3"]()
    for quantity, kind in (("V", "velocity [m/s]"), ("a", "acceleration [km/s²]")):
        for mode in ("stop mode", "dynamic mode, i = 2"):
            of = [columns[f"{kind}, {mode}, {quantity}_{axis}"] for axis in "xyz"]
            modulus = columns[f"{kind}, {mode}, |{quantity}|"]
            np.testing.assert_allclose(modulus**2, sum(part**2 for part in of), atol=1e-12)


def test_the_pitch_cones_touch_along_the_generatrix():
    g = Geometry(z17=31, z6=19, shaft_angle=1.2, gamma=0.4)
    apex, wheel, satellite = pitch_cones(g)
    for rim in (wheel, satellite):
        np.testing.assert_allclose(np.linalg.norm(rim.T - apex, axis=1), g.L, rtol=1e-14)
    # rims come near each other only at the pole
    pole = g.L * np.array([np.sin(g.psi) * np.cos(g.gamma), np.sin(g.psi) * np.sin(g.gamma), -np.cos(g.psi)])
    assert np.linalg.norm(satellite.T - apex - pole, axis=1).min() < 1e-12


def test_columns_hold_the_curves_of_figures_2_and_3():
    _, second = all_figures()["stelmashchuk_2"]()
    _, third = all_figures()["stelmashchuk_3"]()
    for balancer in ("with the balancer", "without the balancer"):
        assert {f"a″ [1], {balancer}, ν = {nu}" for nu in ("4.4", "8", "100")} < set(second)
        assert {f"a″ [1], {balancer}, Π = {Pi}" for Pi in ("0", "5")} < set(third)
    expected = response(second["relative time κ = t/T [1]"], Criteria(8.0, 0.5), 1.0, 0.0).acceleration
    assert (second["a″ [1], without the balancer, ν = 8"] == expected).all()
