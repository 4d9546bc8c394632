"""One long step of DrivenShaft is many short ones; the audit of energy closes to rounding."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from inertia_module.memory import DrivenShaft

WALK = {
    "underdamped": {"shaft_damping": 0.05, "driven_friction": 0.1},
    "critical": {"shaft_damping": 2.0 * math.sqrt(200.0)},
    "overdamped": {"shaft_damping": 300.0, "driven_friction": 2.0},
    "undamped and stiff": {"shaft_stiffness": 1e9, "shaft_damping": 0.0},
    "stiff": {"shaft_stiffness": 1e15},
    "soft": {"shaft_stiffness": 1e-6, "shaft_damping": 0.0},
    "light": {"driven_inertia": 1e-12, "shaft_damping": 0.0, "driven_friction": 1e-9},
}


@pytest.mark.parametrize("name, steps", [*((name, 2**14) for name in WALK), ("underdamped", 2**20)])
def test_many_tiny_steps_are_one_long_step(compiled, name, steps):
    def end(count):
        shaft = DrivenShaft(compiled).start(
            **WALK[name], hub_speed=20.0, load_torque=7.0, omega_out_start=19.0, twist_start=1e-3
        )
        means = []
        for _ in range(count):
            shaft.advance(0.125 / count)
            means.append(shaft["shaft_torque_mean"] / count)
        return shaft, math.fsum(means)

    long, torque = end(1)
    short, mean = end(steps)
    settings = {"driven_inertia": 0.5, "shaft_stiffness": 400.0} | WALK[name]
    phase = 1.0 + 0.125 * math.sqrt(settings["shaft_stiffness"] / settings["driven_inertia"])
    # doubles know a swing to rounding of its phase
    close = 1e-13 + 4e-16 * phase
    peak = settings["shaft_stiffness"] * max(abs(long["twist"]), 1e-3)
    assert short["omega_out"] == pytest.approx(long["omega_out"], abs=close * 30.0 * max(1.0, phase))
    assert short["twist"] == pytest.approx(long["twist"], abs=close * peak / settings["shaft_stiffness"])
    assert mean == pytest.approx(torque, abs=close * peak)
    for energy in ("energy_in", "energy_out", "energy_lost"):
        largest = max(abs(long["energy_in"]), long["energy_stored"])
        assert short[energy] == pytest.approx(long[energy], abs=close * largest), energy


def test_speed_and_twist_do_not_drift_over_a_million_steps_at_rest(compiled):
    """Under a steady load at steady speed nothing moves, whatever the number of steps."""
    shaft = DrivenShaft(compiled).start(
        hub_speed=20.0, load_torque=7.0, omega_out_start=20.0, twist_start=7.0 / 400.0
    )
    for _ in range(10**6):
        shaft.advance(1e-4)
    assert shaft["omega_out"] == pytest.approx(20.0, rel=1e-15)
    assert shaft["twist"] == pytest.approx(7.0 / 400.0, rel=1e-15)
    assert shaft["energy_out"] == pytest.approx(7.0 * 20.0 * 100.0, rel=1e-14)
    assert abs(shaft["energy_residual"]) < 1e-15 * shaft["energy_in"]


def powers(low, high):
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


SIGNED = st.one_of(
    st.just(0.0), st.tuples(st.sampled_from((-1.0, 1.0)), powers(-6.0, 5.0)).map(lambda p: p[0] * p[1])
)


@given(
    inertia=powers(-12, 12),
    stiffness=powers(-6, 15),
    damping=st.one_of(st.just(0.0), powers(-12, 12)),
    friction=st.one_of(st.just(0.0), powers(-12, 12)),
    balancer=st.sampled_from((0.0, 1.0, -2.5)),
    hold=st.sampled_from((0, 1)),
    steps=st.lists(st.tuples(powers(-9, 3), SIGNED, SIGNED), min_size=1, max_size=5),
)
def test_energy_audit_closes_to_rounding_at_every_extreme(
    inertia, stiffness, damping, friction, balancer, hold, steps
):
    shaft = DrivenShaft("compiled").start(
        driven_inertia=inertia,
        shaft_stiffness=stiffness,
        shaft_damping=damping,
        driven_friction=friction,
        balancer=balancer,
        input_hold=hold,
    )
    largest = 0.0
    slope, last, before = 0.0, 0.0, (0.0, 0.0)
    speed = 0.0
    for h, hub, load in steps:
        shaft.set(hub_speed=hub, load_torque=load)
        old = shaft["omega_out"]
        shaft.advance(h)
        if hold and before[1] > 0.0:
            slope = (hub - before[0]) / before[1]
        # the balancer's work and what damping makes of it may cancel: both count
        push = abs(balancer) * (abs(hub - last) + abs(slope) * h)
        speed = max(abs(old), abs(shaft["omega_out"])) + push
        names = ("energy_in", "energy_out", "energy_lost", "energy_stored")
        largest = max(largest, inertia * push * speed, *(abs(shaft[name]) for name in names))
        last, before = hub + slope * h, (hub, h)
    assert all(math.isfinite(value) for value in shaft.snapshot().values())
    assert abs(shaft["energy_residual"]) <= 1e-11 * largest


@given(
    damping=st.floats(0.0, 100.0),
    friction=st.floats(0.0, 100.0),
    balancer=st.floats(-1.0, 2.0),
    speeds=st.lists(st.floats(-50.0, 50.0), min_size=2, max_size=8),
)
def test_damping_and_friction_only_lose(damping, friction, balancer, speeds):
    """With the hub's speed held, what is lost falls only where the balancer pushes, at a jump."""
    shaft = DrivenShaft("plain").start(
        shaft_damping=damping, driven_friction=friction, balancer=balancer, hub_speed=speeds[0]
    )
    for speed in speeds:
        old, before, hub = shaft["omega_out"], shaft["energy_lost"], shaft["hub_speed"]
        shaft.set(hub_speed=speed)
        shaft.advance(0.07)
        push = balancer * (speed - hub)
        work = 0.5 * push * (old + 0.5 * push)
        assert shaft["energy_lost"] - before >= -work - 1e-9 * (1.0 + abs(work) + abs(before))
