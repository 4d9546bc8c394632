"""Test the kernel, and the losses of the reference, against MuJoCo with a hinge for each joint."""

import itertools

import numpy as np
import pytest
from geometry import ratio, satellite_ratio
from scenes import LAYOUTS, parameters, started, vector

from benchmarks.peers.mujoco_model import mechanism
from inertia_module.kernel.equations.motion import evaluate
from inertia_module.kernel.equations.states import RATIO_PRESCRIBED
from inertia_module.kernel.layout import imbalance_motion
from inertia_module.kernel.links import kinetic_energy
from inertia_module.kernel.loads import write_loads
from verification.reference.cases import A1, A2, A3, CLOSED, FIRST_INTEGRAL, OMEGA1, OPEN, THETA1, Machine, Q

mujoco = pytest.importorskip("mujoco")

# Scales of random (q, theta1, omega1, alpha1, omega2, alpha2).
SCALE = np.array([10.0, 10.0, 100.0, 3000.0, 100.0, 3000.0])
GEAR = {"drive_inertia": 0.004, "satellite_inertia": 0.007, "satellite_transverse_inertia": 0.005}
FLAT = {"imbalance_mass": 1e-3, "satellite_inertia": 0.2, "satellite_transverse_inertia": 0.1}
OWN = {
    "J16": {"drive_inertia": 0.004},
    "J16 and bodies": GEAR,
    "long bodies": {"satellite_inertia": 1e-4, "satellite_transverse_inertia": 0.02},
    "flat bodies, nearly alone": FLAT,
}


class Multibody:
    """Links 1 and 2, drives and satellites as hinges; virtual work represents the gears."""

    def __init__(self, p):
        self.p = p
        self.model = mujoco.MjModel.from_xml_string(mechanism(p))
        self.data = mujoco.MjData(self.model)
        self.names = [self.model.joint(n).name for n in range(self.model.njnt)]
        self.link1, self.link2 = (
            np.array([name == link for name in self.names], float) for link in ("link 1", "link 2")
        )
        # Rotation of each hinge per drive angle q.
        turns = {"drive": 1.0, "satellite": satellite_ratio(p)}
        self.gear = np.array([turns.get(name.split()[0], 0.0) for name in self.names])

    def prescribe(self, q, theta1, omega1, alpha1, omega2, alpha2):
        """Return (M1, M2) by inverse dynamics of a motion of links 1 and 2.

        With dq = k (dtheta1 - dtheta2) the virtual work of the hinge torques equals the work of M1 on link 1
        and of the external torque on link 2. J2 alpha2 is the sum of external torque and mesh torque.
        """
        k, data = ratio(self.p), self.data
        data.qpos[:] = self.link1 * theta1 + self.gear * q
        data.qvel[:] = self.link1 * omega1 + self.link2 * omega2 + self.gear * k * (omega1 - omega2)
        data.qacc[:] = self.link1 * alpha1 + self.link2 * alpha2 + self.gear * k * (alpha1 - alpha2)
        mujoco.mj_inverse(self.model, data)
        torque = data.qfrc_inverse
        geared = k * (self.gear @ torque)
        outer = self.link2 @ torque - geared
        return self.link1 @ torque + geared, self.p["link2_inertia"] * alpha2 - outer

    def energy(self):
        """Return the kinetic energy of the last prescribed motion."""
        mujoco.mj_energyVel(self.model, self.data)
        return self.data.energy[1]

    def on_the_mount(self):
        """Return (F, Mo) of the last prescribed motion: reaction force and moment on the mount.

        They exclude the inertia of the links and the torques that drive the links.
        """
        mujoco.mj_rnePostConstraint(self.model, self.data)
        force, moment = np.zeros(3), np.zeros(3)
        for name, inertia, hinge in (
            ("link 1", self.p["input_inertia"], self.link1),
            ("link 2", self.p["link2_inertia"], self.link2),
        ):
            body = self.model.joint(name).bodyid[0]
            torque, values = np.split(self.data.cfrc_int[body], 2)
            force -= values
            moment -= torque + np.cross(self.data.subtree_com[body], values)
            moment[0] += inertia * (hinge @ self.data.qacc)
        return force, moment

    def imbalance(self):
        """Return (position, velocity, acceleration) of imbalance 0 of module 0 in the last motion."""
        body = self.model.body("imbalance 0 0").id
        velocity, acceleration = np.zeros(6), np.zeros(6)
        mujoco.mj_rnePostConstraint(self.model, self.data)
        kind = mujoco.mjtObj.mjOBJ_BODY
        mujoco.mj_objectVelocity(self.model, self.data, kind, body, velocity, 0)
        mujoco.mj_objectAcceleration(self.model, self.data, kind, body, acceleration, 0)
        return self.data.xipos[body], velocity[3:], acceleration[3:]


def states(number, seed):
    return SCALE * np.random.default_rng(seed).uniform(-1.0, 1.0, (number, 6))


def largest(values):
    return np.abs(values).max()


@pytest.fixture(params=itertools.product(LAYOUTS, (1, 2, 3), (1, 2)), ids=str)
def multibodies(request):
    """Return a layout with numbers of satellites and modules, and all inertias."""
    layout, satellites, modules = request.param
    links = {"imbalance_mass": 0.8, "input_inertia": 0.02, "link2_inertia": 0.006}
    many = {"satellites": satellites, "modules": modules}
    return [Multibody(parameters(**LAYOUTS[layout], **many, **{**links, **own})) for own in OWN.values()]


def torques(module, q, omega1, alpha1, omega2, alpha2):
    """Return M1 and M2 of a prescribed motion of links 1 and 2 by the equations of the kernel."""
    x, m = module.state, module.derived.machine
    x.output_state = RATIO_PRESCRIBED
    m.q, m.omega1, m.omega2, m.omega3, m.alpha2 = q, omega1, omega2, omega2, alpha2
    evaluate(module.derived, x, alpha1, 0.0, False)
    return m.drive, m.mesh


def test_torques_forces_and_energy_agree_with_the_multibody_engine(multibodies):
    for multibody in multibodies:
        p, module, k = multibody.p, started("plain", multibody.p), ratio(multibody.p)
        d, actual, expected = module.derived, [], []
        for q, theta1, omega1, alpha1, omega2, alpha2 in states(20, 2020):
            motion = {"q": q, "theta1": theta1, "omega1": omega1, "alpha1": alpha1, "omega2": omega2}
            expected.append(multibody.prescribe(**motion, alpha2=alpha2))
            actual.append(torques(module, q, omega1, alpha1, omega2, alpha2))
            assert kinetic_energy(d, q, omega1, omega2, 0.0) == pytest.approx(multibody.energy(), rel=1e-8)
            moved = imbalance_motion(
                d, q, theta1, omega1, alpha1, k * (omega1 - omega2), k * (alpha1 - alpha2), 0.0
            )
            for right, values in zip(multibody.imbalance(), np.reshape(moved, (3, 3)), strict=True):
                assert largest(values - right) < 1e-8 * largest(right)
            for name, value in motion.items():
                setattr(module.state, name, value)
            write_loads(d, module.state, module.outputs, alpha2)
            scale = p["imbalance_mass"] * module["imbalance_acceleration"] * p["modules"] * p["satellites"]
            for name, right in zip(("force", "moment"), multibody.on_the_mount(), strict=True):
                scale = max(scale, largest(right))
                assert largest(vector(module, f"shaking_{name}") - right) < 1e-8 * scale
        assert largest(np.array(actual) - expected) < 1e-8 * largest(expected)


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("satellites, modules", [(1, 1), (2, 1), (3, 2)])
def test_accelerations_with_losses_agree_with_inverse_dynamics(layout, satellites, modules):
    p = {"drive_inertia": 0.004, "satellite_inertia": 5e-4, "satellite_transverse_inertia": 4e-4}
    p |= {"input_inertia": 0.02, "link2_inertia": 0.006, "output_inertia": 0.03, "gravity": 9.81, "drive": 1}
    p |= {"input_friction": 0.3, "drive_friction": 0.2, "link2_friction": 0.1}
    p |= {"housing_drag": 4.0, "housing_drag_viscous": 0.05, "satellites": satellites, "modules": modules}
    multibody = Multibody(parameters(**LAYOUTS[layout], **p, imbalance_mass=0.8))
    # Dampers at the hinges (equal on all drives), dry friction at link 2, and weight.
    model, kinds = multibody.model, [name.split()[0] for name in multibody.names]
    model.dof_damping[:] = p["drive_friction"] / kinds.count("drive") * (np.array(kinds) == "drive")
    model.dof_damping += p["input_friction"] * multibody.link1
    model.dof_damping += (p["link2_friction"] + p["housing_drag_viscous"]) * multibody.link2
    model.dof_frictionloss[:] = p["housing_drag"] * multibody.link2
    # With this stiffness the hinge slides at any acceleration.
    model.dof_solref[multibody.names.index("link 2")] = -1.0, -1e9
    model.opt.gravity[2] = -p["gravity"]
    machine, y = Machine(multibody.p), np.zeros(FIRST_INTEGRAL)
    for q, theta1, omega1, alpha1, omega2, alpha2 in states(20, 7):
        ahead = abs(omega2)  # The housing freewheel overruns.
        m1, m2 = multibody.prescribe(q, theta1, omega1, alpha1, ahead, alpha2)
        # The mesh torque minus friction accelerates link 2 and the shaft.
        machine.torque, machine.load = m1, m2 - (p["link2_inertia"] + p["output_inertia"]) * alpha2
        y[Q], y[THETA1], y[OMEGA1 : OMEGA1 + 4] = q, theta1, (omega1, ahead, ahead, ahead)
        solution = machine.forces(y, (OPEN, CLOSED, 1, 1, *[1] * satellites)).x
        assert solution[[A1, A2, A3]] == pytest.approx([alpha1, alpha2, alpha2], rel=1e-8, abs=3e-5)
