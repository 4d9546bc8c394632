"""The records of Karetin's equations and claims: complete, and each verdict borne out by its figure."""

import importlib
import math
from dataclasses import replace

import numpy as np
import pytest

from inertia_module.papers.karetin import asymmetry
from inertia_module.papers.karetin.cases import DYNAMIC, GENERAL, PAPER, STANDARD, STOP, period
from inertia_module.papers.karetin.claims import CLAIMS
from inertia_module.papers.karetin.equations import EQUATIONS
from inertia_module.papers.karetin.swing import swings
from inertia_module.papers.report import FAILS, HOLDS, PARTLY

ROUNDING = 1e-12
# of the search for the best instant
SEARCH = 1e-6


def test_every_numbered_equation_is_there_once():
    assert [equation.number for equation in EQUATIONS] == [f"({n})" for n in range(1, 34)]


@pytest.mark.parametrize("equation", EQUATIONS, ids=lambda equation: equation.number)
def test_the_verdict_on_an_equation_is_borne_out_by_its_difference(equation):
    difference = equation.difference()
    if equation.right:
        assert difference < ROUNDING
    else:
        assert difference > 0.01
        assert equation.correction


@pytest.mark.parametrize("equation", EQUATIONS, ids=lambda equation: equation.number)
def test_the_forms_an_equation_names_exist(equation):
    for name in (equation.exact, equation.printed):
        module, function = name.split(".")
        code = importlib.import_module(f"inertia_module.papers.karetin.{module}")
        assert callable(getattr(code, function))
    # the printed form says of which equation it is
    assert equation.number in getattr(code, function).__doc__


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: f"{claim.where}: {claim.text[:40]}")
def test_a_claim_has_a_verdict_and_a_figure(claim):
    found = claim.found()
    assert claim.verdict in (HOLDS, PARTLY, FAILS)
    assert any(character.isdigit() for character in found) or "rounding" in found
    assert "nan" not in found
    assert "inf " not in found


@pytest.mark.parametrize("base", [STANDARD, PAPER, GENERAL], ids=["standard", "paper", "general"])
@pytest.mark.parametrize(("epsilon", "gamma"), [(0.5, 0.0), (0.0, 0.5), (0.5, 0.5)])
def test_conclusion_2_offsets_leave_the_moduli_of_the_stop_mode_symmetric(base, epsilon, gamma):
    g = replace(base, epsilon=epsilon, gamma=gamma)
    assert asymmetry.of_speed(g, STOP) < SEARCH
    assert asymmetry.of_acceleration(g, STOP) < SEARCH


@pytest.mark.parametrize("base", [STANDARD, PAPER, GENERAL], ids=["standard", "paper", "general"])
@pytest.mark.parametrize(("epsilon", "gamma"), [(0.5, 0.0), (0.0, 0.5)], ids=["epsilon", "gamma"])
def test_conclusion_2_either_offset_alone_makes_the_dynamic_mode_asymmetric(base, epsilon, gamma):
    g = replace(base, epsilon=epsilon, gamma=gamma)
    assert asymmetry.of_speed(g, DYNAMIC) > 0.02
    assert asymmetry.of_acceleration(g, DYNAMIC) > 0.02


@pytest.mark.parametrize("epsilon", [0.0, 0.5, 1.7])
def test_conclusion_2_offsets_that_only_shift_time_leave_all_symmetric(epsilon):
    g = replace(PAPER, epsilon=epsilon, gamma=epsilon / PAPER.s)
    assert asymmetry.of_speed(g, DYNAMIC) < SEARCH
    assert asymmetry.of_acceleration(g, DYNAMIC) < SEARCH
    assert asymmetry.of_components(g, STOP) < SEARCH


def test_the_best_mirror_of_a_known_function_is_found():
    """sin t + 0.3 sin 2t has no mirror, cos(t - 1) one at 1 (or 1 + pi)."""
    found = asymmetry.best_mirror(lambda t: 5.0 * np.cos(t - 1.0) + 2.0, math.tau)
    assert found.asymmetry < SEARCH
    assert math.remainder(found.instant - 1.0, math.pi) == pytest.approx(0.0, abs=1e-5)
    skewed = asymmetry.best_mirror(lambda t: np.sin(t) + 0.3 * np.sin(2.0 * t), math.tau)
    assert skewed.asymmetry > 0.1


def test_conclusion_3_the_swing_of_the_stop_mode_and_the_turn_of_the_dynamic_mode():
    at_stop = swings(PAPER, STOP, period(PAPER, STOP))
    assert (at_stop["Ox"].turns, at_stop["Oy"].turns, at_stop["Oz"].turns) == (0, 0, 1)
    assert math.degrees(at_stop["Ox"].amplitude) == pytest.approx(45.0, abs=0.01)
    # two turns of link 1 in a period
    assert swings(PAPER, DYNAMIC, period(PAPER, DYNAMIC))["Ox"].turns == -2
    assert swings(GENERAL, DYNAMIC, period(GENERAL, DYNAMIC))["Oy"].turns != 0
