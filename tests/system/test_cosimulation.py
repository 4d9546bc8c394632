"""An engine in front of the FMU, a shaft behind it: limits, orders, energy, independent references."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from inertia_module.cosimulation import (
    SCHEMES,
    CoupledEngine,
    Engine,
    EngineMap,
    ErrorControl,
    Governor,
    Scheme,
    interface_inertia,
    run_adaptive,
)
from inertia_module.cosimulation.amplification import characteristic
from inertia_module.instance import DriveError, Fmu
from inertia_module.scene import load_scene
from inertia_module.studies.coupling import limits
from inertia_module.studies.coupling.case import URBAN_MODULE, bevel, planar
from inertia_module.studies.coupling.figure import worst
from inertia_module.studies.coupling.monolithic import Monolith
from inertia_module.studies.coupling.rows import read_rows
from inertia_module.studies.coupling.study import CRUISE, Files, coupling_map, write_part
from inertia_module.studies.coupling.trial import Trial, adaptive, course, fixed, trial
from inertia_module.studies.coupling.urban import SCENE, urban_run, urban_scene

CONVERGED = Scheme(correction="implicit", iterations=6)


@pytest.fixture(scope="module")
def fmu_path(built):
    return built / "InertiaModule.fmu"


@pytest.fixture(scope="module")
def reference():
    """Courses of the one-piece reference, once for a case."""
    found = {}

    def course_of(case):
        key = case.name, case.ratio
        if key not in found:
            found[key] = Monolith(case).run()
        return found[key]

    return course_of


# --- the added-mass limit ---


@pytest.mark.parametrize("name", [name for name, scheme in SCHEMES.items() if scheme.torque == "mean"])
@pytest.mark.parametrize("ratio", [0.3, 3.0])
def test_changes_of_speed_follow_the_characteristic_polynomial(fmu_path, name, ratio):
    scheme = SCHEMES[name]
    assumed = ratio if scheme.correction == "inertia" else 0.0
    polynomial = np.array(characteristic(scheme, ratio, assumed))
    changes = np.array(limits.speed_changes(scheme, ratio, 1e-3, fmu_path)[:12])
    unrest, rounding = np.diff(changes), 1e-5 * np.abs(changes).min()
    for n in range(4, unrest.size - polynomial.size):
        window = unrest[n : n + polynomial.size][::-1]
        terms = np.abs(polynomial * window).sum()
        assert abs(polynomial @ window) < 1e-3 * terms + rounding


@pytest.mark.parametrize(
    "name, limit", [("mean module first held", 1.0), ("mean module first ramp", 1.0 / 3.0)]
)
@pytest.mark.parametrize("step", [1e-5, 1e-4, 5e-3])
def test_shorter_steps_do_not_move_the_limit(fmu_path, name, limit, step):
    assert limits.is_stable(SCHEMES[name], 0.95 * limit, step, fmu_path)
    assert not limits.is_stable(SCHEMES[name], 1.05 * limit, step, fmu_path)


@pytest.mark.parametrize("name", ["inertia engine first ramp", "inertia module first ramp", "implicit ramp"])
def test_corrected_schemes_have_no_limit(fmu_path, name):
    assert limits.is_stable(SCHEMES[name], 1000.0, 1e-3, fmu_path)


def test_instantaneous_torque_of_a_held_speed_hides_the_inertia_of_the_module(fmu_path):
    assert limits.felt_inertia(SCHEMES["instantaneous module first held"], fmu_path) == pytest.approx(
        0.0, abs=1e-3
    )
    assert limits.felt_inertia(SCHEMES["mean module first held"], fmu_path) == pytest.approx(1.0, abs=1e-3)


def test_interface_inertia_is_that_of_a_rolling_satellite():
    """Held wheel: the imbalance turns about the point of contact at (1 + k) omega1, r - l to r + l away."""
    turned = 3 * 0.3 * (1.0 + 0.1 / 0.06) ** 2
    found = interface_inertia(URBAN_MODULE)
    assert found.least == pytest.approx(turned * 0.02**2, rel=1e-12)
    assert found.greatest == pytest.approx(turned * 0.10**2, rel=1e-12)


# --- accuracy ---


@pytest.mark.parametrize("make", [planar, bevel])
def test_the_converged_coupling_and_the_one_piece_reference_agree(fmu_path, reference, make):
    case = make(1.0)
    expected = reference(case)
    found, ledger, word, _ = course(case, CONVERGED, fixed(1e-4), fmu_path, 1e-10)
    assert word == "stable"
    assert np.abs(found.omega1 - expected.omega1).max() < 3e-5 * case.speed
    assert np.abs(found.omega_out - expected.omega_out).max() < 3e-5 * expected.omega_out.max()
    assert found.work == pytest.approx(expected.work, rel=3e-5)
    assert abs(ledger.defect) < 3e-5 * expected.work


@pytest.mark.parametrize(
    "name, order",
    [("mean module first held", 1.0), ("inertia module first ramp", 2.0), ("implicit ramp", 2.0)],
)
def test_error_falls_with_the_order_of_the_scheme(fmu_path, reference, name, order):
    case = planar(0.3)
    errors = [
        trial(case, name, SCHEMES[name], step, fixed(step), reference(case), fmu_path).output_error
        for step in (1e-3, 2.5e-4)
    ]
    assert math.log(errors[0] / errors[1]) / math.log(4.0) > 0.85 * order


def test_recommended_scheme_is_within_a_percent_at_a_tenth_of_a_pulse(fmu_path, reference):
    for make, step in ((planar, 2e-3), (bevel, 4e-3)):
        case = make(0.5)
        found = trial(case, "", SCHEMES["implicit ramp"], step, fixed(step), reference(case), fmu_path)
        assert max(found.speed_error, found.output_error, abs(found.energy_error)) < 0.01


def coupled_engine(fmu, name, case):
    return CoupledEngine(fmu, case.engine(), SCHEMES[name], case.interface.middle)


@pytest.mark.parametrize("name", list(SCHEMES)[6:])
def test_no_angular_momentum_is_lost_with_step_means(fmu_path, name):
    """What one side has given and the other not yet got stays bounded: it is the exchange of one step."""
    case = planar(0.2)
    with Fmu(fmu_path, case.parameters, {"omega1": case.speed, "load_torque": 8.0}, 1e-8) as fmu:
        coupled = coupled_engine(fmu, name, case)
        largest = bound = 0.0
        for _ in range(500):
            exchange = coupled.step(1e-3)
            largest = max(largest, abs(coupled.ledger.impulse_defect))
            bound = max(bound, 1e-3 * abs(exchange.module_torque))
    assert largest < 1.5 * bound + case.interface.middle * 0.1 * case.speed


def test_every_joule_of_the_engine_is_on_one_of_the_accounts(fmu_path):
    case = planar(0.3)
    with Fmu(fmu_path, case.parameters, {"omega1": case.speed, "load_torque": 8.0}, 1e-8) as fmu:
        coupled = coupled_engine(fmu, "implicit ramp", case)
        engine = coupled.engine
        before = engine.energy_stored + fmu["energy_stored"]
        for _ in range(300):
            coupled.advance(2e-3)
        names = ("energy_out", "energy_lost", "energy_stored", "bond_defect", "engine_work_in")
        out, lost, stored, defect, worked = coupled.read(names)
        left = worked - out - lost - (stored + engine.energy_stored - before)
        assert left == pytest.approx(defect, abs=1e-5 * worked)
        assert abs(defect) < 3e-3 * worked


def test_cost_counts_steps_that_were_taken_back(fmu_path):
    case = planar(0.3)
    with Fmu(fmu_path, case.parameters, {"omega1": case.speed, "load_torque": 8.0}) as fmu:
        coupled = coupled_engine(fmu, "implicit ramp", case)
        for _ in range(10):
            coupled.step(1e-3)
        assert fmu.time == pytest.approx(0.01)
        assert coupled.ledger.steps == 10
        assert coupled.ledger.fmu_steps == 20
        assert coupled.ledger.cost == 40


def test_quick_map_finds_the_recommended_scheme_best_and_comes_back_from_csv(built, tmp_path):
    files = Files(built / "InertiaModule.fmu", built / "DrivenShaft.fmu")
    rows = coupling_map(files, quick=True)
    fine = [row for row in rows if row.step < 2e-3]
    assert len(fine) == len(SCHEMES)
    assert min(fine, key=worst).scheme == "implicit ramp"
    assert max(fine, key=lambda row: abs(row.energy_error)).scheme == "instantaneous jacobi ramp"
    written = write_part(tmp_path, "map", rows)
    assert all(Path(file).stat().st_size > 1000 for file in written.values())
    again = read_rows(tmp_path / "coupling_map.csv", Trial)
    assert [row.scheme for row in again] == [row.scheme for row in rows]
    assert [row.cost for row in again] == pytest.approx([row.cost for row in rows], rel=1e-5)


def test_python_of_the_page_runs(built, tmp_path, monkeypatch, capsys):
    (tmp_path / "build").symlink_to(built)
    page = Path(__file__).parents[2] / "docs" / "coupling.md"
    monkeypatch.chdir(tmp_path)
    defects = []
    for code in re.findall(r"```python\n(.*?)```", page.read_text(), re.S):
        exec(compile(code, "coupling.md", "exec"), {})
        speed, _, defect = map(float, capsys.readouterr().out.split())
        assert speed == pytest.approx(200.0, rel=0.2)
        defects.append(abs(defect))
    by_speed, by_torque = defects
    assert by_speed < 10.0
    assert by_torque < 1e-8


# --- the adaptive step ---


def test_adaptive_step_beats_equal_steps_of_the_same_number(fmu_path):
    name = "inertia module first ramp"
    expected = Monolith(CRUISE).run()
    found = trial(CRUISE, name, SCHEMES[name], 0.0, adaptive(ErrorControl(1e-4)), expected, fmu_path)
    equal = trial(CRUISE, name, SCHEMES[name], found.step, fixed(found.step), expected, fmu_path)
    assert found.cost == pytest.approx(equal.cost, rel=0.02)
    assert found.speed_error < 0.3 * equal.speed_error
    assert found.output_error < 0.5 * equal.output_error
    assert abs(found.energy_error) < 0.1 * abs(equal.energy_error)


def test_adaptive_run_ends_at_the_stop_time(fmu_path):
    case = planar(0.3)
    with Fmu(fmu_path, case.parameters, {"omega1": case.speed, "load_torque": 8.0}) as fmu:
        coupled = coupled_engine(fmu, "mean module first held", case)
        steps = [exchange.step for exchange in run_adaptive(coupled, 0.1, ErrorControl(1e-4, longest=0.01))]
        assert sum(steps) == pytest.approx(0.1, rel=1e-12)
        assert max(steps) <= 0.01
        with pytest.raises(ValueError, match="stop_time = -1 is refused"):
            next(run_adaptive(coupled, -1, ErrorControl(1e-4)))


# --- the urban cycle ---


def test_urban_module_is_that_of_the_scene():
    given = load_scene(SCENE).parameters()
    assert {name: given[name] for name in URBAN_MODULE} == URBAN_MODULE


@pytest.mark.slow
def test_energy_over_the_urban_cycle_adds_up_with_step_means(fmu_path):
    found = urban_run(urban_scene(), fmu_path, "implicit ramp", 3)
    assert abs(found.residual) < 1e-3
    assert found.outside == 0.0
    assert found.engine > 2e5


def test_energy_over_the_launch_does_not_add_up_with_instantaneous_torque(fmu_path):
    scene = urban_scene()
    assert abs(urban_run(scene, fmu_path, "implicit ramp", 5, stop_time=20.0).residual) < 1e-3
    assert (
        abs(urban_run(scene, fmu_path, "instantaneous module first held", 1, stop_time=20.0).residual) > 0.05
    )


# --- what is refused ---


def test_engine_and_module_at_different_speeds_are_refused(fmu_path):
    limits_ = EngineMap((0.0,), (100.0,), (10.0,))
    engine = Engine(0.1, limits_, Governor(1.0, 1.0), 100.0, 90.0)
    with Fmu(fmu_path, {}, {"omega1": 100.0}) as fmu:
        with pytest.raises(
            ValueError, match="omega1 = 100 rad/s of the FMU is refused: allowed is the engine's 90"
        ):
            CoupledEngine(fmu, engine, SCHEMES["implicit ramp"])
        engine = Engine(0.1, limits_, Governor(1.0, 1.0), 100.0, 100.0)
        with pytest.raises(ValueError, match="inertia = None is refused"):
            CoupledEngine(fmu, engine, SCHEMES["inertia module first ramp"])
        with pytest.raises(ValueError, match="substeps = 0 is refused"):
            CoupledEngine(fmu, engine, SCHEMES["implicit ramp"], substeps=0)
    with (
        Fmu(fmu_path, {"input_hold": "linear"}, {"omega1": 100.0}) as fmu,
        pytest.raises(ValueError, match="input_hold = linear is refused"),
    ):
        CoupledEngine(fmu, engine, SCHEMES["implicit ramp"])


@pytest.mark.parametrize("name", ["mean jacobi held", "inertia module first ramp", "implicit ramp"])
def test_after_a_refused_step_a_good_one_goes_on_as_if_nothing_had_been(fmu_path, name):
    case = planar(0.3)
    ends = []
    for load in (8.0, 1e300):
        with Fmu(fmu_path, case.parameters, {"omega1": case.speed, "load_torque": 8.0}, 1e-8) as fmu:
            coupled = coupled_engine(fmu, name, case)
            for n in range(40):
                if n == 20 and load != 8.0:
                    coupled.set(load_torque=load)
                    with pytest.raises(DriveError, match="load_torque"):
                        coupled.step(1e-3)
                    coupled.set(load_torque=8.0)
                coupled.step(1e-3)
            ends.append((coupled.engine.state, *fmu.read(("omega_out", "energy_in"))))
            assert coupled.ledger.steps == 40
    assert ends[0] == ends[1]
