"""Ecos: a scene's values are a set of parameters, its changes are set between the steps."""

import ctypes
import importlib.metadata
import sys

from task import run_all

# the library looks for libtbb.so.12 among those of the system; this one comes with a package of Python
if sys.platform == "linux":
    for file in importlib.metadata.files("tbb"):
        if file.name == "libtbb.so.12":
            ctypes.CDLL(str(file.locate()), ctypes.RTLD_GLOBAL)

from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure


def check(task, simulation):
    """Make sure that all is set: of a variable it does not know it only warns."""
    for model, variable, value in task.values():
        kind = {"Real": "real", "Boolean": "bool"}.get(variable.type, "integer")
        found = getattr(simulation, f"get_{kind}")(f"{model}::{variable.name}")
        connected = any((model, variable.name) == tuple(sink) for _, _, *sink in task.connections)
        assert connected or found == value, f"{variable.name} is not set"


def run(task):
    with EcosSimulationStructure() as structure:
        for model, path in task.paths.items():
            structure.add_model(model, path)
        for model, output, other, name in task.connections:
            structure.make_real_connection(f"{model}::{output}", f"{other}::{name}")
        values = {f"{model}::{variable.name}": value for model, variable, value in task.values()}
        structure.add_parameter_set("scene", values)
        with EcosSimulation(structure=structure, step_size=task.step) as simulation:
            assert simulation.init(parameter_set="scene"), EcosLib.get_last_error()
            check(task, simulation)
            rows = []
            for n in range(task.steps):
                for model, variable, value in task.changes(n):
                    simulation.set_real(f"{model}::{variable.name}", value)
                simulation.step()
                rows.append([simulation.get_real(f"{model}::{name}") for model, name in task.outputs])
            simulation.terminate()
    task.write(rows)


EcosLib.set_log_level("warn")
run_all(run)
