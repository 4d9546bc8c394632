"""The state is a copy of numbers: saved, restored and refused without losing a bit."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import SCENES, advanced, started

from inertia_module.memory import Module, Refused

STEPS = st.lists(st.floats(2e-3, 0.02), min_size=1, max_size=6)


def drive(module, steps):
    """All bytes after each of these steps, the input moving."""
    states = []
    for n, step in enumerate(steps):
        advanced(module, step, omega1=100.0 + 7.0 * n)
        states.append(module.save())
    return states


@pytest.mark.parametrize("input_hold", [0, 1], ids=["constant", "linear"])
@pytest.mark.parametrize("scene", SCENES)
@given(before=STEPS, after=STEPS)
def test_state_saved_runs_on_to_the_same_bits_wherever_it_is_restored(
    compiled, scene, input_hold, before, after
):
    module = started(compiled, SCENES[scene], input_hold=input_hold)
    drive(module, before)
    saved, values = module.save(), module.snapshot()
    # a refused step leaves no trace
    for step in (0.0, -1.0, float("nan"), float("inf"), 1e7):
        with pytest.raises(Refused):
            module.advance(step)
        assert module.save() == saved
    expected = drive(module, after)
    for one in (module, Module(compiled)):
        one.restore(saved)
        assert (one.save(), one.snapshot()) == (saved, values)
        assert drive(one, after) == expected


@pytest.mark.parametrize("scene", SCENES)
def test_state_before_the_start_can_be_restored_too(compiled, scene):
    module = Module(compiled)
    module.set(**SCENES[scene])
    saved = module.save()
    module.start()
    advanced(module, 0.01)
    module.restore(saved)
    assert not module.started
    module.start()
    assert module.save() == started(compiled, SCENES[scene]).save()


def test_what_is_no_state_is_refused_and_changes_nothing(compiled):
    module = advanced(started(compiled), 0.01)
    saved = module.save()
    damaged = {
        "empty": b"",
        "short": saved[:-1],
        "long": saved + b"\0",
        "another kind": b"X" + saved[1:],
        "another build": saved[:16] + bytes([saved[16] ^ 1]) + saved[17:],
        "zeros": bytes(len(saved)),
    }
    for name, state in damaged.items():
        with pytest.raises(Refused, match="the state must be one saved by this build, "):
            module.restore(state)
        assert module.save() == saved, name


def test_step_given_up_leaves_no_trace(compiled):
    module = advanced(started(compiled, omega1=1e5, load_torque=1e5), 1e-3)
    saved = module.save()
    with pytest.raises(Refused, match="abandoned"):
        module.advance(1e4)
    assert module.save() == saved
    assert advanced(module, 1e-4)["energy_in"] > 0.0
