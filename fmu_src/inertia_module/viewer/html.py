"""HTML file of the viewer: the template of `make page` with kernel, tables, scene and an optional run."""

from __future__ import annotations

import base64
import html
import json
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ..common.errors import ParameterError, must_be
from ..common.files import writable_folder
from ..common.units import BOOLEANS, factor_between, units_like
from ..driveline.closed_loop import PLANT_INPUTS
from ..driveline.sources import Table
from ..fmi.results import Result
from ..fmu.builder import WEB_KERNEL, content_of
from ..interface.models import INERTIA_MODULE, Model
from ..interface.variables import BOOLEAN, ENUMERATIONS, INPUT, Variable
from ..kernel import codes
from ..scene import Scene, SceneResult
from ..scene.run import initial_values

TEMPLATE = Path(__file__).parent / "template.html"
# places in the template for the presets, which `make page` inserts, and for the data
PRESETS, DATA = "<!-- PRESETS -->", "<!-- DATA -->"
TITLE = "<title>Inertia module</title>"
OPERATIONS = ("START", "STEP", "WARN")
# fields of variables with the same name in the viewer
SAME_NAMES = ("name", "group", "kind", "causality", "unit", "description", "start", "allowed", "nominal")
COLUMNS = {**{name: name for name in SAME_NAMES}, "tunable": "is_tunable", "min": "minimum", "max": "maximum"}
# maximum count of numbers of a run in a file; uncompressed they need 1.5 MB
MAX_NUMBERS = 280_000
# function that combines the skipped rows with the next written row, by the ending of the name
ROW_REDUCTIONS: dict[str, Callable[..., Any]] = {"_mean": np.mean, "_peak": np.max}


def template() -> str:
    """Return the viewer without data.

    Raises:
        ParameterError: The viewer has not been built.
    """
    try:
        return TEMPLATE.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ParameterError(
            "the viewer has not been built. Run `make page` in a clone, or install the wheel."
        ) from None


def checked_path(path: Path, name: str) -> Path:
    """Check that an HTML file can be written, and return its path.

    Args:
        path: Path of the file.
        name: Name of the path in messages.

    Raises:
        ParameterError: The ending is not .html, the path is a folder, or the folder is not writable.
    """
    if path.suffix.lower() != ".html":
        raise ParameterError(must_be(name, "a file with the ending .html", str(path)))
    if path.is_dir():
        raise ParameterError(must_be(name, "a file", f"the folder {path}"))
    writable_folder(path.parent)
    return path


def html_file(scene: Scene, outcome: SceneResult | None) -> bytes:
    """Return the HTML file of a scene.

    Args:
        scene: Scene with a named fidelity.
        outcome: Result of its run with all variables in variables.COMPUTED; None if the viewer integrates.

    Raises:
        ParameterError: The viewer has not been built.
    """
    record, run = None, None
    if outcome is not None:
        record, run = outcome, page_run(outcome, outcome.warnings)
    start = {"scene": page_scene(scene, record), "run": run}
    data = [
        f'<script id="kernel" type="text/plain">{_pack(content_of(WEB_KERNEL))}</script>',
        script("tables", page_tables(INERTIA_MODULE)),
        script("start", start),
    ]
    title = f"<title>{html.escape(scene.title)}</title>"
    return template().replace(TITLE, title, 1).replace(DATA, "\n".join(data), 1).encode()


def script(name: str, content: Any) -> str:
    """Return an HTML element with JSON data; escapes keep the data from ending the element.

    Args:
        name: Identifier of the element.
        content: Data, ready for JSON.
    """
    text = json.dumps(content, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    return f'<script id="{name}" type="application/json">{text}</script>'


def _pack(content: bytes) -> str:
    """Return bytes as text: compressed (raw deflate), base64."""
    return base64.b64encode(zlib.compress(content, 9, -zlib.MAX_WBITS)).decode()


# --- tables of a model ---


def page_tables(model: Model) -> dict[str, Any]:
    """Return the tables of a model, ready for JSON (type Tables in viewer/src/kernel/tables.ts).

    Args:
        model: The model.
    """
    return {
        "symbol": model.symbol,
        "sizes": list(model.sizes),
        "operations": {name: getattr(codes, name) for name in OPERATIONS},
        "ok": codes.OK,
        "variables": [_variable(variable, model) for variable in model.variables],
        "messages": dict(model.messages),
        "warnings": dict(model.warnings),
        "units": _units({variable.unit for variable in model.variables} | {"s"}),
    }


def _units(of: set[str]) -> dict[str, dict[str, float]]:
    """Return the factor from each unit of the same kind, by unit.

    Args:
        of: Units of the variables; "" and "1" are left out.
    """
    return {
        unit: {name: factor_between(name, unit) for name in units_like(unit)}
        for unit in sorted(of - {"", "1"})
    }


def _variable(variable: Variable, model: Model) -> dict[str, Any]:
    is_input = variable.causality == INPUT
    items = ENUMERATIONS.get(variable.enumeration, ())
    if variable.kind == BOOLEAN:
        items = tuple((name, int(number), "") for name, number in BOOLEANS.items())
    return {
        **{name: getattr(variable, field) for name, field in COLUMNS.items()},
        "items": [{"name": name, "number": number, "description": text} for name, number, text in items],
        "place": model.place(variable.name),
        "ratePlace": model.place(f"{variable.name}_rate") if is_input else -1,
        "rateGivenPlace": model.place(f"{variable.name}_has_rate") if is_input else -1,
    }


# --- initial scene of the viewer ---


def page_scene(scene: Scene, record: Result | None = None) -> dict[str, Any]:
    """Return a scene for the viewer, ready for JSON (type Scene in viewer/src/run/start.ts).

    An input that depends on the module becomes constant: its mean over the run with four digits, or its
    initial value without a run.

    Args:
        scene: Scene with a named fidelity.
        record: Record of a run, or None.
    """
    parameters, inputs = initial_values(scene)
    if record is not None:
        inputs |= {name: float(f"{record[name].mean():.4g}") for name in PLANT_INPUTS if name in record}
    signals = inputs | scene.prescribed
    return {
        "name": "scene",
        "title": scene.title,
        "description": scene.description.strip(),
        "parameters": parameters,
        # Inputs are constants or piecewise linear signals (type Input in viewer/src/run/signals.ts).
        "inputs": {
            name: {"times": signal.points.tolist(), "values": signal.values.tolist()}
            if isinstance(signal, Table)
            else float(signal)
            for name, signal in signals.items()
        },
        "step": scene.run.communication_step,
        "duration": scene.run.stop_time,
        "outputs": scene.run.outputs,
        "exact": is_exact(scene),
    }


def is_exact(scene: Scene) -> bool:
    """Return True if no input depends on the module, so that the viewer itself can run the scene.

    Args:
        scene: The scene.
    """
    return not scene.surroundings.input_labels


# --- a recorded run ---


def page_run(record: Result, warnings: tuple[str, ...] = ()) -> dict[str, Any]:
    """Return a run for the viewer, ready for JSON (type Recorded in viewer/src/run/recorded.ts).

    Numbers have single precision and are compressed. A long run is reduced to every n-th row.

    Args:
        record: Record with all variables in variables.COMPUTED, at equal time steps.
        warnings: Warnings of the FMU.
    """
    names = [name for name in record.names if name != "time"]
    stride = -(-len(record) * len(names) // MAX_NUMBERS)
    columns = []
    for name in names:
        # A step mean is averaged, and a peak maximised, over the rows since the previous written row.
        values = record[name]
        columns.append(values[::stride].copy())
        combine = next(
            (function for ending, function in ROW_REDUCTIONS.items() if name.endswith(ending)), None
        )
        if combine is not None:
            last = 1 + stride * (columns[-1].size - 1)
            columns[-1][1:] = combine(values[1:last].reshape(-1, stride), axis=1)
    return {
        "names": names,
        "units": record.units,
        "step": float(record.time[1] - record.time[0]) * stride,
        "rows": columns[0].size,
        "every": stride,
        "numbers": _pack(np.stack(columns).astype("<f4").tobytes()),
        "warnings": list(warnings),
    }
