"""Test specifications of designs: errors, the judgement of designs, doubts and the search."""

import math
from pathlib import Path
from types import SimpleNamespace

import pytest
from rejected import REJECTED, assert_rejected

from inertia_module.analysis.converter_chart import compute_chart
from inertia_module.common.examples import example
from inertia_module.kernel.layout import imbalance_position
from inertia_module.model import Module
from inertia_module.scene import Scene, load_scene, run_scene
from inertia_module.scene.keys import validated
from inertia_module.scene.quantity import Quantity
from inertia_module.studies.design_judge import Judge
from inertia_module.studies.design_result import DesignResult, Finalist, caveats_of
from inertia_module.studies.design_search import metrics_of_designs
from inertia_module.studies.design_specification import Limit, limits_of, read_spec
from inertia_module.studies.evaluation import Row
from inertia_module.studies.parameter_sweep import unreached
from inertia_module.studies.search import DesignSearch, Searched, Start
from inertia_module.studies.steady_metrics import STEADY_METRICS, SteadyMechanism

SPEC = Path(__file__).with_name("specification.toml").read_text(encoding="utf-8")
UNITS = {"stall_torque": "N.m", "omega_out_final": "rad/s", "total_imbalance_mass": "kg"}


@pytest.fixture
def read(tmp_path):
    def read(text):
        path = tmp_path / "spec.toml"
        path.write_text(text)
        return read_spec(path)

    return read


def test_a_specification_is_a_scene_with_free_keys_metrics_and_a_search(read):
    spec = read(SPEC)
    assert [axis.name for axis in spec.axes] == ["mechanism.imbalance_mass", "mechanism.satellites"]
    assert spec.goals == {"omega_out_final": "greatest", "total_imbalance_mass": "least"}
    assert spec.steady_demands == {
        "stall_torque": (pytest.approx(104.7197551), 0.0),
        "total_imbalance_mass": (0.0, 0.0),
    }
    assert spec.metrics.keys() - spec.steady_demands.keys() == {"omega_out_final"}
    assert spec.load.inertia == 0.5
    assert (spec.search.check, spec.search.population) == ("rigid", 40)


@pytest.mark.parametrize("old, new, sentence", REJECTED["specifications"])
def test_invalid_specification_is_rejected_in_a_sentence(old, new, sentence, read):
    text = SPEC.replace(old, new)
    assert text != SPEC
    assert_rejected(sentence, read, text)


def test_at_most_three_metrics_have_a_goal(read):
    more = "".join(
        f'torque_{name} = {{ speed = 9, ratio = 0, goal = "least" }}\n' for name in ("ripple", "peak")
    )
    assert_rejected(r"1 to 3 \(got 4\)", read, SPEC.replace("[search]", f"{more}[search]"))


def row(torque, speed, mass):
    metrics = {"stall_torque": torque, "omega_out_final": speed, "total_imbalance_mass": mass}
    metrics_of_row = {name: value for name, value in metrics.items() if value is not None}
    return Row({"mass": mass}, metrics_of_row, 0.0)


def test_designs_are_compared_in_the_units_of_their_metrics(read):
    judge = Judge(read(SPEC), UNITS)
    good = row(22.0, 40.0, 1.0)
    assert judge.meets(good)
    # The margin refers to the units of the scene: 10 % of 100 rpm, 10 % of 50 rad/s.
    assert judge.violations(good, 0.1) == pytest.approx(
        [-0.1, 1.0 - 40.0 / 10.4719755 + 0.1, -0.2 + 0.1, 0.0]
    )
    short = row(15.0, 60.0, 1.0)
    assert not judge.meets(short)
    assert judge.total_violation(short) == pytest.approx(0.25 + 0.2)
    assert judge.tightest(short) == "stall_torque 15 N·m (limit: at least 20 N·m)"
    rejected = Row({"mass": 1.0}, {}, 0.0, "no")
    assert judge.violations(rejected) == [1.0, 1.0, 1.0, 1.0]
    assert judge.violations(row(22.0, None, 1.0)) == pytest.approx([-0.1, 1.0, 1.0, 1.0])


def test_front_contains_the_nondominated_designs(read):
    judge = Judge(read(SPEC), UNITS)
    light, fast, both = row(22.0, 20.0, 0.5), row(22.0, 45.0, 2.0), row(22.0, 40.0, 1.0)
    worse, worst = row(22.0, 39.0, 1.1), row(22.0, 38.0, 1.2)
    first, second, third = judge.fronts([worst, fast, worse, light, both])
    assert sorted(one.point["mass"] for one in first) == [0.5, 1.0, 2.0]
    assert (second, third) == ([worse], [worst])


def test_better_designs_of_another_search_dominate_within_the_limits(read):
    judge = Judge(read(SPEC), UNITS)
    # The arguments are torque, speed and mass.
    here = row(30.0, 20.0, 1.0)
    for other, better in (
        (row(30.0, 20.0, 0.9), True),
        (row(25.0, 21.0, 1.0), True),
        (here, False),
        (row(30.0, 19.0, 0.5), False),
        (row(10.0, 21.0, 0.5), False),
        (row(30.0, 60.0, 0.5), False),
    ):
        assert (judge.dominating_row(here, [other]) is other) == better
    assert (
        judge.dominating_row(here, [row(30.0, 20.0, 0.9), row(30.0, 25.0, 0.8)]).metrics["omega_out_final"]
        == 25.0
    )


def test_keys_of_a_specification_are_set_as_in_its_file(tmp_path):
    path = tmp_path / "spec.toml"
    path.write_text(SPEC)
    keys = {"search.population": 8, "metrics.stall_torque.minimum": "30 N.m", "free.satellites": "2:3"}
    spec = read_spec(path, keys)
    assert spec.search.population == 8
    assert [limit.bound for limit in limits_of("stall_torque", spec.metrics["stall_torque"], "N.m")] == [30.0]
    assert {axis.name: axis.high for axis in spec.axes}["mechanism.satellites"] == 3.0
    words = r"spec.toml: unknown key 'search.populatoin'; did you mean 'population'\?$"
    assert_rejected(words, read_spec, path, ["search.populatoin=8"])


def test_unreached_speed_is_reported():
    slow, fast, rejected = (
        Row({}, {}, 0.0),
        Row({}, {"time_to_25_kmh": 3.0}, 0.0),
        Row({}, {}, 0.0, "too heavy"),
    )
    limit = Limit("time_to_25_kmh", "s", 9.0, 1.0)
    assert limit.text(slow) == "time_to_25_kmh not reached (limit: at most 9 s)"
    assert limit.text(rejected) == "time_to_25_kmh not available (limit: at most 9 s)"
    scene = load_scene(example("engine_launch")).replaced(load={"times_to": ["25 km/h"]})
    assert unreached(scene, [slow, slow, fast, rejected]) == {"time_to_25_kmh": 2}
    assert unreached(scene, [fast, rejected]) == {}


# --- doubts about designs that meet the limits ---

# Design 3 of methods.md with massless satellites.
POINTS = {
    "layout": "planar",
    "sun_radius": 0.09761,
    "satellite_radius": 0.03984,
    "eccentricity": 0.03129,
    "imbalance_mass": 0.1658,
    "satellites": 6.0,
    "link2_inertia": 0.01,
    "output_inertia": 0.05,
}


def disc(density):
    """Return the axial inertia of a disc with the pitch radius of the satellite, 15 mm wide, kg.m2."""
    return 0.5 * math.pi * density * 0.015 * POINTS["satellite_radius"] ** 4


def metric(name, values, ratio=0.0):
    return STEADY_METRICS[name].value(SteadyMechanism(values), 250.0, ratio)


@pytest.mark.parametrize("density, end", [(0.0, 1.0), (2700.0, 0.54), (7850.0, 0.31)])
def test_metrics_with_satellite_mass_have_a_caveat(density, end):
    values = {**POINTS, "satellite_inertia": disc(density)}
    # The satellite mass does not change the stall torque.
    assert metric("stall_torque", values) == pytest.approx(208.54, abs=0.01)
    assert metric("end_ratio", values) == pytest.approx(end, abs=0.01)
    held, least = (metric(name, values) for name in ("lock_up_torque", "least_torque"))
    assert (held, least) == ((0.0, 0.0) if density else pytest.approx((655.15, 55.24), abs=0.01))
    scene = load_scene(example("engine_launch")).replaced(mechanism={**values, "output_inertia": None})
    doubts = caveats_of(scene, {"distance": 80.0}, 250.0)
    doubts.pop("drive too weak", None)  # A machine that locks up has this doubt
    assert doubts == (
        {"no lock-up": f"no torque is transmitted above a speed ratio of {end}"}
        if density
        else {"satellites without inertia": "satellite_inertia is 0"}
    )


@pytest.mark.parametrize("density, reached", [(0.0, 9.82), (2700.0, 21.5), (7850.0, None)])
def test_a_car_is_launched_as_its_satellites_weigh(density, reached, built):
    """The module of POINTS accelerates the car of methods.md to 50 km/h in 25 s, or does not."""
    spec = read_spec(example("design_car"))
    tables = {name: table for name, table in spec.tables.items() if name in Scene.model_fields}
    kept = {name: value for name, value in tables["mechanism"].items() if name != "satellite"}
    tables["mechanism"] = {**kept, **POINTS, "satellite_inertia": disc(density)}
    tables["load"]["final_drive"] = 4.017
    tables["run"] = {"stop_time": 25.0, "communication_step": 0.02}
    summary = run_scene(
        validated(Scene, tables).with_fidelity("elastic"), built / "InertiaModule.fmu"
    ).summary
    assert summary.get("time_to_50_kmh") == (reached and pytest.approx(reached, abs=0.05))
    assert (summary["vehicle_speed_maximum"] < 37.0) is (reached is None)


def test_input_torque_pulses_follow_from_the_reduced_inertia():
    # Link 2 is at rest. M1 - M2 is the rate of I omega1. Six satellites have a constant I: use one.
    one = {**POINTS, "satellites": 1.0}
    lengths = POINTS["sun_radius"] + POINTS["satellite_radius"], POINTS["eccentricity"]
    k = POINTS["sun_radius"] / POINTS["satellite_radius"]
    # I = m (R^2 + l^2 - 2 R l cos q), so M1 = I' q' omega1 + M2 with M2 = - k I' omega1^2 / 2.
    peak = 0.5 * k * 2.0 * POINTS["imbalance_mass"] * math.prod(lengths) * 250.0**2
    # The second term is k B' q'^2, with B = m l (l - R cos q).
    peak += POINTS["imbalance_mass"] * math.prod(lengths) * (k * 250.0) ** 2
    assert metric("input_torque_peak", one) == pytest.approx(peak, rel=2e-3)
    assert metric("input_torque_ripple", one) == pytest.approx(peak / math.sqrt(2.0), rel=2e-3)
    assert metric("satellite_speed", one) == pytest.approx(k * 250.0)
    reached = [metric("bearing_force", POINTS, ratio) for ratio in (0.0, 0.5, 0.9)]
    assert metric("bearing_force_peak", POINTS) >= max(reached) * (1.0 - 1e-3)


def test_satellite_of_bevel_gears_turns_by_both_meshes():
    assert metric("satellite_speed", {"z2": 30.0, "z16": 20.0, "z17": 34.0, "z6": 17.0}) == 750.0


def test_resting_load_and_missing_freewheel_are_reported():
    scene = load_scene(example("engine_launch"))
    assert "load does not move" not in caveats_of(scene, {"distance": 80.0, "omega_out_maximum": 0.0}, 250.0)
    resting = caveats_of(scene, {"distance": 0.09, "omega_out_maximum": 9.0}, 250.0)
    assert resting["load does not move"].startswith("0.0")
    shaft = load_scene(example("reference")).replaced(mechanism={"output_freewheel": 0.0})
    assert "load does not move" not in caveats_of(shaft, {"omega_out_maximum": 90.0}, 250.0)
    caveats = caveats_of(shaft, {"omega_out_maximum": 0.0}, 250.0)
    assert caveats["load does not move"] == "0 revolutions in the run"
    assert "without both freewheels there is no mean torque" in caveats["no mean torque"]
    # A scene without a run has no doubts.
    assert "load does not move" not in caveats_of(shaft, {}, 250.0)


def test_verdict_contains_caveats_and_the_end_of_the_search(read, tmp_path):
    spec, good, short = read(SPEC), row(22.0, 40.0, 1.0), row(15.0, 60.0, 1.0)

    def verdict(checked, front, cut, doubts):
        finalists = [Finalist(good, one, spec, tmp_path / "design_1.toml", doubts) for one in checked]
        judge = Judge(spec, UNITS)
        return DesignResult(judge, [good, short], front, finalists, 2, {}, Searched([good, short], [], cut))

    result = verdict([good, good], [good], False, {"no lock-up": "none above 0.3"})
    assert result.verdict().endswith("; caveats: no lock-up in 2 of them")
    assert result.lines(result.finalists[0])["caveat: no lock-up"] == "none above 0.3"
    assert "caveat" not in verdict([good], [good], False, {}).verdict()
    lost = verdict([short], [good], False, {}).verdict()
    assert lost.startswith(
        "0 of 1 verified designs satisfy all limits; 1 of 2 designs do with fidelity 'averaged'; closest"
    )
    assert "no improvement in the last 8 generations" in verdict([short], [], False, {}).verdict()
    assert "search.longest = 600 s ended the search" in verdict([short], [], True, {}).verdict()
    # A rejected design is never the nearest design, even if all others are far from the limits.
    distant, rejected = row(1.0, 500.0, 1.0), Row({"mass": 9.0}, {}, 0.0, "too heavy")
    judge = Judge(spec, UNITS)
    assert judge.total_violation(distant) > judge.total_violation(rejected)
    none = DesignResult(judge, [rejected, distant], [], [], 2, {}, Searched([], [], False)).verdict()
    assert "closest design: omega_out_final 500 rad/s (limit: at most 50 rad/s)" in none
    assert none.endswith("; 1 of 2 designs were rejected, most often: too heavy")


def test_verdict_names_the_most_frequent_rejection(read):
    reasons = ["mass = 3.1 kg", "inertia = 1e-3 kg.m2", "inertia = 2e-4 kg.m2"]
    rows = [row(1.0, 500.0, 1.0), *(Row({"mass": 9.0}, {}, 0.0, reason) for reason in reasons)]
    result = DesignResult(Judge(read(SPEC), UNITS), rows, [], [], 4, {}, Searched([], [], False))
    assert result.verdict().endswith("; 3 of 4 designs were rejected, most often: inertia = 1e-3 kg.m2")


# --- the search: global, polished, from several starts ---


def searched(read, height, **settings):
    """Minimise a mass that depends only on imbalance mass and number of satellites."""
    text = SPEC.replace(', goal = "greatest"', "").replace("[search]", "[search]\nstarts = 3")
    keys = "".join(f"{name} = {value}\n" for name, value in settings.items())
    spec = read(text.replace("[search]\n", f"[search]\n{keys}"))

    def evaluate(points):
        rows = []
        for point in points:
            mass, number = point["mechanism.imbalance_mass"], point["mechanism.satellites"]
            metrics = {"omega_out_final": 40.0, "stall_torque": 20.0 + mass - 1.0}
            rows.append(Row(point, metrics | {"total_imbalance_mass": height(mass, number)}, 0.0))
        return rows

    judge = Judge(spec, UNITS)
    search = DesignSearch(spec, judge, evaluate)
    return search, search.run()


def test_the_polish_reaches_the_limit_and_the_starts_agree(read):
    """The minimum mass is at the torque limit, at an imbalance mass of 1 kg."""
    _, result = searched(read, lambda mass, number: mass + number, population=8, generations=4)
    assert result.has_converged
    assert len(result.starts) == 3
    for start in result.starts:
        assert start.best["total_imbalance_mass"] == pytest.approx(2.0, rel=5e-3)
    assert all(0.0 <= spread < 5e-3 for spread in result.spread().values())


def test_starts_with_different_minima_are_not_converged(read):
    """The dips are far narrower than the distance between the designs."""
    _, result = searched(
        read, lambda mass, number: 1e-3 + abs(math.sin(3e5 * mass)), population=4, generations=1
    )
    assert not result.has_converged
    assert max(result.spread().values()) > 0.05


def test_verdict_reports_the_agreement_of_starts(read, tmp_path):
    spec, good = read(SPEC), row(22.0, 40.0, 1.0)

    def convergence(masses, cut=False):
        starts = [
            Start(seed, {"omega_out_final": 40.0, "total_imbalance_mass": mass} if mass else {})
            for seed, mass in enumerate(masses)
        ]
        result = Searched([good], starts, cut)
        finalists = [Finalist(good, good, spec, tmp_path, {})]
        return DesignResult(Judge(spec, UNITS), [good], [good], finalists, 1, {}, result).verdict()

    assert "; converged; best of 3 starts: " in convergence([1.0, 1.01, 1.02])
    assert "total_imbalance_mass 1, 1.01, 1.02 kg (spread 2 %)" in convergence([1.0, 1.01, 1.02])
    assert "not converged: the best designs of the starts differ by more than 5 %" in convergence([1.0, 1.5])
    assert "not converged: 1 of 3 starts found no design" in convergence([1.0, None, 1.0])
    assert "not converged: one start shows no spread" in convergence([1.0])
    assert "not converged: search.longest = 600 s ended" in convergence([1.0, 1.0], cut=True)


def test_tightest_limit_can_be_exceeded(read):
    """Each machine that locks up reaches a speed ratio of 1 exactly."""
    text = SPEC.replace("[search]", "end_ratio = { speed = 9, minimum = 1 }\n[search]")
    judge = Judge(read(text), UNITS | {"end_ratio": "1"})

    def design(torque, ratio, speed=40.0):
        good = row(torque, speed, 1.0)
        return good._replace(metrics=good.metrics | {"end_ratio": ratio})

    rows = [design(22.0, 1.0), design(15.0, 0.5), design(30.0, 1.0), design(40.0, 1.0, 60.0)]
    assert judge.tightest(rows[0]).startswith("end_ratio")
    assert judge.tightest(rows[0], rows).startswith("stall_torque")
    # The tightest limit of a design outside the limits is the violated limit.
    assert judge.tightest(design(22.0, 0.5), rows).startswith("end_ratio")


# --- power and grip ---


def test_drive_that_is_too_weak_is_a_caveat():
    scene = load_scene(example("engine_launch"))
    torque = scene.drive_torque_limit(200.0)
    assert torque == pytest.approx(35.6, abs=0.5)
    caveat = caveats_of(scene, {}, 200.0)["drive too weak"]
    chart = compute_chart(scene.parameters(), 200.0)
    assert f"requires up to {(chart.input_torque * 4e4).max():.4g} N·m at 200 rad/s" in caveat
    strong = scene.replaced(drive={"full_load": {"speed": [0.0, 300.0], "torque": [2000.0, 2000.0]}})
    assert "drive too weak" not in caveats_of(strong, {}, 200.0)
    assert load_scene(example("planar")).drive_torque_limit(200.0) is None


def test_slipping_wheels_are_a_caveat():
    scene = load_scene(example("engine_launch")).replaced(load={"friction_coefficient": 0.5})
    grip = 0.5 * 900.0 * 9.80665
    assert scene.load.grip == pytest.approx(grip)
    caveats = caveats_of(scene, {"tractive_force_maximum": 1.01 * grip}, 200.0)
    assert (
        caveats["wheels slip"] == f"the tractive force reaches {1.01 * grip:.4g} N, the grip is {grip:.4g} N"
    )
    assert "wheels slip" not in caveats_of(scene, {"tractive_force_maximum": 0.99 * grip}, 200.0)


# --- envelope and mass of a mechanism, against its geometry scanned over all angles ---


BEVEL = [
    {},
    {"a": 0.6, "b": 1.3, "c": 0.9, "z17": 41.0, "z6": 23.0, "shaft_angle": 1.1, "satellites": 3.0},
    {"a": 0.5, "b": 0.4, "c": 1.2, "z17": 20.0, "z6": 31.0, "shaft_angle": 2.0},
]


def farthest(values):
    """Return the largest distance of an imbalance from the central axis over many drive angles, m."""
    module = Module("plain")
    module.check(**values)
    places = (imbalance_position(module.derived, 0.03 * n, 0.0) for n in range(10_000))
    return max(math.hypot(place[1], place[2]) for place in places)


@pytest.mark.parametrize("values", BEVEL)
def test_envelope_of_bevel_gears_includes_imbalance_and_rim(values):
    # Over time an imbalance passes all angles of its satellite at every position.
    reached = max(farthest(values), farthest({**values, "a": 1.0, "b": 1.0}))
    assert SteadyMechanism(values).envelope_diameter / 2.0 == pytest.approx(reached, rel=2e-3)
    assert SteadyMechanism(values).envelope_diameter / 2.0 >= reached * (1.0 - 1e-12)


def test_envelope_mass_and_room_of_a_planar_mechanism():
    planar = {"layout": "planar", "sun_radius": 0.1, "satellite_radius": 0.06}
    for eccentricity, reach in ((0.04, 0.1 + 2 * 0.06), (0.08, 0.1 + 0.06 + 0.08)):
        found = SteadyMechanism({**planar, "eccentricity": eccentricity}).envelope_diameter
        assert found == pytest.approx(2 * reach)
    of_all = {"modules": 2.0, "satellites": 3.0, "imbalance_mass": "250 g"}
    assert metric("total_imbalance_mass", of_all) == 1.5
    assert metric("total_imbalance_mass", {}) == 1.0
    scene = load_scene(example("planar")).replaced(mechanism=planar)
    asked = {"tables": scene.tables, "steady_demands": {"envelope_diameter": (0.0, 0.0)}, "runs": False}
    metrics = metrics_of_designs(asked, None)
    found = metrics({"fidelity": "rigid", "mechanism.eccentricity": 0.06})
    assert found["envelope_diameter"] == (pytest.approx(0.44), "m")
    for name, value in (("eccentricity", 0.061), ("satellites", 9.0)):
        assert_rejected(name, metrics, {"fidelity": "rigid", f"mechanism.{name}": value})


def test_driven_mass_is_rigid_with_the_hub_of_a_design():
    shaft = load_scene(example("reference")).replaced(mechanism={"driven_inertia": 0.3})
    run = SimpleNamespace(run=lambda scene: SimpleNamespace(quantities={"scene": Quantity(scene, "")}))
    metrics = metrics_of_designs({"tables": shaft.tables, "steady_demands": {}, "runs": True}, run)
    for level, inertia in (("averaged", 0.5), ("elastic", 0.2)):
        scene = metrics({"fidelity": level, "mechanism.output_inertia": 0.2})["scene"].value
        assert scene.parameters()["output_inertia"] == pytest.approx(inertia)


def test_a_design_with_a_deprecated_method_can_be_built():
    scene = load_scene(example("reference")).replaced(mechanism={"method": "timestepping"})
    metrics = metrics_of_designs(
        {"tables": scene.tables, "steady_demands": {}, "runs": False}, SimpleNamespace()
    )
    assert metrics({"fidelity": "rigid"}) == {}
