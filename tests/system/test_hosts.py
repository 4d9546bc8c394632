"""Test libcosim and Ecos with several instances, changing inputs and rejections.

test_documentation and test_export run the documented programs in these hosts and others.
"""

import pytest

from inertia_module.fmi.instance import Fmu
from tests.system.programs import needs, printed

STEP, EVERY = 0.01, 10
OUTPUTS = ("omega_out", "omega2", "input_torque_mean", "output_torque_mean", "imbalance_acceleration")
# Initial speeds of three modules, and inputs of the first one before each ten steps.
SPEEDS = (100.0, 70.0, 100.0)
CHANGES = ({}, {"omega1": 104.0}, {"load_torque": -3.0, "omega1": 90.0}, {})
GIVEN = f"STEP, EVERY, OUTPUTS, CHANGES = {STEP}, {EVERY}, {OUTPUTS}, {CHANGES}\nSPEEDS = "
PROGRAMS = {
    "libcosimpy": """
from libcosimpy._internal import get_last_error_message
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

log_output_level(CosimLogLevel.WARNING)
execution = CosimExecution.from_step_size(round(STEP * 1e9))
slaves = [execution.add_local_slave(CosimLocalSlave("InertiaModule.fmu", f"n{n}")) for n in range(3)]
references = {variable.name.decode(): variable.reference for variable in execution.slave_variables(slaves[0])}
observer, override = CosimObserver.create_last_value(), CosimManipulator.create_override()
execution.add_observer(observer)
execution.add_manipulator(override)
for slave, speed in zip(slaves, SPEEDS):
    execution.real_initial_value(slave, references["omega1"], speed)
for changes in CHANGES:
    for name, value in changes.items():
        override.slave_real_values(slaves[0], [references[name]], [value])
    assert execution.step(EVERY), get_last_error_message()
print(*(observer.last_real_values(slave, [references[name]])[0] for slave in slaves for name in OUTPUTS))
""",
    "ecospy": """
from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

EcosLib.set_log_level("warn")
with EcosSimulationStructure() as structure:
    for n in range(3):
        structure.add_model(f"n{n}", "InertiaModule.fmu")
    structure.add_parameter_set("scene", {f"n{n}::omega1": speed for n, speed in enumerate(SPEEDS)})
    with EcosSimulation(structure=structure, step_size=STEP) as simulation:
        simulation.init(parameter_set="scene")
        for changes in CHANGES:
            for name, value in changes.items():
                simulation.set_real(f"n0::{name}", value)
            simulation.step(EVERY)
        print(*(simulation.get_real(f"n{n}::{name}") for n in range(3) for name in OUTPUTS))
""",
}


@pytest.fixture(params=PROGRAMS)
def host(request):
    needs(request.param)
    return request.param


def alone(path, speed, changes):
    """Return the final outputs of a single module in this process."""
    with Fmu(path, inputs={"omega1": speed, "load_torque": 10.0}) as fmu:
        for values in changes:
            fmu.set(**values)
            for _ in range(EVERY):
                fmu.advance(STEP)
        return fmu.read(OUTPUTS)


def test_instances_in_a_host_are_independent(host, built):
    values = printed(GIVEN + f"{SPEEDS}\n" + PROGRAMS[host], built)
    path, count = built / "InertiaModule.fmu", len(OUTPUTS)
    for n, speed in enumerate(SPEEDS):
        expected = alone(path, speed, CHANGES if n == 0 else ({},) * len(CHANGES))
        # Hosts count time differently, in the last digits.
        assert values[n * count : (n + 1) * count] == pytest.approx(expected, rel=1e-9)


def test_rejection_ends_the_run_with_a_message(host, built):
    bad = GIVEN + f"{(1e9, *SPEEDS[1:])}\n" + PROGRAMS[host]
    if host == "ecospy":
        printed(bad, built)  # Ecos continues without results.
        return
    with pytest.raises(AssertionError, match=r"omega1 must be between .* .got 10*"):
        printed(bad, built)
