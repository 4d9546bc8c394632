"""A mechanism that cannot be built runs, and both FMUs log the same sentences about it."""

import subprocess
import sys
import zipfile

import pytest
from fmpy.fmi1 import FMICallException

from inertia_module.harness.fmu import Fmu
from inertia_module.harness.loading import messages_of_others
from inertia_module.memory import Module

CASES = {
    "overlap, planar": {"layout": 1, "satellites": 12},
    "overlap, bevel": {"satellites": 6},
    "imbalance, planar": {"layout": 1, "eccentricity": 0.04},
    "imbalance, bevel": {"a": 1.5},
    "both": {"layout": 1, "satellites": 12, "eccentricity": 0.04},
    "none": {},
}


@pytest.mark.parametrize("case", CASES)
def test_warnings_are_logged_once_and_nothing_is_refused(instance, case):
    warnings = []
    with messages_of_others(warnings) as errors:
        instance.start(**CASES[case], omega1=100.0)
        instance.step(0.01)
    assert warnings == Module("plain").start(**CASES[case]).warnings()
    assert bool(warnings) == (case != "none")
    assert errors == []


@pytest.mark.parametrize("case", CASES)
def test_harness_tells_warnings_from_errors(fmu_path, case):
    with Fmu(fmu_path, CASES[case], {"omega1": 100.0}) as fmu:
        fmu.advance(0.01)
        assert fmu.warnings == Module("plain").start(**CASES[case]).warnings()


def test_warnings_come_again_after_a_reset(instance):
    warnings = []
    with messages_of_others(warnings):
        instance.start(satellites=6)
        instance.fmu.reset()
        instance.start(satellites=6)
    assert len(warnings) == 2


def test_a_refused_mechanism_is_not_warned_of(instance):
    warnings = []
    with messages_of_others(warnings) as errors, pytest.raises(FMICallException):
        instance.start(satellites=6, imbalance_mass=-1.0)
    assert warnings == []
    assert len(errors) == 1


def test_check_passes_warnings_on_without_a_problem(built, tmp_path):
    path = tmp_path / "Overlapping.fmu"
    with zipfile.ZipFile(built / "InertiaModulePy.fmu") as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            # the start value is now one that cannot be built
            new.writestr(name, content.replace(b'"satellites", "", 1,', b'"satellites", "", 6,'))
    # in a process of its own: pythonfmu shares the code of FMUs that were loaded before
    command = [sys.executable, "-m", "inertia_module", "check", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (warning,) = Module("plain").start(satellites=6).warnings()
    assert done.stderr == f"warning: {warning}\n"
    assert "no problems found" in done.stdout
