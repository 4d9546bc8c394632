"""What gravity and the satellites' inertia change: page, table and module say the same."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(DOCS)
    import make_weight_picture

    return make_weight_picture


def test_page_says_what_the_table_has(study):
    page = (DOCS / "mechanics.md").read_text(encoding="utf-8")
    lines = list(study.lines_of_page(study.read()))
    assert len(lines) == len(study.MECHANISMS) * len(study.RATIOS)
    assert all(page.count(f"{line}\n") == 1 for line in lines)


def test_table_is_what_the_module_gives(study):
    with (DOCS / "weight.csv").open(encoding="utf-8", newline="") as file:
        _, *lines = csv.reader(file)
    mechanism, body = study.MECHANISMS["planar"]
    ideal = study.measured(50.0, 0.2, **mechanism)
    for cause, added in ((study.GRAVITY, {"gravity": 9.81}), (study.INERTIA, body)):
        _, ratio, _, omega1, *changes = next(line for line in lines if line[:3] == ["planar", "0.2", cause])
        found = study.measured(float(omega1), float(ratio), **mechanism, **added) / ideal - 1.0
        assert found == pytest.approx(np.array(changes, dtype=float), abs=2e-4)


def test_peak_of_the_torque_takes_the_weight_at_the_distance_of_the_satellite(study):
    (part,) = (part for key, part in study.read().items() if key == ("planar", 0.2, study.GRAVITY))
    fast = part[part[:, 0] > 50.0]
    assert fast[:, 3] == pytest.approx(9.81 / (fast[:, 0] ** 2 * 0.08), rel=2e-3)


def test_small_is_what_stays_so(study):
    part = np.array(
        [[1.0, 0.5, 0.001, 0.5], [2.0, 0.001, 0.001, 0.5], [3.0, -0.02, 0.001, 0.5], [4.0, 0.0, 0.0, 0.5]]
    )
    assert study.small_from(part) == [4.0, 1.0, math.inf]
