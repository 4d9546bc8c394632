"""Verdicts on the equations and claims of the papers, how the page tells them, and the figures.

What the verdicts are stands in docs/papers.md, which tests/system/test_pages.py compares.
"""

import io
import re

import numpy as np
import pytest

from studies.papers import karetin, page, stelmashchuk
from studies.papers.engine import FAILS, HOLDS, PARTLY, ROUNDING, Found, claims_of, rounds_to, verdict, worst
from studies.papers.figures import FIGURES, numbers, pitch_cones
from studies.papers.page import PAPERS, equations, papers_page, words

NUMBERED = {"karetin": 33, "lysenko": 24, "stelmashchuk": 5}
papers = pytest.mark.parametrize("name", PAPERS)


@pytest.fixture(scope="module")
def claims():
    return {name: claims_of(name, paper) for name, paper in PAPERS.items()}


@pytest.fixture(scope="module")
def drawn():
    """Figures and their columns by name, each drawn once."""
    figures = {name: draw() for name, draw in FIGURES.items()}
    return {name: (figure, numbers(figure)) for name, figure in figures.items()}


@papers
def test_every_equation_is_right_or_clearly_wrong_and_every_claim_has_a_row(name, claims):
    for number, equation in PAPERS[name].EQUATIONS.items():
        assert equation.difference < ROUNDING or equation.difference > 0.01, number
    told = re.findall(r"\*\*\{(\w+)\[verdict\]\}\*\*", words(f"{name}.md"))
    assert sorted(told) == sorted(claims[name])


@papers
def test_each_equation_is_shown_as_printed_and_exact_and_a_wrong_curve_is_drawn(name):
    _, *sections = re.split(r"^#### ", equations(name), flags=re.M)
    shown, last = {section.partition(": ")[0]: section for section in sections}, NUMBERED[name]
    assert [n for n in shown if re.fullmatch(r"\(\d+\)", n)] == [f"({n})" for n in range(1, last + 1)]
    assert set(shown) - set(PAPERS[name].EQUATIONS) == ({"(1)", "(2)"} if name == "stelmashchuk" else set())
    drawn = set(re.findall(r"\(papers/(\w+)\.svg\)", "".join(sections)))
    curves = {figure for figure in FIGURES if figure.startswith(f"{name}_equation")}
    assert curves <= drawn <= set(FIGURES)
    for section in shown.values():
        _, judged, told, formula, *rest = section.split("\n\n")
        if judged != "**not known**":
            assert re.match(r"\*\*(right|wrong)\*\*", judged)
            assert told.startswith("As printed")
            assert formula.startswith("$$")
            two = judged.startswith("**wrong") or "as scanned" in told
            assert ("and exact" not in told) == two
            assert any(part.startswith("Exact") for part in rest) == two


def test_the_page_has_no_figure_that_is_none_and_whole_tables(claims, monkeypatch):
    monkeypatch.setattr(page, "claims_of", lambda name, _: claims[name])
    whole = papers_page()
    assert not re.search(r"\bnan\b|\binf\b", whole)
    for table in whole.split("| in the paper | in the FMU |")[1:]:
        rows = table.split("\n\n")[0].splitlines()[1:]
        assert {row.replace(r"\|", "").count("|") for row in rows} == {6}


def test_a_claim_holds_as_far_as_what_it_says_is_so_and_tells_its_figures():
    for says, judged in (
        ((True, True), HOLDS),
        ((True, False), PARTLY),
        ((False, False), FAILS),
        (np.array([[True, False]]), PARTLY),
        (True, HOLDS),
    ):
        assert verdict(says) == judged
    figures = {"off": 0.1234, "each": [0.5, 0.25], "count": 3, "kept": {"a": 2.5}, "same": 1e-15}
    claim = {name: Found(value) for name, value in figures.items()}
    told = "{off:.1%} of {count}, {each:.2f}; {each:.0%}; {each[1]:g}; {kept[a]:g}; {same} {off}"
    assert told.format_map(claim) == "12.3 % of 3, 0.50, 0.25; 50, 25 %; 0.25; 2.5; rounding 0.12"
    assert f"{Found(['a', 'b'])}" == "a, b"


def test_a_number_is_met_when_it_rounds_to_what_is_printed():
    for found, printed in ((0.048, "0.05"), (7.22, "7")):
        assert rounds_to(found, printed)
    for found, printed in ((0.055001, "0.05"), (8.0, "7"), (2.4, "3")):
        assert not rounds_to(found, printed)


def test_the_worst_difference_is_over_the_largest_length():
    assert worst(([3.0, 0.0], [0.0, 4.0]), ([0.0, 0.0], [0.0, 5.0])) == pytest.approx(3.0 / 5.0)
    assert worst([1.0, 2.5], [1.0, 2.0]) == pytest.approx(0.25)
    assert worst(0.5, 0.0, scale=2.0) == 0.25


# --- figures ---


def test_figures_come_with_columns_of_one_length_and_their_parameters(drawn):
    for figure, columns in drawn.values():
        assert len({values.shape for values in columns.values()}) == 1
        assert all(np.isfinite(values).all() for values in columns.values())
        assert "=" in figure.get_supxlabel()
        # a unit, or a number of turns
        assert all("[" in column or "turns" in column for column in columns)
    # of each kind one is written
    for name in ("karetin_1", "karetin_2", "karetin_3", "lysenko_forces"):
        written = io.BytesIO()
        drawn[name][0].savefig(written, format="svg")
        assert written.tell() > 10_000


def test_columns_hold_the_curves(drawn):
    for name, values in drawn["karetin_2"][1].items():
        # trajectories close after a period
        assert values[-1] == pytest.approx(values[0], abs=1e-12), name
    columns = drawn["karetin_3"][1]
    for quantity, kind in (("V", "velocity [m/s]"), ("a", "acceleration [km/s²]")):
        for mode in ("stop mode", "dynamic mode, i = 2"):
            of = [columns[f"{kind}, {mode}, {quantity}_{axis}"] for axis in "xyz"]
            modulus = columns[f"{kind}, {mode}, |{quantity}|"]
            np.testing.assert_allclose(modulus**2, sum(part**2 for part in of), atol=1e-12)
    # what is drawn as mirrored is as far from the speed as is told
    columns = drawn["karetin_offsets"][1]
    exact = [name for name in columns if name.endswith("exact")]
    assert len(exact) == 8
    for name in exact:
        off = np.abs(columns[name] - columns[name.replace("exact", "mirrored")]).max() / np.ptp(columns[name])
        assert 100.0 * off == pytest.approx(float(re.search(r"asymmetry ([\d.]+) %", name)[1]), abs=0.06)
    second, third = (drawn[f"stelmashchuk_{n}"][1] for n in (2, 3))
    for balancer in ("with the balancer", "without the balancer"):
        assert {f"a″ [1], {balancer}, ν = {nu}" for nu in ("4.4", "8", "100")} < set(second)
        assert {f"a″ [1], {balancer}, Π = {Pi}" for Pi in ("0", "5")} < set(third)
    motion = stelmashchuk.response(second["relative time κ = t/T [1]"], stelmashchuk.REFERENCE, 1.0, 0.0)
    assert (second["a″ [1], without the balancer, ν = 8"] == motion.acceleration).all()


def test_the_pitch_cones_touch_along_the_generatrix():
    g = karetin.Geometry(z17=31, z6=19, shaft_angle=1.2, gamma=0.4)
    apex, wheel, satellite = pitch_cones(g)
    for rim in (wheel, satellite):
        np.testing.assert_allclose(np.linalg.norm(rim.T - apex, axis=1), g.L, rtol=1e-14)
    # rims come near each other only at the pole
    pole = g.L * np.array([np.sin(g.psi) * np.cos(g.gamma), np.sin(g.psi) * np.sin(g.gamma), -np.cos(g.psi)])
    assert np.linalg.norm(satellite.T - apex - pole, axis=1).min() < 1e-12
