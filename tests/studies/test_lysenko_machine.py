"""What the module gives of Lysenko's wheel, by which claims are judged, against equations of their own."""

import numpy as np
import pytest

from studies.papers.lysenko import claims as machine
from studies.papers.lysenko.equations import EXAMPLE, EXAMPLE_SPEED, exact
from studies.papers.stelmashchuk import claims
from studies.papers.stelmashchuk.exact import Criteria

# at the ends of the steps over a turn of the carrier
ALPHA = np.linspace(0.0, 2.0 * np.pi / EXAMPLE.b, machine.STEPS + 1)
STEP = machine.TURN / machine.STEPS


def test_power_of_the_drive_is_the_rate_of_the_kinetic_energy():
    power = machine.drive_power(EXAMPLE)
    energy = exact(EXAMPLE, ALPHA, EXAMPLE_SPEED).kinetic_energy
    assert power == pytest.approx(np.diff(energy) / STEP, abs=1e-7 * power.max())


def test_weight_adds_the_rate_at_which_the_imbalance_is_lifted():
    added = machine.drive_power(EXAMPLE, gravity=9.81) - machine.drive_power(EXAMPLE)
    height = (exact(EXAMPLE, ALPHA).place * np.exp(1j * EXAMPLE.b * ALPHA)).real
    assert added == pytest.approx(EXAMPLE.m * 9.81 * np.diff(height) / STEP, abs=1e-6 * added.max())


def test_mean_power_of_the_drive_is_what_is_lost():
    e, loss = exact(EXAMPLE, ALPHA[:-1], EXAMPLE_SPEED), machine.LOSSES
    viscous = loss["input_friction"] * machine.CARRIER_SPEED**2 + loss["drive_friction"] * EXAMPLE_SPEED**2
    journal = loss["journal_friction"] * np.abs(e.force).mean() * EXAMPLE_SPEED
    mesh = (1.0 - loss["mesh_efficiency"]) * np.abs(e.M1).mean() / EXAMPLE.b * machine.CARRIER_SPEED
    # the mesh also carries what journal and wheel lose
    assert machine.drive_power(EXAMPLE, **loss).mean() == pytest.approx(viscous + journal + mesh, rel=0.01)


def test_mesh_loses_its_share_of_the_power_that_passes_it_steady_and_free():
    m, alpha = EXAMPLE, np.linspace(0.0, 2.0 * np.pi, 20001)
    inertia = m.J_wheel + m.m * m.arm * (m.arm - m.centre_distance * np.cos(alpha))
    for speed, found in zip(
        (1.0, exact(m, alpha).free_speed), dict(machine.of_the_machine())["circulation"].share, strict=True
    ):
        square = (m.b * speed) ** 2 * np.ones_like(alpha)
        acceleration = 0.5 * np.gradient(square, m.b * alpha)
        # by links.py with omega2 = 0: k ((k G + B) alpha1 - I' omega1^2 / 2)
        torque = ((m.J_wheel + m.m * m.arm**2) / m.b + inertia) * acceleration
        torque -= m.m * m.arm * m.centre_distance * np.sin(alpha) * square
        lost = (1.0 - machine.LOSSES["mesh_efficiency"]) * np.trapezoid(np.abs(torque) / m.b, alpha)
        time = 1.0 / speed * np.ones_like(alpha)
        energy = 0.5 * exact(m, alpha).J_red * square
        mean = np.trapezoid(energy * time, alpha) / np.trapezoid(time, alpha)
        # three cycles a turn, each m.b of it; free, the energy falls by some percent in it
        assert found == pytest.approx(100.0 * lost / mean, rel=0.03)


@pytest.mark.parametrize("load", [1.0, 0.1])
@pytest.mark.parametrize("Pi", [5.0, 0.1])
def test_efficiency_of_the_driven_shaft_is_that_of_the_closed_form(Pi, load):
    velocity = claims.response(claims.TIMES, Criteria(8.0, Pi), claims.KAPPA2).velocity
    friction = 2.0 * Pi * np.sum(velocity[:-1] ** 2) * claims.TIMES[1]
    out = load * 2.0 * np.pi * (1.0 + 2.0 * claims.KAPPA2)
    assert claims.under_load(Pi, load) == pytest.approx(out / (out + friction), rel=2e-3)
