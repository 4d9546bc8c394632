"""The mechanism as a tree of bodies for MuJoCo, an independent multibody engine: geometry only.

Each joint is a hinge of its own: link 1, link 2, the drives on link 1 and the satellites on them.
What couples them (gears, freewheels) is added by who uses the tree. Nothing of the kernel is used.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ..trajectory import Array

NEXT_TO_NOTHING = 1e-13  # the engine wants every moving body to have mass and inertia
EX, EY, EZ = np.eye(3)

Parameters = Mapping[str, Any]


def turn(axis: int, angle: float) -> Array:
    """Matrix of a turn about axis 0, 1 or 2 (x, y, z) by an angle, rad, shape (3, 3)."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[j, i] = np.sin(angle)
    matrix[i, j] = -matrix[j, i]
    return matrix


def ratio(p: Parameters) -> float:
    """k: turns of the drive on link 1 per turn of link 1 against link 2."""
    return float(p["sun_radius"] / p["satellite_radius"] if p["layout"] else p["z2"] / p["z16"])


def satellite_ratio(p: Parameters) -> float:
    """s: turns of the satellite on the drive per turn of the drive."""
    return float(1.0 if p["layout"] else p["z17"] / p["z6"])


def bevel_lengths(p: Parameters) -> tuple[float, float, float]:
    """(AD, QA, OQ), m: the pitch cones touch on the line about which the satellite turns in link 1."""
    satellite_axis = turn(1, -p["shaft_angle"]) @ EZ
    line = EZ + satellite_ratio(p) * satellite_axis
    line /= np.linalg.norm(line)
    cone = p["wheel_radius"] / np.linalg.norm(np.cross(line, EZ))
    radius = cone * np.linalg.norm(np.cross(line, satellite_axis))
    return (
        float(p["a"] * radius),
        float(p["b"] * cone * (line @ satellite_axis)),
        float(p["c"] * cone * (line @ EZ)),
    )


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{value:.17g}" for value in values)


def _frame(place: Array, turned: Array) -> str:
    return f'pos="{_numbers(place)}" xyaxes="{_numbers([*turned[:, 0], *turned[:, 1]])}"'


def _inertial(mass: float, *inertia: float) -> str:
    return f'<inertial pos="0 0 0" mass="{mass:.17g}" diaginertia="{_numbers(inertia)}"/>'


def _imbalance(p: Parameters, name: str, place: Iterable[float]) -> str:
    inertial = _inertial(p["imbalance_mass"], *[NEXT_TO_NOTHING] * 3)
    return f'<body name="{name}" pos="{_numbers(place)}">{inertial}</body>'


def _bevel_module(p: Parameters, module: int) -> str:
    """Drive about the z axis of link 1, satellites on it. Half of J16 across its axis is J1's."""
    own = max(p["drive_inertia"] / p["modules"], NEXT_TO_NOTHING)
    ad, qa, oq = bevel_lengths(p)
    satellites = ""
    for n in range(int(p["satellites"])):
        turned = turn(2, p["gamma"] + 2.0 * np.pi * n / p["satellites"]) @ turn(1, -p["shaft_angle"])
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


def _planar_module(p: Parameters, module: int) -> str:
    """Satellites on link 1, their axes parallel to the central one."""
    own = max(p["drive_inertia"] / p["modules"] / p["satellites"], NEXT_TO_NOTHING)
    centre = (p["sun_radius"] + p["satellite_radius"]) * EZ
    satellites = ""
    for n in range(int(p["satellites"])):
        turned = turn(0, 2.0 * np.pi * n / p["satellites"])
        satellites += (
            f"<body {_frame(turned @ centre, turned)}>"
            f'<joint name="drive {module} {n}" type="hinge" axis="1 0 0"/>'
            f"{_inertial(NEXT_TO_NOTHING, own, own, own)}"
            f"{_imbalance(p, f'imbalance {module} {n}', (0.0, 0.0, -p['eccentricity']))}</body>"
        )
    return f"{_inertial(NEXT_TO_NOTHING, *[NEXT_TO_NOTHING] * 3)}{satellites}"


def _shaft(name: str, inertia: float, children: str = "") -> str:
    return (
        f'<body><joint name="{name}" type="hinge" axis="{_numbers(EX)}"/>'
        f"{_inertial(NEXT_TO_NOTHING, *[inertia] * 3)}{children}</body>"
    )


def mechanism(
    p: Parameters, options: str = "", more: str = "", output_shaft: bool = False, flywheel: float = 0.0
) -> str:
    """The MuJoCo model (MJCF) of the mechanism.

    Args:
        p: all parameters of the module by name.
        options: attributes of <option>. more: elements beside the worldbody.
        output_shaft: whether the output shaft is there. flywheel: inertia on link 1 beyond J1, kg m^2.
    """
    module = _planar_module if p["layout"] else _bevel_module
    # of the input inertia J1 the drives of the bevel layout already bring half of J16
    rest = p["input_inertia"] - (0.0 if p["layout"] else 0.5 * p["drive_inertia"]) + flywheel
    frames = [_frame(np.zeros(3), turn(0, 1.1 * n)) for n in range(int(p["modules"]))]
    modules = "".join(f"<body {frame}>{module(p, n)}</body>" for n, frame in enumerate(frames))
    shafts = _shaft("link 1", rest, modules) + _shaft("link 2", p["link2_inertia"])
    if output_shaft:
        shafts += _shaft("output", p["output_inertia"])
    return f"""<mujoco>
        <compiler angle="radian" inertiafromgeom="false"/>
        <option gravity="0 0 0" {options}><flag energy="enable"/></option>
        <worldbody>{shafts}</worldbody>
        {more}</mujoco>"""
