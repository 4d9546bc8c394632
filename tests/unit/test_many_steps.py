"""Test many steps in one call in memory: bits, outputs and states equal a loop of steps."""

import numpy as np
import pytest
from scenes import REFERENCE, advanced, motions, started

from inertia_module.common.errors import ParameterError
from inertia_module.interface.variables import OUTPUT, with_causality
from inertia_module.model import Plant

LATE = tuple(variable.name for variable in with_causality(OUTPUT) if variable.late)
EARLY = tuple(variable.name for variable in with_causality(OUTPUT) if not variable.late)
LENGTHS = np.linspace(1e-3, 3e-3, 40)


def take_steps(module, outputs, lengths=LENGTHS, take=None):
    """Take steps with a rising load, and return the outputs."""
    rows = np.empty((len(lengths) + 1, len(outputs)))
    loads = np.linspace(4.0, 6.0, len(lengths)).reshape(-1, 1)
    (take or module.take_steps)(lengths, ("load_torque",), loads, outputs, rows)
    return rows


@motions(added=("ideal", "losses", "worn"), missing=())
@pytest.mark.parametrize("outputs", [EARLY, EARLY + LATE[:1]], ids=["early", "late"])
def test_steps_have_the_bits_of_the_loop(compiled, scene, outputs):
    first, second = started(compiled, scene), started(compiled, scene)
    rows = take_steps(first, outputs)
    loop = take_steps(second, outputs, take=lambda *steps: Plant.take_steps(second, *steps))
    assert np.array_equal(rows, loop)
    assert first.snapshot() == second.snapshot()
    assert advanced(first, 0.01).snapshot() == advanced(second, 0.01).snapshot()


@pytest.mark.parametrize("accepted", [0, 7])
def test_outputs_after_a_rejected_step_hold_at_its_beginning(compiled, accepted):
    lengths = np.full(20, 1e-3)
    lengths[accepted] = -1.0
    first, second = started(compiled, REFERENCE), started(compiled, REFERENCE)
    with pytest.raises(ParameterError, match="communication step must be"):
        take_steps(first, EARLY, lengths)
    if accepted:
        loads = np.linspace(4.0, 6.0, 20)[:accepted].reshape(-1, 1)
        rows = np.empty((accepted + 1, len(LATE)))
        second.take_steps(lengths[:accepted], ("load_torque",), loads, LATE, rows)
    assert first.read(EARLY + LATE) == second.read(EARLY + LATE)
