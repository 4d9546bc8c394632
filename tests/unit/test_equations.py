"""Test equations of motion at an instant: mass matrix, signs of the mesh torques, power balance."""

import random

import numpy as np
import pytest
from differences import difference
from scenes import ALL_LOSSES, ELASTIC, ENGINE, GEARS, LAYOUTS, started

from inertia_module.kernel.codes import DRIVING, FREE, HELD, HELD_DRIVING
from inertia_module.kernel.equations.losses import FREEWHEEL, write_loss_powers
from inertia_module.kernel.equations.motion import evaluate, potential_energy, solve_links, solve_sticking
from inertia_module.kernel.equations.satellites import toggle_bit
from inertia_module.kernel.equations.states import LOCKED, OVERRUNNING, RATIO_PRESCRIBED
from inertia_module.kernel.inertia import reduced_inertia
from inertia_module.kernel.layout import imbalance_position
from inertia_module.kernel.links import kinetic_energy

MODES = [HELD, FREE, DRIVING, HELD_DRIVING]
INERTIAS = {"input_inertia": 0.5, "drive_inertia": 0.002, "link2_inertia": 0.02, "output_inertia": 0.03}


@pytest.fixture
def chance(request):
    return random.Random(request.node.name)


@pytest.mark.parametrize("is_held", [False, True])
@pytest.mark.parametrize("drive", [0, 1], ids=["speed", "torque"])
def test_links_solve_the_mass_matrix(chance, drive, is_held):
    module = started("plain", INERTIAS, drive=drive)
    d, x, m = module.derived, module.state, module.derived.machine
    x.housing_state = LOCKED if is_held else OVERRUNNING
    inertia1, inertia2, b, b_s, g_s = 1.3, 0.4, 0.07, 0.09, 0.2
    f_k, r1, r, r2, prescribed = 1.04 * d.k, *(chance.uniform(-5.0, 5.0) for _ in range(4))
    alpha1, alpha2, tau = solve_links(d, x, m, prescribed, inertia1, inertia2, b, b_s, g_s, f_k, r1, r, r2)
    k = d.k
    matrix = np.array(
        [
            [inertia1 + k * b + f_k * (b_s + k * g_s), -k * (b + f_k * g_s)],
            [-f_k * (b_s + k * g_s), inertia2 + f_k * k * g_s],
        ]
    )
    residual = matrix @ [alpha1, alpha2] - [prescribed - r1 - f_k * r, f_k * r - r2]
    assert tau == pytest.approx(r + b_s * alpha1 + g_s * k * (alpha1 - alpha2), rel=1e-12)
    if drive == 0:
        assert alpha1 == prescribed
    else:
        assert residual[0] == pytest.approx(0.0, abs=1e-12)
    if is_held:
        assert alpha2 == 0.0
    else:
        assert residual[1] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("load", [3.0, -40.0])
def test_sticking_links_have_the_friction_of_the_mesh_in_reserve(load):
    """At constant speed the reserve is (1 - eta) |M2| / k - |M2 / k + I' omega1^2 / 2|."""
    module = started("plain", INERTIAS, mesh_efficiency=0.9)
    d, x, m = module.derived, module.state, module.derived.machine
    x.housing_state, m.q, m.omega1, m.omega2 = OVERRUNNING, 0.7, 12.0, 12.0
    inertia = reduced_inertia(d, m.q)
    solve_sticking(d, x, m, 0.0, inertia, imbalance_position(d, m.q, 0.0), d.J2, load)
    required = abs(load / d.k + 0.5 * inertia[1] * m.omega1 * m.omega1)
    assert m.friction_reserve == pytest.approx(0.1 * abs(load) / d.k - required, rel=1e-12)


def test_prescribed_ratio_removes_the_row_of_link_2(chance):
    module = started("plain", INERTIAS)
    d, x, m = module.derived, module.state, module.derived.machine
    x.output_state, m.alpha2 = RATIO_PRESCRIBED, 2.5
    alpha1, alpha2, tau = solve_links(d, x, m, 4.0, 1.3, 0.4, 0.07, 0.09, 0.2, d.k, 1.0, 2.0, 3.0)
    assert (alpha1, alpha2) == (4.0, 2.5)
    assert tau == pytest.approx(2.0 + 0.09 * 4.0 + 0.2 * d.k * 1.5, rel=1e-14)


def evaluated(values, mode, chance):
    """Return a module whose machine is evaluated at a random motion in this contact mode."""
    module = started("plain", INERTIAS, values)
    d, x, m = module.derived, module.state, module.derived.machine
    x.housing_state = LOCKED if mode in (HELD, HELD_DRIVING) else OVERRUNNING
    x.output_state = LOCKED if mode in (DRIVING, HELD_DRIVING) else OVERRUNNING
    m.q, m.theta1, m.omega1 = (chance.uniform(-7.0, 7.0) for _ in range(3))
    m.omega2 = 0.0 if x.housing_state == LOCKED else chance.uniform(0.0, 5.0)
    m.omega3 = m.omega2 + (0.0 if x.output_state == LOCKED else chance.uniform(0.0, 5.0))
    m.twist, m.relative = chance.uniform(-0.01, 0.01), chance.uniform(-1.0, 1.0)
    x.slip_sign = 1.0 if m.omega1 >= m.omega2 else -1.0
    x.load_torque = chance.uniform(-5.0, 5.0)
    evaluate(d, x, chance.uniform(-5.0, 5.0), x.load_torque, False)
    x.flow_sign, x.tau6_signs = m.flow_sign, m.tau6_signs
    return module


def stored_energy_after(module, time):
    """Return the energy of the motion in the machine extrapolated by its rates, J."""
    d, x, m = module.derived, module.state, module.derived.machine
    omega1, omega2, omega3 = (
        speed + time * rate
        for speed, rate in ((m.omega1, m.alpha1), (m.omega2, m.alpha2), (m.omega3, m.alpha3))
    )
    q = m.q + time * d.k * (m.omega1 - m.omega2)
    x.q, x.theta1 = q, m.theta1 + time * m.omega1
    energy = kinetic_energy(d, q, omega1, omega2, omega3) + potential_energy(d, x)
    if d.elastic:
        twist = m.twist + time * m.relative
        omega4 = omega3 - (m.relative + time * m.rate_relative)
        energy += 0.5 * d.shaft_stiffness * twist * twist + 0.5 * d.J4 * omega4 * omega4
    return energy


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("output", [{}, ELASTIC], ids=["rigid", "elastic"])
@pytest.mark.parametrize("drive", [{}, ENGINE], ids=["speed", "torque"])
@pytest.mark.parametrize("satellites", [1, 3])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_input_power_is_output_power_losses_and_stored_energy(
    chance, layout, satellites, drive, output, mode
):
    values = {**LAYOUTS[layout], "satellites": satellites, **GEARS, **drive, **output, **ALL_LOSSES}
    module = evaluated({**values, "windage": 1e-3}, mode, chance)
    d, x, m = module.derived, module.state, module.derived.machine
    write_loss_powers(d, x, m, m)
    loss = sum(m.lost)
    omega_out = m.omega3 - m.relative if d.elastic else m.omega3
    stored = difference(lambda time: stored_energy_after(module, time), 1e-4)
    power = m.drive * m.omega1
    scale = abs(power) + loss + abs(stored)
    assert power - x.load_torque * omega_out - loss == pytest.approx(stored, abs=1e-7 * scale)
    assert loss > 0.0
    assert m.lost[FREEWHEEL] >= 0.0


@pytest.mark.parametrize("drive", [{}, ENGINE], ids=["speed", "torque"])
@pytest.mark.parametrize("satellites", [1, 2, 5])
def test_mesh_signs_agree_with_the_torques(chance, satellites, drive):
    losses = {"mesh_efficiency": 0.9, "satellite_mesh_efficiency": 0.9, "satellites": satellites}
    for _ in range(20):
        module = evaluated({**LAYOUTS["bevel, askew"], **losses, **drive}, FREE, chance)
        d, x, m = module.derived, module.state, module.derived.machine
        assert m.flow_sign * m.flow_torque >= 0.0
        terms = list(m.mesh_friction_by[:satellites])
        assert all(term >= 0.0 for term in terms) or satellites == 1
        assert sum(terms) == pytest.approx(m.mesh_friction, rel=1e-12)
        # With these fixed signs the solution is the same.
        alpha1, alpha2, prescribed = m.alpha1, m.alpha2, m.drive if d.by_torque else m.alpha1
        evaluate(d, x, prescribed, x.load_torque, True)
        assert (m.alpha1, m.alpha2) == pytest.approx((alpha1, alpha2), rel=1e-9)


def test_mesh_torque_of_a_held_link_2_is_the_closed_form(chance):
    """M2 = k [G q'' + G' q'^2 / 2 + B alpha1 - I' omega1^2 / 2] without losses."""
    module = started("plain", LAYOUTS["bevel, askew"])
    d, x, m = module.derived, module.state, module.derived.machine
    x.housing_state, x.output_state, x.slip_sign = LOCKED, OVERRUNNING, 1.0
    m.q, m.omega1, alpha1 = 1.7, 30.0, -4.0
    evaluate(d, x, alpha1, 0.0, False)
    _, i1, b, _, g, g1 = reduced_inertia(d, m.q)
    k, omega1 = d.k, m.omega1
    mesh = k * (g * k * alpha1 + 0.5 * g1 * (k * omega1) ** 2 + b * alpha1 - 0.5 * i1 * omega1**2)
    assert m.mesh == pytest.approx(mesh, rel=1e-12)
    assert m.housing == pytest.approx(-mesh, rel=1e-12)


def test_sign_of_each_satellite_can_be_toggled():
    for signs in range(16):
        for n in range(6):
            assert toggle_bit(float(signs), n) == signs ^ (1 << n)
