"""The state is a copy of numbers: saved, restored and refused without losing a bit."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import SCENES, advanced, started

from inertia_module.memory import Module, Refused

STEPS = st.lists(st.floats(2e-3, 0.02), min_size=1, max_size=6)


@pytest.fixture(scope="module", params=SCENES)
def scene(request):
    return SCENES[request.param]


@pytest.fixture(scope="module", params=[0, 1], ids=["constant", "linear"])
def input_hold(request):
    return request.param


def drive(module, steps):
    """All bytes after each of these steps, the input moving."""
    states = []
    for n, step in enumerate(steps):
        advanced(module, step, omega1=100.0 + 7.0 * n)
        states.append(module.save())
    return states


@given(before=STEPS, after=STEPS)
def test_restored_state_runs_on_to_the_same_bits(kernel, scene, input_hold, before, after):
    module = started(kernel, scene, input_hold=input_hold)
    drive(module, before)
    saved = module.save()
    first = drive(module, after)
    module.restore(saved)
    assert module.save() == saved
    assert drive(module, after) == first


@given(before=STEPS, after=STEPS)
def test_state_moves_into_a_new_module(kernel, scene, input_hold, before, after):
    module = started(kernel, scene, input_hold=input_hold)
    drive(module, before)
    other = Module(kernel)
    other.restore(module.save())
    assert other.snapshot() == module.snapshot()
    assert drive(other, after) == drive(module, after)


def test_state_before_the_start_can_be_restored_too(kernel, scene):
    module = Module(kernel)
    module.set(**scene)
    saved = module.save()
    module.start()
    advanced(module, 0.01)
    module.restore(saved)
    assert not module.started
    module.start()
    assert module.save() == started(kernel, scene).save()


@pytest.mark.parametrize(
    "damage",
    [
        lambda saved: b"",
        lambda saved: saved[:-1],
        lambda saved: saved + b"\0",
        lambda saved: b"X" + saved[1:],
        lambda saved: saved[:16] + bytes([saved[16] ^ 1]) + saved[17:],
        lambda saved: bytes(len(saved)),
    ],
    ids=["empty", "short", "long", "another kind", "another build", "zeros"],
)
def test_what_is_no_state_is_refused_and_changes_nothing(kernel, damage):
    module = advanced(started(kernel), 0.01)
    saved = module.save()
    with pytest.raises(Refused, match="the state must be one saved by this build, "):
        module.restore(damage(saved))
    assert module.save() == saved


@given(before=STEPS, after=STEPS)
def test_refused_step_leaves_no_trace(kernel, scene, input_hold, before, after):
    module = started(kernel, scene, input_hold=input_hold)
    drive(module, before)
    saved = module.save()
    for step in (0.0, -1.0, float("nan"), float("inf"), 1e7):
        with pytest.raises(Refused):
            module.advance(step)
        assert module.save() == saved
    undisturbed = Module(kernel)
    undisturbed.restore(saved)
    assert drive(module, after) == drive(undisturbed, after)


def test_step_given_up_leaves_no_trace(compiled):
    module = advanced(started(compiled, omega1=1e5, load_torque=1e5), 1e-3)
    saved = module.save()
    with pytest.raises(Refused, match="abandoned"):
        module.advance(1e4)
    assert module.save() == saved
    assert advanced(module, 1e-4)["energy_in"] > 0.0
