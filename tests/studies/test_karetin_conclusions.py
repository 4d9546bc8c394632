"""Karetin's conclusions 2 and 3: when quantities are symmetric, and about which axes D swings."""

import math
from dataclasses import replace

import numpy as np
import pytest

from studies.papers.karetin import conclusions
from studies.papers.karetin.cases import DYNAMIC, GENERAL, PAPER, STANDARD, STOP

# of the search for the best instant
SEARCH = 1e-6


@pytest.mark.parametrize("base", [STANDARD, PAPER, GENERAL], ids=["standard", "paper", "general"])
@pytest.mark.parametrize(("epsilon", "gamma"), [(0.5, 0.0), (0.0, 0.5), (0.5, 0.5)])
def test_conclusion_2_offsets_leave_the_moduli_of_the_stop_mode_symmetric(base, epsilon, gamma):
    g = replace(base, epsilon=epsilon, gamma=gamma)
    assert conclusions.asymmetry("speed", g, STOP) < SEARCH
    assert conclusions.asymmetry("acceleration_modulus", g, STOP) < SEARCH


@pytest.mark.parametrize("base", [STANDARD, PAPER, GENERAL], ids=["standard", "paper", "general"])
@pytest.mark.parametrize(("epsilon", "gamma"), [(0.5, 0.0), (0.0, 0.5)], ids=["epsilon", "gamma"])
def test_conclusion_2_either_offset_alone_makes_the_dynamic_mode_asymmetric(base, epsilon, gamma):
    g = replace(base, epsilon=epsilon, gamma=gamma)
    assert conclusions.asymmetry("speed", g, DYNAMIC) > 0.02
    assert conclusions.asymmetry("acceleration_modulus", g, DYNAMIC) > 0.02


@pytest.mark.parametrize("epsilon", [0.0, 0.5, 1.7])
def test_conclusion_2_offsets_that_only_shift_time_leave_all_symmetric(epsilon):
    g = replace(PAPER, epsilon=epsilon, gamma=epsilon / PAPER.s)
    assert conclusions.asymmetry("speed", g, DYNAMIC) < SEARCH
    assert conclusions.asymmetry("acceleration_modulus", g, DYNAMIC) < SEARCH
    assert conclusions.asymmetry_of_components(g, STOP) < SEARCH


def test_the_best_mirror_of_a_known_function_is_found():
    """sin t + 0.3 sin 2t has no mirror, cos(t - 1) one at 1 (or 1 + pi)."""
    found = conclusions.best_mirror(lambda t: 5.0 * np.cos(t - 1.0) + 2.0, math.tau)
    assert found.asymmetry < SEARCH
    assert math.remainder(found.instant - 1.0, math.pi) == pytest.approx(0.0, abs=1e-5)
    skewed = conclusions.best_mirror(lambda t: np.sin(t) + 0.3 * np.sin(2.0 * t), math.tau)
    assert skewed.asymmetry > 0.1
    odd = conclusions.best_mirror(lambda t: np.sin(t) + 0.3 * np.sin(2.0 * t), math.tau, sign=-1.0)
    assert odd.asymmetry < SEARCH


def test_conclusion_3_the_swing_of_the_stop_mode_and_the_turn_of_the_dynamic_mode():
    at_stop = conclusions.swings(PAPER, STOP)
    assert (at_stop["Ox"].turns, at_stop["Oy"].turns, at_stop["Oz"].turns) == (0, 0, 1)
    assert math.degrees(at_stop["Ox"].amplitude) == pytest.approx(45.0, abs=0.01)
    # two turns of link 1 in a period
    assert conclusions.swings(PAPER, DYNAMIC)["Ox"].turns == -2
    assert conclusions.swings(GENERAL, DYNAMIC)["Oy"].turns != 0
