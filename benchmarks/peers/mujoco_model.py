"""The module as a constrained multibody model in MuJoCo, an independent engine.

- Bodies: link 1, link 2, the pinion shafts on link 1 and the satellites on them, each on a hinge. The
  geometry of the reference places them at angle 0 of the pinion shafts.
- Gears are equality constraints. A fixed tendon ties the angle of each pinion shaft to links 1 and 2. A joint
  constraint ties the angle of each satellite to its pinion shaft.
- A freewheel is a tendon limit that is always active, without stiffness and with damping 1 / timestep. MuJoCo
  then applies a torque in one direction that keeps the relative speed after the step from falling below zero.
  This is the complementarity condition on velocities, at each step.
- A flywheel on link 1 keeps the input speed constant.

Source: MuJoCo, "Computation": constraint model, reference acceleration and impedance.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from inertia_module.common.extras import library
from inertia_module.fidelity.timing import median_time
from verification.reference import geometry
from verification.reference.geometry import EX, EZ, Array, Parameters, ratio, satellite_ratio

from ..trade_off import Case, Trajectory
from .integrators import Problem

# minimum mass and inertia of a body, which MuJoCo requires; kg, kg·m²
NEGLIGIBLE = 1e-13
# maximum impedance that MuJoCo allows; a rigid constraint would have 1
IMPEDANCE = 0.9999
# inverse inertia that scales the softness of constraints, 1/(kg·m²). The default of MuJoCo is its value at
# the first position. It is infinite if the mass of a satellite is at its rolling pole (bevel layout, a = b).
INVERSE_INERTIA = 0.01
# added inertia of pinion shafts and satellites, kg·m²: otherwise the mass matrix is singular at this position
ARMATURE = 1e-9
# inertia of the flywheel on link 1 over the sum of the shaft inertias
FLYWHEEL = 1e7
ORIGIN, UPRIGHT = np.zeros(3), np.eye(3)


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{value:.17g}" for value in values)


def _body(
    name: str,
    children: str = "",
    axis: Array | None = None,
    inertia: Iterable[float] = (0.0, 0.0, 0.0),
    mass: float = NEGLIGIBLE,
    place: Array = ORIGIN,
    turned: Array = UPRIGHT,
) -> str:
    """Return a body as MJCF text.

    Args:
        name: Name of the body and of its hinge.
        children: Bodies on this body, MJCF.
        axis: Axis of the hinge in the frame of the body, shape (3,); None without a hinge.
        inertia: Principal inertias, kg·m².
        mass: Mass, kg.
        place: Position in the parent frame, m, shape (3,).
        turned: Orientation in the parent frame, rotation matrix, shape (3, 3).
    """
    frame = f'pos="{_numbers(place)}" xyaxes="{_numbers([*turned[:, 0], *turned[:, 1]])}"'
    hinge = f'<joint name="{name}" type="hinge" axis="{_numbers(axis)}"/>' if axis is not None else ""
    own = _numbers(max(value, NEGLIGIBLE) for value in inertia)
    inertial = f'<inertial pos="0 0 0" mass="{mass:.17g}" diaginertia="{own}"/>'
    return f'<body name="{name}" {frame}>{hinge}{inertial}{children}</body>'


def _module(p: Parameters, module: int) -> str:
    """Return the pinion shafts and satellites of a module as MJCF text.

    In the planar layout a satellite is its own pinion shaft.

    Args:
        p: All parameters of the module, by name.
        module: Number of the module.
    """
    shares = p["modules"] * (p["satellites"] if p["layout"] else 1.0)
    own, across = p["drive_inertia"] / shares, p["satellite_transverse_inertia"]
    satellites, start = "", np.zeros(1)
    for n in range(int(p["satellites"])):
        turned = geometry.attitudes(p, start, n)[0]
        if p["layout"]:
            name, axis, inertia = "drive", EX, [own + p["satellite_inertia"]] * 3
            pivot = (p["sun_radius"] + p["satellite_radius"]) * turned @ EZ
        else:
            name, axis, inertia = "satellite", EZ, [across, across, p["satellite_inertia"]]
            pivot = geometry.bevel_lengths(p)[2] * EZ
        place = turned.T @ (geometry.positions(p, start, n)[0] - pivot)
        imbalance = _body(f"imbalance {module} {n}", mass=p["imbalance_mass"], place=place)
        satellites += _body(f"{name} {module} {n}", imbalance, axis, inertia, place=pivot, turned=turned)
    frame = geometry.turn(0, 2.0 * np.pi * module / p["modules"])
    if p["layout"]:
        return _body(f"module {module}", satellites, turned=frame)
    # J1 contains half of J16 about the transverse axes
    return _body(f"drive {module}", satellites, EZ, [0.5 * own, 0.5 * own, own], turned=frame)


def mechanism(
    p: Parameters, options: str = "", more: str = "", output_shaft: bool = False, flywheel: float = 0.0
) -> str:
    """Return the MuJoCo model of the mechanism, MJCF.

    Args:
        p: All parameters of the module, by name.
        options: Attributes of <option>.
        more: Elements next to the worldbody.
        output_shaft: True to include the output shaft.
        flywheel: Inertia on link 1 in addition to J1, kg·m².
    """
    # the pinion shafts of the bevel layout already contribute half of J16 to J1
    rest = p["input_inertia"] - (0.0 if p["layout"] else 0.5 * p["drive_inertia"]) + flywheel
    modules = "".join(_module(p, n) for n in range(int(p["modules"])))
    shafts = _body("link 1", modules, EX, [rest] * 3) + _body("link 2", "", EX, [p["link2_inertia"]] * 3)
    if output_shaft:
        shafts += _body("output", "", EX, [p["output_inertia"]] * 3)
    return f"""<mujoco>
        <compiler angle="radian" inertiafromgeom="false"/>
        <option gravity="0 0 0" {options}><flag energy="enable"/></option>
        <worldbody>{shafts}</worldbody>
        {more}</mujoco>"""


def _model_text(
    case: Case, drives: Iterable[str], satellites: Mapping[str, str], step: float, integrator: str
) -> str:
    """Return the MuJoCo model with gears and freewheels, MJCF.

    Args:
        case: The case.
        drives: Names of the pinion shafts.
        satellites: Name of the pinion shaft of each satellite, by name of the satellite.
        step: Time step, s.
        integrator: Name of the MuJoCo integrator.
    """
    p = case.all_parameters
    k, s = ratio(p), satellite_ratio(p)
    softness = f'="0 {-1.0 / step!r}"', f'="{IMPEDANCE} {IMPEDANCE} 1"'
    rigid = f"solref{softness[0]} solimp{softness[1]}"
    active = f'limited="true" range="1e9 2e9" solreflimit{softness[0]} solimplimit{softness[1]}'
    slip = '<joint joint="output" coef="1"/><joint joint="link 2" coef="-1"/>'
    tendons = f'<fixed name="output slip" {active if p["output_freewheel"] else ""}>{slip}</fixed>'
    equalities = "" if p["output_freewheel"] else f'<tendon tendon1="output slip" {rigid}/>'
    if p["housing_freewheel"]:
        tendons += f'<fixed name="housing slip" {active}><joint joint="link 2" coef="1"/></fixed>'
    for name in drives:
        links = f'<joint joint="link 1" coef="{-k!r}"/><joint joint="link 2" coef="{k!r}"/>'
        tendons += f'<fixed name="mesh of {name}"><joint joint="{name}" coef="1"/>{links}</fixed>'
        equalities += f'<tendon tendon1="mesh of {name}" {rigid}/>'
    for name, drive in satellites.items():
        equalities += f'<joint joint1="{name}" joint2="{drive}" polycoef="0 {s!r} 0 0 0" {rigid}/>'
    return mechanism(
        p,
        options=f'timestep="{step!r}" integrator="{integrator}" iterations="100" tolerance="1e-14"',
        more=f"<tendon>{tendons}</tendon><equality>{equalities}</equality>",
        output_shaft=True,
        flywheel=FLYWHEEL * (p["input_inertia"] + p["link2_inertia"] + p["output_inertia"]),
    )


def simulate(case: Case, timestep: float, integrator: str) -> Trajectory:
    """Run a case in MuJoCo.

    Args:
        case: Case of the rigid module.
        timestep: Maximum time step, s. A sampling interval is a whole number of steps.
        integrator: "Euler" or "RK4".

    Raises:
        UnavailableError: The model does not support the case.
        MissingDependencyError: mujoco is not installed.
        RuntimeError: The state in MuJoCo is no longer finite.
    """
    Problem(case)
    engine, p = library("mujoco", "peers"), case.all_parameters
    places = [f"{m} {n}" for m in range(int(p["modules"])) for n in range(int(p["satellites"]))]
    drives = {f"drive {place if p['layout'] else place.split()[0]}": None for place in places}
    satellites = (
        {} if p["layout"] else {f"satellite {place}": f"drive {place.split()[0]}" for place in places}
    )
    interval = case.stop_time / case.points
    steps = max(1, math.ceil(interval / timestep * (1.0 - 1e-12)))
    text = _model_text(case, drives, satellites, interval / steps, integrator)
    model = engine.MjModel.from_xml_string(text)
    model.tendon_invweight0[:] = model.dof_invweight0[:] = INVERSE_INERTIA
    for name in (*satellites, *drives):
        model.dof_armature[model.joint(name).dofadr[0]] = ARMATURE
    data = engine.MjData(model)
    start, rate = p["drive_angle_start"], ratio(p) * (case.omega1 - p["omega2_start"])
    motion = {
        **{"link 1": (0.0, case.omega1), "link 2": (0.0, p["omega2_start"])},
        **{"output": (0.0, p["omega_out_start"])},
        **dict.fromkeys(drives, (start, rate)),
        **dict.fromkeys(satellites, (satellite_ratio(p) * start, satellite_ratio(p) * rate)),
    }

    def samples(points: int, steps: int) -> Iterator[tuple[float, float, float]]:
        """Run the case from its start and yield (q, omega2, omega3) at each point, rad and rad/s.

        Args:
            points: Number of intervals between points.
            steps: Number of time steps per interval.
        """
        engine.mj_resetData(model, data)
        for name, (angle, speed) in motion.items():
            data.joint(name).qpos[0], data.joint(name).qvel[0] = angle, speed
        data.joint("output").qfrc_applied[0] = -case.load_torque
        for n in range(points + 1):
            engine.mj_step(model, data, steps if n else 0)
            if any(warning.number for warning in data.warning):
                raise RuntimeError("MuJoCo failed: the state is no longer finite")
            q, omega2 = data.joint(next(iter(drives))).qpos[0], data.joint("link 2").qvel[0]
            yield q, omega2, data.joint("output").qvel[0]

    warn = engine.get_mju_user_warning()
    # the default function writes a log file into the working directory
    engine.set_mju_user_warning(lambda text: None)
    try:
        return Trajectory(
            motion=np.array(list(samples(case.points, steps))),
            evaluations=(4 if integrator == "RK4" else 1) * steps * case.points,
            wall_time=median_time(lambda: list(samples(1, steps * case.points))),
        )
    finally:
        engine.set_mju_user_warning(warn)
