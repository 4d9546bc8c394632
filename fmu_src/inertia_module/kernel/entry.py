"""The one entry of the compiled kernel of the module: all its operations (see :mod:`.codes`)."""

from .clearance import warnings
from .codes import (
    CHECK,
    OK,
    OUTPUTS,
    RATES,
    RIGID,
    START,
    STEP_TO_SWITCH,
    SWITCH,
    TUNE,
    WARN,
)
from .engine import switch_now
from .outputs import write_late_outputs, write_outputs
from .rates import write_rates
from .step import advance, check, start, tune


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
        switch_now(d, x)
        write_outputs(x, y)
        return OK
    if operation == RATES:
        return write_rates(p, d, u, x, y, w)
    return advance(p, d, u, x, y, w, h, operation)
