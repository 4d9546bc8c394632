"""The independent reference, held to Lagrange's equations, to quadrature, to closed forms.

Closed forms of drag, wind-up and sticking are held by the kernel (test_losses.py), and it by the reference.
"""

import itertools

import numpy as np
import pytest
from geometry import direct_sums
from scenes import ELASTIC, LAYOUTS, PLANAR, SCENES, parameters, reference

from studies.reference import cases
from studies.reference.geometry import Unavailable, positions, ratio, satellite_ratio, turn

MESHES = {"mesh_efficiency": 0.9, "satellite_mesh_efficiency": 0.92, "journal_friction": 2e-3}
VISCOUS = {"input_friction": 0.02, "drive_friction": 0.01, "link2_friction": 0.05, "output_friction": 0.2}
BODIES = {"satellite_inertia": 4e-4, "satellite_transverse_inertia": 3e-4, "drive_inertia": 1e-3}
NO_FREEWHEELS = {"housing_freewheel": 0, "output_freewheel": 0}
# a link 2 that nothing slows down
STEADY = {**NO_FREEWHEELS, "link2_inertia": 1e9}
# central differences of sixth order: of what is a radian wide, to about 1e-11
STEP, FIRST = 1e-2, np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0
SECOND = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0


def lagranges_matrices(p, q):
    """M of links 1 and 2 without their own inertia, and dM/dq, from the reduced inertia."""
    k = ratio(p)
    i, i1, _, b, b1, g, g1, _ = direct_sums(p, q)
    return [
        np.array([[i + 2.0 * k * b + k * k * g, -k * (b + k * g)], [-k * (b + k * g), k * k * g]])
        for i, b, g in ((i, b, g), (i1, b1, g1))
    ]


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("satellites, modules", [(1, 1), (1, 2), (2, 1), (3, 2)])
def test_without_losses_by_load_it_is_lagranges_equations(layout, satellites, modules):
    states = np.random.default_rng(3).uniform(-50.0, 50.0, (16, 6))
    contacts = itertools.product((cases.OPEN, cases.CLOSED), repeat=2)
    kinds = itertools.product(({}, {"drive": 1}), ({}, ELASTIC), contacts)
    for state, (drive, output, closed) in zip(states, kinds, strict=True):
        values = {**LAYOUTS[layout], **drive, **output, **VISCOUS, **BODIES, "input_inertia": 0.2}
        p = parameters(**values, satellites=satellites, modules=modules)
        machine, k = cases.Machine(p), ratio(p)
        machine.torque, machine.slope, machine.load = 20.0, 300.0, 7.0
        own, y = np.diag([p["input_inertia"], p["link2_inertia"]]), np.zeros(cases.SUMS)
        y[[cases.Q, cases.TWIST]], y[cases.OMEGA1 : cases.OMEGA4 + 1] = state[:2] * [1.0, 1e-3], state[2:]
        w1, w2, w3, w4 = y[cases.OMEGA1 : cases.OMEGA4 + 1]
        x = machine.forces(y, (*closed, 1, 1, *[1] * satellites)).x
        alpha, (m1, _, tc, th, ts) = x[cases.A1 : cases.A4 + 1], x[cases.M1 : cases.TS + 1]
        assert (m1 == pytest.approx(20.0)) if p["drive"] else (alpha[0] == pytest.approx(300.0))
        assert alpha[1] == pytest.approx(0.0, abs=1e-9) if closed[cases.HOUSING] else th == 0.0
        assert alpha[2] == pytest.approx(alpha[1], abs=1e-9) if closed[cases.OUTPUT] else tc == 0.0
        mass, slope = lagranges_matrices(p, y[cases.Q])
        w, rate, along = y[cases.OMEGA1 : cases.OMEGA1 + 2], k * (w1 - w2), np.array([k, -k])
        left = (mass + own) @ alpha[:2] + slope @ w * rate - 0.5 * (w @ slope @ w) * along
        outer = [m1 - p["input_friction"] * w1, th - tc - p["link2_friction"] * w2]
        right = outer - p["drive_friction"] * rate * along
        assert left == pytest.approx(right, abs=1e-10 * np.abs(x).max())
        assert p["output_inertia"] * alpha[2] == pytest.approx(tc - ts - p["output_friction"] * w3, abs=1e-9)
        twice = w @ (mass + own) @ w + p["output_inertia"] * w3**2
        if output:
            twice += p["driven_inertia"] * w4**2 + p["shaft_stiffness"] * y[cases.TWIST] ** 2
            shaft = p["shaft_stiffness"] * y[cases.TWIST] + p["shaft_damping"] * (w3 - w4)
            assert [ts, p["driven_inertia"] * alpha[3]] == pytest.approx([shaft, ts - 7.0], abs=1e-9)
        else:
            assert (ts, alpha[3]) == pytest.approx((7.0, alpha[2]))
        assert machine.energy(y) == pytest.approx(0.5 * twice, rel=1e-11)


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("satellites", [1, 2])
def test_weight_is_the_slope_of_the_height(scene, satellites):
    values = {**SCENES[scene], "satellites": satellites, "modules": 1, "gravity": 9.81}
    machine, k = cases.Machine(values), ratio(parameters(**values))

    def at_rest(theta1, q):
        y = np.zeros(cases.SUMS)
        y[[cases.THETA1, cases.Q]] = theta1, q
        return y

    for theta1, q in np.random.default_rng(1).uniform(-5.0, 5.0, (10, 2)):
        steps = STEP * np.arange(-3.0, 4.0)
        by_theta1 = FIRST @ [machine.energy(at_rest(theta1 + step, q)) for step in steps] / STEP
        by_q = FIRST @ [machine.energy(at_rest(theta1, q + step)) for step in steps] / STEP
        # what holds links 1 and 2: dq = k (dtheta1 - dtheta2)
        found = machine.forces(at_rest(theta1, q), (cases.CLOSED, cases.OPEN, 1, 1, *[1] * satellites)).x
        assert found[[cases.M1, cases.M2]] == pytest.approx([by_theta1 + k * by_q, k * by_q], abs=1e-9)
    several = cases.Machine({**values, "modules": 2})
    assert several.energy(at_rest(0.2, 0.3)) == 0.0


def powers_of_a_steady_motion(p, omega1, omega2, times):
    """(mesh, journal) losses, W, where both links turn evenly: from places in the fixed frame alone."""
    k, s = ratio(p), satellite_ratio(p)
    rate, sigma = k * (omega1 - omega2), np.sign(omega1 - omega2)
    dt = STEP / (abs(omega1) + (1.0 + s) * abs(rate))

    def places(satellite, late=0.0, drive=0.0, spin=0.0):
        moved = p | {"epsilon": p["epsilon"] + spin}
        q = p["drive_angle_start"] + rate * (times + late) + drive
        in_link1 = positions(moved, q, satellite)
        return np.einsum("nij,nj->ni", turn(0, omega1 * (times + late)), in_link1)

    torque, bearings, teeth = (np.zeros_like(times) for _ in range(3))
    for satellite in range(int(p["satellites"])):
        offsets = np.arange(-3.0, 4.0)
        force = p["imbalance_mass"] * np.tensordot(
            SECOND, [places(satellite, late=n * dt) for n in offsets], 1
        ) / dt**2  # fmt: skip
        by_q, by_b = (
            np.tensordot(FIRST, [places(satellite, **{name: n * STEP}) for n in offsets], 1) / STEP
            for name in ("drive", "spin")
        )
        torque += (force * by_q).sum(axis=1)
        bearings += np.linalg.norm(force, axis=1)
        teeth += np.abs((force * by_b).sum(axis=1))
    journal = p["journal_friction"] * s * bearings
    satellites = 0.0 if p["layout"] else (1.0 - p["satellite_mesh_efficiency"]) * s * teeth
    passed = p["modules"] * k * (torque + sigma * (journal + satellites))
    eta = p["mesh_efficiency"]
    m2 = passed * np.where(passed * sigma > 0.0, 1.0 / eta, 1.0 / (2.0 - eta))
    slip = abs(omega1 - omega2)
    return (1.0 - eta) * np.abs(m2) * slip + p["modules"] * satellites * k * slip, p[
        "modules"
    ] * journal * k * slip


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("omega2", [0.0, 40.0, 130.0])
@pytest.mark.parametrize("satellites, modules", [(1, 1), (2, 2)])
def test_losses_of_a_steady_slip_are_those_of_quadrature(scene, omega2, satellites, modules):
    values = {**SCENES[scene], **STEADY, **MESHES, "omega2_start": omega2, "omega_out_start": omega2}
    values |= {"satellites": satellites, "modules": modules, "drive_angle_start": 0.7}
    found = reference(values, 0.05).integrals()
    times = np.linspace(0.0, 0.05, 20001)
    powers = powers_of_a_steady_motion(parameters(**values), values["omega1"], omega2, times)
    for name, power in zip(("mesh", "journal"), powers, strict=True):
        assert found[name] == pytest.approx(np.trapezoid(power, times), rel=1e-6), name


def test_even_friction_takes_link_2_along_at_a_constant_rate_and_then_it_sticks():
    # imbalances on the axes of their satellites: the journals rub evenly, whatever link 2 does
    eta, friction = 0.8, 0.05 * 3 * 0.8 * 120.0**2 * 0.08
    values = {**PLANAR, **NO_FREEWHEELS, "eccentricity": 0.0, "journal_friction": 0.05, "load_torque": 0.0}
    values["mesh_efficiency"] = eta
    k, inertia = 0.05 / 0.03, 0.003 + 0.4
    torque = k * friction / eta
    stuck = inertia * 120.0 / torque
    motion = reference(values, 0.5 * stuck)
    assert motion.state[cases.OMEGA3] == pytest.approx(60.0, rel=1e-11)
    assert motion.integrals()["journal"] == pytest.approx(friction * k * 90.0 * 0.5 * stuck, rel=1e-11)
    assert motion.integrals()["mesh"] == pytest.approx((1.0 - eta) * torque * 90.0 * 0.5 * stuck, rel=1e-11)
    motion.advance(2.0 * stuck)
    assert motion.mode[cases.SLIP] == 0
    assert list(motion.state[cases.OMEGA1 : cases.OMEGA4 + 1]) == [120.0] * 4
    lost = motion.integrals()
    assert lost["journal"] + lost["mesh"] == pytest.approx(0.5 * inertia * 120.0**2, rel=1e-11)
    # and a brake that is stronger tears them apart: it slips as fast as the two differ
    motion.give(0.0, 2.0 * torque)
    motion.advance(2.0 * stuck + 0.1)
    assert motion.state[cases.OMEGA3] == pytest.approx(120.0 - 0.1 * torque / inertia, rel=1e-11)


@pytest.mark.parametrize("omega1", [130.0, 60.0, -20.0])
@pytest.mark.parametrize("time", [0.003, 0.006, 0.011])
@pytest.mark.parametrize("scene", SCENES)
def test_a_jump_gives_impulses_by_lagranges_equations_and_knows_no_friction(scene, time, omega1):
    values = {**SCENES[scene], "omega_out_start": 5.0}
    ideal, rubbed = reference(values, time), reference({**values, **MESHES})
    p, energy = parameters(**values), ideal.energy()
    before = ideal.state[cases.OMEGA1 : cases.OMEGA4 + 1].copy()
    rubbed.time, rubbed.state[: cases.WOUND] = ideal.time, ideal.state[: cases.WOUND]
    for motion in (ideal, rubbed):
        motion.turn(omega1)
    assert rubbed.state[: cases.WOUND] == pytest.approx(ideal.state[: cases.WOUND], rel=1e-14)
    found = rubbed.integrals()
    assert found["energy_in"] == pytest.approx(rubbed.energy() - energy, rel=1e-14)
    assert found["mesh"] == found["journal"] == 0.0
    # M (w+ - w-) is the impulse: 0 <= omega2 _|_ Th >= 0 and 0 <= omega3 - omega2 _|_ Tc >= 0 after it
    _, w2, w3, _ = ideal.state[cases.OMEGA1 : cases.OMEGA4 + 1]
    gained = ideal.state[cases.OMEGA1 : cases.OMEGA4 + 1] - before
    mass, _ = lagranges_matrices(p, ideal.state[cases.Q])
    impulse2 = (mass @ gained[:2])[1] + p["link2_inertia"] * gained[1]
    output = p["output_inertia"] * gained[2]
    least = -1e-12 * abs(gained[0])
    assert min(w2, w3 - w2, output, impulse2 + output) >= least
    assert min(w2, impulse2 + output) <= -least
    assert min(w3 - w2, output) <= -least


@pytest.mark.parametrize(
    "values",
    [
        {"omega2_start": -1.0, "omega_out_start": 1.0},
        {**ELASTIC, "freewheel_stiffness": 1.0, "output_freewheel": 0},
    ],
)
def test_what_it_does_not_take_it_says(values):
    with pytest.raises(Unavailable):
        reference({**SCENES["bevel"], **values}, 0.0)
