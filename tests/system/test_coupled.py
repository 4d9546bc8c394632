"""An engine in front of the FMU, by speed and by torque: limits, orders, energy, an independent reference."""

import csv
import math
from functools import cache
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
from rejected import assert_rejected

from examples.coupling import study
from examples.coupling.engine import SCHEMES, CoupledEngine, Engine, Scheme
from examples.coupling.study import TORQUE, coupled_engine, course, planar, trial
from inertia_module import driveline
from inertia_module.common.errors import FmuError
from inertia_module.fmi.instance import Fmu
from tests.system.programs import DOCS

TABLE = DOCS / "verification" / "coupling_map.csv"
SAMPLE = 5e-3
# kg.m2, nearly all of it on link 1, so that it does not change with the angle
INTERFACE = 0.1
PURE_INERTIA = {"input_inertia": INTERFACE, "imbalance_mass": 1e-9}
SPEED, TORQUE_STEP = 100.0, 1.0


monolithic = study.monolithic


@cache
def reference(name, ratio):
    """Course of a case in one piece, which takes seconds."""
    return monolithic(study.CASES[name](ratio))


# --- the added-mass limit, on a module that is an inertia and little else ---


def characteristic(scheme, r, rho):
    """Return the polynomial of the growth per step of any length, highest power first.

    u and m are the speed changes of engine and module: (1 + rho) u = (rho - r) m, with r = Phi/J_E and rho
    the inertia of the scheme over J_E. m is u of the previous step, or 2 u minus u of the step before along a
    ramp.
    """
    return {
        Scheme.JACOBI: (1.0, 0.0, r),
        Scheme.MODULE_FIRST: (1.0, r),
        Scheme.INERTIA: (1.0 + rho, 2.0 * (r - rho), rho - r),
        Scheme.IMPLICIT: (1.0, 0.0),
    }[scheme]


def speed_changes(scheme, ratio, step, fmu, share=1.0, count=300):
    """Changes of the engine's speed, step by step, after a step of torque; cut off where they are absurd."""
    inertia = INTERFACE / ratio
    still = driveline.Governor(0.0, 0.0, 1e9)
    engine = Engine(inertia, driveline.EngineMap((0.0,), (1e6,), (1e6,)), still, SPEED, SPEED, TORQUE_STEP)
    changes = []
    with Fmu(fmu, PURE_INERTIA, {"omega1": SPEED, "load_torque": 0.0}, 1e-8) as module:
        coupled = CoupledEngine(module, engine, scheme, share * INTERFACE)
        while len(changes) < count and (not changes or abs(changes[-1]) < 1e3 * TORQUE_STEP / inertia * step):
            before = engine.speed
            coupled.advance(step)
            changes.append(engine.speed - before)
    return changes


@pytest.mark.parametrize(
    "scheme, share, ratio, step, stable",
    [
        # inertia of the scheme over the interface inertia; shorter steps do not change the limit
        *(
            (scheme, share, ratio, step, ratio < 1.0)
            for scheme, share in (
                (Scheme.JACOBI, 1.0),
                (Scheme.MODULE_FIRST, 1.0),
                (Scheme.INERTIA, 0.5),
            )
            for ratio in (0.3, 0.95, 1.05, 3.0)
            for step in (1e-5, 5e-3)
        ),
        # there is none
        *(
            (Scheme.INERTIA, share, ratio, 1e-3, True)
            for share in (0.75, 1.0)
            for ratio in (0.3, 3.0, 1000.0)
        ),
        *((Scheme.IMPLICIT, 1.0, ratio, 1e-3, True) for ratio in (0.3, 3.0, 1000.0)),
    ],
)
def test_changes_of_speed_follow_the_characteristic_polynomial_to_either_side_of_its_limit(
    fmu, scheme, share, ratio, step, stable
):
    polynomial = np.array(characteristic(scheme, ratio, share * ratio))
    changes = np.array(speed_changes(scheme, ratio, step, fmu, share, 12)[:12])
    # an error of the module's torque moves a small engine the more
    unrest, rounding = np.diff(changes), 1e-5 * np.abs(changes).min() * max(1.0, 0.01 * ratio)
    for n in range(4, unrest.size - polynomial.size):
        window = unrest[n : n + polynomial.size][::-1]
        terms = np.abs(polynomial * window).sum()
        assert abs(polynomial @ window) < 1e-3 * terms + rounding
    assert (np.abs(np.roots(polynomial)).max() < 1.0) == stable


@pytest.mark.parametrize("scheme", Scheme)
def test_speed_changes_approach_the_response_of_the_total_inertia(fmu, scheme):
    ratio, step = 0.2, 1e-4
    acceleration = speed_changes(scheme, ratio, step, fmu)[-1] / step
    assert TORQUE_STEP / acceleration - INTERFACE / ratio == pytest.approx(INTERFACE, rel=1e-3)


def test_interface_inertia_equals_a_rolling_satellite():
    """Held wheel: the imbalance turns about the point of contact at (1 + k) omega1, r - l to r + l away."""
    turned = 3 * 0.3 * (1.0 + 0.1 / 0.06) ** 2
    interface = driveline.interface_inertia(study.URBAN_MODULE)
    assert interface.minimum == pytest.approx(turned * 0.02**2, rel=1e-12)
    assert interface.maximum == pytest.approx(turned * 0.10**2, rel=1e-12)


# --- accuracy ---


@pytest.mark.parametrize("name, ratio, close", [("planar", 0.5, 1.9e-5), ("bevel", 5.0, 1e-4)])
def test_coupling_converges_to_the_monolithic_reference(fmu, name, ratio, close):
    case, expected = study.CASES[name](ratio), reference(name, ratio)
    # by torque in steps that meet the samples
    by_torque = [(None, step, 1e-9) for step in (SAMPLE / 4, SAMPLE)]
    for scheme, step, bound in [(Scheme.IMPLICIT, 1e-4, close), *by_torque]:
        actual = course(case, scheme, step, fmu, 1e-10)
        assert np.abs(actual.omega1 - expected.omega1).max() < bound * case.speed
        assert np.abs(actual.omega_out - expected.omega_out).max() < bound * expected.omega_out.max()
        assert actual.work == pytest.approx(expected.work, rel=bound)
        assert abs(actual.ledger.defect) < bound * expected.work


def test_torque_driven_steps_between_samples_delay_the_speed(fmu):
    steps, expected = (2e-3, 1e-2, 2e-2), reference("planar", 0.5)
    errors = [trial(planar(0.5), TORQUE, step, expected, fmu).max_error for step in steps]
    assert 1e-4 < errors[0] < errors[1] < errors[2]


# --- momentum, energy, cost ---


@pytest.mark.parametrize(
    "scheme, step, loss",
    [(None, 1e-3, 1e-12), (None, SAMPLE, 1e-12), (None, 2e-2, 1e-12), (Scheme.IMPLICIT, 2e-3, 3e-3)],
)
def test_engine_work_equals_the_sum_of_all_energies(fmu, scheme, step, loss):
    with coupled_engine(planar(0.3), scheme, fmu) as coupled:
        before = coupled.energy_stored
        for _ in range(round(0.6 / step)):
            coupled.advance(step)
        names = ("energy_out", "energy_lost", "energy_in", "energy_residual", "engine_work_in", "bond_defect")
        out, lost, energy_in, residual, work, defect = coupled.read(names)
        difference = work - out - lost - (coupled.energy_stored - before)
        assert difference == pytest.approx(defect, abs=1e-5 * work)
        assert abs(residual) < 1e-7 * work
        assert abs(defect) < loss * work
        if scheme is None:  # by torque no rotor is in between
            assert work == pytest.approx(energy_in, rel=1e-12)
            assert abs(difference) < 1e-7 * work


def test_torque_driven_engine_has_the_speed_of_link_1_and_respects_its_map(fmu):
    case = planar(0.5)
    with coupled_engine(case, None, fmu) as coupled:
        torques = []
        for reference in (2.0 * case.speed, 0.5 * case.speed):
            coupled.set(omega1=reference)
            for _ in range(100):
                coupled.advance(SAMPLE)
                torques.append(coupled.read(("engine_torque", "drive_torque")))
        names = ("engine_speed", "input_speed", "engine_angle", "input_angle", "input_turns", "engine_energy")
        speed, torque_now, angle, rest, turns, energy = coupled.read(names)
        assert speed == torque_now
        assert angle == pytest.approx(rest + 2.0 * math.pi * turns, rel=1e-12)
        assert energy == pytest.approx(0.5 * case.engine().inertia * speed**2, rel=1e-12)
        assert coupled.ledger.cost == 200
    torque_values = np.array(torques)
    assert torque_values[:, 1] == pytest.approx(torque_values[:, 0], rel=1e-12)
    assert (torque_values[:, 0].max(), torque_values[:, 0].min()) == (200.0, -20.0)


def test_a_plant_in_substeps_is_a_plant_in_steps(fmu):
    ends = []
    for substeps, step in ((1, 0.5 * SAMPLE), (4, 2.0 * SAMPLE)):
        with coupled_engine(planar(0.5), None, fmu) as coupled:
            coupled.substeps = substeps
            for _ in range(240 // substeps):
                coupled.advance(step)
            assert coupled.ledger.steps == 240
            ends.append(coupled.engine.state)
    assert ends[0] == ends[1]


# --- the study and its page ---


def test_quick_map_has_the_rows_of_the_page_and_finds_the_torque_best_and_cheapest(
    fmu, tmp_path, monkeypatch
):
    monkeypatch.setattr(study, "monolithic", lambda case: reference(case.name, case.ratio))
    rows = study.coupling_map(fmu, quick=True)
    table = {
        tuple(row[name] for name in ("case", "ratio", "scheme", "step")): row for row in read_rows(TABLE)
    }
    for row in (row for row in rows if row.step == 1e-3):
        of_page = table[row.case, f"{row.ratio:g}", row.scheme, f"{row.step:g}"]
        assert of_page["stable"] == str(row.stable)
        for column in ("speed_error", "output_error", "energy_error", "cost") if row.stable else ():
            assert float(of_page[column]) == pytest.approx(getattr(row, column), rel=0.02, abs=1e-6)
    fine = sorted((row for row in rows if row.step < 2e-3), key=lambda row: row.max_error)
    assert [row.scheme for row in fine] == [TORQUE, *reversed(SCHEMES)]
    by_scheme = {(row.scheme, row.step): row for row in rows}
    by_torque, implicit = by_scheme[TORQUE, SAMPLE], by_scheme["implicit ramp", 1e-3]
    assert max(row.max_error for (scheme, _), row in by_scheme.items() if scheme == TORQUE) < 1e-7
    assert implicit.cost >= 20 * by_torque.cost
    assert implicit.max_error > 1e3 * by_torque.max_error
    written = study.write_part(tmp_path, "map", rows)
    assert all(Path(file).stat().st_size > 500 for file in written.values())
    again = read_rows(tmp_path / "coupling_map.csv")
    assert [row["scheme"] for row in again] == [row.scheme for row in rows]
    for name in ("cost", "energy_error", "work_error"):
        expected = [getattr(row, name) for row in rows]
        assert [float(row[name]) for row in again] == pytest.approx(expected, rel=1e-5)


def read_rows(path):
    """Rows by heading, without its unit."""
    with path.open(newline="") as file:
        headings, *rows = csv.reader(file)
    return [dict(zip((heading.split(" [")[0] for heading in headings), row, strict=True)) for row in rows]


# a pulse, s, of the cases of the map
PULSES = {"planar": 0.019, "bevel": 0.037}


@pytest.mark.parametrize(
    "scheme, share, ratio",
    [
        ("implicit ramp", 1 / 4, 0.1),
        ("implicit ramp", 1 / 10, 0.5),
        ("implicit ramp", 1 / 20, 2.0),
        ("inertia module first ramp", 1 / 40, 1.0),
    ],
)
def test_recommended_steps_keep_within_a_percent_and_a_half_in_the_rows_of_the_page(scheme, share, ratio):
    rows = [
        row
        for row in read_rows(TABLE)
        if row["scheme"] == scheme and float(row["ratio"]) <= ratio
        # to the step of the map next to it
        if float(row["step"]) <= 1.1 * share * PULSES[row["case"]]
    ]
    assert {row["case"] for row in rows} == set(PULSES)
    for row in rows:
        worst = max(abs(float(row[f"{name}_error"])) for name in ("speed", "output", "energy"))
        assert worst < 0.015, row


@pytest.mark.parametrize("name, order", [*zip(SCHEMES, (1.0, 1.0, 2.0, 2.0), strict=True)])
def test_error_falls_with_the_order_of_the_scheme_in_the_rows_of_the_page(name, order):
    key = {"case": "planar", "ratio": "0.3", "scheme": name}
    rows = [row for row in read_rows(TABLE) if key.items() <= row.items()]
    errors = {float(row["step"]): float(row["output_error"]) for row in rows}
    assert math.log(errors[1e-3] / errors[2e-4]) / math.log(5.0) > 0.85 * order


# --- the urban cycle ---


def test_energy_over_the_launch_adds_up_but_with_a_held_speed_in_long_steps(fmu):
    scene = study.urban_scene()
    run = study.urban_run(scene, fmu, TORQUE, 2, stop_time=20.0)
    assert abs(run.residual) < 1e-6
    assert run.outside == 0.0
    assert run.cost == pytest.approx(200.0)
    assert abs(study.urban_run(scene, fmu, "implicit ramp", 5, stop_time=20.0).residual) < 1e-3
    assert abs(study.urban_run(scene, fmu, "mean module first held", 1, stop_time=20.0).residual) > 0.05


# --- rejections ---


def test_parameters_add_the_rotor_to_link_1():
    parameters = driveline.torque_driven({"z2": 30.0, "input_inertia": 0.05}, 0.1)
    assert parameters == {"z2": 30.0, "input_inertia": pytest.approx(0.15), "drive": 1.0}


@pytest.mark.parametrize("name", study.COUPLINGS)
def test_rejected_step_has_no_effect(fmu, name):
    ends, step = [], SAMPLE if name == TORQUE else 1e-3
    for load in (8.0, 1e300):
        with coupled_engine(planar(0.3), study.COUPLINGS[name], fmu) as coupled:
            for n in range(40):
                if n == 21 and load != 8.0:
                    coupled.set(load_torque=load)
                    assert_rejected("load_torque", coupled.advance, step)
                    coupled.set(load_torque=8.0)
                coupled.advance(step)
            ends.append((coupled.engine.state, *coupled.read(("omega_out", "energy_in"))))
            assert coupled.ledger.steps == 40
    assert ends[0] == ends[1]


def test_implicit_step_that_fails_in_the_middle_is_restored(fmu, monkeypatch):
    with coupled_engine(planar(0.3), Scheme.IMPLICIT, fmu) as coupled:
        coupled.advance(1e-3)
        names = ("omega_out", "energy_in", "input_angle")
        before = coupled.fmu.time, coupled.engine.state, coupled.read(names)
        monkeypatch.setattr(coupled.fmu, "jacobian", Mock(side_effect=FmuError("no derivative")))
        assert_rejected("no derivative", coupled.advance, 1e-3)
        assert (coupled.fmu.time, coupled.engine.state, coupled.read(names)) == before
