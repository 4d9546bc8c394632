"""The mechanism as a tree of bodies for MuJoCo, an independent multibody engine.

Each joint is a hinge of its own: link 1, link 2, the drives on link 1 and the satellites on them.
What couples them (gears, freewheels) is added by who uses the tree. Nothing of the kernel is used.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..reference.geometry import EX, EZ, Array, Parameters, bevel_lengths, turn

NEGLIGIBLE = 1e-13  # kg, kg m^2: the engine wants every moving body to have mass and inertia


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{value:.17g}" for value in values)


def _frame(place: Array, turned: Array) -> str:
    return f'pos="{_numbers(place)}" xyaxes="{_numbers([*turned[:, 0], *turned[:, 1]])}"'


def _inertial(mass: float, *inertia: float) -> str:
    return f'<inertial pos="0 0 0" mass="{mass:.17g}" diaginertia="{_numbers(inertia)}"/>'


def _imbalance(p: Parameters, name: str, place: Iterable[float]) -> str:
    inertial = _inertial(p["imbalance_mass"], *[NEGLIGIBLE] * 3)
    return f'<body name="{name}" pos="{_numbers(place)}">{inertial}</body>'


def _bevel_module(p: Parameters, module: int) -> str:
    """Drive about the z axis of link 1, satellites on it. Half of J16 across its axis is J1's."""
    own = max(p["drive_inertia"] / p["modules"], NEGLIGIBLE)
    across = max(p["satellite_transverse_inertia"], NEGLIGIBLE)
    gear = across, across, max(p["satellite_inertia"], NEGLIGIBLE)
    ad, qa, oq = bevel_lengths(p)
    satellites = ""
    for n in range(int(p["satellites"])):
        turned = turn(2, p["gamma"] + 2.0 * np.pi * n / p["satellites"]) @ turn(1, -p["shaft_angle"])
        satellites += (
            f"<body {_frame(oq * EZ, turned)}>"
            f'<joint name="satellite {module} {n}" type="hinge" axis="0 0 1"/>'
            f"{_inertial(NEGLIGIBLE, *gear)}"
            f"{_imbalance(p, f'imbalance {module} {n}', (-ad, 0.0, -qa))}</body>"
        )
    return (
        f'<joint name="drive {module}" type="hinge" axis="0 0 1"/>'
        f"{_inertial(NEGLIGIBLE, 0.5 * own, 0.5 * own, own)}{satellites}"
    )


def _planar_module(p: Parameters, module: int) -> str:
    """Satellites on link 1, their axes parallel to the central one."""
    own = max(p["drive_inertia"] / p["modules"] / p["satellites"] + p["satellite_inertia"], NEGLIGIBLE)
    centre = (p["sun_radius"] + p["satellite_radius"]) * EZ
    satellites = ""
    for n in range(int(p["satellites"])):
        turned = turn(0, 2.0 * np.pi * n / p["satellites"])
        satellites += (
            f"<body {_frame(turned @ centre, turned)}>"
            f'<joint name="drive {module} {n}" type="hinge" axis="1 0 0"/>'
            f"{_inertial(NEGLIGIBLE, own, own, own)}"
            f"{_imbalance(p, f'imbalance {module} {n}', (0.0, 0.0, -p['eccentricity']))}</body>"
        )
    return f"{_inertial(NEGLIGIBLE, *[NEGLIGIBLE] * 3)}{satellites}"


def _shaft(name: str, inertia: float, children: str = "") -> str:
    return (
        f'<body><joint name="{name}" type="hinge" axis="{_numbers(EX)}"/>'
        f"{_inertial(NEGLIGIBLE, *[inertia] * 3)}{children}</body>"
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
    frames = [_frame(np.zeros(3), turn(0, 2.0 * np.pi * n / p["modules"])) for n in range(int(p["modules"]))]
    modules = "".join(f"<body {frame}>{module(p, n)}</body>" for n, frame in enumerate(frames))
    shafts = _shaft("link 1", rest, modules) + _shaft("link 2", p["link2_inertia"])
    if output_shaft:
        shafts += _shaft("output", p["output_inertia"])
    return f"""<mujoco>
        <compiler angle="radian" inertiafromgeom="false"/>
        <option gravity="0 0 0" {options}><flag energy="enable"/></option>
        <worldbody>{shafts}</worldbody>
        {more}</mujoco>"""
