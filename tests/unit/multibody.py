"""The mechanism in mujoco, an independent multibody engine, each joint a hinge of its own."""

import mujoco
import numpy as np
from geometry import ratio, satellite_ratio

from studies.peers.mujoco_model import mechanism


class Multibody:
    """Links 1 and 2, drives and satellites as hinges; the gears are virtual work."""

    def __init__(self, p):
        self.p = p
        self.model = mujoco.MjModel.from_xml_string(mechanism(p))
        self.data = mujoco.MjData(self.model)
        names = [self.model.joint(n).name for n in range(self.model.njnt)]
        self.link1 = np.array([name == "link 1" for name in names], float)
        self.link2 = np.array([name == "link 2" for name in names], float)
        # how each hinge turns with the drive angle q
        self.gear = np.array(
            [{"drive": 1.0, "satellite": satellite_ratio(p)}.get(name.split()[0], 0.0) for name in names]
        )

    def prescribe(self, q, theta1, omega1, alpha1, omega2, alpha2):
        """Inverse dynamics of a motion of links 1 and 2: (M1, M2).

        With dq = k (dtheta1 - dtheta2) the virtual work of the hinge torques is that of M1 on link 1
        and of the outer torque on link 2, and J2 alpha2 is the outer torque and that of the mesh.
        """
        k = ratio(self.p)
        data = self.data
        data.qpos[:] = self.link1 * theta1 + self.gear * q
        data.qvel[:] = self.link1 * omega1 + self.link2 * omega2 + self.gear * k * (omega1 - omega2)
        data.qacc[:] = self.link1 * alpha1 + self.link2 * alpha2 + self.gear * k * (alpha1 - alpha2)
        mujoco.mj_inverse(self.model, data)
        torque = data.qfrc_inverse
        geared = k * (self.gear @ torque)
        outer = self.link2 @ torque - geared
        return self.link1 @ torque + geared, self.p["link2_inertia"] * alpha2 - outer

    def energy(self):
        """Kinetic energy of the motion prescribed last."""
        mujoco.mj_energyVel(self.model, self.data)
        return self.data.energy[1]

    def on_the_mount(self):
        """(F, Mo) of the motion prescribed last: what the world gives to links 1 and 2, the other way round.

        Their own inertia and the torques that turn them are left out.
        """
        mujoco.mj_rnePostConstraint(self.model, self.data)
        force, moment = np.zeros(3), np.zeros(3)
        for name, inertia, hinge in (
            ("link 1", self.p["input_inertia"], self.link1),
            ("link 2", self.p["link2_inertia"], self.link2),
        ):
            body = self.model.joint(name).bodyid[0]
            torque, given = np.split(self.data.cfrc_int[body], 2)
            force -= given
            moment -= torque + np.cross(self.data.subtree_com[body], given)
            moment[0] += inertia * (hinge @ self.data.qacc)
        return force, moment

    def imbalance(self):
        """(position, velocity, acceleration) of imbalance 0 of module 0 in the motion prescribed last."""
        body = self.model.body("imbalance 0 0").id
        velocity, acceleration = np.zeros(6), np.zeros(6)
        mujoco.mj_rnePostConstraint(self.model, self.data)
        mujoco.mj_objectVelocity(self.model, self.data, mujoco.mjtObj.mjOBJ_BODY, body, velocity, 0)
        mujoco.mj_objectAcceleration(self.model, self.data, mujoco.mjtObj.mjOBJ_BODY, body, acceleration, 0)
        return self.data.xipos[body], velocity[3:], acceleration[3:]
