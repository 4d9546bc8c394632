"""Figures of Lysenko and Stelmashchuk: drawn without a window, with the numbers that were drawn."""

import io

import numpy as np
import pytest

from inertia_module.paper_figures import lysenko, stelmashchuk
from inertia_module.papers.stelmashchuk.criteria import Criteria
from inertia_module.papers.stelmashchuk.exact import response

FIGURES = lysenko.FIGURES | stelmashchuk.FIGURES


@pytest.mark.parametrize("name", FIGURES)
def test_figure_comes_with_columns_of_one_length(name):
    figure, columns = FIGURES[name]()
    assert len({values.shape for values in columns.values()}) == 1
    assert all(np.isfinite(values).all() for values in columns.values())
    for form in ("png", "svg"):
        written = io.BytesIO()
        figure.savefig(written, format=form)
        assert written.tell() > 10_000


def test_columns_hold_the_curves_of_figures_2_and_3():
    _, second = stelmashchuk.over_stiffness()
    _, third = stelmashchuk.over_damping()
    assert {f"ν = {nu}, balancer {beta}" for nu in ("4.4", "8", "100") for beta in "01"} < set(second)
    assert {f"Π = {Pi}, balancer {beta}" for Pi in ("0", "5") for beta in "01"} < set(third)
    expected = response(second["kappa"], Criteria(8.0, 0.5), stelmashchuk.KAPPA2, 0.0).acceleration
    assert (second["ν = 8, balancer 0"] == expected).all()
