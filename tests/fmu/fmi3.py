"""An FMU of FMI 3.0 by the calls that fmpy has for FMI 2.0, so that the same tests drive both."""

from fmpy.fmi3 import FMU3Slave

from inertia_module.harness.logs import pass_on


class Slave(FMU3Slave):
    """Types of variables are those of the description; without event mode and early return."""

    def __init__(self, types, **arguments):
        super().__init__(**arguments)
        self.types = types
        self.experiment = {}

    def instantiate(self, loggingOn=False, **modes):
        super().instantiate(loggingOn=loggingOn, logMessage=pass_on, **modes)

    def setupExperiment(self, **experiment):
        self.experiment = experiment

    def enterInitializationMode(self):
        super().enterInitializationMode(**self.experiment)

    def _type_of(self, references):
        of_enumerations = all(self.types.get(reference) == "Enumeration" for reference in references)
        return "Int64" if of_enumerations else "Int32"

    def getReal(self, references):
        return self.getFloat64(references)

    def setReal(self, references, values):
        self.setFloat64(references, values)

    def getInteger(self, references):
        return getattr(self, f"get{self._type_of(references)}")(references)

    def setInteger(self, references, values):
        getattr(self, f"set{self._type_of(references)}")(references, values)

    def getFMUstate(self):
        return self.getFMUState()

    def setFMUstate(self, state):
        self.setFMUState(state)

    def freeFMUstate(self, state):
        self.freeFMUState(state)

    def serializeFMUstate(self, state):
        return self.serializeFMUState(state)

    def deSerializeFMUstate(self, saved, state=None):
        return self.deserializeFMUState(saved, state)

    def fmi2SetDebugLogging(self, component, on, count, categories):
        self.fmi3SetDebugLogging(component, bool(on), count, categories)

    def fmi2DoStep(self, _, time, step, __):
        self.doStep(time, step)

    def fmi2GetRealOutputDerivatives(self, component, references, count, orders, values):
        self.fmi3GetOutputDerivatives(component, references, count, orders, values, count)

    def fmi2FreeInstance(self, _):
        self.freeInstance()
