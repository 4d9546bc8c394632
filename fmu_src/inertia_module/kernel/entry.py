"""The one entry of the compiled kernel of the module: all its operations (see :mod:`.codes`)."""

from .clearance import warnings
from .codes import (
    CHECK,
    OK,
    OUTPUTS,
    RATES,
    RIGID,
    START,
    STEP_PRECISELY,
    STEP_TO_SWITCH,
    SWITCH,
    TUNE,
    WARN,
)
from .outputs import write_late_outputs, write_outputs
from .rates import write_rates
from .run import switch_now
from .step import advance, check, start, tune

# tolerance of a step whose results are to be differenced
PRECISE = 1e-11


def advance_precisely(p, d, u, x, y, w, h):
    """Advance with a tolerance so small that differences of results are free of its noise. Returns a status.

    What is modelled stays: a shaft too stiff to be followed at the module's tolerance still is.
    """
    tolerance = d.tolerance
    d.tolerance = min(tolerance, PRECISE)
    status = advance(p, d, u, x, y, w, h, STEP_PRECISELY)
    d.tolerance = tolerance
    return status


def call(operation, p, d, u, x, y, w, h):
    """Carry out one of the operations START, STEP ... of :mod:`.codes`. Returns a status."""
    w.stops = 1.0 if operation == STEP_TO_SWITCH and p.fidelity >= RIGID else 0.0
    if operation == START:
        return start(p, d, u, x, y, w)
    if operation == CHECK:
        return check(p, d, u)
    if operation == WARN:
        return warnings(p)
    if operation == TUNE:
        return tune(p, d, x, w)
    if operation == OUTPUTS:
        write_late_outputs(p, d, x, y)
        return OK
    if operation == SWITCH:
        switch_now(p, d, x)
        write_outputs(x, y)
        return OK
    if operation == STEP_PRECISELY:
        return advance_precisely(p, d, u, x, y, w, h)
    if operation == RATES:
        return write_rates(p, d, u, x, y, w)
    return advance(p, d, u, x, y, w, h, operation)
