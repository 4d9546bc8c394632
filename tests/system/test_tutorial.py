"""The tutorial runs as a reader runs it, and says what it promises."""

import re
from pathlib import Path

import pytest

NOTEBOOK = Path(__file__).parents[2] / "examples" / "tutorial.ipynb"


def test_tutorial_shows_pictures_and_tables(built, tmp_path):
    nbformat = pytest.importorskip("nbformat", reason="nbformat is not installed")
    client = pytest.importorskip("nbclient", reason="nbclient is not installed")
    pytest.importorskip("pymoo", reason="pymoo is not installed")
    (tmp_path / "build").symlink_to(built, target_is_directory=True)
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells), "it is kept without outputs"
    client.NotebookClient(
        notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}
    ).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    shown = [output["data"] for output in outputs if "data" in output]
    assert sum("image/png" in data for data in shown) >= 5
    assert "<table>" in shown[0]["text/html"]
    assert "omega_out [rad/s]" in shown[1]["text/html"]
    # it launches the car and finds the values of the rig
    text = "".join(output.get("text", "") for output in outputs)
    light, heavy = (float(speed) for speed in re.findall(r"kg: ([\d.]+) rad/s", text))
    assert heavy > light
    assert float(re.search(r"25 km/h after ([\d.]+) s", text)[1]) < 20.0
    low, high = (float(n) for n in re.search(r"imbalance_mass = \S+ from (\S+) to (\S+)", text).groups())
    assert low < 1.07 < high
