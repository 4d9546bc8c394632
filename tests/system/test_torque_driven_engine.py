"""An engine whose rotor is in the FMU: exact where steps meet the governor's samples, no energy lost."""

import dataclasses
import math

import numpy as np
import pytest

from inertia_module.harness.fmu import Fmu, FmuError
from inertia_module.loops import (
    SCHEMES,
    CoupledEngine,
    Engine,
    EngineMap,
    Governor,
    TorqueDrivenEngine,
    torque_driven,
)
from studies import coupling

SAMPLE = 5e-3


@pytest.fixture(scope="module")
def fmu_path(built):
    return built / "InertiaModule.fmu"


@pytest.fixture
def case():
    return coupling.planar(0.5)


def by_torque(fmu_path, case, tolerance=1e-8):
    return coupling.coupled_engine(case, None, fmu_path, tolerance)


def engine(**values):
    given = {"inertia": 0.1, "reference": 100.0, "speed": 100.0} | values
    return Engine(limits=EngineMap((0.0,), (100.0,), (10.0,)), governor=Governor(1.0, 1.0), **given)


# --- accuracy ---


@pytest.mark.parametrize(
    "make, ratio", [(coupling.planar, 0.3), (coupling.planar, 5.0), (coupling.bevel, 5.0)]
)
def test_with_steps_that_meet_the_samples_it_is_the_one_piece_reference(fmu_path, make, ratio):
    case = make(ratio)
    expected = coupling.one_piece(case)
    for step in (SAMPLE / 4, SAMPLE):
        found = coupling.course(case, None, step, fmu_path, 1e-10)
        assert np.abs(found.omega1 - expected.omega1).max() < 1e-9 * case.speed
        assert np.abs(found.omega_out - expected.omega_out).max() < 1e-9 * expected.omega_out.max()
        assert found.work == pytest.approx(expected.work, rel=1e-9)


def test_steps_that_miss_the_samples_see_the_speed_late(fmu_path, case):
    expected = coupling.one_piece(case)
    steps = 2e-3, 1e-2, 2e-2
    errors = [coupling.trial(case, coupling.TORQUE, step, expected, fmu_path).worst for step in steps]
    assert 1e-4 < errors[0] < errors[1] < errors[2]


@pytest.mark.parametrize("step", [1e-3, SAMPLE, 7e-3, 2e-2])
def test_no_energy_is_lost_whatever_the_step(fmu_path, case, step):
    with by_torque(fmu_path, case) as coupled:
        before = coupled.energy_stored
        for _ in range(round(0.5 / step)):
            coupled.advance(step)
        names = ("energy_out", "energy_lost", "energy_in", "energy_residual", "engine_work_in", "bond_defect")
        out, lost, given, residual, worked, defect = coupled.read(names)
        assert worked == pytest.approx(given, rel=1e-12)
        assert abs(residual) < 1e-7 * worked
        assert out + lost + coupled.energy_stored - before == pytest.approx(worked, rel=1e-7)
        assert abs(defect) < 1e-12 * worked


@pytest.mark.parametrize("name", ["InertiaModule.fmu", "InertiaModulePy.fmu"])
@pytest.mark.parametrize(
    "level",
    [
        {"fidelity": 1},
        {"method": 1, "max_step": 1e-3},
        {"fidelity": 3, "driven_inertia": 0.5, "shaft_stiffness": 4e3, "shaft_damping": 0.5},
    ],
    ids=["averaged", "timestepping", "elastic"],
)
def test_it_drives_every_level_of_fidelity_of_either_fmu(built, case, level, name):
    case = dataclasses.replace(case, parameters={**case.parameters, **level})
    with by_torque(built / name, case) as coupled:
        for _ in range(100):
            coupled.advance(SAMPLE)
        worked, given, residual, defect, speed = coupled.read(
            ("engine_work_in", "energy_in", "energy_residual", "bond_defect", "omega_out")
        )
        assert worked == pytest.approx(given, rel=1e-9)
        assert abs(defect) < 1e-9 * worked
        assert abs(residual) < (0.02 if "method" in level else 1e-4) * worked
        assert coupled.engine.speed == pytest.approx(case.speed, rel=0.2)
        assert speed > 10.0


def test_angle_and_speed_of_the_engine_are_those_of_link_1(fmu_path, case):
    with by_torque(fmu_path, case) as coupled:
        for _ in range(200):
            coupled.step(SAMPLE)
        names = ("engine_speed", "input_speed", "engine_angle", "input_angle", "input_turns", "engine_energy")
        speed, given, angle, rest, turns, energy = coupled.read(names)
        assert speed == given
        assert angle == pytest.approx(rest + 2.0 * math.pi * turns, rel=1e-12)
        assert energy == pytest.approx(0.5 * case.engine().inertia * speed**2, rel=1e-12)
        assert coupled.ledger.cost == 200


def test_torque_keeps_within_the_map(fmu_path, case):
    with by_torque(fmu_path, case) as coupled:
        torques = []
        coupled.set(omega1=2.0 * case.speed)
        for n in range(200):
            if n == 100:
                coupled.set(omega1=0.5 * case.speed)
            coupled.advance(SAMPLE)
            torques.append(coupled.read(("engine_torque", "drive_torque")))
    found = np.array(torques)
    assert found[:, 1] == pytest.approx(found[:, 0], rel=1e-12)
    assert found[:, 0].max() == 200.0
    assert found[:, 0].min() == -20.0


def test_a_plant_in_substeps_is_a_plant_in_steps(fmu_path, case):
    ends = []
    for substeps, step in ((1, 0.5 * SAMPLE), (4, 2.0 * SAMPLE)):
        with by_torque(fmu_path, case) as coupled:
            coupled.substeps = substeps
            for _ in range(240 // substeps):
                coupled.advance(step)
            assert coupled.ledger.steps == 240
            ends.append(coupled.engine.state)
    assert ends[0] == ends[1]


# --- the study ---


def test_energy_over_the_beginning_of_the_urban_cycle_adds_up(fmu_path):
    found = coupling.urban_run(coupling.urban_scene(), fmu_path, coupling.TORQUE, 2, stop_time=20.0)
    assert abs(found.residual) < 1e-6
    assert found.outside == 0.0
    assert found.cost == pytest.approx(200.0)
    assert found.step == pytest.approx(1.0 / found.cost)


# --- what is refused ---


def test_a_module_that_does_not_fit_is_refused(fmu_path):
    with (
        Fmu(fmu_path, {"input_inertia": 0.1}, {"omega1": 100.0}) as fmu,
        pytest.raises(ValueError, match="drive of the FMU must be torque for TorqueDrivenEngine, is speed"),
    ):
        TorqueDrivenEngine(fmu, engine())
    with Fmu(fmu_path, torque_driven({}, 0.1), {"omega1": 100.0}) as fmu:
        with pytest.raises(ValueError, match="omega1 of the FMU must be the engine's 90 rad/s, is 100"):
            TorqueDrivenEngine(fmu, engine(speed=90.0))
        with pytest.raises(
            ValueError, match=r"input_inertia of the FMU must be at least 0.2 kg.m2, .* is 0.1"
        ):
            TorqueDrivenEngine(fmu, engine(inertia=0.2))
        with pytest.raises(ValueError, match="substeps must be a whole number from 1, is 0"):
            TorqueDrivenEngine(fmu, engine(), 0)
        with pytest.raises(ValueError, match="drive of the FMU must be speed for CoupledEngine, is torque"):
            CoupledEngine(fmu, engine(), SCHEMES["implicit ramp"])
        with pytest.raises(ValueError, match=r"drive_torque = 5 N.m cannot be set, the engine gives it"):
            TorqueDrivenEngine(fmu, engine()).set(drive_torque=5.0)


def test_parameters_add_the_rotor_to_link_1():
    assert torque_driven({"z2": 30.0, "input_inertia": 0.05}, 0.1) == {
        "z2": 30.0,
        "input_inertia": pytest.approx(0.15),
        "drive": 1.0,
    }


def test_after_a_refused_step_a_good_one_goes_on_as_if_nothing_had_been(fmu_path, case):
    ends = []
    for load in (8.0, 1e300):
        with by_torque(fmu_path, case) as coupled:
            for n in range(40):
                if n == 21 and load != 8.0:
                    coupled.set(load_torque=load)
                    with pytest.raises(FmuError, match="load_torque"):
                        coupled.step(SAMPLE)
                    coupled.set(load_torque=8.0)
                coupled.step(SAMPLE)
            ends.append((coupled.engine.state, *coupled.read(("omega_out", "energy_in"))))
            assert coupled.ledger.steps == 40
    assert ends[0] == ends[1]
