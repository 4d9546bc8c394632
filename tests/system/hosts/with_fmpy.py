"""The calls one by one, over FMPy: what the hosts are compared with."""

from fmpy import extract
from fmpy.fmi2 import FMU2Slave
from task import run_all


def assign(slave, variable, value):
    kind = {"Real": "Real", "Boolean": "Boolean"}.get(variable.type, "Integer")
    getattr(slave, f"set{kind}")([variable.valueReference], [value])


def pass_on(task, slaves):
    """The outputs of all are read, then the inputs are set."""
    values = [
        slaves[model].getReal([task.variables[model][output].valueReference])[0]
        for model, output, _, _ in task.connections
    ]
    for (_, _, model, name), value in zip(task.connections, values, strict=True):
        assign(slaves[model], task.variables[model][name], value)


def times(task):
    """Communication points and steps, as the clock has them."""
    time = 0.0
    for n in range(task.steps):
        if task.clock == "nanoseconds":
            nanoseconds = round(task.step * 1e9)
            time = n * nanoseconds / 1e9
            yield time, (n + 1) * nanoseconds / 1e9 - time
        else:
            yield time, task.step
            time += task.step


def initialised(task):
    slaves = {}
    for model, description in task.descriptions.items():
        slaves[model] = FMU2Slave(
            guid=description.guid,
            unzipDirectory=extract(str(task.paths[model]), unzipdir=str(task.work / model)),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=model,
        )
        slaves[model].instantiate()
        slaves[model].setupExperiment(startTime=0.0)
        slaves[model].enterInitializationMode()
    for model, variable, value in task.values():
        assign(slaves[model], variable, value)
    for _ in slaves:
        pass_on(task, slaves)
    for slave in slaves.values():
        slave.exitInitializationMode()
    pass_on(task, slaves)
    return slaves


def run(task):
    slaves = initialised(task)
    rows = []
    for n, (time, step) in enumerate(times(task)):
        for model, variable, value in task.changes(n):
            assign(slaves[model], variable, value)
        for slave in slaves.values():
            slave.doStep(currentCommunicationPoint=time, communicationStepSize=step)
        pass_on(task, slaves)
        rows.append([])
        for model, name in task.outputs:
            rows[-1] += slaves[model].getReal([task.variables[model][name].valueReference])
    for slave in slaves.values():
        slave.terminate()
        slave.freeInstance()
    task.write(rows)


run_all(run)
