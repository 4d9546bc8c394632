"""The mechanism in mujoco, an independent multibody engine, each joint a hinge of its own."""

import mujoco
import numpy as np
from geometry import EX, EZ, bevel_lengths, ratio, satellite_ratio, turn_x, turn_y, turn_z

NEXT_TO_NOTHING = 1e-13  # the engine wants every moving body to have mass and inertia


def _numbers(values):
    return " ".join(f"{value:.17g}" for value in values)


def _frame(place, turned):
    return f'pos="{_numbers(place)}" xyaxes="{_numbers([*turned[:, 0], *turned[:, 1]])}"'


def _inertial(mass, *inertia):
    return f'<inertial pos="0 0 0" mass="{mass:.17g}" diaginertia="{_numbers(inertia)}"/>'


def _imbalance(p, name, place):
    inertial = _inertial(p["imbalance_mass"], *[NEXT_TO_NOTHING] * 3)
    return f'<body name="{name}" pos="{_numbers(place)}">{inertial}</body>'


def _bevel_module(p, module):
    """Drive about the z axis of link 1, satellites on it. Half of J16 across its axis is J1's."""
    own = max(p["drive_inertia"] / p["modules"], NEXT_TO_NOTHING)
    ad, qa, oq = bevel_lengths(p)
    satellites = ""
    for n in range(p["satellites"]):
        turned = turn_z(p["gamma"] + 2.0 * np.pi * n / p["satellites"]) @ turn_y(-p["shaft_angle"])
        satellites += (
            f"<body {_frame(oq * EZ, turned)}>"
            f'<joint name="satellite {module} {n}" type="hinge" axis="0 0 1"/>'
            f"{_inertial(NEXT_TO_NOTHING, *[NEXT_TO_NOTHING] * 3)}"
            f"{_imbalance(p, f'imbalance {module} {n}', (-ad, 0.0, -qa))}</body>"
        )
    return (
        f'<joint name="drive {module}" type="hinge" axis="0 0 1"/>'
        f"{_inertial(NEXT_TO_NOTHING, 0.5 * own, 0.5 * own, own)}{satellites}"
    )


def _planar_module(p, module):
    """Satellites on link 1, their axes parallel to the central one."""
    own = max(p["drive_inertia"] / p["modules"] / p["satellites"], NEXT_TO_NOTHING)
    centre = (p["sun_radius"] + p["satellite_radius"]) * EZ
    satellites = ""
    for n in range(p["satellites"]):
        turned = turn_x(2.0 * np.pi * n / p["satellites"])
        satellites += (
            f"<body {_frame(turned @ centre, turned)}>"
            f'<joint name="drive {module} {n}" type="hinge" axis="1 0 0"/>'
            f"{_inertial(NEXT_TO_NOTHING, own, own, own)}"
            f"{_imbalance(p, f'imbalance {module} {n}', (0.0, 0.0, -p['eccentricity']))}</body>"
        )
    return f"{_inertial(NEXT_TO_NOTHING, *[NEXT_TO_NOTHING] * 3)}{satellites}"


class Multibody:
    """Links 1 and 2, drives and satellites as hinges; the gears are virtual work.

    Of the input inertia J1 the drives of the bevel layout already bring half of J16.
    """

    def __init__(self, p):
        self.p = p
        module = _planar_module if p["layout"] else _bevel_module
        rest = p["input_inertia"] - (0.0 if p["layout"] else 0.5 * p["drive_inertia"])
        modules = "".join(
            f"<body {_frame((0, 0, 0), turn_x(1.1 * n))}>{module(p, n)}</body>" for n in range(p["modules"])
        )
        text = f"""<mujoco>
            <compiler angle="radian" inertiafromgeom="false"/>
            <option gravity="0 0 0"><flag energy="enable"/></option>
            <worldbody>
            <body><joint name="link 1" type="hinge" axis="{_numbers(EX)}"/>
            {_inertial(NEXT_TO_NOTHING, rest, rest, rest)}{modules}</body>
            <body><joint name="link 2" type="hinge" axis="{_numbers(EX)}"/>
            {_inertial(NEXT_TO_NOTHING, *[p["link2_inertia"]] * 3)}</body>
            </worldbody></mujoco>"""
        self.model = mujoco.MjModel.from_xml_string(text)
        self.data = mujoco.MjData(self.model)
        names = [self.model.joint(n).name for n in range(self.model.njnt)]
        self.link1 = np.array([name == "link 1" for name in names], float)
        self.link2 = np.array([name == "link 2" for name in names], float)
        # how each hinge turns with the drive angle q
        self.gear = np.array(
            [{"drive": 1.0, "satellite": satellite_ratio(p)}.get(name.split()[0], 0.0) for name in names]
        )
        self.offset = np.array([p["epsilon"] * (name.split()[0] == "satellite") for name in names])

    def prescribe(self, q, theta1, omega1, alpha1, omega2, alpha2):
        """Inverse dynamics of a motion of links 1 and 2: (M1, M2).

        With dq = k (dtheta1 - dtheta2) the virtual work of the hinge torques is that of M1 on link 1
        and of the outer torque on link 2, and J2 alpha2 is the outer torque and that of the mesh.
        """
        k = ratio(self.p)
        data = self.data
        data.qpos[:] = self.link1 * theta1 + self.gear * q + self.offset
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

    def imbalance(self):
        """(position, velocity, acceleration) of imbalance 0 of module 0 in the motion prescribed last."""
        body = self.model.body("imbalance 0 0").id
        velocity, acceleration = np.zeros(6), np.zeros(6)
        mujoco.mj_rnePostConstraint(self.model, self.data)
        mujoco.mj_objectVelocity(self.model, self.data, mujoco.mjtObj.mjOBJ_BODY, body, velocity, 0)
        mujoco.mj_objectAcceleration(self.model, self.data, mujoco.mjtObj.mjOBJ_BODY, body, acceleration, 0)
        return self.data.xipos[body], velocity[3:], acceleration[3:]
