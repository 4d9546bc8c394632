"""FMUs as an importer sees them: built once a session, driven through fmpy only."""

import ctypes
import math

import pytest
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2Discard, fmi2Error

from inertia_module.contract.variable import BOOLEAN, PARAMETER, REAL
from inertia_module.harness.loading import Slave, messages_of_others, pass_on

# the FMUs a test runs with, unless its file says otherwise by a FLAVOURS of its own
FLAVOURS = ("InertiaModule", "InertiaModule3", "InertiaModulePy")


BAD_STEPS = (0.0, -0.01, math.nan, math.inf, 1e9)


def sentence(variable, value):
    """The whole refusal of a value, from the table of variables."""
    return f"{variable.name} must be {variable.allowed}, is {value:.16g}"


def bad_step(step):
    """The whole refusal of a communication step."""
    return f"communication step must be above 0 and at most 1e+06 s, is {step:.16g}"


def out_of_range(model):
    """Parameters of a model and values that they do not take."""
    for variable in model.with_causality(PARAMETER):
        if variable.kind == REAL:
            too_far = (variable.minimum - 1.0, variable.maximum * 2.0 + 1.0)
            yield from ((variable, value) for value in (math.nan, math.inf, *too_far))
        elif variable.kind != BOOLEAN:  # in FMI a Boolean has two values and no others
            yield from ((variable, value) for value in (int(variable.minimum) - 1, int(variable.maximum) + 1))


def pytest_generate_tests(metafunc):
    if "fmu_path" in metafunc.fixturenames:
        flavours = getattr(metafunc.module, "FLAVOURS", FLAVOURS)
        if metafunc.definition.get_closest_marker("fmi2"):
            flavours = [flavour for flavour in flavours if not flavour.endswith("3")]
        metafunc.parametrize("fmu_path", flavours, indirect=True, scope="session")


@pytest.fixture(scope="session")
def fmu_path(request, built):
    return built / f"{request.param}.fmu"


@pytest.fixture(scope="session")
def description(fmu_path):
    return read_model_description(str(fmu_path))


@pytest.fixture(scope="session")
def unpacked(fmu_path, tmp_path_factory):
    return extract(str(fmu_path), unzipdir=str(tmp_path_factory.mktemp("unpacked")))


class Instance:
    """One instance over fmpy's calls, values by name."""

    def __init__(self, description, folder, **modes):
        table = [v for v in description.modelVariables if v.causality != "independent"]
        self.clock = len(table)
        self.references = {v.name: v.valueReference for v in table}
        self.causalities = {v.name: v.causality for v in description.modelVariables}
        self.is_native = not description.modelName.endswith("Py")
        self.is_fmi3 = description.fmiVersion == "3.0"
        self.takes_rates = description.coSimulation.canInterpolateInputs
        of_enumerations = "Int64" if self.is_fmi3 else "Integer"
        self.calls = {
            v.name: of_enumerations if v.type == "Enumeration" else v.type for v in description.modelVariables
        }
        if self.is_fmi3:
            modes["logMessage"] = pass_on
        self.fmu = (Slave if self.is_fmi3 else FMU2Slave)(
            guid=description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="instance",
        )
        self.fmu.instantiate(loggingOn=True, **modes)
        self.time = 0.0

    def set(self, **values):
        for name, value in values.items():
            getattr(self.fmu, f"set{self.calls[name]}")([self.references[name]], [value])

    def get(self, name):
        return getattr(self.fmu, f"get{self.calls[name]}")([self.references[name]])[0]

    def all_values(self):
        return {name: self.get(name) for name in self.references}

    def start(self, tolerance=None, **values):
        self.fmu.setupExperiment(tolerance=tolerance, startTime=0.0)
        self.set(**values)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def step(self, h):
        self.try_step(h)
        self.time += h

    def try_step(self, h):
        self.fmu.doStep(self.time, h)

    def is_discarded(self, h):
        """Whether the step is answered by fmi2Discard."""
        try:
            self.try_step(h)
        except FMICallException as error:
            if error.status != fmi2Discard:
                raise
            return True
        return False

    def discard(self, h):
        """The message of a step that is answered by fmi2Discard."""
        with messages_of_others() as messages:
            assert self.is_discarded(h), f"a step of {h} s is not discarded"
        return "; ".join(messages)

    def check_range_of_parameters(self, model):
        """Every parameter out of its range is refused by name, value and range, and a good start follows."""
        for variable, value in out_of_range(model):
            self.set(**{variable.name: value})
            said = self.refusal(self.start)
            assert said == sentence(variable, value)
            self.fmu.reset()
        self.start()
        assert not self.is_discarded(0.01)

    def check_bad_input_and_step(self, undisturbed, model, good, bad):
        """Bad inputs and steps are discarded with a sentence, and the run goes on as if nothing had been."""
        for name, value in [*bad, *((None, step) for step in BAD_STEPS)]:
            before = self.all_values()
            self.set(**({name: value} if name else {}))
            said = self.discard(0.01 if name else value)
            assert said == (sentence(model.by_name[name], value) if name else bad_step(value))
            self.set(**good)
            assert self.all_values() == before, f"{said}: values have changed"
            for one in (self, undisturbed):
                one.step(0.1)
            assert self.all_values() == undisturbed.all_values(), f"{said}: the next step is another"

    def set_rates(self, order=1, **rates):
        if self.is_fmi3:
            pytest.skip("FMI 3.0 has no derivatives of inputs")
        references = [self.references[name] for name in rates]
        self.fmu.setRealInputDerivatives(references, [order] * len(rates), list(rates.values()))

    def rates(self, *names, order=1):
        references = [self.references[name] for name in names]
        return self.fmu.getRealOutputDerivatives(references, [order] * len(names))

    def directional(self, unknowns, knowns, direction):
        return self.fmu.getDirectionalDerivative(
            [self.references[name] for name in unknowns],
            [self.references[name] for name in knowns],
            direction,
        )

    def real_status(self, kind):
        value = ctypes.c_double()
        self.fmu.fmi2GetRealStatus(self.fmu.component, kind, ctypes.byref(value))
        return value.value

    def boolean_status(self, kind):
        value = ctypes.c_int(7)
        self.fmu.fmi2GetBooleanStatus(self.fmu.component, kind, ctypes.byref(value))
        return bool(value.value)

    def refusal(self, action):
        """The message of what an action is refused with: an error."""
        status = None
        with messages_of_others() as messages:
            try:
                action()
            except FMICallException as error:
                status = error.status
        assert status == fmi2Error
        return "; ".join(messages)

    def close(self):
        # the library stays: one of pythonfmu that is loaded again may abort the process at its end
        free = self.fmu.fmi3FreeInstance if self.is_fmi3 else self.fmu.fmi2FreeInstance
        free(self.fmu.component)


@pytest.fixture
def instances(description, unpacked):
    """Makes instances and frees them after the test."""
    made = []

    def make():
        made.append(Instance(description, unpacked))
        return made[-1]

    yield make
    for instance in made:
        instance.close()


@pytest.fixture
def instance(instances):
    return instances()
