"""Envelope and mass of a mechanism, against its geometry scanned over all angles."""

import math

import pytest

from inertia_module.common.errors import Refused
from inertia_module.jobs.spec import Mechanism
from inertia_module.kernel.layout import imbalance
from inertia_module.memory import Module

BEVEL = [
    {},
    {"a": 0.6, "b": 1.3, "c": 0.9, "z17": 41.0, "z6": 23.0, "shaft_angle": 1.1, "satellites": 3.0},
    {"a": 0.5, "b": 0.4, "c": 1.2, "z17": 20.0, "z6": 31.0, "shaft_angle": 2.0},
]


def farthest(values):
    """Largest distance of an imbalance from the central axis, m, of many drive angles."""
    module = Module("plain")
    module.check(**values)
    places = (imbalance(module.derived, 0.003 * n, 0.0) for n in range(100_000))
    return max(math.hypot(place[1], place[2]) for place in places)


@pytest.mark.parametrize("values", BEVEL)
def test_envelope_of_bevel_gears_is_that_of_imbalance_and_rim(values):
    # a whole number of teeth: in time an imbalance passes all angles of its satellite anywhere
    reached = max(farthest(values), farthest({**values, "a": 1.0, "b": 1.0}))
    assert Mechanism(values).envelope_diameter / 2.0 == pytest.approx(reached, rel=2e-3)
    assert Mechanism(values).envelope_diameter / 2.0 >= reached * (1.0 - 1e-12)


def test_envelope_of_a_planar_mechanism():
    planar = {"layout": "planar", "sun_radius": 0.1, "satellite_radius": 0.06}
    assert Mechanism({**planar, "eccentricity": 0.04}).envelope_diameter == pytest.approx(
        2 * (0.1 + 2 * 0.06)
    )
    assert Mechanism({**planar, "eccentricity": 0.08}).envelope_diameter == pytest.approx(
        2 * (0.1 + 0.06 + 0.08)
    )


def test_mass_of_all_imbalances():
    assert (
        Mechanism({"modules": 2.0, "satellites": 3.0, "imbalance_mass": "250 g"}).total_imbalance_mass == 1.5
    )
    assert Mechanism({}).total_imbalance_mass == 1.0


def test_what_cannot_be_built_is_refused():
    planar = {"layout": "planar", "sun_radius": 0.1, "satellite_radius": 0.06}
    Mechanism({**planar, "eccentricity": 0.06}).check_room()
    with pytest.raises(Refused, match="eccentricity"):
        Mechanism({**planar, "eccentricity": 0.061}).check_room()
    with pytest.raises(Refused, match="satellites"):
        Mechanism({**planar, "satellites": 9.0}).check_room()
