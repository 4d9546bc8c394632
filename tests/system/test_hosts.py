"""The native FMUs in other hosts than FMPy: libcosim, Ecos, and the container that comes with FMPy.

libcosim and Ecos know no enumerations and leave such variables out; where a scene sets one, they are given a
copy of the FMU in which it is described as an Integer.
"""

import numpy as np
import pytest
from hosts import ACCUMULATED, FMPY, HOSTS, NANOSECONDS, HostFailed, Scene, run

from inertia_module.contract.models import INERTIA_MODULE
from inertia_module.contract.variables import ENUMERATION
from inertia_module.export.integers import with_integers
from inertia_module.fmu.builder import MODULE_FMU, SHAFT_FMU, build

MODULE, SHAFT = MODULE_FMU.identifier, SHAFT_FMU.identifier
R1 = {"omega1": 100.0, "load_torque": 10.0}
PLANAR = {
    "layout": 1,
    "sun_radius": 0.05,
    "satellite_radius": 0.03,
    "eccentricity": 0.02,
    "imbalance_mass": 0.8,
    "satellites": 3,
    "link2_inertia": 0.003,
    "output_inertia": 0.4,
    "omega1": 120.0,
    "load_torque": 8.0,
}
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
def folders(tmp_path_factory):
    """Folders with the FMUs: as built, and with integers for enumerations."""
    built, changed = tmp_path_factory.mktemp("built"), tmp_path_factory.mktemp("changed")
    skipped = build(built).skipped
    for name in (MODULE_FMU.file_name, SHAFT_FMU.file_name):
        if name in skipped:
            pytest.skip(skipped[name])
        (changed / name).write_bytes(with_integers((built / name).read_bytes()))
    return {True: built, False: changed}


@pytest.fixture(params=HOSTS)
def host(request):
    missing = HOSTS[request.param].missing
    if missing:
        pytest.skip(
            f"not installed: {', '.join(missing)}; comes with the extra inertia-module[hosts]"
            " where there are packages for the platform"
        )
    return request.param


@pytest.fixture(scope="module")
def reference(folders, tmp_path_factory):
    """Runs a scene over FMPy by a clock, once."""
    known = {}

    def run_once(name, clock):
        if (name, clock) not in known:
            work = tmp_path_factory.mktemp("fmpy") / "run"
            known[name, clock] = run(FMPY, SCENES[name], folders[True], work, clock)
        return known[name, clock]

    return run_once


def in_host(host, scene, folders, work):
    plain = not any(ENUMERATIONS & set(values) for values in scene.models.values())
    return run(host, scene, folders[plain or HOSTS[host].enumerations], work)


@pytest.mark.parametrize("name", SCENES)
def test_host_gives_the_bits_of_fmpy_by_the_same_clock(host, name, folders, reference, tmp_path):
    found = in_host(host, SCENES[name], folders, tmp_path / "run")
    expected = reference(name, HOSTS[host].clock)
    assert found.keys() == expected.keys()
    for output, values in expected.items():
        assert np.array_equal(found[output], values), output


@pytest.mark.parametrize("name", SCENES)
def test_the_clocks_of_the_hosts_make_no_difference(name, reference):
    one, other = reference(name, ACCUMULATED), reference(name, NANOSECONDS)
    for output, values in one.items():
        assert np.abs(other[output] - values).max() <= 1e-9 * np.abs(values).max(), output


def test_instances_in_one_host_do_not_know_of_each_other(host, folders, reference, tmp_path):
    found = in_host(host, SCENES["three at once"], folders, tmp_path / "run")
    alone = reference("R1", HOSTS[host].clock)
    for output in ("omega2", "omega_out", "input_torque_mean", "imbalance_acceleration"):
        first, second, third = (found[f"{MODULE}{number}.{output}"] for number in ("", "_2", "_3"))
        assert np.array_equal(first, alone[f"{MODULE}.{output}"][: len(first)])
        assert np.array_equal(first, third)
        assert not np.array_equal(first, second)


@pytest.mark.parametrize("values", [{"wheel_radius": -1.0}, {"omega1": 1e9}])
def test_refusal_ends_the_run_and_says_why(host, values, folders, tmp_path):
    scene = Scene({MODULE: R1 | values}, 0.01, 3)
    if not HOSTS[host].minds_errors:
        run(host, scene, folders[True], tmp_path / "run")  # goes on without results, and survives that
        return
    with pytest.raises(HostFailed, match=f"{next(iter(values))} = -?10* is refused: allowed is from"):
        run(host, scene, folders[True], tmp_path / "run")
