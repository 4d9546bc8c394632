"""Converter tables for lookup blocks: finite, and what a block makes of them is what the module does."""

import numpy as np
import pytest
from scenes import PLANAR, started

from inertia_module.common.errors import Refused
from inertia_module.harness.chart import (
    LARGEST_TORQUE_RATIO,
    TorqueConverterChart,
    converter_table,
    torque_converter_chart,
)
from inertia_module.harness.steady import SteadyMachine

PLANAR_MECHANISM = {name: value for name, value in PLANAR.items() if name not in ("omega1", "load_torque")}
LOSSES = {"input_friction": 0.002, "output_friction": 0.001, "output_drag": 0.2, "output_drag_viscous": 1e-3}
MECHANISMS = {
    "bevel": {},
    "planar": PLANAR_MECHANISM,
    "planar with losses": {**PLANAR_MECHANISM, **LOSSES},
}


def table_of(parameters, omega1, kernel):
    chart = torque_converter_chart(parameters, omega1 < 0.0, kernel, abs(omega1))
    return converter_table(parameters, chart, omega1, kernel)


def block(table, speed_ratio):
    """What a lookup block makes of a table: input and output torque."""
    k = np.interp(speed_ratio, table.speed_ratio, table.capacity_factor)
    taken = (table.omega1 / k) ** 2
    return taken, np.interp(speed_ratio, table.speed_ratio, table.torque_ratio) * taken


@pytest.mark.parametrize("mechanism", MECHANISMS)
@pytest.mark.parametrize("omega1", [30.0, 314.0, -50.0])
def test_it_is_finite_and_gives_the_torques_of_the_chart(compiled, mechanism, omega1):
    table = table_of(MECHANISMS[mechanism], omega1, compiled)
    assert all(np.isfinite(values).all() for name, values in vars(table).items() if name != "omega1")
    assert (np.diff(table.speed_ratio) > 0.0).all()
    assert table.speed_ratio[0] == 0.0
    assert table.torque_ratio.max() <= LARGEST_TORQUE_RATIO * (1.0 + 1e-12)
    taken, passed = block(table, table.speed_ratio)
    assert passed == pytest.approx(table.output_torque, rel=1e-12, abs=1e-12)
    limited = table.torque_ratio > LARGEST_TORQUE_RATIO * (1.0 - 1e-9)
    # no capacity factor says that the shaft drives link 1: the column of the input torque does
    expected, floor = np.maximum(table.input_torque, 0.0), 1e-4 * table.input_torque.max()
    assert taken[~limited] == pytest.approx(expected[~limited], rel=1e-9, abs=1.01 * floor)
    assert (taken[limited] >= table.input_torque[limited] * (1.0 - 1e-9)).all()


@pytest.mark.parametrize("mechanism", ["bevel", "planar"])
def test_between_its_rows_a_block_has_the_torque_of_the_module(compiled, mechanism):
    settings = MECHANISMS[mechanism]
    table = table_of(settings, 100.0, compiled)
    for ratio in (0.0, 0.0525, 0.3333, 0.721):
        module = started(compiled, settings, fidelity=1, omega1=100.0, omega_out_start=100.0 * ratio)
        taken, passed = block(table, ratio)
        assert passed == pytest.approx(module["output_torque"], rel=5e-3)
        if ratio > 0.04:
            assert taken == pytest.approx(ratio * module["output_torque"], rel=5e-3)


def test_on_the_coast_side_an_ideal_freewheel_passes_nothing(compiled):
    table = table_of(PLANAR_MECHANISM, 100.0, compiled)
    coast = table.speed_ratio > 1.0
    assert coast.sum() == 5
    assert not table.output_torque[coast].any()
    assert not table.input_torque[coast].any()
    # as the rigid module, whose shaft is driven from outside
    braked, taken = SteadyMachine(PLANAR_MECHANISM, compiled).coasting(100.0, 1.5)
    assert abs(braked) + abs(taken) < 1e-2 * table.output_torque.max()


def test_on_the_coast_side_losses_brake_the_shaft_by_what_rubs_there(compiled):
    table = table_of(MECHANISMS["planar with losses"], 100.0, compiled)
    coast = table.speed_ratio > 1.0
    ahead = 100.0 * (table.speed_ratio[coast] - 1.0)
    # link 2 has come along at the speed of link 1
    drag = LOSSES["output_drag"] + LOSSES["output_drag_viscous"] * ahead
    shaft = LOSSES["output_friction"] * 100.0 * table.speed_ratio[coast]
    assert table.output_torque[coast] == pytest.approx(-(drag + shaft), rel=1e-3)
    assert table.input_torque[coast] == pytest.approx(LOSSES["input_friction"] * 100.0 - drag, abs=0.02)


def test_a_mechanism_that_passes_nothing_is_refused(compiled):
    chart = torque_converter_chart({}, kernel=compiled)
    none = TorqueConverterChart(*(0.0 * values for values in vars(chart).values()))
    with pytest.raises(Refused, match="must pass torque for a converter table, passes none at 100 rad/s"):
        converter_table({}, none, 100.0, compiled)
