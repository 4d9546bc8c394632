"""Test the verdicts on equations and claims of the papers, their text on the page, and the figures.

docs/papers/index.md contains the verdicts; `make docs` compares it.
"""

import io
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from papers import stelmashchuk
from papers.engine import ROUNDING
from papers.figures import FIGURES, numbers
from papers.page import PAPERS, equations, read_file

PAGE = Path(__file__).parents[2] / "docs" / "papers" / "index.md"
NUMBERED = {"karetin": 33, "lysenko": 24, "stelmashchuk": 5}
papers = pytest.mark.parametrize("name", PAPERS)


@pytest.fixture(scope="module")
def drawn():
    """Draw each figure once; return figures and their columns by name."""
    figures = {name: draw() for name, draw in FIGURES.items()}
    return {name: (figure, numbers(figure)) for name, figure in figures.items()}


@papers
def test_equations_are_right_or_clearly_wrong_and_claims_have_a_row(name):
    for number, equation in PAPERS[name].EQUATIONS.items():
        assert equation.difference < ROUNDING or equation.difference > 0.01, number
    claims_of_text = re.findall(r"\*\*\{(\w+)\[verdict\]\}\*\*", read_file(f"{name}.md"))
    claims = tomllib.loads(read_file(f"{name}_claims.toml"))
    assert sorted(["common", *claims_of_text]) == sorted(claims)


@papers
def test_equations_have_a_printed_and_an_exact_form_and_wrong_ones_a_figure(name):
    _, *sections = re.split(r"^#### ", equations(name), flags=re.M)
    texts, last = {section.partition(": ")[0]: section for section in sections}, NUMBERED[name]
    assert [n for n in texts if re.fullmatch(r"\(\d+\)", n)] == [f"({n})" for n in range(1, last + 1)]
    assert set(texts) - set(PAPERS[name].EQUATIONS) == ({"(1)", "(2)"} if name == "stelmashchuk" else set())
    drawn = set(re.findall(r"\((\w+)\.svg\)", "".join(sections)))
    curves = {figure for figure in FIGURES if figure.startswith(f"{name}_equation")}
    assert curves <= drawn <= set(FIGURES)
    for section in texts.values():
        _, verdict, introduction, formula, *rest = section.split("\n\n")
        if verdict != "**not known**":
            assert re.match(r"\*\*(right|wrong)\*\*", verdict)
            assert introduction.startswith("As printed")
            assert formula.startswith("$$")
            has_two_forms = verdict.startswith("**wrong") or "as scanned" in introduction
            assert ("and exact" not in introduction) == has_two_forms
            assert any(part.startswith("Exact") for part in rest) == has_two_forms


def test_page_has_finite_values_and_complete_tables():
    page = PAGE.read_text(encoding="utf-8")
    assert not re.search(r"\bnan\b|\binf\b", page)
    for table in page.split("| in the paper | in the FMU |")[1:]:
        rows = table.split("\n\n")[0].splitlines()[1:]
        assert {row.replace(r"\|", "").count("|") for row in rows} == {6}


# --- figures ---


def test_figures_have_columns_of_equal_length_and_their_parameters(drawn):
    for figure, columns in drawn.values():
        assert len({values.shape for values in columns.values()}) == 1
        assert all(np.isfinite(values).all() for values in columns.values())
        assert "=" in figure.get_label()
        # a unit, or a number of revolutions
        assert all("[" in column or "revolutions" in column for column in columns)
    # write one figure of each kind
    for name in ("karetin_1", "karetin_2", "karetin_3", "lysenko_forces"):
        stream = io.BytesIO()
        drawn[name][0].savefig(stream, format="svg")
        assert stream.tell() > 10_000


def test_columns_contain_the_curves(drawn):
    for name, values in drawn["karetin_2"][1].items():
        # trajectories close after a period
        assert values[-1] == pytest.approx(values[0], abs=1e-12), name
    columns = drawn["karetin_3"][1]
    for quantity, kind in (("V", "velocity [m/s]"), ("a", "acceleration [km/s²]")):
        for mode in ("stop mode", "dynamic mode, i = 2"):
            components = [columns[f"{kind}, {mode}, {quantity}_{axis}"] for axis in "xyz"]
            modulus = columns[f"{kind}, {mode}, |{quantity}|"]
            np.testing.assert_allclose(modulus**2, sum(part**2 for part in components), atol=1e-12)
    # the mirror image differs from the speed by the printed asymmetry
    columns = drawn["karetin_offsets"][1]
    exact = [name for name in columns if name.endswith("exact")]
    assert len(exact) == 8
    for name in exact:
        difference = np.abs(columns[name] - columns[name.replace("exact", "mirrored")]).max() / np.ptp(
            columns[name]
        )
        assert 100.0 * difference == pytest.approx(
            float(re.search(r"asymmetry ([\d.]+) %", name)[1]), abs=0.06
        )
    second, third = (drawn[f"stelmashchuk_{n}"][1] for n in (2, 3))
    for balancer in ("with the balancer", "without the balancer"):
        assert {f"a″ [1], {balancer}, ν = {nu}" for nu in ("4.4", "8", "100")} < set(second)
        assert {f"a″ [1], {balancer}, Π = {Pi}" for Pi in ("0", "5")} < set(third)
    motion = stelmashchuk.response(second["relative time κ = t/T [1]"], stelmashchuk.REFERENCE, 1.0, 0.0)
    assert (second["a″ [1], without the balancer, ν = 8"] == motion.acceleration).all()
