"""Test satellites by sizes and materials against MuJoCo, and rejections."""

import math

import numpy as np
import pytest
from rejected import REJECTED, assert_rejected

from inertia_module.common.examples import example
from inertia_module.scene import load_scene
from inertia_module.scene.reading import scene_text
from inertia_module.scene.satellite import Satellite

SIZES = {
    "width": "12 mm",
    "material": "aluminium",
    "weight_radius": "25 mm",
    "weight_width": "20 mm",
    "weight_material": "18000 kg/m3",
}
PLANAR = {"layout": "planar", "sun_radius": 0.09, "satellite_radius": 0.03}


def of_sizes(mechanism, **changed):
    """Return scene R1 with another mechanism that has a single satellite with SIZES."""
    keys = {**mechanism, "satellite": {**SIZES, **changed}}
    return load_scene(example("reference")).replaced(mechanism=keys)


def half_disc(radius, thickness, place, density, segments=720):
    """Return a mesh and a geom of MuJoCo: a prism with half a regular polygon as base, towards x."""
    angles = np.linspace(-0.5 * np.pi, 0.5 * np.pi, segments + 1)
    rim = radius * np.array([np.cos(angles), np.sin(angles)]).T
    points = [f"{x:.17g} {y:.17g} {side * thickness:.17g}" for side in (-0.5, 0.5) for x, y in rim.tolist()]
    name = f"half {place:g}"
    mesh = f'<mesh name="{name}" inertia="exact" vertex="{" ".join(points)}"/>'
    return mesh, f'<geom type="mesh" mesh="{name}" pos="0 0 {place:.17g}" density="{density!r}"/>'


@pytest.mark.parametrize("layout", ["planar", "bevel"])
def test_inertia_of_satellite_shapes_agrees_with_mujoco(layout):
    mujoco = pytest.importorskip("mujoco")
    pitch, width, radius, thickness = 0.03, 0.012, 0.025, 0.02
    sizes = {"width": width, "weight_radius": radius, "weight_width": thickness}
    satellite = Satellite(**sizes, material="aluminium", weight_material="brass")
    gears = {"layout": 1.0, "satellite_radius": pitch}
    if layout == "bevel":
        gears = {"layout": 0.0, "wheel_radius": pitch * 1.7, "z17": 34.0, "z6": 20.0}
    result = satellite.parameters(gears)
    places = [side * 0.5 * (width + 0.5 * thickness) for side in (-1.0, 1.0)]
    halves = [half_disc(radius, 0.5 * thickness, place, 8500.0) for place in places]
    gear = f'<geom type="cylinder" size="{pitch!r} {0.5 * width!r}" density="2700"/>'
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><compiler inertiafromgeom="true"/><asset>{"".join(mesh for mesh, _ in halves)}</asset>
        <worldbody><body>{gear}{"".join(geom for _, geom in halves)}</body></worldbody></mujoco>"""
    )
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[1])
    inertia = np.diag(turn.reshape(3, 3) @ np.diag(model.body_inertia[1]) @ turn.reshape(3, 3).T)
    offset = result["a"] * pitch if layout == "bevel" else result["eccentricity"]
    # Half a polygon of 1,440 sides is smaller than half a disc by 3e-6.
    assert model.body_mass[1] == pytest.approx(result["imbalance_mass"], rel=1e-5)
    assert model.body_ipos[1] == pytest.approx([offset, 0.0, 0.0], rel=1e-5, abs=1e-9)
    assert inertia[2] == pytest.approx(result["satellite_inertia"], rel=1e-5)
    if layout == "bevel":
        assert np.mean(inertia[:2]) == pytest.approx(result["satellite_transverse_inertia"], rel=1e-5)
        # The module omits only this part.
        swing = result["imbalance_mass"] * offset**2
        assert abs(inertia[1] - inertia[0]) == pytest.approx(swing, rel=1e-4)


def test_derived_parameters_are_written_as_sizes(tmp_path):
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
    # Other keys, such as the fidelity, can be changed.
    assert scene.with_fidelity("averaged").following == followed
    wider = scene.with_keys({"mechanism.satellite.weight_width": "30 mm"}).following
    assert wider["imbalance_mass"] == pytest.approx(gear + 1.5 * weight)
    alone = scene.with_keys({"mechanism.satellite.weight_material": None}).following
    assert alone["imbalance_mass"] == pytest.approx(gear + 0.15 * weight)


@pytest.mark.parametrize(
    "key, value, sentence",
    [*REJECTED["satellites"], ("satellite.width", None, "^missing key 'mechanism.satellite.width'$")],
)
def test_contradiction_to_satellite_sizes_is_rejected_in_a_sentence(key, value, sentence):
    assert_rejected(sentence, of_sizes(PLANAR).with_keys, {f"mechanism.{key}": value})
