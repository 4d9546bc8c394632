"""The axes of friction, losses by load, drag, gravity, wind-up and bodies: tiny, usual and dominant."""

from __future__ import annotations

import math
from collections.abc import Iterator

from .case import ELASTIC_LEVELS, Extreme
from .mechanisms import TRAVEL, Mechanism, imbalance_inertia

EFFICIENCIES = (1.0 - 1e-12, 0.97, 0.5, 0.1)
# an elastic output: hub and driven mass, kg.m2
ELASTIC_OUTPUT = {"output_inertia": 0.02, "driven_inertia": 0.5}

Extremes = Iterator[Extreme]


def viscous_friction(mechanism: Mechanism) -> Extremes:
    """Of links 1 and 2, of the drives and of the output shaft, up to all that is allowed."""
    for part in ("input", "drive", "link2", "output"):
        for viscous in (1e-12, 1e-2, 1.0, 1e3):
            yield mechanism.extreme(f"{part} {viscous:g} N.m.s/rad", {f"{part}_friction": viscous})


def efficiency(mechanism: Mechanism) -> Extremes:
    """Of the mesh of link 2, of that of the satellites and of both, from 1 - 1e-12 to 0.1."""
    both = ("mesh_efficiency", "satellite_mesh_efficiency")
    meshes = {"link 2": both[:1], "satellites": both[1:], "both": both}
    for where, names in meshes.items() if mechanism.layout == "bevel" else [("link 2", both[:1])]:
        for value in EFFICIENCIES:
            called = "1 - 1e-12" if value > 0.99 else f"{value:g}"
            yield mechanism.extreme(f"{where} {called}", dict.fromkeys(names, value))


def journal_friction(mechanism: Mechanism) -> Extremes:
    """The journals of the satellites, from nothing to far more than the imbalances can turn."""
    for lever in (1e-12, 1e-3, 0.1, 1.0, 1e3):
        yield mechanism.extreme(f"{lever:g} m", {"journal_friction": lever})


def stick(mechanism: Mechanism) -> Extremes:
    """Links 1 and 2 locked together at the same speed by friction, for a short and for a long time."""
    together = dict.fromkeys(("omega2_start", "omega_out_start"), mechanism.omega1)
    for lever in (1.0, 1e3):
        locked = together | {"journal_friction": lever, "drive_angle_start": 3.0}
        for turned in (TRAVEL, 1e6, 1e9):
            value = f"journals {lever:g} m, {turned:g} rad"
            time = turned / mechanism.omega1
            yield mechanism.extreme(value, locked, load=1.0, duration=time, slow=turned >= 1e6)


def drag(mechanism: Mechanism) -> Extremes:
    """Of overrunning freewheels, constant and viscous, up to what stops any motion."""
    for wheel in ("housing", "output"):
        for torque in (1e-12, 1.0, 1e3, 1e9):
            yield mechanism.extreme(f"{wheel} {torque:g} N.m", {f"{wheel}_drag": torque})
        for viscous in (1e-12, 1e-2, 1.0, 1e3):
            yield mechanism.extreme(f"{wheel} {viscous:g} N.m.s/rad", {f"{wheel}_drag_viscous": viscous})


def gravity(mechanism: Mechanism) -> Extremes:
    """Next to the acceleration of the imbalances, from nothing to a thousand times as much."""
    for g, omega1 in ((1e-12, mechanism.omega1), (9.81, mechanism.omega1), (1e3, mechanism.omega1)):
        yield mechanism.extreme(f"{g:g} m/s2", {"gravity": g}, omega1=omega1)
    for omega1 in (10.0, 1.0, 1e-3):
        for load in (0.1, 0.0):
            value = f"1000 m/s2 at {omega1:g} rad/s, load {load:g} N.m"
            time = TRAVEL / max(omega1, 1.0)
            yield mechanism.extreme(value, {"gravity": 1e3}, omega1=omega1, load=load, duration=time)


def wind_up(mechanism: Mechanism) -> Extremes:
    """Freewheels that wind up: soft and stiff, without and with damping."""
    inertia = float(mechanism.derived.J2)
    for wheels in (("housing",), ("freewheel",), ("housing", "freewheel")):
        for exponent in range(2, 10):
            stiffness = 10.0**exponent
            for damped, part in (("no damping", 0.0), ("damped", 0.1)):
                damping = 2.0 * part * math.sqrt(stiffness * inertia)
                values = {f"{wheel}_stiffness": stiffness for wheel in wheels}
                values |= {f"{wheel}_damping": damping for wheel in wheels}
                value = f"{' and '.join(wheels)} {stiffness:g} N.m/rad, {damped}"
                yield mechanism.extreme(value, ELASTIC_OUTPUT | values, duration=0.1, levels=ELASTIC_LEVELS)


def satellite_bodies(mechanism: Mechanism) -> Extremes:
    """Inertia of the satellite gears about and (bevel) across their axes, next to that of the imbalances."""
    imbalance = imbalance_inertia(mechanism.derived)
    names = {"Ja": "satellite_inertia", "Jt": "satellite_transverse_inertia"}
    for symbol, name in names.items():
        for ratio in (1e-9, 1e-3, 1.0, 1e3, 1e6) if symbol == "Ja" or mechanism.layout == "bevel" else ():
            yield mechanism.extreme(f"{symbol} {ratio:g}", {name: ratio * imbalance})


def all_losses(mechanism: Mechanism) -> Extremes:
    """Everything that takes energy and gravity at once, one after the other tiny, usual and dominant."""
    usual = {"mesh_efficiency": 0.97, "journal_friction": 1e-3, "gravity": 9.81}
    usual |= {"housing_drag": 0.5, "output_drag": 0.5, "input_friction": 0.01, "link2_friction": 0.01}
    for called, part in (("1e-12 of the usual", 1e-12), ("usual", 1.0), ("10 times the usual", 10.0)):
        values = {name: part * value for name, value in usual.items()}
        yield mechanism.extreme(called, values | {"mesh_efficiency": 1.0 - 0.03 * part})


LOSS_AXES = (
    *(viscous_friction, efficiency, journal_friction, stick, drag),
    *(gravity, wind_up, satellite_bodies, all_losses),
)
