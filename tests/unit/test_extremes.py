"""Test that all bounds hold at the extremes, except for the known limits in stability.csv."""

import re
import tomllib
from pathlib import Path
from typing import NamedTuple

import pytest

from inertia_module.interface.variables import PARAMETER, Group, with_causality
from verification.stability.extremes import MECHANISMS, OUT_OF_RANGE, RANGE_ENDS
from verification.stability.verdicts import Cell, chosen_cases, read_rows, rows_of, run_study

MAP = Path(__file__).parents[2] / "docs" / "verification" / "stability.csv"


class Limit(NamedTuple):
    """A known limit: patterns of the cases, bounds that they may violate, part of their rejection."""

    axis: str
    value: str
    layout: str
    level: str
    violated: tuple[str, ...] = ()
    rejection: str = ""

    def covers(self, case):
        names = (*place(case), case.level.name)
        return all(re.fullmatch(pattern, text) for pattern, text in zip(self, names, strict=False))


# Known limits: cases that must be rejected, and bounds that may be violated
TABLE = tomllib.loads(Path(__file__).with_name("extremes.toml").read_text(encoding="utf-8"))
LIMITS = [Limit(*names, rejection=words) for *names, words in TABLE["cases"]["refused"]]
LIMITS += [Limit(*names, violated=tuple(metrics)) for *names, metrics in TABLE["cases"]["missed"]]
# largest error of a known limit, in tolerances
MAX_TOLERANCES = 100.0


def place(row):
    """Return the key of a row or case in the table."""
    return row.axis, row.value, row.layout


# Cases of an extreme on one layout at all fidelity levels
EXTREMES = {}
for case in chosen_cases():
    EXTREMES.setdefault(place(case), []).append(case)
DOCUMENTED = {place(row): row.cells for row in read_rows(MAP)}
# `make test` runs every eighth extreme; `make test-long` runs all
SAMPLE = 8


def to_try():
    """Return the extremes of each axis without slow cases: the sample, and the others, marked as slow."""
    chosen = {}
    for number, extreme in enumerate(key for key, cases in EXTREMES.items() if not cases[0].slow):
        slow = bool(number % SAMPLE)
        chosen.setdefault((extreme[0], slow), []).append(extreme)
    for (axis, slow), extremes in chosen.items():
        yield pytest.param(extremes, id=axis + ", others" * slow, marks=pytest.mark.slow if slow else ())


def objections(verdict):
    """Return the objections to a verdict that no known limit covers."""
    limits = [limit for limit in LIMITS if limit.covers(verdict.case)]
    rejections = [limit.rejection for limit in limits if limit.rejection]
    if verdict.outcome == "broken":
        return [verdict.reason]
    if verdict.outcome == "rejected":
        return [] if any(part in verdict.reason for part in rejections) else [verdict.reason]
    if rejections:
        return [f"not rejected, although {part}" for part in rejections]
    allowed = {name for limit in limits for name in limit.violated}
    maximum = MAX_TOLERANCES * verdict.case.accuracy
    return [
        f"{name}: {verdict.reason}"
        for name in verdict.violated
        if name not in allowed or verdict.metrics[name].value > maximum
    ]


def is_alike(cell, documented):
    """Return True if verdict and reason are equal and the errors differ by at most a power of ten."""
    if (cell.outcome, cell.reason) != (documented.outcome, documented.reason):
        return False
    if None in (cell.power, documented.power):
        return cell == documented
    return abs(cell.power - documented.power) <= 1


def test_cells_agree_within_a_power_of_ten():
    assert is_alike(Cell("exact", -6), Cell("exact", -7))
    assert not is_alike(Cell("exact", -6), Cell("exact", -8))
    assert not is_alike(Cell("exact", -6), Cell("degraded", -6, "work"))
    assert not is_alike(Cell("exact", -6), Cell("exact", None))
    assert not is_alike(Cell("rejected", None, "one"), Cell("rejected", None, "another"))


@pytest.mark.parametrize("extremes", list(to_try()))
def test_extremes_are_within_their_bounds_and_as_documented(compiled, extremes):
    wrong, stale = {}, {}
    for extreme in extremes:
        verdicts = run_study(EXTREMES[extreme])
        (row,) = rows_of(verdicts)
        documented = DOCUMENTED[extreme]
        assert row.cells.keys() == documented.keys()
        for verdict, (name, cell) in zip(verdicts, row.cells.items(), strict=True):
            if reasons := objections(verdict):
                wrong[*extreme, name] = reasons
            if not is_alike(cell, documented[name]):
                stale[*extreme, name] = str(cell), str(documented[name])
    assert not wrong
    assert not stale, "docs/verification/stability.csv is out of date: make stability"


def test_both_ends_of_every_range_are_tried_on_every_layout_that_has_the_parameter():
    tried = {row[1:] for row in DOCUMENTED if row[0] in (RANGE_ENDS, OUT_OF_RANGE)}
    for mechanism in MECHANISMS:
        other = Group.PLANAR if mechanism.layout == "bevel" else Group.BEVEL
        for variable in with_causality(PARAMETER):
            if variable.kind not in ("Real", "Integer") or variable.group == other:
                continue
            for end in set(variable.ends) - {mechanism.parameters.get(variable.name, variable.start)}:
                assert (f"{variable.name} {end:g}", mechanism.layout) in tried


def test_every_extreme_is_documented_and_valid():
    assert DOCUMENTED.keys() == EXTREMES.keys()
    assert all(cell.outcome != "broken" for cells in DOCUMENTED.values() for cell in cells.values())


def test_every_known_limit_has_a_documented_case():
    every = [case for group in EXTREMES.values() for case in group]
    for limit in LIMITS:
        cells = [DOCUMENTED[place(case)][case.level.name] for case in every if limit.covers(case)]
        assert any(cell.outcome != "exact" for cell in cells), limit
        assert not limit.rejection or all(cell.outcome == "rejected" for cell in cells), limit
