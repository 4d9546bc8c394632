"""The module at the extremes: every bound holds but for the limits named here, and the map tells the same."""

import re
import tomllib
from pathlib import Path
from typing import NamedTuple

import pytest

from studies.stability.verdicts import Cell, chosen_cases, read_rows, rows_of, run_study

MAP = Path(__file__).parents[2] / "docs" / "stability.csv"


class Limit(NamedTuple):
    """A known limit: the cases it is known of (regular expressions), and what they may miss or must say."""

    axis: str
    value: str
    layout: str
    level: str
    missed: tuple[str, ...] = ()
    refused: str = ""

    def covers(self, case):
        found = (*place(case), case.level.name)
        return all(re.fullmatch(pattern, text) for pattern, text in zip(self, found, strict=False))


# known limits: cases that must be rejected, and bounds that may be missed
TABLE = tomllib.loads(Path(__file__).with_name("extremes.toml").read_text(encoding="utf-8"))
LIMITS = [Limit(*where, refused=words) for *where, words in TABLE["cases"]["refused"]]
LIMITS += [
    Limit(*where, missed=tuple(name for group in groups.split() for name in TABLE["groups"][group]))
    for *where, groups in TABLE["cases"]["missed"]
]


def place(row):
    """Where a row, or a case of it, stands in the map."""
    return row.axis, row.value, row.layout


# cases of one extreme on one layout, all levels of fidelity together
EXTREMES = {}
for case in chosen_cases():
    EXTREMES.setdefault(place(case), []).append(case)
DOCUMENTED = {place(row): row.cells for row in read_rows(MAP)}
# what every eighth extreme shows the others show too, and these take seconds each: left to `make test-long`
DEAR = re.compile(
    "gravity, 1000 .*|shaft, c 1e.(09|12), no damping.*|freewheel compliance, .* 1e.0[789] .*|drag, output .*"
)
SAMPLE = 8


def to_try():
    """The extremes of each axis but those that take minutes: the sample; the others, marked as slow."""
    chosen = {}
    for number, extreme in enumerate(where for where, found in EXTREMES.items() if not found[0].slow):
        slow = bool(number % SAMPLE or DEAR.fullmatch(", ".join(extreme)))
        chosen.setdefault((extreme[0], slow), []).append(extreme)
    for (axis, slow), extremes in chosen.items():
        yield pytest.param(extremes, id=axis + ", the others" * slow, marks=pytest.mark.slow if slow else ())


def objections(verdict):
    """Objections to a verdict, by the bounds and the known limits."""
    known = [limit for limit in LIMITS if limit.covers(verdict.case)]
    refusals = [limit.refused for limit in known if limit.refused]
    if verdict.outcome == "broken":
        return [verdict.reason]
    if verdict.outcome == "rejected":
        return [] if any(part in verdict.reason for part in refusals) else [verdict.reason]
    if refusals:
        return [f"not rejected, though {part}" for part in refusals]
    allowed = {name for limit in known for name in limit.missed}
    return [f"{name}: {verdict.reason}" for name in verdict.missed if name not in allowed]


def alike(cell, told):
    """True if another machine may have measured a cell: equal verdicts, errors within a power of ten."""
    if (cell.outcome, cell.reason) != (told.outcome, told.reason) or None in (cell.power, told.power):
        return cell == told
    return abs(cell.power - told.power) <= 1


def test_cells_are_alike_within_a_power_of_ten():
    assert alike(Cell("exact", -6), Cell("exact", -7))
    assert not alike(Cell("exact", -6), Cell("exact", -8))
    assert not alike(Cell("exact", -6), Cell("degraded", -6, "work"))
    assert not alike(Cell("exact", -6), Cell("exact", None))
    assert not alike(Cell("rejected", None, "one"), Cell("rejected", None, "another"))


@pytest.mark.parametrize("extremes", list(to_try()))
def test_extremes_are_within_their_bounds_and_as_documented(compiled, extremes):
    wrong, stale = {}, {}
    for extreme in extremes:
        verdicts = run_study(EXTREMES[extreme])
        (row,) = rows_of(verdicts)
        told = DOCUMENTED[extreme]
        assert row.cells.keys() == told.keys()
        for verdict, (name, cell) in zip(verdicts, row.cells.items(), strict=True):
            if found := objections(verdict):
                wrong[*extreme, name] = found
            if not alike(cell, told[name]):
                stale[*extreme, name] = str(cell), str(told[name])
    assert not wrong
    assert not stale, "docs/stability.csv is out of date: make stability"


def test_every_extreme_is_documented_and_none_is_broken():
    assert DOCUMENTED.keys() == EXTREMES.keys()
    assert all(cell.outcome != "broken" for cells in DOCUMENTED.values() for cell in cells.values())


def test_every_known_limit_is_met_by_a_documented_case():
    every = [case for group in EXTREMES.values() for case in group]
    for limit in LIMITS:
        cells = [DOCUMENTED[place(case)][case.level.name] for case in every if limit.covers(case)]
        assert any(cell.outcome != "exact" for cell in cells), limit
        assert not limit.refused or all(cell.outcome == "rejected" for cell in cells), limit
