"""A system as one FMU: FMPy's container, whose library is a co-simulation host of its own."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from ..variables import Variable
from .plan import Plan, typed

# the container passes an Integer on to an enumeration too
KINDS = {"Real": "Real", "Boolean": "Boolean"}


def _variable(name: str, variable: Variable, value: float | None = None) -> Any:
    from fmpy.model_description import ModelVariable

    return ModelVariable(
        name=name,
        type=KINDS.get(variable.kind, "Integer"),
        causality=variable.causality,
        variability=variable.variability,
        description=variable.description,
        start=None if value is None else typed(variable, value)[1],
    )


def _configuration(plan: Plan, folder: Path) -> Any:
    """FMPy's description of the container: what it shows, where that is, and the wires."""
    from fmpy import read_model_description
    from fmpy.container_fmu.config import Component, Configuration, Connection
    from fmpy.model_description import (
        CoSimulation,
        DefaultExperiment,
        ModelDescription,
        ModelVariable,
        Unknown,
    )

    paths = {part.name: folder / part.fmu.file_name for part in plan.parts}
    descriptions = {name: read_model_description(str(path)) for name, path in paths.items()}
    components = {name: Component(name, path, descriptions[name]) for name, path in paths.items()}
    inner = {name: {v.name: v for v in found.modelVariables} for name, found in descriptions.items()}
    wired = {(wire.sink, wire.input) for wire in plan.wires}
    mappings = {}
    for part in plan.parts:
        for name, value in part.values.items():
            if (part.name, name) not in wired:
                shown = _variable(f"{part.name}.{name}", part.variable(name), value)
                mappings[shown] = [(components[part.name], inner[part.name][name])]
    outputs = []
    for name, output in plan.outputs:
        outputs.append(_variable(f"{name}.{output}", plan.part(name).variable(output)))
        mappings[outputs[-1]] = [(components[name], inner[name][output])]

    def connector(instance: str, name: str) -> Any:
        found = inner[instance][name]
        return ModelVariable(name=name, valueReference=found.valueReference, type="Float64")

    unknowns = [Unknown(variable=variable) for variable in outputs]
    description = ModelDescription(
        fmiVersion="2.0",
        modelName="container",
        description=plan.title,
        instantiationToken="container",
        coSimulation=CoSimulation(modelIdentifier="container", fixedInternalStepSize=plan.step),
        defaultExperiment=DefaultExperiment(stopTime=str(plan.stop_time), stepSize=str(plan.step)),
        # what the container counts as its variable 0
        modelVariables=[
            ModelVariable(name="time", type="Real", causality="independent", variability="continuous"),
            *mappings,
        ],
        outputs=unknowns,
        initialUnknowns=unknowns,
    )
    connections = [
        Connection(
            components[wire.source],
            [connector(wire.source, wire.output)],
            components[wire.sink],
            [connector(wire.sink, wire.input)],
        )
        for wire in plan.wires
    ]
    return Configuration(False, description, list(components.values()), connections, mappings)


def container(plan: Plan, fmus: dict[str, bytes]) -> bytes:
    """The content of an FMU around the FMUs of a plan; fmus: contents by file name.

    Values of the parts are its start values, named part.variable; it steps its parts side by side (Jacobi)
    at the step of the plan.
    """
    from fmpy.container_fmu.cli import create_container_fmu

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file_name, content in fmus.items():
            (folder / file_name).write_bytes(content)
        (folder / "packing").mkdir()
        create_container_fmu(_configuration(plan, folder), folder / "packing", folder / "container.fmu")
        return (folder / "container.fmu").read_bytes()
