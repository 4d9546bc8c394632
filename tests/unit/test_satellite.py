"""A satellite by its sizes and materials: its energy against integrals over its volume; refusals."""

import math

import numpy as np
import pytest
from refused import assert_refused

from inertia_module.common.examples import example
from inertia_module.memory import Module
from inertia_module.scene import load_scene
from inertia_module.scene.reading import scene_text

SIZES = {
    "width": "12 mm",
    "material": "aluminium",
    "weight_radius": "25 mm",
    "weight_width": "20 mm",
    "weight_material": "18000 kg/m3",
}
PLANAR = {"layout": "planar", "sun_radius": 0.09, "satellite_radius": 0.03}
BEVEL = {"z17": 34, "z6": 20, "shaft_angle": 1.1, "b": 0.9, "c": 1.1, "gamma": 0.4, "epsilon": 0.7}


def of_sizes(mechanism, **changed):
    """Scene R1 with another mechanism, whose one satellite has SIZES."""
    keys = {**mechanism, "satellite": {**SIZES, **changed}}
    return load_scene(example("reference")).replaced(mechanism=keys)


def cylinder(radius, angles, heights, density):
    """Points (u, v, height) and masses of a sector of a cylinder, whose second moments are exact."""
    nodes, weights = np.polynomial.legendre.leggauss(12)

    def over(low, high):
        return 0.5 * (low + high + (high - low) * nodes), 0.5 * (high - low) * weights

    (r, of_r), (turned, of_turned), (z, of_z) = over(0.0, radius), over(*angles), over(*heights)
    r, turned, z = (part.ravel() for part in np.meshgrid(r, turned, z, indexing="ij"))
    mass = density * r * np.einsum("i,j,k->ijk", of_r, of_turned, of_z).ravel()
    return np.array([r * np.cos(turned), r * np.sin(turned), z]).T, mass


def body(pitch):
    """The satellite of SIZES, u towards its weight, heights along its axis from the middle of the gear."""
    half = (-0.5 * math.pi, 0.5 * math.pi)
    parts = [
        # two halves, for an angle of a whole turn asks for more nodes
        cylinder(pitch, half, (-0.006, 0.006), 2700.0),
        cylinder(pitch, (half[1], 3.0 * half[1]), (-0.006, 0.006), 2700.0),
        cylinder(0.025, half, (0.006, 0.016), 18000.0),
        cylinder(0.025, half, (-0.016, -0.006), 18000.0),
    ]
    return np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])


def placed(values, q):
    """Centre of the gear, and unit vectors towards the weight, across and along the axis; in link 1.

    And the angular velocities, for a unit of q', of the drive and of the satellite to link 1.
    """
    if values["layout"]:
        u = np.array([0.0, math.sin(q), -math.cos(q)])
        x = np.array([1.0, 0.0, 0.0])
        centre = np.array([0.0, 0.0, values["sun_radius"] + values["satellite_radius"]])
        return centre, (u, np.cross(x, u), x), 0.0 * x, x
    sigma, s = values["shaft_angle"], values["z17"] / values["z6"]
    phi = math.atan2(math.sin(sigma), s + math.cos(sigma))
    pitch = values["wheel_radius"] / math.sin(sigma - phi)
    qa, oq = values["b"] * pitch * math.cos(phi), values["c"] * pitch * math.cos(sigma - phi)
    a, b = q + values["gamma"], s * q + values["epsilon"]
    turn = np.array([[math.cos(a), -math.sin(a), 0.0], [math.sin(a), math.cos(a), 0.0], [0.0, 0.0, 1.0]])
    e = turn @ (-math.sin(sigma), 0.0, math.cos(sigma))
    u = turn @ (-math.cos(sigma) * math.cos(b), -math.sin(b), -math.sin(sigma) * math.cos(b))
    z = np.array([0.0, 0.0, 1.0])
    return oq * z - qa * e, (u, np.cross(e, u), e), z, z + s * e


def energies(mechanism, q, omega1, omega2):
    """Kinetic energy of the body, of the module, and what the latter is known to leave out, J."""
    scene = of_sizes(mechanism)
    module = Module("plain")
    speeds = {"omega1": omega1, "omega2_start": omega2, "omega_out_start": omega2, "drive_angle_start": q}
    fixed = {"fidelity": "rigid", "satellites": 1, "load_torque": 0.0}
    module.start(**{**scene.parameters(), **fixed, **speeds})
    links = 0.5 * (module["link2_inertia"] + module["output_inertia"]) * omega2**2
    values = {name: module[name] for name in [*PLANAR, *BEVEL, "wheel_radius"]}
    slip = module.derived.k * (omega1 - omega2)
    pitch = values["satellite_radius"] if values["layout"] else 0.08 * values["z6"] / values["z17"]
    local, mass = body(pitch)
    centre, axes, drive, own = placed(values, q)
    x = np.array([1.0, 0.0, 0.0])
    spin = omega1 * x + slip * own
    moves = np.cross(omega1 * x + slip * drive, centre) + np.cross(spin, local @ np.array(axes))
    # of a weight the inertias across differ by its static moment times the eccentricity
    e = local.T @ mass / mass.sum()
    swing = mass.sum() * e[0] ** 2 / 4.0 * ((spin @ axes[0]) ** 2 - (spin @ axes[1]) ** 2)
    assert e[1:] == pytest.approx([0.0, 0.0], abs=1e-12)
    return 0.5 * mass @ (moves**2).sum(1), module["energy_stored"] - links, 0.0 if values["layout"] else swing


@pytest.mark.parametrize("mechanism", [PLANAR, BEVEL])
def test_energy_of_a_satellite_is_that_of_its_volume(mechanism):
    for q, omega1, omega2 in np.random.default_rng(3).uniform((0.0, 50.0, 0.0), (7.0, 150.0, 50.0), (12, 3)):
        of_volume, of_module, swing = energies(mechanism, q, omega1, omega2)
        assert of_module + swing == pytest.approx(of_volume, rel=1e-9)
        # what is left out of bevel gears is little
        assert abs(swing) < 0.02 * of_volume


def test_parameters_that_follow_are_ordinary_ones_and_written_as_sizes(tmp_path):
    pytest.importorskip("tomli_w")
    scene = of_sizes(PLANAR)
    followed = scene.following
    assert followed.keys() == {"imbalance_mass", "eccentricity", "satellite_inertia"}
    assert scene.parameters().items() >= followed.items()
    gear, weight = 2700.0 * math.pi * 0.03**2 * 0.012, 18000.0 * math.pi * 0.025**2 * 0.01
    assert followed["imbalance_mass"] == pytest.approx(gear + weight)
    moment = weight * 4.0 * 0.025 / (3.0 * math.pi)
    assert followed["imbalance_mass"] * followed["eccentricity"] == pytest.approx(moment)
    path = tmp_path / "scene.toml"
    path.write_text(scene_text(scene))
    assert 'material = "2700 kg/m3"' in path.read_text()
    assert "imbalance_mass" not in path.read_text()
    assert load_scene(path).parameters() == scene.parameters()
    # the fidelity, and other keys, may be changed as ever
    assert scene.with_fidelity("averaged").following == followed
    wider = scene.with_keys({"mechanism.satellite.weight_width": "30 mm"}).following
    assert wider["imbalance_mass"] == pytest.approx(gear + 1.5 * weight)
    alone = scene.with_keys({"mechanism.satellite.weight_material": None}).following
    assert alone["imbalance_mass"] == pytest.approx(gear + 0.15 * weight)


@pytest.mark.parametrize(
    "key, value, sentence",
    [
        ("imbalance_mass", 2.0, "imbalance_mass must not be given with .mechanism.satellite., .* 2$"),
        ("a", 0.5, "mechanism.a must not be given with .mechanism.satellite., which it follows from, is 0.5"),
        ("satellite_radius", 0.02, "satellite.weight_radius must be at most .* = 0.02 m, is 0.025 m"),
        ("satellite.width", 0, "mechanism.satellite.width must be a number .*above 0 .*, is 0"),
        ("satellite.width", None, "mechanism.satellite.width must be given, is missing"),
        ("satellite.material", "steal", "must be one of polyamide, .* or its density, .* is 'steal'"),
        ("satellite.material", "7 kg", "material must be one of polyamide, .* or its density, .* is '7 kg'"),
        ("satellite.thickness", 1, "mechanism.satellite.thickness = 1: there is no such key"),
    ],
)
def test_what_contradicts_a_body_is_refused_in_a_sentence(key, value, sentence):
    assert_refused(sentence, of_sizes(PLANAR).with_keys, {f"mechanism.{key}": value})
