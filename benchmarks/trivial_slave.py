"""Trivial pythonfmu FMU, the baseline for the cost of the Python FMU."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class TrivialSlave(Fmi2Slave):
    """Slave with one input and two outputs that computes nothing."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u = 0.0
        self.y = 0.0
        self.z = 0.0
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(Real("y", causality=Fmi2Causality.output))
        self.register_variable(Real("z", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        """Return True without a computation."""
        return True
