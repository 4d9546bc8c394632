"""The HTML file: the template that `make page` leaves, with kernel, tables, scene and maybe a run in it."""

from __future__ import annotations

import base64
import html
import json
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ..common.errors import Refused, must_be
from ..common.files import writable_folder
from ..common.units import BOOLEANS
from ..contract.models import INERTIA_MODULE, Model
from ..contract.variables import BOOLEAN, ENUMERATIONS, INPUT, Variable
from ..fmu.builder import WEB_KERNEL, content_of
from ..harness.results import Result
from ..kernel import codes
from ..loops.closed_loop import PLANT_INPUTS
from ..loops.sources import Table
from ..scene import Scene, SceneResult
from ..scene.run import start_of

TEMPLATE = Path(__file__).parent / "template.html"
# where it takes the presets, which `make page` fills in, and the rest
PRESETS, DATA = "<!-- PRESETS -->", "<!-- DATA -->"
TITLE = "<title>Inertia module</title>"
OPERATIONS = ("START", "STEP", "WARN")
# of the table of variables that the page has as they are
SAME = ("name", "group", "kind", "causality", "unit", "description", "start", "allowed", "nominal")
COLUMNS = {**{name: name for name in SAME}, "tunable": "is_tunable", "min": "minimum", "max": "maximum"}
# numbers of a run in a page at most: not compressed at all they take 1.5 MB of it
MOST = 280_000
# what a row stands for that has those before it in it, by the ending of the name
OVER_ROWS: dict[str, Callable[..., Any]] = {"_mean": np.mean, "_peak": np.max}


def template() -> str:
    """Return the viewer without data; raise Refused if it has not been built."""
    try:
        return TEMPLATE.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise Refused(
            "the viewer has not been built. Run `make page` in a clone, or install the wheel."
        ) from None


def checked_path(path: Path, what: str) -> Path:
    """Return the path of an HTML file; raise Refused if it cannot be written."""
    if path.suffix.lower() != ".html":
        raise Refused(must_be(what, "a file with the ending .html", str(path)))
    if path.is_dir():
        raise Refused(must_be(what, "a file", f"the folder {path}"))
    writable_folder(path.parent)
    return path


def html_file(scene: Scene, outcome: SceneResult | None) -> bytes:
    """The HTML file of a scene.

    Args:
        scene: whose fidelity is chosen.
        outcome: its run with all of variables.COMPUTED, or None where the page is to integrate.
    """
    record, run = None, None
    if outcome is not None:
        record, run = outcome.record, page_run(outcome.record, outcome.warnings)
    start = {"scene": page_scene(scene, record), "run": run}
    data = [
        f'<script id="kernel" type="text/plain">{_packed(content_of(WEB_KERNEL))}</script>',
        script("tables", page_tables(INERTIA_MODULE)),
        script("start", start),
    ]
    title = f"<title>{html.escape(scene.title)}</title>"
    return template().replace(TITLE, title, 1).replace(DATA, "\n".join(data), 1).encode()


def script(name: str, content: Any) -> str:
    """Data for the page to parse; nothing in it ends the element."""
    text = json.dumps(content, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    return f'<script id="{name}" type="application/json">{text}</script>'


def _packed(content: bytes) -> str:
    """Bytes as text: compressed (raw deflate), base64."""
    return base64.b64encode(zlib.compress(content, 9, -zlib.MAX_WBITS)).decode()


# --- tables of a model ---


def page_tables(model: Model) -> dict[str, Any]:
    """Tables of a model for the page (the interface Tables of page/src/kernel/tables.ts), ready for JSON."""
    return {
        "symbol": model.symbol,
        "sizes": list(model.sizes),
        "operations": {name: getattr(codes, name) for name in OPERATIONS},
        "ok": codes.OK,
        "variables": [_variable(variable, model) for variable in model.variables],
        "messages": dict(model.messages),
        "warnings": dict(model.warnings),
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
        "rateGivenPlace": model.place(f"{variable.name}_rate_given") if is_input else -1,
    }


# --- a scene as a page starts with it ---


def page_scene(scene: Scene, record: Result | None = None) -> dict[str, Any]:
    """A scene for the page (the interface Scene of page/src/run/start.ts), ready for JSON.

    Args:
        scene: whose fidelity is chosen. record: a run of it. An input that follows from what the module does
            becomes constant: its mean over the run to four digits, without a run its value at the start.
    """
    parameters, inputs = start_of(scene)
    if record is not None:
        inputs |= {name: float(f"{record[name].mean():.4g}") for name in PLANT_INPUTS if name in record}
    signals = inputs | scene.prescribed
    return {
        "name": "scene",
        "title": scene.title,
        "description": scene.description.strip(),
        "parameters": parameters,
        # numbers, or points of straight lines (the type Input of page/src/run/signals.ts)
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
    """Tell whether the inputs follow from nothing that the module does: the page can run the scene itself."""
    return not scene.surroundings.input_labels


# --- a recorded run ---


def page_run(record: Result, warnings: tuple[str, ...] = ()) -> dict[str, Any]:
    """A run for the page (the interface Recorded of page/src/run/recorded.ts), ready for JSON.

    Packed: single precision, compressed, every so many rows if it is long.

    Args:
        record: with all of variables.COMPUTED, at equal steps of time. warnings: of the FMU.
    """
    names = [name for name in record.names if name != "time"]
    stride = -(-len(record) * len(names) // MOST)
    columns = []
    for name in names:
        # one row of so many: of means over a step the mean, of peaks the greatest since the row before
        values = record[name]
        columns.append(values[::stride].copy())
        over = next((over for ending, over in OVER_ROWS.items() if name.endswith(ending)), None)
        if over is not None:
            last = 1 + stride * (columns[-1].size - 1)
            columns[-1][1:] = over(values[1:last].reshape(-1, stride), axis=1)
    return {
        "names": names,
        "units": record.units,
        "step": float(record.time[1] - record.time[0]) * stride,
        "rows": columns[0].size,
        "every": stride,
        "numbers": _packed(np.stack(columns).astype("<f4").tobytes()),
        "warnings": list(warnings),
    }
