"""libcosim: a scene's values are initial values, its changes are overrides, its outputs are observed."""

from libcosimpy._internal import get_last_error_message
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave
from task import run_all


def run(task):
    execution = CosimExecution.from_step_size(round(task.step * 1e9))
    slaves = {model: CosimLocalSlave(str(path), model) for model, path in task.paths.items()}
    indices = {model: execution.add_local_slave(slave) for model, slave in slaves.items()}
    for model, variable, value in task.values():
        kind = {"Real": "real", "Boolean": "boolean"}.get(variable.type, "integer")
        put = getattr(execution, f"{kind}_initial_value")
        assert put(indices[model], variable.valueReference, value), f"{variable.name} is not set"
    for model, output, other, name in task.connections:
        source, sink = task.variables[model][output], task.variables[other][name]
        failed = execution.connect_real_variables(
            indices[model], source.valueReference, indices[other], sink.valueReference
        )
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
            rows[-1] += observer.last_real_values(
                indices[model], [task.variables[model][name].valueReference]
            )
    task.write(rows)


log_output_level(CosimLogLevel.WARNING)
run_all(run)
