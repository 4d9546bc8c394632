"""Test DrivenShaft with multiple precision, at ordinary and extreme parameters.

The exact solution uses the matrix exponential, and integrals of quadratic forms for the energies.
"""

import math

import mpmath
import numpy as np
import pytest
from differences import assert_rates

from inertia_module.model import DrivenShaft

# J4, c, d, f: limits of the ranges, and ordinary shafts in each damping regime.
SHAFTS = {
    "undamped": (0.5, 400.0, 0.0, 0.0),
    "underdamped": (0.5, 400.0, 0.05, 0.1),
    "nearly critical": (0.5, 400.0, 2.0 * math.sqrt(200.0) * (1.0 - 1e-13), 0.0),
    "critical": (0.25, 400.0, 10.0, 10.0),
    "just overdamped": (0.5, 400.0, 2.0 * math.sqrt(200.0) * (1.0 + 1e-9), 0.0),
    "overdamped": (0.5, 400.0, 30.0, 400.0),
    "stiff": (0.5, 1e8, 1e3, 0.2),
    "stiff, hardly damped": (0.5, 1e8, 0.05, 0.0),
    "soft": (0.5, 1e-2, 1e-9, 0.0),
    "soft and dragged": (0.5, 1e-2, 1e5, 0.0),
    "braked": (0.5, 400.0, 0.05, 1e5),
    "light": (1e-9, 400.0, 0.05, 0.1),
    "heavy": (1e5, 400.0, 0.05, 0.1),
    "light and dragged": (1e-9, 1e8, 1e5, 1e5),
}
TORQUES = ("shaft_torque", "shaft_torque_mean")
ENERGIES = ("energy_in", "energy_out", "energy_lost")


def flow_of(linear, forms, h):
    """Return exp(linear h), and for each form M the integral of exp(linear t)' M exp(linear t) over h.

    Scaling and squaring: the Taylor series over a short part of h has all digits with 20 terms.
    """
    doublings = max(0, math.ceil(mpmath.log(h * abs(linear).max(), 2)) + 20)
    part = h / 2**doublings
    flow, integrals = np.eye(4, dtype=object), [0 * form for form in forms]
    term, slopes = flow, forms
    for n in range(1, 21):
        term = term @ linear * (part / n)
        flow = flow + term
        slopes = [slope * (part / n) for slope in slopes]
        integrals = [integral + slope for integral, slope in zip(integrals, slopes, strict=True)]
        slopes = [linear.T @ slope + slope @ linear for slope in slopes]
    for _ in range(doublings):
        integrals = [integral + flow.T @ integral @ flow for integral in integrals]
        flow = flow @ flow
    return flow, integrals


def exact(J, c, d, f, beta, hub, slope, load, twist, omega4, h):
    """Return all results at the end of a step of constant slope by name, without an initial jump."""
    with mpmath.workdps(100):
        J, c, d, f, beta, hub, slope, load, h = map(mpmath.mpf, (J, c, d, f, beta, hub, slope, load, h))
        # Rows over the linear state: twist, speed of the driven mass, time, constant 1.
        speed, hub_speed, unit = [0, 1, 0, 0], [0, 0, slope, hub], [0, 0, 0, 1]
        slip, torque = [0, -1, slope, hub], [c, -d, d * slope, d * hub]
        rate = [c / J, -(d + f) / J, d * slope / J, (d * hub - load) / J + beta * slope]
        of = np.outer
        lost = d * of(slip, slip) + f * of(speed, speed) - beta * J * slope * of(speed, unit)
        forms = [of(torque, unit), of(torque, hub_speed), load * of(speed, unit), lost]
        flow, integrals = flow_of(np.array([slip, rate, unit, [0] * 4]), forms, h)
        begin = np.array([mpmath.mpf(twist), mpmath.mpf(omega4), 0, 1])
        state = flow @ begin
        momentum, work, out, lost = (begin @ integral @ begin for integral in integrals)
        return {
            "twist": state[0],
            "omega_out": state[1],
            "shaft_torque": torque @ state,
            "driven_acceleration": rate @ state,
            "shaft_torque_mean": momentum / h,
            "energy_in": work,
            "energy_out": out,
            "energy_lost": lost,
        }


def made(kernel, shaft, **values):
    """Return one of SHAFTS, started."""
    names = ("driven_inertia", "shaft_stiffness", "shaft_damping", "driven_friction")
    return DrivenShaft(kernel).start(**dict(zip(names, SHAFTS[shaft], strict=True)), **values)


@pytest.mark.parametrize("shaft", SHAFTS)
@pytest.mark.parametrize("h", [1e-9, 1e-3, 0.1, 1000.0])
def test_motion_torque_and_energies_are_exact(compiled, shaft, h):
    J, c, d, f = SHAFTS[shaft]
    if math.sqrt(c / J) * h > 1e6 and d + f < 1e-3 * math.sqrt(c * J):
        h = 1e6 * math.sqrt(J / c)  # A double cannot represent the phase beyond this.
    beta, hub, slope, load = 0.4, 30.0, 7.0, 12.0
    # A step of 1 s at constant speed sets the slope. The start is its end with the following jump.
    inputs = {"balancer": beta, "input_hold": 1, "hub_speed": hub - slope, "load_torque": load}
    model = made(compiled, shaft, **inputs, omega_out_start=29.0, twist_start=0.01)
    model.advance(1.0)
    before = model.read(ENERGIES)
    omega4, twist = model["omega_out"] + beta * slope, model["twist"]
    pushed = -J * beta * slope * (model["omega_out"] + 0.5 * beta * slope)
    model.set(hub_speed=hub)
    model.advance(h)
    actual, expected = model.snapshot(), exact(J, c, d, f, beta, hub, slope, load, twist, omega4, h)
    for name, earlier, jump in zip(ENERGIES, before, (0.0, 0.0, pushed), strict=True):
        actual[name] -= earlier + jump
    phase = 1.0 + math.sqrt(c / J) * h * (d + f < 2.0 * math.sqrt(c * J))
    # Errors are at rounding level of the largest value of the same kind in this or the previous step.
    speed = max(30.0 + 7.0 * h, abs(actual["omega_out"]))
    torque = max(abs(c * actual["twist"]), *(abs(actual[name]) for name in TORQUES), 12.0 + J)
    energy = max(
        *(abs(actual[name]) for name in actual if name.startswith("energy")), *map(abs, before), 1e-9
    )
    scales = {
        "twist": max(abs(actual["twist"]), 0.01 if c < 1e9 else 0.0),
        "omega_out": speed,
        "shaft_torque": torque,
        "shaft_torque_mean": torque,
        "driven_acceleration": (torque + f * speed) / J,
        **dict.fromkeys(ENERGIES, energy),
    }
    for name, value in expected.items():
        assert abs(actual[name] - float(value)) <= 1e-14 * phase * scales[name], name
    assert abs(actual["energy_residual"]) <= 1e-14 * phase * energy


@pytest.mark.parametrize("h", [1e-9, 5e-4, 0.1])
def test_ramp_from_rest_is_exact(compiled, h):
    """Larger energies do not hide the friction loss of the first twist."""
    shaft = {"driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.0, "driven_friction": 20.0}
    model = DrivenShaft(compiled).start(**shaft)
    model.set_rates(hub_speed=7.0)
    model.advance(h)
    for name, value in exact(*shaft.values(), 0.0, 0.0, 7.0, 0.0, 0.0, 0.0, h).items():
        assert model[name] == pytest.approx(float(value), rel=1e-13, abs=0.0), name


@pytest.mark.parametrize("damping", [0.05, 10.0, 300.0])
def test_twist_and_torque_keep_their_digits_after_a_huge_hub_speed(compiled, damping):
    """The fully balanced driven mass follows; the difference of two huge speeds is small."""
    shaft = DrivenShaft(compiled).start(shaft_damping=damping, balancer=1.0, input_hold=1)
    shaft.advance(2.0**-17)
    with mpmath.workdps(60):
        twist, omega4, end = mpmath.mpf(0), mpmath.mpf(0), mpmath.mpf(0)
        for hub, slope, h in ((0.3, 0.3 * 2.0**17, 0.5), (0.2, (0.2 - 0.3) / 0.5, 1e-3)):
            shaft.set(hub_speed=hub, load_torque=5.0)
            shaft.advance(h)
            omega4 += hub - end
            right = exact(0.5, 400.0, damping, 0.0, 1.0, hub, slope, 5.0, twist, omega4, h)
            twist, omega4, end = right["twist"], right["omega_out"], hub + mpmath.mpf(slope) * h
    for name in ("twist", "shaft_torque", "driven_acceleration"):
        assert shaft[name] == pytest.approx(float(right[name]), rel=1e-13), name


@pytest.mark.parametrize("shaft", ["underdamped", "critical", "overdamped"])
def test_rates_of_the_outputs(compiled, shaft):
    def after(t):
        model = made(compiled, shaft, balancer=0.4)
        model.set_rates(hub_speed=7.0)
        model.advance(0.2 + t)
        return model

    rates = after(0.0).rates()
    assert rates.pop("shaft_torque_mean") == 0.0
    assert_rates(list(rates.values()), lambda t: [after(t)[name] for name in rates])


WALK = ["undamped", "underdamped", "critical", "overdamped", "stiff, hardly damped", "soft", "light"]


@pytest.mark.parametrize("shaft, steps", [*((name, 2**14) for name in WALK), ("underdamped", 2**17)])
def test_many_tiny_steps_equal_a_long_step(compiled, shaft, steps):
    def end(count):
        module = made(
            compiled, shaft, hub_speed=20.0, load_torque=7.0, omega_out_start=19.0, twist_start=1e-3
        )
        means = []
        for _ in range(count):
            module.advance(0.125 / count)
            means.append(module["shaft_torque_mean"] / count)
        return module, math.fsum(means)

    long, torque = end(1)
    short, mean = end(steps)
    inertia, stiffness, _, _ = SHAFTS[shaft]
    phase = 1.0 + 0.125 * math.sqrt(stiffness / inertia)
    # The phase of the oscillation has a rounding error.
    close = 1e-13 + 4e-16 * phase
    peak = stiffness * max(abs(long["twist"]), 1e-3)
    assert short["omega_out"] == pytest.approx(long["omega_out"], abs=close * 30.0 * max(1.0, phase))
    assert short["twist"] == pytest.approx(long["twist"], abs=close * peak / stiffness)
    assert mean == pytest.approx(torque, abs=close * peak)
    for energy in ENERGIES:
        largest = max(abs(long["energy_in"]), long["energy_stored"])
        assert short[energy] == pytest.approx(long[energy], abs=close * largest), energy
