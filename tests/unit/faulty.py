"""Modules with one fault each, which what judges them has to find."""

from inertia_module.model import Module


def faulty(after_step=None, told=None, after_restore=None):
    """A class of modules with a fault.

    Args:
        after_step: done to a module after each step (module, step size). told: parameters in place of those
            that a module is started with (a function of these). after_restore: done to a restored module.
    """

    class Faulty(Module):
        def start(self, **values):
            return super().start(**values | (told(values) if told else {}))

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
    """A class of modules whose steps end with an exception."""

    def fault(module, step_size):
        raise error

    return faulty(fault)


def showing(**values):
    """A class of modules with other outputs after each step: numbers, or functions of module and step."""

    def fault(module, step_size):
        for name, value in values.items():
            setattr(module.outputs, name, value(module, step_size) if callable(value) else value)

    return faulty(fault)
