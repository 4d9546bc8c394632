"""Test FMI 3.0: results of FMI 2.0, events, intermediate updates, adjoint derivatives."""

import numpy as np
import pytest
from fmpy.fmi3 import fmi3Discard, fmi3Error

from inertia_module.kernel.codes import DRIVING, FREE

from .conftest import BY_TORQUE, LEVELS, R1

FLAVOURS = ("InertiaModule3",)
# Levels of fidelity whose steps stop at switches.
BY_EVENTS = [name for name in LEVELS if name.startswith(("rigid", "elastic"))]


def pass_event(instance):
    needs_update, *_ = instance.fmu.updateDiscreteStates()
    assert not needs_update
    instance.fmu.enterStepMode()


def handle_event(instance):
    instance.fmu.enterEventMode()
    pass_event(instance)


def started(instances, event_mode=True, **settings):
    instance = instances(eventModeUsed=event_mode, earlyReturnAllowed=True).start(**settings)
    if event_mode:
        pass_event(instance)
    return instance


def run(instance, step, count, seen=lambda: None, event_mode=True, handle=handle_event):
    """Run the steps of a host that continues after an early return; return the times of the returns."""
    times = []
    for n in range(1, count + 1):
        reached = (n - 1) * step
        while reached < n * step:
            event, _, early, reached = instance.fmu.doStep(reached, n * step - reached)
            assert event or not early or not event_mode
            if early:
                times.append(reached)
            if event:
                seen()
                handle(instance)
                seen()
    return times


def test_events_are_the_125_switches_of_r1_each_at_its_time(instances, instances_of):
    instance = started(instances, **R1)
    seen = []
    names = ("contact_mode", "contact_switches", "omega2", "omega_out")
    times = np.array(run(instance, 1e-3, 1000, lambda: seen.append([instance.get(name) for name in names])))
    assert len(times) == 125
    assert (np.diff(times) > 0.0).all()
    for (mode, count, *speeds), (next_mode, next_count, *next_speeds) in zip(
        seen[::2], seen[1::2], strict=True
    ):
        assert mode != next_mode
        assert next_count == count + 1.0
        assert next_speeds == speeds
    # An FMU of FMI 2.0 counts the same number of switches before each communication point.
    other = instances_of("InertiaModule").start(**R1)
    for n in range(1, 1001):
        other.step(1e-3)
        assert other.get("contact_switches") == (times <= n * 1e-3).sum(), n
    assert instance.get("omega_out") == pytest.approx(other.get("omega_out"), rel=1e-9)


def test_events_do_not_depend_on_the_communication_step(instances):
    fine, coarse = (started(instances, tolerance=1e-10, **R1) for _ in range(2))
    assert run(coarse, 0.05, 20) == pytest.approx(run(fine, 1e-3, 1000), abs=1e-8)


def test_torque_is_seen_before_and_after_an_event(instances):
    instance = started(instances, tolerance=1e-9, **R1)
    seen = []
    run(
        instance, 0.01, 10, lambda: seen.append((instance.get("contact_mode"), instance.get("output_torque")))
    )
    opened, jumps = [], []
    for (mode, before), (next_mode, after) in zip(seen[::2], seen[1::2], strict=True):
        if (mode, next_mode) == (DRIVING, FREE):
            opened.append(before)
        if next_mode == DRIVING:
            jumps.append(after - before)
    # The output freewheel opens at zero torque and closes with a jump.
    assert len(opened) > 1
    assert max(map(abs, opened)) < 1e-3
    assert max(jumps) > 1.0


@pytest.mark.parametrize("settings", [{}, BY_TORQUE], ids=["speed", "torque"])
def test_a_host_may_go_on_without_event_mode(instances, settings):
    settings = {**R1, "drive_torque": 30.0, **settings}
    passing, ignoring = (started(instances, event_mode=mode, **settings) for mode in (True, False))
    assert run(passing, 0.01, 20) == run(ignoring, 0.01, 20, event_mode=False)
    assert passing.all_values() == ignoring.all_values()
    # An instance with event mode that ignores events.
    careless = started(instances, **settings)
    run(careless, 0.01, 20, handle=lambda instance: None)
    assert careless.get("omega_out") == passing.get("omega_out")


@pytest.mark.parametrize("early", [False, True])
@pytest.mark.parametrize("level", LEVELS)
def test_discrete_values_change_in_event_mode_only_and_only_events_return_early(
    instances, description, level, early
):
    discrete = [v for v in description.modelVariables if v.variability == "discrete"]
    names = [v.name for v in discrete if v.causality not in ("input", "parameter")]
    assert names == ["housing_engagements", "output_engagements", "contact_mode", "contact_switches"]
    settings = {"tolerance": 1e-9, **R1, "drive_torque": 30.0, **LEVELS[level]}
    instance = instances(eventModeUsed=True, earlyReturnAllowed=early).start(**settings)
    plain = instances().start(**settings)
    pass_event(instance)
    changes = returns = 0
    for n in range(1, 101):
        reached = (n - 1) * 1e-3
        plain.step(n * 1e-3 - reached)
        while reached < n * 1e-3:
            held = [instance.get(name) for name in names]
            event, ends, returned, reached = instance.fmu.doStep(reached, n * 1e-3 - reached)
            assert not ends
            returns += returned
            assert [instance.get(name) for name in names] == held
            if event:
                handle_event(instance)
            assert event == ([instance.get(name) for name in names] != held)
            changes += event
        # Without early return a switch is an event at the end of the step.
        assert early or instance.all_values() == plain.all_values()
    assert (changes > 0) == (not level.startswith(("kinematic", "averaged")))
    assert (returns > 5) == (early and level in BY_EVENTS)
    # Events change nothing beyond the tolerance.
    for name in ("omega2", "omega_out", "input_speed", "energy_in", "energy_out"):
        assert instance.get(name) == pytest.approx(plain.get(name), rel=1e-5, abs=1e-4), name
    assert instance.get("contact_switches") == pytest.approx(plain.get("contact_switches"), abs=1)
    if level in BY_EVENTS:
        assert abs(instance.get("energy_residual")) < 1e-5 * instance.get("energy_in")


@pytest.mark.parametrize("early", [False, True])
def test_state_includes_a_pending_event(instances, early):
    modes = {"eventModeUsed": True, "earlyReturnAllowed": early}
    instance, other = (instances(**modes).start(**R1) for _ in range(2))
    pass_event(instance)
    before, reached = instance.get("contact_mode"), 0.0
    while not (event := instance.fmu.doStep(reached, 1e-3))[0]:
        *_, reached = event
    *_, returned, reached = event
    assert returned == early
    other.restore(instance.saved())
    for each in (instance, other):
        assert each.get("contact_mode") == before
        handle_event(each)
        assert each.get("contact_mode") != before
        each.fmu.doStep(reached, 0.01)
    values = instance.all_values()
    assert values == other.all_values()
    instance.fmu.terminate()
    assert instance.all_values() == values


def test_parameters_and_inputs_may_change_at_an_event(instances):
    instance = started(instances, **R1)
    *_, reached = instance.fmu.doStep(0.0, 0.1)
    instance.fmu.enterEventMode()
    instance.set(input_friction=0.5, load_torque=20.0, omega1=90.0)
    pass_event(instance)
    *_, reached = instance.fmu.doStep(reached, 0.1 - reached)
    assert instance.get("input_speed") == 90.0
    assert instance.get("energy_lost_viscous") > 0.0
    assert abs(instance.get("energy_residual")) < 1e-5


def test_intermediate_update_reports_every_switch_without_changing_the_run(instances):
    seen = []
    holder = []

    def update(_, time, set_requested, get_allowed, finished, can_return, __, ___):
        assert (bool(set_requested), bool(get_allowed), bool(can_return)) == (False, True, False)
        assert holder[0].fmu.getFloat64([holder[0].clock]) == [time]
        message = holder[0].rejection(lambda: holder[0].set(omega1=50.0))
        assert (
            message
            == "setting omega1 is allowed only between steps (the instance is in an intermediate update)"
        )
        message = holder[0].rejection(holder[0].fmu.terminate)
        assert (
            message == "terminate is allowed only between steps (the instance is in an intermediate update)"
        )
        seen.append((time, bool(finished), holder[0].get("contact_mode")))

    watched, plain = instances(intermediateUpdate=update).start(**R1), instances().start(**R1)
    holder.append(watched)
    for _ in range(20):
        count = len(seen)
        before = watched.get("contact_mode")
        watched.step(0.01)
        plain.step(0.01)
        assert {mode for *_, mode in seen[count:]} == {before}
    assert watched.all_values() == plain.all_values()
    times = run(started(instances, **R1), 0.01, 20)
    assert [time for time, finished, _ in seen if not finished] == pytest.approx(times, abs=1e-12)
    assert [time for time, finished, _ in seen if finished] == pytest.approx(np.arange(1, 21) * 0.01)


def times_of_updates(instances, step, **settings):
    """Return the times of the intermediate updates within a step, and True if the step succeeds."""
    times = []

    def update(_, time, *modes):
        if not modes[2]:  # Test the flag for a finished step.
            times.append(time)

    return times, not instances(intermediateUpdate=update).start(**R1, **settings).is_discarded(step)


def test_intermediate_updates_are_distributed_over_a_long_step(instances):
    times, is_taken = times_of_updates(instances, 100.0)  # The run has some 12,000 switches.
    assert is_taken
    assert 1500 < len(times) <= 2000
    first = times_of_updates(instances, 1.0)[0]
    assert times[: len(first)] == pytest.approx(first, abs=1e-9)
    assert max(np.diff(times)) < 0.2


def test_a_rejected_step_makes_no_intermediate_update(instances):
    assert times_of_updates(instances, 1.0, max_step=1e-9) == ([], False)


def test_adjoint_derivatives_are_the_transposed_of_the_directional_ones(instances):
    instance = instances().start(**R1)
    instance.step(0.01)
    outputs, inputs = ("omega_out", "input_torque_mean", "output_torque_mean"), ("omega1", "load_torque")
    unknowns, knowns = ([instance.references[name] for name in names] for names in (outputs, inputs))
    columns = np.array(
        [instance.fmu.getDirectionalDerivative(unknowns, [variable], [1.0]) for variable in knowns]
    )
    for seed in ([1.0, 0.0, 0.0], [0.3, -2.0, 5.0]):
        adjoint = instance.fmu.getAdjointDerivative(unknowns, knowns, seed, nSensitivity=2)
        assert adjoint == pytest.approx(columns @ seed, rel=1e-12)
    instance.rejection(lambda: instance.fmu.getAdjointDerivative(knowns, unknowns, [1.0, 1.0]), fmi3Error)


@pytest.mark.parametrize("event_mode", [False, True])
def test_modes_follow_each_other_in_order_only(instances, event_mode):
    instance = started(instances, event_mode=event_mode, **R1)
    assert "is allowed only in event mode" in instance.rejection(instance.fmu.enterStepMode)
    assert "is allowed only in event mode" in instance.rejection(instance.fmu.updateDiscreteStates)
    if not event_mode:
        assert "with eventModeUsed = true" in instance.rejection(instance.fmu.enterEventMode)
        return
    instance.fmu.enterEventMode()
    message = instance.rejection(lambda: instance.fmu.doStep(0.0, 0.01))
    assert message == "doStep is allowed only in step mode (the instance is in event mode)"
    instance.rejection(lambda: instance.set(output_friction=-1.0), fmi3Discard)


def test_unsupported_functions_are_rejected_by_name(instance):
    instance.start(**R1)
    fmu = instance.fmu
    assert "no variables of type Float32" in instance.rejection(lambda: fmu.getFloat32([0]))
    assert "EvaluateDiscreteStates is not supported" in instance.rejection(
        lambda: fmu.fmi3EvaluateDiscreteStates(fmu.component)
    )
    assert "the number of values must be 1, " in instance.rejection(lambda: fmu.getFloat64([0], nValues=2))
