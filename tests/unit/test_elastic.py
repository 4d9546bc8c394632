"""Fidelity `elastic`: hub, shaft and driven mass behind the output freewheel; any stiffness, any damping."""

import itertools
import math

import numpy as np
import pytest
from scenes import ELASTIC, REFERENCE, advanced, started

from inertia_module.contract.records import record_type
from inertia_module.kernel import fields
from inertia_module.kernel.events import advance, rosenbrock, stages
from inertia_module.kernel.links import slowest_rate
from inertia_module.kernel.tableau import LONG

# damping over the critical one
DAMPINGS = {"undamped": 0.0, "underdamped": 0.1, "critical": 1.0, "overdamped": 10.0}


def damping(stiffness, share, hub=0.02, driven=0.5):
    """Damping that is this share of the critical one, N m s/rad."""
    return 2.0 * share * math.sqrt(stiffness / (1.0 / hub + 1.0 / driven))


@pytest.mark.parametrize("share", [0.1, 1.1, 3.0, 100.0])
def test_slowest_rate_is_that_of_the_slowest_eigenvalue(share):
    d, compliance = started("plain", ELASTIC, shaft_damping=damping(400.0, share)).derived, 1.0 / 0.02
    mobility = compliance + 1.0 / ELASTIC["driven_inertia"]
    slowest = min(abs(np.roots([1.0, d.shaft_damping * mobility, d.shaft_stiffness * mobility])))
    assert slowest_rate(d, compliance) == pytest.approx(slowest, rel=1e-9)


@pytest.mark.parametrize("share", DAMPINGS.values(), ids=DAMPINGS)
@pytest.mark.parametrize("stiffness", [1e10, 1e12, 1e15])
def test_a_stiff_shaft_costs_no_small_steps(compiled, scene, share, stiffness):
    shaft = {"shaft_stiffness": stiffness, "shaft_damping": damping(stiffness, share)}
    stiff = advanced(started(compiled, scene, ELASTIC, shaft), 0.5)
    # without damping the swing that the load makes in the beginning is followed until the hub moves, with all
    # the times that the freewheel lets it go
    swings = stiffness == 1e10 and share == 0.0
    assert stiff["rhs_evaluations"] < (6e4 if swings else 1.5e4)
    whole = started(compiled, scene, output_inertia=0.52)
    assert stiff["omega_out"] == pytest.approx(advanced(whole, 0.5)["omega_out"], rel=2e-5)


@pytest.mark.parametrize("balancer", [-0.5, 0.4, 0.9])
def test_the_work_of_the_balancer_is_in_the_audit(compiled, balancer):
    module = started(compiled, REFERENCE, ELASTIC, balancer=balancer, tolerance=1e-9)
    for n in range(30):
        advanced(module, 0.01, omega1=100.0 + 20.0 * (n % 2))  # jumps pass through it as well
        assert abs(module["energy_residual"]) < 1e-6 * module["energy_in"]


@pytest.mark.parametrize("light", ["output_inertia", "driven_inertia"])
@pytest.mark.parametrize("inertia", [1e-3, 1e-6, 1e-12])
@pytest.mark.parametrize("share", [0.1, 1.0, 10.0])
def test_light_ends_of_the_shaft_are_finite_and_cost_no_small_steps(compiled, light, inertia, share):
    ends = {"output_inertia": 0.3, "driven_inertia": 0.3, light: inertia}
    critical = damping(400.0, share, ends["output_inertia"], ends["driven_inertia"])
    module = started(compiled, REFERENCE, ELASTIC, ends, shaft_damping=critical)
    advanced(module, 0.3)
    assert all(math.isfinite(value) for value in module.snapshot().values())
    assert module["rhs_evaluations"] < 6e4
    assert abs(module["energy_residual"]) < 1e-4 * module["energy_in"]


@pytest.mark.parametrize("drag", [5e-3, 100.0], ids=["swinging", "overdamped"])
@pytest.mark.parametrize("stiffness", [40.0, 400.0, 1e4, 1e7])
@pytest.mark.parametrize("hub", [1e-4, 1e-3, 0.1])
def test_the_twist_of_a_shaft_pulled_by_its_load_follows_tolerance(compiled, drag, stiffness, hub):
    """A shaft between free masses, the driven one of 1 kg m^2, 0.1 s after a load pulls there from rest."""
    shaft = {
        "output_inertia": hub,
        "driven_inertia": 1.0,
        "shaft_stiffness": stiffness,
        "shaft_damping": drag,
    }
    mobility = 1.0 / hub + 1.0
    fast, slow = np.roots([1.0, drag * mobility, stiffness * mobility])
    left = (fast * np.exp(0.1 * slow) - slow * np.exp(0.1 * fast)) / (fast - slow)
    twist = -10.0 / (stiffness * mobility) * (1.0 - left.real)
    for tolerance, steps in itertools.product((1e-4, 1e-6, 1e-8), (1, 10)):
        module = started(compiled, ELASTIC, shaft, load_torque=-10.0, tolerance=tolerance)
        advanced(module, *[0.1 / steps] * steps)
        # what swings is known to its phase
        scale = abs(twist) if drag == 100.0 else module["omega_out"] / abs(slow)
        assert abs(module["shaft_twist"] - twist) <= 30.0 * tolerance * scale


def test_a_shaft_that_has_come_to_rest_costs_little(compiled):
    module = advanced(started(compiled, REFERENCE, ELASTIC, omega1=0.0), 1000.0)
    assert module["shaft_twist"] == pytest.approx(10.0 / 400.0, rel=1e-6)
    assert module["rhs_evaluations"] < 1e5


# --- the stiff step: Rosenbrock's pair, where it is taken and what it leaves out ---


MOTION = ("q", "omega2", "omega3", "twist", "relative", "drive", "work_in", "square")


def driving(scene):
    """Constants, state and an empty workspace at a moment at which link 2 drives the shaft."""
    module = advanced(started("plain", scene, ELASTIC, tolerance=1e-9), 0.005)
    d, x = module.derived, module.state
    w = record_type(fields.WORKSPACE)()
    w.prescribed = x.drive_torque if d.by_torque else x.alpha1
    w.load = x.load_torque
    assert x.output_state == 1.0
    return d, x, w


def stiff_step(scene, h, part):
    """Changes over this part of a stiff step h."""
    d, x, w = driving(scene)
    advance.begin_step(d, x, w)
    rosenbrock.differentiate(d, x, w)
    rosenbrock.make_stiff_step(d, x, w, h)
    rosenbrock.set_part(d, x, w, part)
    return np.array([getattr(w.change, name) for name in MOTION])


def test_weights_of_sums_are_those_that_the_stages_give_what_nothing_depends_on():
    a, c = (np.reshape(table, (8, 7)) for table in (rosenbrock.A, rosenbrock.C))
    by_rates = np.linalg.inv(np.eye(8) / rosenbrock.GAMMA - np.pad(c, ((0, 0), (0, 1))))
    found = np.delete(np.reshape(rosenbrock.SUMS, (2, 11)), [1, 2, 3], axis=1)
    assert found == pytest.approx(np.array([np.append(a[-1], 1.0) @ by_rates, by_rates[-1]]), abs=1e-12)


def exact_step(scene, h):
    """Changes by the explicit pair, in sixteen steps."""
    d, x, w = driving(scene)
    total = np.zeros(len(MOTION))
    for _ in range(16):
        x.rates_cached = 0.0
        advance.begin_step(d, x, w)
        stages.make_step(d, x, w, LONG, h / 16)
        total += [getattr(w.change, name) for name in MOTION]
        for name in ("q", "theta1", "omega1", "omega2", "omega3", "twist", "relative"):
            setattr(x, name, getattr(x, name) + getattr(w.change, name))
    return total


@pytest.mark.parametrize("part, order, count", [(1.0, 5, None), (0.4, 4, 5)], ids=["end", "inside"])
def test_a_stiff_step_is_of_its_order_in_all_that_is_followed(scene, part, order, count):
    lengths = [1e-3, 5e-4]
    errors = [abs(stiff_step(scene, h, part) - exact_step(scene, part * h))[:count] for h in lengths]
    scale = (abs(exact_step(scene, lengths[0])) + 1e-12)[:count]
    assert np.all(errors[0] < 1e-3 * scale)
    # of what errs at all, halving the step leaves no more than 2^-(order + 1), or nearly
    counted = errors[0] > 1e-11 * scale
    assert counted.any()
    assert np.median(np.log2(errors[0][counted] / errors[1][counted])) > order + 0.5
