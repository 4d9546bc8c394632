"""Scenes run by several FMI hosts, in processes of their own: one that crashes does not end the tests.

Every host couples its models by the same algorithm, Jacobi's with a fixed step: all step side by side with
the inputs of the communication point, then the outputs are passed on. All set the values of a scene before
the end of initialisation, so that there is no jump at the start.
"""

import ctypes
import dataclasses
import importlib.metadata
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
from fmpy import read_model_description

from inertia_module.harness.system import Node, WiredFmus
from inertia_module.harness.wires import Wire

# given in the course of a run, where no wire gives them
INPUTS = ("omega1", "load_torque", "drive_torque", "hub_speed")


@dataclasses.dataclass(frozen=True)
class Host:
    """What there is to know about a host.

    Attributes:
        packages: what it needs besides fmpy. minds_errors: whether it stops when the FMU refuses something.
    """

    packages: tuple[str, ...] = ()
    minds_errors: bool = True

    @property
    def missing(self):
        """Packages that it needs and that are not installed."""
        return [name for name in self.packages if not [*importlib.metadata.distributions(name=name)]]


HOSTS = {
    "libcosim": Host(("libcosimpy",)),
    "ecos": Host(("ecospy", "tbb") if sys.platform == "linux" else ("ecospy",), minds_errors=False),
}


@dataclasses.dataclass(frozen=True)
class Scene:
    """Models to step side by side.

    Attributes:
        models: values (parameters and inputs) by name, by name of the instance, which is that of the FMU or
            that and a number: Module_2.
        step: communication step, s. steps: how many.
        connections: (instance, output, instance, input).
        changes: values of inputs by name, by instance, by the number of the step they are set before.
    """

    models: dict[str, dict[str, float]]
    step: float
    steps: int
    connections: tuple[tuple[str, str, str, str], ...] = ()
    changes: dict[int, dict[str, dict[str, float]]] = dataclasses.field(default_factory=dict)


class HostFailed(RuntimeError):
    """The host ended with an error: what it says."""


def looped(scene, folder):
    """Outputs after each step, by 'instance.output', of the FMUs side by side in this process."""
    task = Task.of(scene, folder)
    nodes = {}
    for model, values in scene.models.items():
        inputs = {name: value for name, value in values.items() if name in INPUTS}
        parameters = {name: value for name, value in values.items() if name not in INPUTS}
        nodes[model] = Node(task.paths[model], parameters, inputs)
    rows = []
    with WiredFmus(nodes, [Wire(*connection) for connection in scene.connections], scene.step) as system:
        for n in range(scene.steps):
            for model, values in scene.changes.get(n, {}).items():
                system.set(model, **values)
            system.advance()
            rows.append([system.fmus[model][name] for model, name in task.outputs])
    names = [f"{model}.{name}" for model, name in task.outputs]
    return dict(zip(names, np.transpose(rows), strict=True))


def run(host, scenes, work):
    """Run scenes in a host, one after the other in one process.

    Args:
        host: one of HOSTS. scenes: by name, each with the folder of its FMUs.
        work: folder for what the host leaves behind.

    Returns:
        By the name of the scene the outputs after each step, by 'instance.output'.

    Raises:
        HostFailed: the host ends with an error.
    """
    folders = {}
    for number, (name, (scene, folder)) in enumerate(scenes.items()):
        folders[name] = work / str(number)
        folders[name].mkdir(parents=True)
        task = dataclasses.asdict(scene) | {"folder": str(folder)}
        (folders[name] / "task.json").write_text(json.dumps(task))
    done = subprocess.run(
        [sys.executable, __file__, host, *map(str, folders.values())],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        check=False,
        cwd=work,
    )
    if done.returncode != 0:
        raise HostFailed(f"{host} ends with {done.returncode}: {done.stdout[-3000:]}")
    return {name: _outputs(scene, folders[name]) for name, (scene, _) in scenes.items()}


def _outputs(scene, work):
    names = json.loads((work / "names.json").read_text())
    rows = np.load(work / "rows.npy")
    assert rows.shape == (scene.steps, len(names))
    return dict(zip(names, rows.T, strict=True))


# --- in the process of a host ---


class Task:
    """A scene in a folder.

    Attributes:
        work: the folder. models, step, steps, connections: as given.
        paths, descriptions, variables: of each instance; the variables by name.
        outputs: (instance, output) of all.
    """

    @classmethod
    def of(cls, scene, folder):
        """A scene in this process."""
        return cls(folder, dataclasses.asdict(scene) | {"folder": folder})

    def __init__(self, work, given=None):
        self.work = Path(work)
        given = given or json.loads((self.work / "task.json").read_text())
        self.models, self.step, self.steps = given["models"], given["step"], given["steps"]
        self.connections, self._changes = given["connections"], given["changes"]
        folder = Path(given["folder"])
        self.paths = {model: folder / f"{model.split('_')[0]}.fmu" for model in self.models}
        self.descriptions = {model: read_model_description(str(path)) for model, path in self.paths.items()}
        self.variables = {
            model: {variable.name: variable for variable in description.modelVariables}
            for model, description in self.descriptions.items()
        }
        self.outputs = [
            (model, name)
            for model, variables in self.variables.items()
            for name, variable in variables.items()
            if variable.causality == "output"
        ]

    def reference(self, model, name):
        """Value reference of a variable."""
        return self.variables[model][name].valueReference

    def values(self):
        """(instance, variable, value) of all that the scene sets before the end of initialisation."""
        yield from self._each(self.models)

    def changes(self, step):
        """(instance, variable, value) of all inputs that are set before a step."""
        yield from self._each(self._changes.get(str(step), {}))

    def _each(self, models):
        for model, values in models.items():
            for name, value in values.items():
                yield model, self.variables[model][name], value

    def write(self, rows):
        """Leave the outputs after each step."""
        (self.work / "names.json").write_text(json.dumps([f"{model}.{name}" for model, name in self.outputs]))
        np.save(self.work / "rows.npy", np.array(rows))


def in_ecos(task):
    """Ecos: a scene's values are a set of parameters, its changes are set between the steps."""
    # the library looks for libtbb.so.12 among those of the system; this one comes with a package of Python
    if sys.platform == "linux":
        for file in importlib.metadata.files("tbb"):
            if file.name == "libtbb.so.12":
                ctypes.CDLL(str(file.locate()), ctypes.RTLD_GLOBAL)
    from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

    EcosLib.set_log_level("warn")
    with EcosSimulationStructure() as structure:
        for model, path in task.paths.items():
            structure.add_model(model, path)
        for model, output, other, name in task.connections:
            structure.make_real_connection(f"{model}::{output}", f"{other}::{name}")
        values = {f"{model}::{variable.name}": value for model, variable, value in task.values()}
        structure.add_parameter_set("scene", values)
        with EcosSimulation(structure=structure, step_size=task.step) as simulation:
            assert simulation.init(parameter_set="scene"), EcosLib.get_last_error()
            # of a variable it does not know it only warns
            for model, variable, value in task.values():
                kind = {"Real": "real", "Boolean": "bool"}.get(variable.type, "integer")
                found = getattr(simulation, f"get_{kind}")(f"{model}::{variable.name}")
                connected = any((model, variable.name) == tuple(sink) for _, _, *sink in task.connections)
                assert connected or found == value, f"{variable.name} is not set"
            rows = []
            for n in range(task.steps):
                for model, variable, value in task.changes(n):
                    simulation.set_real(f"{model}::{variable.name}", value)
                simulation.step()
                rows.append([simulation.get_real(f"{model}::{name}") for model, name in task.outputs])
            simulation.terminate()
    task.write(rows)


def in_libcosim(task):
    """libcosim: a scene's values are initial values, its changes are overrides, its outputs are observed."""
    from libcosimpy._internal import get_last_error_message
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_step_size(round(task.step * 1e9))
    slaves = {model: CosimLocalSlave(str(path), model) for model, path in task.paths.items()}
    indices = {model: execution.add_local_slave(slave) for model, slave in slaves.items()}
    for model, variable, value in task.values():
        kind = {"Real": "real", "Boolean": "boolean"}.get(variable.type, "integer")
        put = getattr(execution, f"{kind}_initial_value")
        assert put(indices[model], variable.valueReference, value), f"{variable.name} is not set"
    for model, output, other, name in task.connections:
        source, sink = task.reference(model, output), task.reference(other, name)
        failed = execution.connect_real_variables(indices[model], source, indices[other], sink)
        assert not failed, f"{output} is not connected with {name}"
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    assert execution.add_observer(observer)
    assert execution.add_manipulator(manipulator)
    rows = []
    for n in range(task.steps):
        for model, variable, value in task.changes(n):
            assert manipulator.slave_real_values(indices[model], [variable.valueReference], [value])
        assert execution.step(), get_last_error_message()
        rows.append([])
        for model, name in task.outputs:
            rows[-1] += observer.last_real_values(indices[model], [task.reference(model, name)])
    task.write(rows)


if __name__ == "__main__":
    for folder in sys.argv[2:]:
        {"ecos": in_ecos, "libcosim": in_libcosim}[sys.argv[1]](Task(folder))
