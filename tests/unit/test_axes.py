"""What is varied: ranges and lists of keys of a scene, and the points of them."""

import numpy as np
import pytest

from inertia_module.common.errors import Refused
from inertia_module.jobs.axes import axes_of, grid, of_shares, shares_sampled
from inertia_module.scene import read_scene

SCENE = """
[drive]
kind = "constant"
omega1 = "100 rad/s"
[load]
kind = "shaft"
inertia = "0.5 kg.m2"
[run]
stop_time = "0.1 s"
communication_step = "1 ms"
"""


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return read_scene(SCENE, tmp_path_factory.mktemp("scene"))


def test_a_grid_has_all_combinations_in_si_units_the_last_key_fastest(scene):
    points = grid(axes_of(["imbalance_mass=500 g:2:3", "drive.omega1=600rpm,100"], scene))
    assert [list(point.values()) for point in points] == [
        [mass, speed] for mass in (0.5, 1.25, 2.0) for speed in (pytest.approx(20 * np.pi), 100.0)
    ]
    assert list(points[0]) == ["mechanism.imbalance_mass", "drive.omega1"]


def test_points_even_in_the_logarithm_names_and_whole_numbers(scene):
    (log,) = axes_of({"load.inertia": "log:0.1:10:3"}, scene)
    assert grid([log]) == [{"load.inertia": pytest.approx(value)} for value in (0.1, 1.0, 10.0)]
    (layout,) = axes_of({"layout": ["bevel", "planar"]}, scene)
    assert [point["mechanism.layout"] for point in grid([layout])] == ["bevel", "planar"]
    (teeth,) = axes_of(["z17=30:34:9"], scene)
    assert [point["mechanism.z17"] for point in grid([teeth])] == [30.0, 31.0, 32.0, 33.0, 34.0]


@pytest.mark.parametrize("kind", ["latin", "sobol"])
def test_samples_fill_the_ranges_and_are_the_same_for_the_same_seed(kind, scene):
    axes = axes_of(["imbalance_mass=0.5:2", "satellites=1:4", "layout=bevel,planar"], scene)
    points, same, other = (of_shares(axes, shares_sampled(3, f"{kind}:64", seed)) for seed in (3, 3, 4))
    assert points == same != other
    masses = np.array([point["mechanism.imbalance_mass"] for point in points])
    counts = np.histogram(masses, bins=8, range=(0.5, 2.0))[0]
    assert counts.min() >= 7
    assert counts.max() <= 9
    satellites = [point["mechanism.satellites"] for point in points]
    assert {number: satellites.count(number) for number in set(satellites)} == dict.fromkeys(
        (1.0, 2.0, 3.0, 4.0), 16
    )
    assert sum(point["mechanism.layout"] == "planar" for point in points) == 32


@pytest.mark.parametrize(
    "vary, sentence",
    [
        ([], "at least one key must be varied, such as imbalance_mass=0.5:2:7, none is"),
        (["imbalance_mass"], "NAME=FROM:TO:COUNT"),
        (["imbalance_mass=1:2:x"], "imbalance_mass must be given as FROM:TO:COUNT"),
        (["imbalance_mas=1:2:3"], r"did you mean imbalance_mass\?"),
        (["drive.omega=1:2:3"], r"drive.omega = '1': there is no such key \(did you mean omega1\?\)"),
        (["imbalance_mass=2:1:3"], "from a lower to a higher value, goes from 2 to 1"),
        (["imbalance_mass=-1:1:3"], "imbalance_mass must be between 0 and .* kg, is '-1'"),
        (["imbalance_mass=1 s:2:3"], "s is not a unit for kg"),
        (["imbalance_mass=log:0:2:3"], "above 0"),
        (["imbalance_mass=1:2:1"], "at least 2 points"),
        (["imbalance_mass=1:2:3", "mechanism.imbalance_mass=1,2"], "varied once, is given 2 times"),
        (["layout=bevel,conical"], "layout must be 0 .bevel. or 1 .planar., is 'conical'"),
        (["z17=30.5,31"], "z17 must be a whole number"),
    ],
)
def test_what_cannot_be_varied_is_refused_in_a_sentence(vary, sentence, scene):
    with pytest.raises(Refused, match=sentence):
        axes_of(vary, scene)


def test_a_grid_needs_numbers_of_points_and_a_sample_a_kind(scene):
    axes = axes_of(["imbalance_mass=1:2"], scene)
    with pytest.raises(Refused, match="number of points for a grid"):
        grid(axes)
    with pytest.raises(Refused, match="must be latin:COUNT or sobol:COUNT"):
        shares_sampled(1, "random:10", 0)
    with pytest.raises(Refused, match="at most 10000000 points"):
        grid(axes_of(["imbalance_mass=1:2:9999", "drive.omega1=1:2:9999"], scene))
