"""Test that losses.md lists the losses of each level of fidelity."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest
from scenes import ALL_LOSSES, GEARS, PLAY, WIND_UP

from inertia_module.common.errors import InertiaModuleError
from inertia_module.kernel.codes import DRIVE_TORQUE, KINEMATIC
from inertia_module.model import Module
from verification.stability.motion import LEVELS

PAGE = Path(__file__).parents[2] / "docs" / "explanation" / "losses.md"
MACHINE = {"input_inertia": 1.0, "output_inertia": 0.05, "driven_inertia": 0.4, "kinematic_ratio": 0.5}
DAMPINGS = ("housing_damping", "freewheel_damping")
SIZES = {name: size for name, size in (ALL_LOSSES | WIND_UP | GEARS | PLAY).items() if name not in DAMPINGS}
SIZES |= {"shaft_damping": 1.0, "driven_friction": 0.1, "windage": 1e-4}


def told():
    """Return the table: the statement about each parameter, by name of the level."""
    lines = PAGE.read_text().partition("| parameter | ")[2].partition("\n\n")[0].splitlines()
    levels = [head.strip() for head in lines[0].strip("| ").split(" | ")]
    table = {}
    for line in lines[2:]:
        names, *cells = (cell.strip() for cell in line.strip("| ").split("|"))
        table |= {name: dict(zip(levels, cells, strict=True)) for name in re.findall(r"`(\w+)`", names)}
    return table


def ends(level, by_torque, **losses):
    """Return energies, mean torque and speed after half a second."""
    drive = {"drive": DRIVE_TORQUE, "drive_torque": 20.0} if by_torque else {}
    values = {**MACHINE, **level.values, **drive, **losses}
    module = Module().start(**values, omega1=100.0, load_torque=10.0)
    for _ in range(10):
        module.advance(0.05)
    return [module[name] for name in ("energy_in", "energy_lost", "input_torque_mean", "omega_out")]


def found(level, name, by_torque=False):
    """Return the effect of a parameter at a level: yes, no or rejected."""
    try:
        changed = ends(level, by_torque, **{name: SIZES[name]}) != ends(level, by_torque)
    except InertiaModuleError as error:
        return "rejected" if name in str(error) else str(error)
    return "yes" if changed else "no"


def test_every_parameter_is_documented_at_every_level():
    table = told()
    assert table.keys() == SIZES.keys()
    assert all([*cells] == [level.name for level in LEVELS] for cells in table.values())


@pytest.mark.parametrize("level", LEVELS, ids=lambda level: level.name)
def test_levels_have_the_losses_of_the_page(level):
    for name, cells in told().items():
        cell = cells[level.name]
        assert found(level, name) == cell, name
        if level.fidelity != KINEMATIC:
            assert found(level, name, by_torque=True) == cell, name


# --- effects of gravity and satellite inertia: page, table and module agree ---


DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(DOCS)
    import make_weight_picture

    return make_weight_picture


def test_page_agrees_with_the_table(study):
    page = PAGE.read_text(encoding="utf-8")
    lines = list(study.lines_of_page(study.read()))
    assert len(lines) == len(study.MECHANISMS) * len(study.RATIOS)
    assert all(page.count(f"{line}\n") == 1 for line in lines)


def test_table_agrees_with_the_module(study):
    with (DOCS / "explanation" / "weight.csv").open(encoding="utf-8", newline="") as file:
        _, *lines = csv.reader(file)
    mechanism, body = study.MECHANISMS["planar"]
    ideal = study.measured(50.0, 0.2, **mechanism)
    for cause, added in ((study.GRAVITY, {"gravity": 9.81}), (study.INERTIA, body)):
        _, ratio, _, omega1, *changes = next(line for line in lines if line[:3] == ["planar", "0.2", cause])
        found = study.measured(float(omega1), float(ratio), **mechanism, **added) / ideal - 1.0
        assert found == pytest.approx(np.array(changes, dtype=float), abs=2e-4)
