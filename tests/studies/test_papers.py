"""What was found of the equations and claims of the papers, and that docs/papers.md says it of each."""

import importlib
import re
from importlib.resources import files

import pytest

from studies.papers import karetin, lysenko, report, stelmashchuk
from studies.papers.figures import all_figures
from studies.papers.page import equations, papers_page
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
CLAIMS = [
    pytest.param(name, claim, id=f"{name} {claim.__name__}")
    for name, paper in PAPERS.items()
    for claim in paper.CLAIMS
]


@pytest.mark.parametrize(("name", "number"), EQUATIONS)
def test_an_equation_fed_with_exact_values_is_right_or_clearly_wrong(name, number):
    difference = PAPERS[name].EQUATIONS[number].difference
    assert difference > 0.01 if number in WRONG[name] else difference < report.ROUNDING


@pytest.mark.parametrize(("name", "claim"), CLAIMS)
def test_a_claim_has_the_verdict_that_its_figures_give_it(name, claim):
    verdict = (
        HOLDS if claim.__name__ in HOLDING[name] else FAILS if claim.__name__ in FAILING[name] else PARTLY
    )
    assert str(claim()) == verdict


def test_every_numbered_equation_of_the_papers_is_judged():
    assert list(karetin.EQUATIONS) == [f"({n})" for n in range(1, 34)]
    assert [n for n in lysenko.EQUATIONS if "note" not in n] == [f"({n})" for n in range(1, 25)]
    assert [n for n in stelmashchuk.EQUATIONS if n.startswith("(")] == [f"({n})" for n in range(1, 6)]


@pytest.mark.parametrize("name", PAPERS)
def test_the_page_has_a_row_for_each_claim(name):
    words = files(PAPERS[name]).joinpath("page.md").read_text(encoding="utf-8")
    for claim in PAPERS[name].CLAIMS:
        assert words.count(f"**{{{claim.__name__}}}**") == 1


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
            _, judged, words, formula, *rest = shown[number].split("\n\n")
            assert judged == str(equation)
            assert words.startswith("As printed")
            assert formula.startswith("$$")
            two = number in WRONG[name] or "as scanned" in words
            assert ("and exact" not in words) == two
            assert any(part.startswith("Exact") for part in rest) == two


@pytest.mark.parametrize("name", PAPERS)
def test_the_quantity_of_an_equation_is_in_the_code_beside_the_number_of_the_equation(name):
    source = files(PAPERS[name]).joinpath("as_printed.py").read_text(encoding="utf-8")
    table = importlib.import_module(f"studies.papers.{name}.as_printed").PRINTED
    for number, equation in PAPERS[name].EQUATIONS.items():
        if equation.name and number.startswith("(") and name != "stelmashchuk":
            assert equation.name in table
            # the numbers of a line of comments stand over the quantities they are of
            above = source[: source.index(f'"{equation.name}": ')].split("PRINTED: Formulas")[1]
            comment = re.findall(r"(?:^    #.*\n)+", above, re.M)[-1]
            assert int(number.strip("()").split(")")[0]) in _numbers(comment)


def _numbers(comment):
    """Numbers of equations a comment names, "(3) to (5)" being three of them."""
    comment = re.sub(
        r"\((\d+)\) to \((\d+)\)",
        lambda ends: " ".join(f"({n})" for n in range(int(ends[1]), int(ends[2]) + 1)),
        comment,
    )
    return {int(number) for number in re.findall(r"\((\d+)\)", comment)}


def test_the_page_has_no_figure_that_is_none():
    assert not re.search(r"\bnan\b|\binf\b", papers_page())


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
