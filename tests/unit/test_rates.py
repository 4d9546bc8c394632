"""Test each rate of the kernel with differences at random states.

The rates determine the dense output of the event indicators, and the contact mode after a tie. A wrong rate
causes more steps, or has an effect only in rare motions. test_averaged_map.py tests rates of fidelity
averaged, test_angles.py rates of the inertia, and test_multibody.py the motion of the imbalance.
"""

import random
from itertools import product

import pytest
from differences import difference
from scenes import ENGINE, FRICTION, LAYOUTS, SCENES, make_step, started

from inertia_module.interface.records import record_type
from inertia_module.kernel.codes import DRIVING, FREE, HELD, HELD_DRIVING
from inertia_module.kernel.equations.choice import select_mode
from inertia_module.kernel.equations.states import LOCKED, OVERRUNNING
from inertia_module.kernel.events.advance import begin_step
from inertia_module.kernel.events.guards import fitted_guard
from inertia_module.kernel.events.stages import evaluate_stages, exact_guard
from inertia_module.kernel.fields import WORKSPACE
from inertia_module.kernel.links import prescribed_at_input
from inertia_module.kernel.tableau import DOP853_LAST_STAGE, DOP853_ROW, N_STAGES, fit_dense_output
from verification.stability.motion import solve_at

MODES = [HELD, FREE, DRIVING, HELD_DRIVING]
# Phase of the highest harmonic in a step, rad. In such a step the dense output is as accurate as differences.
PHASE = 0.2


@pytest.fixture(params=enumerate(product(LAYOUTS.values(), [{}, ENGINE])), ids=lambda _: "")
def values(request):
    """Return a mechanism with a number of satellites, speed- or torque-driven."""
    number, (mechanism, drive) = request.param
    inertias = {"drive_inertia": 0.002, "link2_inertia": 0.02, "output_inertia": 0.03, "driven_inertia": 0.05}
    inertias |= {"satellite_inertia": 0.004, "satellite_transverse_inertia": 0.003}
    return {**mechanism, "satellites": 1 + number % 3, **inertias, **FRICTION, **drive}


@pytest.fixture
def chance(request):
    """Return a source of random numbers with a seed for each test."""
    return random.Random(request.node.name)


def random_motion(chance):
    """Return (q, omega1, omega2, input, torque, its rate) with speeds of about 1 rad/s."""
    return chance.uniform(-7.0, 7.0), *(chance.uniform(-2.0, 2.0) for _ in range(5))


def in_mode(values, mode, chance):
    """Return a module at a random state of this contact mode, and an empty workspace."""
    module = started("plain", values)
    x, d = module.state, module.derived
    x.mode = mode
    x.q, x.omega1, x.omega2, prescribed, x.load_torque, _ = random_motion(chance)
    x.alpha1 = x.drive_torque = prescribed
    x.omega2 = 0.0 if mode in (HELD, HELD_DRIVING) else abs(x.omega2)
    x.omega3 = x.omega2 if mode in (DRIVING, HELD_DRIVING) else x.omega2 + chance.uniform(0.1, 2.0)
    x.twist, x.relative = chance.uniform(-0.1, 0.1), chance.uniform(-1.0, 1.0)
    w = record_type(WORKSPACE)()
    w.prescribed = prescribed_at_input(d, x)
    w.load = x.load_torque
    return d, x, w, PHASE / (d.harmonic * d.k * (1.0 + abs(x.omega1) + abs(x.omega2)))


@pytest.mark.parametrize("mode", MODES)
def test_dense_output_of_the_indicators_agrees_with_the_equations_of_motion(values, chance, mode):
    d, x, w, step = in_mode(values, mode, chance)
    x.housing_state = LOCKED if mode in (HELD, HELD_DRIVING) else OVERRUNNING
    x.output_state = LOCKED if mode in (DRIVING, HELD_DRIVING) else OVERRUNNING
    x.slip_sign, x.rates_cached = 1.0, 0.0
    begin_step(d, x, w)
    make_step(d, x, w, DOP853_ROW, step)
    evaluate_stages(d, x, w, DOP853_LAST_STAGE + 1, N_STAGES - 1)
    for which in range(2):
        fit_dense_output(w.step, w.indicators[which].rate, w.indicators[which].dense)
        for sigma in (0.2, 0.5, 0.8):
            value = exact_guard(d, x, w, which, sigma)
            assert fitted_guard(x, w, which, sigma) == pytest.approx(value, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_tie_is_decided_by_the_rate_of_the_mesh_torque(chance, sign):
    # At q = 0 the mesh torque is 0. It then increases or decreases with the sign of omega1.
    module = started("plain", SCENES["bevel"], omega1=0.0)
    d, x = module.derived, module.state
    x.q = 0.0
    x.omega1 = 100.0 * sign
    x.alpha1 = x.load_torque = 0.0
    speeds = {"omega1": x.omega1, "omega2": 0.0}
    rate = difference(lambda t: solve_at(module, True, False, q=d.k * x.omega1 * t, **speeds).mesh)
    select_mode(d, x, 0.0)
    assert x.mode == (DRIVING if rate > 0.0 else HELD_DRIVING)
