"""The converged kernel can be trusted: the independent reference, which shares nothing with it, agrees."""

import math

import pytest
from scenes import PLANAR

from inertia_module.memory import Module
from studies.reference.cases import OMEGA1, OMEGA4
from studies.reference.motion import Reference
from studies.trade import R1_ELASTIC, Case, agreement

FLAT = {name: value for name, value in PLANAR.items() if name not in ("omega1", "load_torque")}
TURNING_BACK = {"housing_freewheel": 0.0, "omega_out_start": 5.0}
LOSSES = {"mesh_efficiency": 0.97, "journal_friction": 1e-3, "housing_drag": 0.1, "gravity": 9.81}
# the case, and how many switches of the freewheels it has at least
CASES = {
    "bevel": (Case(stop_time=0.2), 20),
    "planar": (Case(FLAT, PLANAR["omega1"], PLANAR["load_torque"], stop_time=0.2), 20),
    "braking": (Case(load_torque=-1.0, stop_time=0.2), 20),
    "no load": (Case(load_torque=0.0, stop_time=0.2), 20),
    "backwards": (Case(omega1=-100.0, stop_time=0.2), 20),
    "no output freewheel": (Case({"output_freewheel": 0.0}, stop_time=0.2), 10),
    "no housing freewheel": (Case(TURNING_BACK, stop_time=0.2), 8),
    "elastic": (Case(R1_ELASTIC.parameters, stop_time=0.2), 10),
    "losses": (Case(LOSSES, stop_time=0.1), 10),
    "losses, elastic": (Case({**R1_ELASTIC.parameters, **LOSSES}, stop_time=0.1), 5),
    "too slow to move": (Case(omega1=-1.0), 0),
}


@pytest.mark.parametrize("name", CASES)
def test_two_independent_methods_agree(name):
    case, least = CASES[name]
    found = agreement(case)
    assert found.omega_out < 1e-10
    assert found.events < 1e-10
    assert found.switches[0] == found.switches[1] >= least


@pytest.mark.parametrize("freewheels", [{}, {"housing_freewheel": 0.0}, {"output_freewheel": 0.0}])
@pytest.mark.parametrize("layout", [{}, FLAT], ids=["bevel", "planar"])
def test_driven_by_torques_that_change_both_methods_end_alike(layout, freewheels):
    parameters = {"drive": 1.0, "input_inertia": 0.2} | layout | freewheels
    first = Module().start(**parameters, omega1=60.0, tolerance=1e-12)
    second = Reference(parameters, 60.0, 0.0)
    for n in range(10):
        torque, load = 12.0 * math.cos(n), 4.0 + 3.0 * math.sin(n)
        first.set(drive_torque=torque, load_torque=load)
        first.advance(0.05)
        second.give(torque, load)
        second.advance(0.05 * (n + 1))
    ends = [first[name] for name in ("input_speed", "omega2", "omega_out")]
    assert ends == pytest.approx(second.state[OMEGA1:OMEGA4], rel=1e-7, abs=1e-7)
