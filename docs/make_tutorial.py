"""Run examples/tutorial.ipynb and store its outputs; the site shows the notebook as its tutorial.

`--clean` only removes what changes with every run.
"""

import base64
import io
import os
import re
import sys
import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from PIL import Image

ROOT = Path(__file__).parents[1]
NOTEBOOK = ROOT / "examples" / "tutorial.ipynb"
COLOURS = 64
EMBEDDED = re.compile(r'(?<=src="data:image/png;base64,)[^"]+')


def run(notebook):
    """Run all cells in an empty folder with the package of this clone."""
    os.environ["PYTHONPATH"] = os.pathsep.join((str(ROOT / "fmu_src"), os.environ.get("PYTHONPATH", "")))
    with tempfile.TemporaryDirectory() as folder:
        settings = {"metadata": {"path": folder}}
        NotebookClient(notebook, timeout=300, kernel_name="python3", resources=settings).execute()


def smaller(encoded):
    """Reduce the colours of a PNG image in base64: a third of the size."""
    picture = Image.open(io.BytesIO(base64.b64decode(encoded)))
    file = io.BytesIO()
    picture.convert("RGB").quantize(COLOURS).save(file, "PNG", optimize=True)
    return base64.b64encode(file.getvalue()).decode()


def clean_output(output):
    """Remove duplicate forms of an output and reduce its images."""
    output.get("metadata", {}).clear()
    data = output.get("data", {})
    if "text/html" in data:
        data["text/html"] = EMBEDDED.sub(lambda match: smaller(match[0]), data["text/html"])
        data.pop("image/png", None)
    if "image/png" in data:
        data["image/png"] = smaller(data["image/png"])
    if len(data) > 1:
        data.pop("text/plain", None)


def clean(notebook):
    """Remove times of the run and progress output; reduce the images."""
    notebook.metadata.pop("language_info", None)
    for cell in notebook.cells:
        cell.metadata.clear()
        if cell.cell_type == "code":
            cell.outputs = [output for output in cell.outputs if output.get("name") != "stderr"]
            for output in cell.outputs:
                clean_output(output)


def main():
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    if "--clean" not in sys.argv:
        run(notebook)
    clean(notebook)
    nbformat.write(notebook, NOTEBOOK)


if __name__ == "__main__":
    main()
