"""FMPy's container: an FMU around FMUs, whose library is a host of its own; values are its start values."""

from fmpy import extract, read_model_description
from fmpy.container_fmu.cli import create_container_fmu
from fmpy.container_fmu.config import Component, Configuration, Connection
from fmpy.fmi2 import FMU2Slave
from fmpy.model_description import CoSimulation, DefaultExperiment, ModelDescription, ModelVariable, Unknown
from task import run_all

# what the container counts as its variable 0
TIME = ModelVariable(name="time", type="Real", causality="independent", variability="continuous")
# the container passes an Integer on as one, to an enumeration too
TYPES = {"Real": "Real", "Boolean": "Boolean"}


def container_variable(model, variable, value=None):
    return ModelVariable(
        name=f"{model}.{variable.name}",
        type=TYPES.get(variable.type, "Integer"),
        causality=variable.causality,
        variability=variable.variability,
        start=None if value is None else str(value).lower(),
    )


def connector(variable):
    return ModelVariable(name=variable.name, valueReference=variable.valueReference, type="Float64")


def configuration(task):
    components = {
        model: Component(model, path, task.descriptions[model]) for model, path in task.paths.items()
    }
    mappings = {
        container_variable(model, variable, value): [(components[model], variable)]
        for model, variable, value in task.values()
    }
    outputs = []
    for model, name in task.outputs:
        variable = task.variables[model][name]
        outputs.append(container_variable(model, variable))
        mappings[outputs[-1]] = [(components[model], variable)]
    description = ModelDescription(
        fmiVersion="2.0",
        modelName="container",
        instantiationToken="container",
        coSimulation=CoSimulation(modelIdentifier="container", fixedInternalStepSize=task.step),
        defaultExperiment=DefaultExperiment(),
        modelVariables=[TIME, *mappings],
        outputs=[Unknown(variable=variable) for variable in outputs],
        initialUnknowns=[Unknown(variable=variable) for variable in outputs],
    )
    connections = [
        Connection(
            components[model],
            [connector(task.variables[model][output])],
            components[other],
            [connector(task.variables[other][name])],
        )
        for model, output, other, name in task.connections
    ]
    return Configuration(False, description, list(components.values()), connections, mappings)


def run(task):
    path, folder = task.work / "container.fmu", task.work / "packing"
    folder.mkdir()
    create_container_fmu(configuration(task), folder, path)
    description = read_model_description(str(path), validate=False)
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=extract(str(path), unzipdir=str(task.work / "unpacked")),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="container",
    )
    slave.instantiate(loggingOn=True)
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    rows, time = [], 0.0
    outputs = [references[f"{model}.{name}"] for model, name in task.outputs]
    for n in range(task.steps):
        for model, variable, value in task.changes(n):
            slave.setReal([references[f"{model}.{variable.name}"]], [value])
        slave.doStep(currentCommunicationPoint=time, communicationStepSize=task.step)
        time += task.step
        rows.append(slave.getReal(outputs))
    slave.terminate()
    slave.freeInstance()
    task.write(rows)


run_all(run)
