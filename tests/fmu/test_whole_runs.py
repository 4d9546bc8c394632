"""Test runs in one call: bits, rejections and states equal a loop of steps."""

from contextlib import ExitStack
from ctypes import byref
from functools import partial

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from rejected import assert_rejected, rejection

from inertia_module.common.errors import FmuError, InertiaModuleError
from inertia_module.fmi import instance
from inertia_module.fmi.instance import Fmu
from inertia_module.interface.variables import COMPUTED
from inertia_module.model import Module, Plant, Run

from .conftest import ELASTIC, R1

FLAVOURS = ("InertiaModule", "InertiaModule3")
TIMES = np.linspace(0.0, 0.2, 301)
# The FMU of FMI 3.0 holds discrete outputs. These include Booleans, enumerations and late outputs.
OUTPUTS = (*COMPUTED, "housing_freewheel", "fidelity", "z17", "omega1", "tolerance")
# Inputs and a tunable parameter.
RISING = {
    "omega1": np.interp(TIMES[:-1], [0.0, 0.05, 0.15], [90.0, 90.0, 120.0]),
    "load_torque": np.full(300, 12.0),
    "output_friction": np.where(TIMES[:-1] < 0.1, 0.0, 0.5),
}


def by_loop(plant):
    """A plant that computes many steps in a loop."""
    plant.take_steps = partial(Plant.take_steps, plant)
    return plant


def run(plant, inputs=RISING, outputs=OUTPUTS, **more):
    rows = np.full((TIMES.size, len(outputs)), np.nan)
    instance.run(plant, np.diff(TIMES), inputs, outputs, rows, **more)
    return rows


@pytest.fixture(params=["InertiaModule", "InertiaModule3", "compiled", "plain"])
def twins(request, built, compiled):
    """Return a function that makes two equal plants: instances of an FMU or models in memory."""
    with ExitStack() as opened:

        def make(parameters=ELASTIC):
            if (request.param, parameters.get("fidelity")) == ("plain", "averaged"):
                pytest.skip("the map takes long in plain Python")
            if request.param in ("compiled", "plain"):
                kernel = "plain" if request.param == "plain" else compiled
                return [Module(kernel).start(**parameters, **R1) for _ in range(2)]
            path = built / f"{request.param}.fmu"
            return [opened.enter_context(Fmu(path, parameters, R1)) for _ in range(2)]

        yield make


@pytest.mark.parametrize("level", [ELASTIC, {"fidelity": "rigid"}, {"fidelity": "averaged"}])
def test_run_has_the_bits_and_the_state_of_the_loop(twins, level):
    first, second = twins(level)
    for plant in (first, second):
        if isinstance(plant, Module):
            plant.set_rates(omega1=5.0)  # This rate applies to the first step only.
        else:
            assert getattr(plant._instance, instance.RUN) is not None
    assert np.array_equal(run(first), run(by_loop(second)))
    assert first.save() == second.save()
    if isinstance(first, Fmu):
        assert first.time == second.time == pytest.approx(TIMES[-1])


def test_steps_are_logged_and_progress_is_reported(fmu_path):
    fractions = []
    with Fmu(fmu_path, inputs=R1) as fmu:
        fmu.set_logging(True, "logSteps")
        run(fmu, progress=fractions.append)
        assert sum("step to" in message for message in fmu.messages) == 300
    assert len(fractions) > 1
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0


@pytest.mark.parametrize("name, bad", [("omega1", np.nan), ("load_torque", 1e300), ("output_friction", -1.0)])
def test_run_that_fails_in_the_middle_equals_a_loop_of_steps(twins, name, bad):
    inputs = {name: np.where(np.arange(300) == 200, bad, RISING.get(name, np.zeros(300)))}
    first, second = twins()
    message, looped = (rejection(run, plant, inputs) for plant in (first, by_loop(second)))
    assert first.save() == second.save()
    when = "at time 0.133333333 s: " if isinstance(first, Fmu) else ""
    assert message.startswith(f"{when}{name} must be ")
    assert message.removeprefix(when) == looped.removeprefix(when)
    first.set(**R1)
    first.advance(1e-3)
    if isinstance(first, Fmu):
        assert first.time == pytest.approx(TIMES[200] + 1e-3)
        assert second.time == pytest.approx(TIMES[200])


def test_unknown_names_and_closed_instances_are_rejected(fmu_path):
    with Fmu(fmu_path, inputs=R1) as fmu:
        assert_rejected("unknown variable 'omega7'", run, fmu, outputs=["omega7"])
        with pytest.raises(FmuError, match=r"must be an input or a parameter \(omega_out is calculated\)"):
            run(fmu, {"omega_out": np.zeros(300)})
    assert_rejected("is closed", run, fmu)


@pytest.mark.parametrize("missing", [{"steps": 1, "lengths": None}, {"input_count": 1}, {"output_count": 1}])
def test_null_pointers_are_rejected(fmu_path, missing):
    request = Run(np.ones(1), 0, np.empty((1, 0)), 0, np.empty((2, 0)))
    for name, value in missing.items():
        setattr(request, name, value)
    with Fmu(fmu_path, inputs=R1) as fmu:
        call = getattr(fmu._instance, instance.RUN)
        for pointer in (byref(request), None):
            with pytest.raises(FMICallException):
                call(fmu._instance.component, pointer)
            assert "requires arrays that are not NULL" in fmu.messages.pop()
        with pytest.raises(FMICallException):
            call(None, byref(request))
        fmu.advance(0.01)


def test_fmu_without_such_a_call_runs_by_the_loop(built):
    names = ("omega_out", "contact_mode", "imbalance_acceleration")
    with (
        Fmu(built / "InertiaModulePy.fmu", inputs=R1) as python_fmu,
        Fmu(built / "InertiaModule.fmu", inputs=R1) as native_fmu,
    ):
        assert not hasattr(python_fmu._instance, instance.RUN)
        np.testing.assert_allclose(run(python_fmu, outputs=names), run(native_fmu, outputs=names), rtol=1e-9)


# --- in memory ---


def test_too_long_step_is_rejected_in_a_run_like_alone(compiled):
    module, once = (Module(compiled).start(**R1) for _ in range(2))
    with pytest.raises(InertiaModuleError, match="2000000"):
        instance.run(module, np.array([0.01, 2e6]), {}, ("omega_out",), np.empty((3, 1)))
    once.advance(0.01)
    assert module.save() == once.save()
