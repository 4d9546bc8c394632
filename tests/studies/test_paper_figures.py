"""Figures of the papers: drawn without a window, with the numbers that were drawn."""

import io

import numpy as np
import pytest

from studies.papers.figures import all_figures, karetin, stelmashchuk
from studies.papers.figures.karetin_cones import pitch_cones
from studies.papers.karetin import Geometry
from studies.papers.stelmashchuk.criteria import Criteria
from studies.papers.stelmashchuk.exact import response


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
    _, columns = karetin.trajectories()
    for name, values in columns.items():
        if name.startswith(("x", "y", "z")):
            assert values[-1] == pytest.approx(values[0], abs=1e-12)


def test_columns_of_figure_3_hold_moduli_and_their_components():
    _, columns = karetin.velocity_and_acceleration()
    for quantity, unit in (("V", "m/s"), ("a", "km/s2")):
        for mode in ("stop", "dynamic"):
            squares = sum(columns[f"{quantity}{axis} [{unit}], {mode}"] ** 2 for axis in "xyz")
            np.testing.assert_allclose(columns[f"|{quantity}| [{unit}], {mode}"] ** 2, squares, atol=1e-12)


def test_the_pitch_cones_touch_along_the_generatrix():
    g = Geometry(z17=31, z6=19, shaft_angle=1.2, gamma=0.4)
    apex, wheel, satellite = pitch_cones(g)
    for rim in (wheel, satellite):
        np.testing.assert_allclose(np.linalg.norm(rim.T - apex, axis=1), g.L, rtol=1e-14)
    # rims come near each other only at the pole
    pole = g.L * np.array([np.sin(g.psi) * np.cos(g.gamma), np.sin(g.psi) * np.sin(g.gamma), -np.cos(g.psi)])
    assert np.linalg.norm(satellite.T - apex - pole, axis=1).min() < 1e-12


def test_columns_hold_the_curves_of_figures_2_and_3():
    _, second = stelmashchuk.over_stiffness()
    _, third = stelmashchuk.over_damping()
    assert {f"a'' [1], ν = {nu}, balancer {beta}" for nu in ("4.4", "8", "100") for beta in "01"} < set(
        second
    )
    assert {f"a'' [1], Π = {Pi}, balancer {beta}" for Pi in ("0", "5") for beta in "01"} < set(third)
    expected = response(second["kappa [1]"], Criteria(8.0, 0.5), stelmashchuk.KAPPA2, 0.0).acceleration
    assert (second["a'' [1], ν = 8, balancer 0"] == expected).all()
