"""Specifications of designs: what is refused, and how designs are judged by them."""

import math

import pytest

from inertia_module.common.errors import Refused
from inertia_module.common.examples import example
from inertia_module.jobs.design import Judge, Limit, Mechanism, limits_of, read_spec
from inertia_module.jobs.evaluation import Row
from inertia_module.jobs.sweep import unreached
from inertia_module.kernel.layout import imbalance
from inertia_module.memory import Module
from inertia_module.scene import SceneError, load_scene

SPEC = """
[drive]
kind = "constant"
omega1 = "100 rad/s"
[load]
kind = "shaft"
inertia = "0.5 kg.m2"
[run]
stop_time = "1 s"
communication_step = "10 ms"
[free]
imbalance_mass = "500 g:2 kg"
satellites = "1:4"
[figures]
stall_torque = { speed = "1000 rpm", minimum = "20 N.m" }
omega_out_final = { minimum = "100 rpm", maximum = 50, goal = "greatest" }
total_imbalance_mass = { goal = "least" }
[search]
margin = "10 %"
"""
UNITS = {"stall_torque": "N.m", "omega_out_final": "rad/s", "total_imbalance_mass": "kg"}


@pytest.fixture
def read(tmp_path):
    def read(text):
        path = tmp_path / "spec.toml"
        path.write_text(text)
        return read_spec(path)

    return read


def test_a_specification_is_a_scene_with_free_keys_figures_and_a_search(read):
    spec = read(SPEC)
    assert [axis.name for axis in spec.axes] == ["mechanism.imbalance_mass", "mechanism.satellites"]
    assert spec.goals == {"omega_out_final": "greatest", "total_imbalance_mass": "least"}
    assert spec.named == {
        "stall_torque": (pytest.approx(104.7197551), 0.0),
        "total_imbalance_mass": (0.0, 0.0),
    }
    assert spec.figures.keys() - spec.named.keys() == {"omega_out_final"}
    assert spec.load.inertia == 0.5
    assert (spec.search.check, spec.search.population) == ("rigid", 40)


@pytest.mark.parametrize(
    "old, new, sentence",
    [
        ("[free]", "[fre]", r"fre = .*: there is no such key \(did you mean free\?\)"),
        ('imbalance_mass = "500 g:2 kg"\nsatellites = "1:4"', "", "at least one key must be varied, such as"),
        ('imbalance_mass = "500 g:2 kg"', 'imbalance_mas = "500 g:2 kg"', r"did you mean imbalance_mass\?"),
        ("500 g:2 kg", "2 kg:1 kg", "from a lower to a higher value"),
        ("1:4", "0:4", "satellites must be a whole number between 1"),
        ('speed = "1000 rpm", ', "", "stall_torque must be given speed, is given none of it"),
        ("omega_out_final = {", "omega_out_final = { ratio = 0.5,", "no speed and no ratio, is given ratio"),
        ("stall_torque", "stal_torque", "figures at a speed are stall_torque, steady_torque"),
        ("20 N.m", "20 kg", "stall_torque.minimum must be a number in N.m, is '20 kg'"),
        ("20 N.m", "lots", "stall_torque.minimum must be a number in N.m, is 'lots'"),
        (', minimum = "20 N.m"', "", "must have a minimum, a maximum or a goal"),
        ('minimum = "20 N.m"', "minimum = 5, maximum = 4", "minimum must be at most maximum, 5 is above 4"),
        ('"greatest"', '"most"', "'least' or 'greatest', is 'most'"),
        ("10 %", "60 %", "search.margin must be a number of at least 0 and of at most 0.5"),
        ("[search]", "[search]\npopulatoin = 4", r"did you mean population\?"),
        ("[drive]", "[drive", "spec.toml: the scene is no TOML: Expected"),
    ],
)
def test_a_bad_specification_is_refused_in_a_sentence(old, new, sentence, read):
    text = SPEC.replace(old, new)
    assert text != SPEC
    with pytest.raises(SceneError, match=sentence) as refused:
        read(text)
    assert "\n" not in str(refused.value).strip()


def test_one_to_three_figures_have_a_goal(read):
    with pytest.raises(SceneError, match="1 to 3, is 0"):
        read(SPEC.replace(', goal = "greatest"', "").replace('goal = "least"', "maximum = 9"))
    more = "".join(
        f'torque_{name} = {{ speed = 9, ratio = 0, goal = "least" }}\n' for name in ("ripple", "peak")
    )
    with pytest.raises(SceneError, match="1 to 3, is 4"):
        read(SPEC.replace("[search]", f"{more}[search]"))


def row(torque, speed, mass):
    figures = {"stall_torque": torque, "omega_out_final": speed, "total_imbalance_mass": mass}
    known = {name: value for name, value in figures.items() if value is not None}
    return Row({"mass": mass}, known, 0.0)


def test_designs_are_judged_in_the_units_of_their_figures(read):
    judge = Judge(read(SPEC), UNITS)
    good = row(22.0, 40.0, 1.0)
    assert judge.meets(good)
    # the margin is for what the scene gives: 10 % of 100 rpm, 10 % of 50 rad/s
    assert judge.violations(good, 0.1) == pytest.approx(
        [-0.1, 1.0 - 40.0 / 10.4719755 + 0.1, -0.2 + 0.1, 0.0]
    )
    short = row(15.0, 60.0, 1.0)
    assert not judge.meets(short)
    assert judge.beyond(short) == pytest.approx(0.25 + 0.2)
    assert judge.tightest(short).text(short, "N.m") == "stall_torque is 15 N.m, must be at least 20 N.m"
    refused = Row({"mass": 1.0}, {}, 0.0, "no")
    assert judge.violations(refused) == [1.0, 1.0, 1.0, 1.0]
    assert judge.violations(row(22.0, None, 1.0)) == pytest.approx([-0.1, 1.0, 1.0, 1.0])


def test_the_front_is_what_no_other_design_is_better_than(read):
    judge = Judge(read(SPEC), UNITS)
    light, fast, both = row(22.0, 20.0, 0.5), row(22.0, 45.0, 2.0), row(22.0, 40.0, 1.0)
    worse, worst = row(22.0, 39.0, 1.1), row(22.0, 38.0, 1.2)
    first, second, third = judge.fronts([worst, fast, worse, light, both])
    assert sorted(one.point["mass"] for one in first) == [0.5, 1.0, 2.0]
    assert (second, third) == ([worse], [worst])


def test_keys_of_a_specification_are_set_as_in_its_file(tmp_path):
    path = tmp_path / "spec.toml"
    path.write_text(SPEC)
    keys = ["search.population=8", "figures.stall_torque.minimum=30 N.m", "free.satellites=2:3"]
    spec = read_spec(path, keys)
    assert spec.search.population == 8
    assert [limit.bound for limit in limits_of("stall_torque", spec.figures["stall_torque"], "N.m")] == [30.0]
    assert {axis.name: axis.high for axis in spec.axes}["mechanism.satellites"] == 3.0
    with pytest.raises(SceneError, match=r"spec.toml: .*populatoin.*did you mean population\?"):
        read_spec(path, ["search.populatoin=8"])


def test_speed_that_a_design_or_a_run_does_not_reach_is_told():
    slow, fast, refused = (
        Row({}, {}, 0.0),
        Row({}, {"time_to_25_kmh": 3.0}, 0.0),
        Row({}, {}, 0.0, "too heavy"),
    )
    limit = Limit("time_to_25_kmh", 9.0, 1.0)
    assert limit.text(slow, "s") == "time_to_25_kmh is not reached, must be at most 9 s"
    assert limit.text(refused, "s") == "time_to_25_kmh is missing, must be at most 9 s"
    scene = load_scene(example("engine_launch")).replaced(load={"times_to": ["25 km/h"]})
    assert unreached(scene, [slow, slow, fast, refused]) == {"time_to_25_kmh": 2}
    assert unreached(scene, [fast, refused]) == {}


# --- envelope and mass of a mechanism, against its geometry scanned over all angles ---


BEVEL = [
    {},
    {"a": 0.6, "b": 1.3, "c": 0.9, "z17": 41.0, "z6": 23.0, "shaft_angle": 1.1, "satellites": 3.0},
    {"a": 0.5, "b": 0.4, "c": 1.2, "z17": 20.0, "z6": 31.0, "shaft_angle": 2.0},
]


def farthest(values):
    """Largest distance of an imbalance from the central axis, m, of many drive angles."""
    module = Module("plain")
    module.check(**values)
    places = (imbalance(module.derived, 0.03 * n, 0.0) for n in range(10_000))
    return max(math.hypot(place[1], place[2]) for place in places)


@pytest.mark.parametrize("values", BEVEL)
def test_envelope_of_bevel_gears_is_that_of_imbalance_and_rim(values):
    # a whole number of teeth: in time an imbalance passes all angles of its satellite anywhere
    reached = max(farthest(values), farthest({**values, "a": 1.0, "b": 1.0}))
    assert Mechanism(values).envelope_diameter / 2.0 == pytest.approx(reached, rel=2e-3)
    assert Mechanism(values).envelope_diameter / 2.0 >= reached * (1.0 - 1e-12)


def test_envelope_mass_and_room_of_a_planar_mechanism():
    planar = {"layout": "planar", "sun_radius": 0.1, "satellite_radius": 0.06}
    for eccentricity, reach in ((0.04, 0.1 + 2 * 0.06), (0.08, 0.1 + 0.06 + 0.08)):
        found = Mechanism({**planar, "eccentricity": eccentricity}).envelope_diameter
        assert found == pytest.approx(2 * reach)
    of_all = {"modules": 2.0, "satellites": 3.0, "imbalance_mass": "250 g"}
    assert Mechanism(of_all).total_imbalance_mass == 1.5
    assert Mechanism({}).total_imbalance_mass == 1.0
    Mechanism({**planar, "eccentricity": 0.06}).check_room()
    for name, value in (("eccentricity", 0.061), ("satellites", 9.0)):
        with pytest.raises(Refused, match=name):
            Mechanism({**planar, name: value}).check_room()
