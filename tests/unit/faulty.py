"""Modules with a planted fault each, for tests of the checks."""

from inertia_module.model import Module


def faulty(after_step=None, change_start=None, after_restore=None):
    """Return a class of modules with a fault.

    Args:
        after_step: Called after each step (module, step size). told: Function that changes the
            parameters of the start. after_restore: Called after a state is restored.
    """

    class Faulty(Module):
        def start(self, **values):
            return super().start(**values | (change_start(values) if change_start else {}))

        def advance(self, step_size):
            super().advance(step_size)
            if after_step:
                after_step(self, step_size)

        def restore(self, *saved):
            super().restore(*saved)
            if after_restore:
                after_restore(self)

    return Faulty


def raising(error):
    """Return a class of modules whose steps raise an exception."""

    def fault(module, step_size):
        raise error

    return faulty(fault)


def showing(**values):
    """Return a class of modules with changed outputs: numbers, or functions of (module, step)."""

    def fault(module, step_size):
        for name, value in values.items():
            setattr(module.outputs, name, value(module, step_size) if callable(value) else value)

    return faulty(fault)
