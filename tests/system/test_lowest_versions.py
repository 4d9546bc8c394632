"""Test scenes and studies with the lowest versions that pyproject.toml allows, installed together."""

import os
import re
import subprocess
import sys
import tomllib
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = ("fast", "studies", "notebook")
# A requirement: the name, the operator, the version.
REQUIREMENT = re.compile(r"([\w.-]+)(>=|==)([\d.]+?)(\.\*)?(,<[\d.]+)?$")
LIGHT = ROOT / "tests" / "system" / "light_module.toml"
SHORT = ["--set", "run.stop_time=10 ms", "--workers", "1"]
RIG = [ROOT / "examples" / "fit_rig.csv", ROOT / "examples" / "fit_rig.toml"]
COMMANDS = [
    ["new", "planar"],
    ["run", "planar.toml"],
    ["chart", "planar.toml", "--map"],
    ["orders", ROOT / "examples" / "orders.toml", "--mat"],
    ["sweep", "planar.toml", "--vary", "imbalance_mass=1:2", "--sensitivity", "4", *SHORT],
    ["fit", *RIG, "--free", "imbalance_mass=0.5:2", "--starts", "2"],
    ["design", LIGHT, "--workers", "1"],
]


def lowest(requirement):
    """Return the lowest version that a requirement allows, as a requirement."""
    result = REQUIREMENT.match(requirement)
    assert result, f"{requirement} must have a lower bound"
    return f"{result[1]}=={result[3]}{'.0' if result[4] else ''}"


def test_lowest_version_of_a_requirement():
    assert lowest("numpy>=2.1.3") == "numpy==2.1.3"
    assert lowest("control>=0.10.1,<0.11") == "control==0.10.1"
    assert lowest("pythonfmu==0.7.*") == "pythonfmu==0.7.0"


@pytest.mark.skipif(
    f">={sys.version_info[0]}.{sys.version_info[1]}" != PROJECT["requires-python"],
    reason="the lowest versions are those of the lowest Python",
)
def test_lowest_versions_go_together_and_run_scenes_and_jobs(tmp_path):
    venv.create(tmp_path / "env", with_pip=True)
    python = str(tmp_path / "env" / "bin" / "python")
    names = [
        *PROJECT["dependencies"],
        *(requirement for e in EXTRAS for requirement in PROJECT["optional-dependencies"][e]),
    ]
    install = [python, "-m", "pip", "install", "-q", "--disable-pip-version-check", *map(lowest, names)]
    own = {"PYTHONPATH": str(ROOT / "fmu_src"), "INERTIA_MODULE_CACHE": str(tmp_path / "cache")}
    for command in (
        install,
        *([python, "-m", "inertia_module", *map(str, requirement)] for requirement in COMMANDS),
    ):
        done = subprocess.run(
            command, cwd=tmp_path, env=os.environ | own, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
        assert "Traceback" not in done.stderr
        assert "Warning" not in done.stderr, done.stderr
