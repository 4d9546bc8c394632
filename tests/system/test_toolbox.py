"""The FMU Manipulation Toolbox, another's: its checker, and its container, a host of FMI 2.0 and 3.0."""

import json
import subprocess
import sys

import fmpy
import pytest

from inertia_module.fmu.builder import FMUS
from inertia_module.harness.system import Node, WiredFmus
from inertia_module.harness.wires import Wire

pytest.importorskip(
    "fmu_manipulation_toolbox", reason="not installed; comes with the extra inertia-module[hosts]"
)
STEP, STEPS = 1e-3, 200


def tool(name, *arguments, folder):
    """What one of the tools says."""
    command = [sys.executable, "-m", f"fmu_manipulation_toolbox.cli.{name}", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", cwd=folder, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.mark.parametrize("fmu", FMUS, ids=lambda fmu: fmu.identifier)
def test_checker_has_nothing_to_say(fmu, built, tmp_path):
    said = tool("fmutool", "-input", built / fmu.file_name, "-check", folder=tmp_path)
    assert "seems to be compliant with FMI-" in said
    assert "No semantic error" in said
    assert not [line for line in said.splitlines() if line.startswith(("WARNING", "ERROR", "CRITICAL"))]


@pytest.mark.parametrize(
    "fmi, module, shaft",
    [
        (2, "InertiaModule", "DrivenShaft"),
        (3, "InertiaModule3", "DrivenShaft3"),
        (3, "InertiaModule", "DrivenShaft3"),
    ],
)
def test_container_gives_the_bits_of_module_and_shaft_side_by_side(built, tmp_path, fmi, module, shaft):
    paths = {"module": built / f"{module}.fmu", "shaft": built / f"{shaft}.fmu"}
    names = {model: path.name for model, path in paths.items()}
    seam = (
        ("module", "omega_out", "shaft", "hub_speed"),
        ("shaft", "shaft_torque_mean", "module", "load_torque"),
    )
    container = {
        "name": "container.fmu",
        "fmu": list(names.values()),
        "link": [[names[a], output, names[b], given] for a, output, b, given in seam],
        "input": [["omega1", names["module"], "omega1"], ["load", names["shaft"], "load_torque"]],
        "output": [[names["module"], "omega_out", "hub"], [names["shaft"], "omega_out", "driven"]],
        "start": [[names["module"], "output_inertia", 0.02]],
        "step_size": STEP,
        **dict.fromkeys(("auto_link", "auto_input", "auto_output"), False),
    }
    (tmp_path / "container.json").write_text(json.dumps(container))
    for path in paths.values():
        (tmp_path / path.name).symlink_to(path)
    tool("fmucontainer", "-container", "container.json", "-fmu-directory", ".", "-fmi", fmi, folder=tmp_path)
    found = fmpy.simulate_fmu(
        str(tmp_path / "container.fmu"),
        stop_time=STEP * STEPS,
        output_interval=STEP,
        start_values={"omega1": 100.0, "load": 10.0},
        output=["hub", "driven"],
    )[-1]
    nodes = {
        "module": Node(paths["module"], {"output_inertia": 0.02}, {"omega1": 100.0}),
        "shaft": Node(paths["shaft"], {}, {"load_torque": 10.0}),
    }
    with WiredFmus(nodes, [Wire(*wire) for wire in seam], STEP) as system:
        for _ in range(STEPS):
            system.advance()
        expected = [system.fmus[name]["omega_out"] for name in names]
    assert [found["hub"], found["driven"]] == expected
