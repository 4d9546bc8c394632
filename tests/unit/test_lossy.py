"""The independent reference, held to quadrature, to closed forms, to Lagrange's equations where it jumps.

Its equations are held by MuJoCo (test_multibody.py) and by the kernel (test_reference.py), which has closed
forms of its own for drag, wind-up and sticking (test_losses.py).
"""

import numpy as np
import pytest
from geometry import direct_sums
from scenes import ELASTIC, PLANAR, SCENES, parameters, reference

from studies.reference import cases
from studies.reference.geometry import Unavailable, positions, ratio, satellite_ratio, turn

MESHES = {"mesh_efficiency": 0.9, "satellite_mesh_efficiency": 0.92, "journal_friction": 2e-3}
NO_FREEWHEELS = {"housing_freewheel": 0, "output_freewheel": 0}
# a link 2 that nothing slows down
STEADY = {**NO_FREEWHEELS, "link2_inertia": 1e9}
# central differences of sixth order: of what is a radian wide, to about 1e-11
STEP, FIRST = 1e-2, np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0
SECOND = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0


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
    k = ratio(p)
    _, _, _, b, _, g, _, _ = direct_sums(p, ideal.state[cases.Q])
    impulse2 = k * k * g * gained[1] - k * (b + k * g) * gained[0] + p["link2_inertia"] * gained[1]
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
