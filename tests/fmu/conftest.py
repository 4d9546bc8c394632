"""Fixtures: FMUs, built once per session and called through fmpy."""

import functools
from pathlib import Path

import pytest
import scenes
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2Discard, fmi2Error
from scenes import ELASTIC, REFERENCE

from inertia_module.fmi.loading import Log, Slave, callbacks_of
from inertia_module.fmu.builder import FMUS

# FMUs of a test, unless its file defines FLAVOURS or the test uses the fixture model (all FMUs).
FLAVOURS = ("InertiaModule", "InertiaModule3", "InertiaModulePy")
MODELS = {fmu.identifier: fmu.model for fmu in FMUS}
R1 = REFERENCE
BY_TORQUE = {"drive": 1, "input_inertia": 0.3}
# Each fidelity and method, driven by speed and, if the level supports it, by torque.
LEVELS = {name: {"fidelity": 2, **level} for name, level in scenes.LEVELS.items()}
LEVELS["rigid with losses"] = {"fidelity": 2, **scenes.ALL_LOSSES}
LEVELS["elastic with losses"] = {**ELASTIC, **scenes.ALL_LOSSES, **scenes.WIND_UP}
LEVELS |= {f"{name}, by torque": {**LEVELS[name], **BY_TORQUE} for name in LEVELS if name != "kinematic"}


def pytest_generate_tests(metafunc):
    if "fmu_path" in metafunc.fixturenames:
        of_both = "model" in metafunc.fixturenames
        flavours = MODELS if of_both else getattr(metafunc.module, "FLAVOURS", FLAVOURS)
        if metafunc.definition.get_closest_marker("fmi2"):
            flavours = [flavour for flavour in flavours if not flavour.endswith("3")]
        metafunc.parametrize("fmu_path", flavours, indirect=True, scope="session")


@pytest.fixture(scope="session")
def fmu_path(request, built):
    return built / f"{request.param}.fmu"


@pytest.fixture(scope="session")
def model(fmu_path):
    """Return the model of the FMU."""
    return MODELS[fmu_path.stem]


@pytest.fixture(scope="session")
def opened(built, tmp_path_factory):
    """Return a function that gives description and folder of an FMU, unpacked once."""

    @functools.cache
    def open_once(identifier):
        folder = extract(str(built / f"{identifier}.fmu"), str(tmp_path_factory.mktemp(identifier)))
        return read_model_description(folder), Path(folder)

    return open_once


@pytest.fixture(scope="session")
def description(fmu_path, opened):
    return opened(fmu_path.stem)[0]


@pytest.fixture(scope="session")
def unpacked(fmu_path, opened):
    return opened(fmu_path.stem)[1]


class Instance:
    """An instance called through fmpy, with values by name."""

    def __init__(self, description, folder, **modes):
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.clock = self.references.pop("time", None)
        self.causalities = {v.name: v.causality for v in description.modelVariables}
        self.is_native = not description.modelName.endswith("Py")
        self.is_fmi3 = description.fmiVersion == "3.0"
        enumeration_type = "Int64" if self.is_fmi3 else "Integer"
        self.calls = {
            v.name: enumeration_type if v.type == "Enumeration" else v.type
            for v in description.modelVariables
        }
        self.log = Log()
        log_arguments = (
            {"logMessage": self.log.take} if self.is_fmi3 else {"callbacks": callbacks_of(self.log)}
        )
        self.fmu = (Slave if self.is_fmi3 else FMU2Slave)(
            guid=description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="instance",
        )
        self.fmu.instantiate(loggingOn=True, **log_arguments, **modes)
        self.time = 0.0

    def set(self, **values):
        """Set variables with one call per type."""
        for kind in dict.fromkeys(self.calls[name] for name in values):
            selected = {name: value for name, value in values.items() if self.calls[name] == kind}
            getattr(self.fmu, f"set{kind}")(
                [self.references[name] for name in selected], list(selected.values())
            )

    def get(self, name):
        return getattr(self.fmu, f"get{self.calls[name]}")([self.references[name]])[0]

    def all_values(self):
        return {name: self.get(name) for name in self.references}

    def saved(self):
        """Return the serialised state."""
        return self.fmu.serializeFMUstate(self.fmu.getFMUstate())

    def restore(self, saved):
        self.fmu.setFMUstate(self.fmu.deSerializeFMUstate(saved))

    def start(self, tolerance=None, **values):
        self.fmu.setupExperiment(tolerance=tolerance, startTime=0.0)
        self.set(**values)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def step(self, h):
        self.try_step(h)
        self.time += h

    # These names are equal to the methods of a model in memory.
    advance, snapshot = step, all_values

    def try_step(self, h):
        self.fmu.doStep(self.time, h)

    def is_discarded(self, h):
        """Try a step; return True if fmi2Discard is the status."""
        try:
            self.try_step(h)
        except FMICallException as error:
            if error.status != fmi2Discard:
                raise
            return True
        return False

    def set_rates(self, order=1, **rates):
        if self.is_fmi3:
            pytest.skip("FMI 3.0 has no derivatives of inputs")
        references = [self.references[name] for name in rates]
        self.fmu.setRealInputDerivatives(references, [order] * len(rates), list(rates.values()))

    def rates(self, *names, order=1):
        references = [self.references[name] for name in names]
        return list(self.fmu.getRealOutputDerivatives(references, [order] * len(names)))

    def directional(self, unknowns, knowns, direction):
        return self.fmu.getDirectionalDerivative(
            [self.references[name] for name in unknowns],
            [self.references[name] for name in knowns],
            direction,
        )

    def rejection(self, action, expected=fmi2Error):
        """Return the message of a rejected action with an error or another expected status."""
        status = None
        self.log.warnings.clear()
        self.log.errors.clear()
        try:
            action()
        except FMICallException as error:
            status = error.status
        assert status == expected
        return "; ".join(self.log.warnings + self.log.errors)

    def close(self):
        # Keep the library loaded: a second load of a pythonfmu library may abort the process at its end.
        free = self.fmu.fmi3FreeInstance if self.is_fmi3 else self.fmu.fmi2FreeInstance
        free(self.fmu.component)


@pytest.fixture
def instances_of(opened):
    """Return a function that makes instances of an FMU, and free them after the test."""
    instances = []

    def make(identifier, **modes):
        instances.append(Instance(*opened(identifier), **modes))
        return instances[-1]

    yield make
    for instance in instances:
        instance.close()


@pytest.fixture
def instances(fmu_path, instances_of):
    """Return a function that makes instances of the FMU of the test."""
    return functools.partial(instances_of, fmu_path.stem)


@pytest.fixture
def instance(instances):
    return instances()
