"""What was found of the equations and claims of the papers, and that docs/papers.md says it of each."""

import re

import pytest

from studies.papers import karetin, lysenko, report, stelmashchuk
from studies.papers.figures import all_figures
from studies.papers.page import equations, papers_page, words
from studies.papers.report import FAILS, HOLDS, PARTLY, Finding, rounds_to, worst

PAPERS = {"karetin": karetin, "lysenko": lysenko, "stelmashchuk": stelmashchuk}
# wrong even if fed with exact values of all they take
WRONG = {
    "karetin": {"(2)", "(5)", "(9)", "(11)", "(14)", "(15)", "(19)", "(21)", "(22)", "(24)", "(31)"},
    "lysenko": {
        *("(2), note", "(5)", "(8)", "(10)", "(13)", "(14)", "(15)", "(16)", "(21)", "(22)", "(23)", "(24)")
    },
    "stelmashchuk": {"(2)", "R″", "C III"},
}
HOLDING = {
    "karetin": {"superposition", "central_velocity_in_plane", "height_of_A", "abscissa"},
    "lysenko": {"cusp", "modulus", "cycles", "zones", "limits", "places", "weight", "circulation"},
    "stelmashchuk": {
        *("stiff_difference", "stiff_oscillation", "less_friction", "no_friction", "low_friction")
    },
}
FAILING = {
    "karetin": {"stop_condition", "arms_of_acceleration", "axes_of_the_angles", "only_modulus"},
    "lysenko": {
        *("note", "moments", "vibration", "equations_of_motion", "angular_momentum", "ratio", "energy"),
        *("impulsive_drive", "no_gain", "optimisation", "drive"),
    },
    "stelmashchuk": set(),
}
EQUATIONS = [
    pytest.param(name, number, id=f"{name} {number}")
    for name, paper in PAPERS.items()
    for number, equation in paper.EQUATIONS.items()
    if not equation.verdict
]


@pytest.fixture(scope="module")
def findings():
    return {name: paper.findings() for name, paper in PAPERS.items()}


@pytest.mark.parametrize(("name", "number"), EQUATIONS)
def test_an_equation_fed_with_exact_values_is_right_or_clearly_wrong(name, number):
    difference = PAPERS[name].EQUATIONS[number].difference
    assert difference > 0.01 if number in WRONG[name] else difference < report.ROUNDING


@pytest.mark.parametrize("name", PAPERS)
def test_claims_have_the_verdicts_that_their_figures_give_them(name, findings):
    for verdict, claims in ((HOLDS, HOLDING[name]), (FAILS, FAILING[name])):
        assert {claim for claim, found in findings[name].items() if str(found) == verdict} == claims


def test_every_numbered_equation_of_the_papers_is_judged():
    assert list(karetin.EQUATIONS) == [f"({n})" for n in range(1, 34)]
    assert [n for n in lysenko.EQUATIONS if "note" not in n] == [f"({n})" for n in range(1, 25)]
    assert [n for n in stelmashchuk.EQUATIONS if n.startswith("(")] == [f"({n})" for n in range(1, 6)]


@pytest.mark.parametrize("name", PAPERS)
def test_the_page_has_a_row_for_each_claim(name, findings):
    told = re.findall(r"\*\*\{(\w+)\}\*\*", words(PAPERS[name]))
    assert sorted(told) == sorted(findings[name])


@pytest.mark.parametrize("name", PAPERS)
def test_each_equation_is_shown_as_printed_and_exact_and_a_wrong_curve_is_drawn(name):
    _, *sections = re.split(r"^#### ", equations(PAPERS[name]), flags=re.M)
    shown = {section.partition(": ")[0]: section for section in sections}
    assert set(shown) == set(PAPERS[name].EQUATIONS)
    drawn = set(re.findall(r"\(papers/(\w+)\.svg\)", "".join(sections)))
    curves = {figure for figure in all_figures() if figure.startswith(f"{name}_equation")}
    assert curves <= drawn <= set(all_figures())
    for number, equation in PAPERS[name].EQUATIONS.items():
        if equation.verdict != "not known":
            _, judged, told, formula, *rest = shown[number].split("\n\n")
            assert judged == str(equation)
            assert told.startswith("As printed")
            assert formula.startswith("$$")
            two = number in WRONG[name] or "as scanned" in told
            assert ("and exact" not in told) == two
            assert any(part.startswith("Exact") for part in rest) == two


def test_the_page_has_no_figure_that_is_none_and_whole_tables():
    page = papers_page()
    assert not re.search(r"\bnan\b|\binf\b", page)
    for table in page.split("| in the paper | in the FMU |")[1:]:
        rows = table.split("\n\n")[0].splitlines()[1:]
        assert {row.replace(r"\|", "").count("|") for row in rows} == {6}


@pytest.mark.parametrize(
    ("says", "verdict"),
    [((True, True), HOLDS), ((True, False), PARTLY), ((False, False), FAILS)],
)
def test_a_claim_holds_as_far_as_what_it_says_is_so(says, verdict):
    assert str(Finding(*says)) == verdict


@pytest.mark.parametrize(
    ("found", "printed", "same"),
    [
        (0.048, "0.05", True),
        (0.055001, "0.05", False),
        (8.0, "7", False),
        (7.22, "7", True),
        (2.4, "3", False),
    ],
)
def test_a_number_is_met_when_it_rounds_to_what_is_printed(found, printed, same):
    assert rounds_to(found, printed) == same


def test_the_worst_difference_is_over_the_largest_length():
    assert worst(([3.0, 0.0], [0.0, 4.0]), ([0.0, 0.0], [0.0, 5.0])) == pytest.approx(3.0 / 5.0)
    assert worst([1.0, 2.5], [1.0, 2.0]) == pytest.approx(0.25)
    assert worst(0.5, 0.0, scale=2.0) == 0.25
