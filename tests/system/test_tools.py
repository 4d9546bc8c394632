"""The programs of docs/tools.md: one second of the module in each host that is installed."""

import re
import shutil

import pytest
from fmpy import simulate_fmu

from tests.system.programs import needs, printed, programs

PROGRAMS = programs("tools.md")
PACKAGES = [re.search(r"^from (\w+)", program)[1] for program in PROGRAMS]
# tolerance that a host gives where the parameter has another
TOLERANCE = {"OMSimulator": 1e-4}


def test_every_host_of_the_page_has_a_program():
    assert sorted(PACKAGES) == ["OMSimulator", "ecospy", "fmpy", "fmpy", "libcosimpy"]


@pytest.mark.parametrize("number", range(len(PROGRAMS)), ids=PACKAGES)
def test_program_of_the_page_runs_the_module(number, built, tmp_path):
    package = PACKAGES[number]
    needs(package)
    for name in ("InertiaModule.fmu", "InertiaModule3.fmu"):
        shutil.copy(built / name, tmp_path)
    expected = simulate_fmu(
        str(built / "InertiaModule.fmu"),
        stop_time=1.0,
        output_interval=1e-3,
        relative_tolerance=TOLERANCE.get(package),
        start_values={"output_inertia": 0.4},
        output=["omega_out"],
    )
    found = printed(PROGRAMS[number], tmp_path)
    # stopped at its switches a step integrates otherwise
    within = 1e-7 if "use_event_mode" in PROGRAMS[number] else 1e-9
    assert found == pytest.approx(expected["omega_out"][-1], rel=within)


def test_fmpy_gives_the_tolerance_that_the_fmu_proposes(built):
    def ended(parameter, **given):
        values = {"output_inertia": 0.4, "tolerance": parameter}
        path, steps = str(built / "InertiaModule.fmu"), {"stop_time": 0.1, "output_interval": 1e-3}
        return simulate_fmu(path, start_values=values, output=["omega_out"], **steps, **given)["omega_out"][
            -1
        ]

    assert ended(1e-6) == ended(1e-2) == ended(1e-2, relative_tolerance=1e-6)
    assert ended(1e-6) != ended(1e-6, relative_tolerance=1e-2)
