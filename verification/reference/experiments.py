"""Reference results in the FMUs (FMI-LS-REF, fmu/references), computed without the kernel.

The results of the module come from the independent reference. SciPy integrates the two equations of the
driven shaft.
"""

from __future__ import annotations

import itertools
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from inertia_module.common.files import PACKAGE_FOLDER
from inertia_module.export.systems import TEMPLATES as SSP
from inertia_module.export.systems import type_and_value
from inertia_module.fmu.archive import render, render_xml
from inertia_module.interface.models import DRIVEN_SHAFT, Model
from inertia_module.interface.variables import INPUT, UNITS

from .cases import CAUSES, OMEGA1, OMEGA2, OMEGA3, OMEGA4
from .geometry import Array
from .motion import TOLERANCE, Reference

HERE = Path(__file__).parent
# folder of FMI-LS-REF in an FMU
LS_REF_FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
STEP, STOP = 0.01, 1.0
TIMES = np.linspace(0.0, STOP, round(STOP / STEP) + 1)
# tolerance of the experiments, and allowed deviation of a result, relative to its maximum
EXPERIMENT_TOLERANCE, MAX_DEVIATION = 1e-6, 1e-4
ORIGIN = "Speeds and step means from {}, integrated by DOP853 of SciPy at 1e-13, independently of this FMU"
SPEEDS = {"input_speed": OMEGA1, "omega2": OMEGA2, "omega_hub": OMEGA3, "omega_out": OMEGA4}
EQUATIONS = {
    "InertiaModule": "separate equations of motion (virtual work on a geometry of rotation matrices)",
    "DrivenShaft": "the two equations of motion of spring and mass",
}
IMPULSES = {"input_torque_mean": "M1", "output_torque_mean": "Tc"}


class Experiment(NamedTuple):
    """A row of experiments.toml.

    Attributes:
        name: name.
        description: one sentence.
        inputs: inputs by name, each a value or the first and the last value of a ramp.
        outputs: names of the compared outputs.
        parameters: parameters that differ from the defaults, by name.
    """

    name: str
    description: str
    inputs: Mapping[str, float | Sequence[float]]
    outputs: tuple[str, ...]
    parameters: Mapping[str, float] = {}

    def input(self, name: str) -> Array:
        """Return an input at TIMES, linear between its ends; 0 if the row does not contain it.

        Args:
            name: name of the input.
        """
        ends = np.broadcast_to(np.asarray(self.inputs.get(name, 0.0), dtype=float), 2)
        return np.asarray(np.interp(TIMES, (0.0, STOP), ends))


def package_folder(model: Model) -> Path:
    """Return the folder in the package with the reference results of a model, arranged as in its FMUs.

    Args:
        model: a model.
    """
    return PACKAGE_FOLDER / "fmu" / "references" / model.name


def experiments(model: Model) -> list[Experiment]:
    """Return the experiments of a model.

    Args:
        model: a model.
    """
    return [Experiment(**row) for row in tomllib.loads((HERE / "experiments.toml").read_text())[model.name]]


def _module(experiment: Experiment) -> list[dict[str, float]]:
    """Return the results of the module at TIMES.

    Args:
        experiment: an experiment.
    """
    drive, load = experiment.input("drive_torque"), experiment.input("load_torque")
    exact = Reference(experiment.parameters, experiment.input("omega1")[0], load[0], drive[0])
    rows, before = list[dict[str, float]](), exact.integrals()
    for n, time in enumerate(TIMES):
        if n:
            exact.set_torques(drive[n - 1], load[n - 1])
            exact.advance(time)
        sums = exact.integrals()
        means = {name: (sums[place] - before[place]) / STEP for name, place in IMPULSES.items()}
        lost = sum(sums[cause] for cause in CAUSES)
        speeds = {name: float(exact.state[place]) for name, place in SPEEDS.items()}
        rows.append(speeds | means | {"energy_lost": lost})
        before = sums
    return rows


def _shaft(experiment: Experiment) -> list[dict[str, float]]:
    """Return the results of the driven shaft at TIMES: J omega' = c twist + d (hub - omega) - f omega - load.

    Args:
        experiment: an experiment.
    """
    p = {v.name: v.start or 0.0 for v in DRIVEN_SHAFT.variables} | {**experiment.parameters}
    hub, load = experiment.input("hub_speed"), experiment.input("load_torque")
    state = np.array([p["twist_start"], p["omega_out_start"], 0.0])
    rows = [{"twist": state[0], "omega_out": state[1], "shaft_torque_mean": 0.0}]

    def rates(_: float, y: Array, hub: float, load: float) -> list[float]:
        slip = hub - y[1]
        torque = p["shaft_stiffness"] * y[0] + p["shaft_damping"] * slip
        return [slip, (torque - p["driven_friction"] * y[1] - load) / p["driven_inertia"], torque]

    settings = {"method": "DOP853", "rtol": TOLERANCE, "atol": TOLERANCE}
    for inputs in itertools.islice(zip(hub, load, strict=True), TIMES.size - 1):
        state = solve_ivp(rates, (0.0, STEP), [*state[:2], 0.0], args=inputs, **settings).y[:, -1]
        rows.append({"twist": state[0], "omega_out": state[1], "shaft_torque_mean": state[2] / STEP})
    return rows


def _csv(names: Sequence[str], columns: Sequence[Array]) -> bytes:
    """Return a CSV table with nine digits and names in quotation marks, as FMI tools expect it.

    Args:
        names: names of the columns without the time.
        columns: columns, with the time first.
    """
    rows = (",".join(f"{value:.9g}" for value in row) for row in np.transpose(columns))
    return "\n".join([",".join(f'"{name}"' for name in ("time", *names)), *rows, ""]).encode()


def _parameters(experiment: Experiment, model: Model) -> bytes:
    """Return the parameter set of an experiment as SSV.

    Args:
        experiment: an experiment.
        model: its model.
    """
    units = {model.by_name[name].unit for name in experiment.parameters} - {""}
    part = SimpleNamespace(values=experiment.parameters, variable=model.by_name.__getitem__)
    values = {
        "part": part,
        "origin": {},
        "type_and_value": type_and_value,
        "units": {name: UNITS[name] for name in sorted(units)},
    }
    return render_xml(SSP / "ParameterSet.ssv", values)


def files(model: Model) -> dict[str, bytes]:
    """Compute the files of FMI-LS-REF of a model; return them by their path in an FMU.

    Args:
        model: a model.
    """
    rows = experiments(model)
    inputs = [variable.name for variable in model.with_causality(INPUT)]
    tables, allowed = dict[str, bytes](), dict[str, dict[str, str]]()
    for experiment in rows:
        results = (_shaft if model is DRIVEN_SHAFT else _module)(experiment)
        columns = {name: np.array([row[name] for row in results]) for name in experiment.outputs}
        allowed[experiment.name] = {
            name: f"{MAX_DEVIATION * np.abs(values).max():.1g}" for name, values in columns.items()
        }
        ends = [experiment.input(name)[[0, -1]] for name in inputs]
        tables[f"{experiment.name}_in.csv"] = _csv(inputs, [TIMES[[0, -1]], *ends])
        tables[f"{experiment.name}_ref.csv"] = _csv(experiment.outputs, [TIMES, *columns.values()])
        if experiment.parameters:
            tables[f"{experiment.name}.ssv"] = _parameters(experiment, model)
    values = {
        "model": model,
        "experiments": rows,
        "allowed": allowed,
        "origin": ORIGIN.format(EQUATIONS[model.name]),
    }
    values |= {"stop": STOP, "step": STEP, "tolerance": EXPERIMENT_TOLERANCE, "max_deviation": MAX_DEVIATION}
    for name in ("experiments.exp", "fmi-ls-manifest.xml"):
        tables[name] = render_xml(HERE / "templates" / name, values)
    text = render(HERE / "templates" / "fmi-ls-ref.txt", values).encode()
    reference_files = {f"{LS_REF_FOLDER}/{name}": content for name, content in tables.items()}
    return reference_files | {"documentation/fmi-ls-ref.txt": text}
