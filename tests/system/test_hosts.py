"""The native FMUs in other hosts than FMPy: libcosim and Ecos. FMPy's container is tried in test_export.

libcosim and Ecos know no enumerations and leave such variables out; where a scene sets one, they are given a
copy of the FMU in which it is described as an Integer.
"""

import numpy as np
import pytest
from hosts import HOSTS, HostFailed, Scene, looped, run
from scenes import PLANAR

from inertia_module.contract.models import INERTIA_MODULE
from inertia_module.contract.variables import ENUMERATION
from inertia_module.export.systems import with_integers
from inertia_module.fmu.builder import MODULE_FMU, SHAFT_FMU

MODULE, SHAFT = MODULE_FMU.identifier, SHAFT_FMU.identifier
R1 = {"omega1": 100.0, "load_torque": 10.0}
HUB = {"output_inertia": 0.02}
DRIVEN = {"driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
SEAM = (
    (MODULE, "omega_out", SHAFT, "hub_speed"),
    (SHAFT, "shaft_torque_mean", MODULE, "load_torque"),
)
SCENES = {
    "R1": Scene({MODULE: R1}, 0.01, 100),
    "R1 in fine steps": Scene({MODULE: R1}, 0.001, 1000),
    "planar": Scene({MODULE: PLANAR}, 0.01, 100),
    "elastic": Scene({MODULE: R1 | HUB | DRIVEN | {"fidelity": 3}}, 0.01, 100),
    "no housing freewheel": Scene({MODULE: R1 | {"housing_freewheel": False}}, 0.01, 50),
    "inputs that change": Scene(
        {MODULE: R1 | {"input_hold": 1}},
        0.01,
        50,
        changes={7: {MODULE: {"omega1": 104.0}}, 30: {MODULE: {"load_torque": -3.0, "omega1": 90.0}}},
    ),
    "driven by torque": Scene(
        {MODULE: R1 | {"drive": 1, "input_inertia": 0.2, "drive_torque": 15.0}},
        0.01,
        50,
        changes={
            7: {MODULE: {"drive_torque": 40.0}},
            30: {MODULE: {"load_torque": -3.0, "drive_torque": -9.0}},
        },
    ),
    "driven shaft": Scene({SHAFT: DRIVEN | {"hub_speed": 20.0, "load_torque": 3.0}}, 0.01, 100),
    "module and shaft": Scene(
        {MODULE: HUB | {"omega1": 100.0}, SHAFT: DRIVEN | {"load_torque": 10.0}}, 0.001, 300, SEAM
    ),
    "three at once": Scene({MODULE: R1, f"{MODULE}_2": R1 | {"omega1": 70.0}, f"{MODULE}_3": R1}, 0.01, 50),
}
ENUMERATIONS = {variable.name for variable in INERTIA_MODULE.variables if variable.kind == ENUMERATION}


@pytest.fixture(scope="module")
def folders(built, tmp_path_factory):
    """Folders with the FMUs: with enumerations as built, and with integers for them."""
    changed = tmp_path_factory.mktemp("changed")
    for name in (MODULE_FMU.file_name, SHAFT_FMU.file_name):
        (changed / name).write_bytes(with_integers((built / name).read_bytes()))
    return {"built": built, "changed": changed}


@pytest.fixture(scope="module", params=HOSTS)
def host(request):
    missing = HOSTS[request.param].missing
    if missing:
        pytest.skip(
            f"not installed: {', '.join(missing)}; comes with the extra inertia-module[hosts]"
            " where there are packages for the platform"
        )
    return request.param


@pytest.fixture(scope="module")
def reference(folders):
    """Outputs of all scenes in this process."""
    return {name: looped(scene, folders["built"]) for name, scene in SCENES.items()}


@pytest.fixture(scope="module")
def found(host, folders, tmp_path_factory):
    """Outputs of all scenes in a host."""

    scenes = {}
    for name, scene in SCENES.items():
        sets_one = any(ENUMERATIONS & set(values) for values in scene.models.values())
        scenes[name] = (scene, folders["changed" if sets_one else "built"])
    return run(host, scenes, tmp_path_factory.mktemp(host))


@pytest.mark.parametrize("name", SCENES)
def test_host_gives_what_the_fmus_side_by_side_give(name, found, reference):
    assert found[name].keys() == reference[name].keys()
    for output, values in reference[name].items():
        # hosts count time in their own ways, in the last digits: on them hangs which moments a peak sees, and
        # forces on the mount that cancel are rounding of the kilonewtons that make them
        bound = 1e-3 if "satellite_force_peak" in output else 1e-9
        size = max(np.abs(values).max(), 1.0 if "shaking" in output else 0.0)
        assert np.abs(found[name][output] - values).max() <= bound * size, output


def test_instances_in_one_host_do_not_know_of_each_other(found):
    alone = found["R1"]
    for output in ("omega2", "omega_out", "input_torque_mean", "imbalance_acceleration"):
        first, second, third = (
            found["three at once"][f"{MODULE}{number}.{output}"] for number in ("", "_2", "_3")
        )
        assert np.array_equal(first, alone[f"{MODULE}.{output}"][: len(first)])
        assert np.array_equal(first, third)
        assert not np.array_equal(first, second)


@pytest.mark.parametrize("values", [{"wheel_radius": -1.0}, {"omega1": 1e9}])
def test_refusal_ends_the_run_and_says_why(host, values, folders, tmp_path):
    scenes = {"bad": (Scene({MODULE: R1 | values}, 0.01, 3), folders["built"])}
    if not HOSTS[host].minds_errors:
        run(host, scenes, tmp_path)  # goes on without results, and survives that
        return
    with pytest.raises(HostFailed, match=f"{next(iter(values))} must be between .*, is -?10*"):
        run(host, scenes, tmp_path)
