"""The table of variables of the module: all that is stated of a variable is in its row.

The kernel's records have fields of these names (models.interface). The description and the shell of the FMU,
argument checks, documentation and the page are made from it. Names and meanings are the contract of the
module.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from typing import Any

from ..common.errors import must_be
from .variable import (
    BOOLEAN,
    DRIVE_ANGLE,
    ENUMERATION,
    ENUMERATIONS,
    FIXED,
    INPUT,
    INTEGER,
    LARGEST_SPEED,
    LARGEST_STEP,
    LARGEST_TORQUE,
    LINK1_ANGLE,
    LOCAL,
    OUTPUT,
    PARAMETER,
    PHASE,
    PULSES,
    REAL,
    SINCE_START,
    SOLVED,
    TUNABLE,
    TWIST,
    Group,
    Variable,
)


def _input(name: str, unit: str, start: float, limit: float, nominal: float, text: str) -> Variable:
    return Variable(name, Group.FLANGES, REAL, INPUT, "continuous", unit, start, -limit, limit, text, nominal)


def signal(
    causality: str,
    group: Group,
    name: str,
    unit: str,
    nominal: float | None,
    text: str,
    minimum: float | None = None,
    variability: str = "continuous",
    **columns: Any,
) -> Variable:
    """A Real that is calculated."""
    return Variable(
        name, group, REAL, causality, variability, unit, None, minimum, None, text, nominal, **columns
    )


def _imbalance(causality: str, name: str, unit: str, nominal: float, follows: str, *text: Any) -> Variable:
    """Motion of an imbalance, or a force that it makes: of an instant, by the place where it is."""
    place: dict[str, Any] = {"follows": follows, "late": True, "needs": (PHASE,)}
    return signal(causality, Group.IMBALANCE, name, unit, nominal, *text, **place)


def _counter(
    group: Group, name: str, text: str, minimum: float | None, causality: str = LOCAL, **columns: Any
) -> Variable:
    """A whole number; discrete is what changes at switches alone, for FMI 3.0 has that change in events alone."""
    return signal(causality, group, name, "1", None, text, minimum, follows=SINCE_START, **columns)


def _parameter(
    group: Group,
    name: str,
    unit: str,
    start: float,
    low: float | None,
    high: float | None,
    text: str,
    kind: str = REAL,
    variability: str = FIXED,
    **columns: Any,
) -> Variable:
    return Variable(name, group, kind, PARAMETER, variability, unit, start, low, high, text, **columns)


# a parameter that may change between steps
_tunable = partial(_parameter, variability=TUNABLE)


def _choice(group: Group, name: str, enumeration: str, start: int, text: str, **columns: Any) -> Variable:
    (_, low, _), *_, (_, high, _) = ENUMERATIONS[enumeration]
    columns["enumeration"] = enumeration
    return _parameter(group, name, "", start, low, high, text, ENUMERATION, **columns)


_INERTIA_LIMIT = 1e12
_SPEED_START_LIMIT = 1e6

VARIABLES: tuple[Variable, ...] = (
    _input("omega1", "rad/s", 100.0, LARGEST_SPEED, 100.0, "speed of the input shaft, link 1 (with drive = torque only that at the start)"),
    _input("load_torque", "N.m", 10.0, LARGEST_TORQUE, 10.0, "torque of the load on the output shaft, positive against positive speed"),
    _input("drive_torque", "N.m", 0.0, LARGEST_TORQUE, 10.0, "torque on the input shaft, link 1 (with drive = torque, else without effect)"),
    signal(OUTPUT, Group.MOTION, "omega2", "rad/s", 100.0, "speed of link 2, the output link of the differential", needs=(SOLVED, PULSES)),
    signal(OUTPUT, Group.MOTION, "omega_out", "rad/s", 100.0, "speed of the output shaft (driven mass if elastic)", needs=(SOLVED,), at_start=("omega1", "fidelity", "kinematic_ratio", "omega_out_start")),
    signal(OUTPUT, Group.INSTANT, "input_torque", "N.m", 100.0, "torque that drives the input shaft at this instant: M1 on link 1", late=True, needs=(PULSES,)),
    signal(OUTPUT, Group.INSTANT, "mesh_torque", "N.m", 100.0, "torque of the gear mesh on link 2 at this instant: M2", late=True, needs=(PULSES,)),
    signal(OUTPUT, Group.INSTANT, "output_torque", "N.m", 100.0, "torque in the output freewheel at this instant: Tc, drives the output shaft", late=True, needs=(PULSES,)),
    signal(OUTPUT, Group.INSTANT, "housing_torque", "N.m", 100.0, "torque in the housing freewheel at this instant: Th, holds link 2", late=True, needs=(PULSES,)),
    signal(OUTPUT, Group.MEANS, "input_torque_mean", "N.m", 100.0, "mean torque that drives the input shaft over the last communication step: M1, impulses included", at_start=()),
    signal(OUTPUT, Group.MEANS, "output_torque_mean", "N.m", 100.0, "mean torque in the output freewheel over the last communication step: Tc, impulses included", at_start=()),
    _imbalance(OUTPUT, "imbalance_acceleration", "m/s2", 1e3, DRIVE_ANGLE, "magnitude of the absolute acceleration of imbalance 0 of module 0", 0.0),
    _imbalance(OUTPUT, "imbalance_acceleration_x", "m/s2", 1e3, DRIVE_ANGLE, "absolute acceleration of imbalance 0 of module 0 along the central axis Ox (fixed frame)"),
    _imbalance(OUTPUT, "imbalance_acceleration_y", "m/s2", 1e3, LINK1_ANGLE, "absolute acceleration of imbalance 0 of module 0 along Oy (fixed frame)"),
    _imbalance(OUTPUT, "imbalance_acceleration_z", "m/s2", 1e3, LINK1_ANGLE, "absolute acceleration of imbalance 0 of module 0 along Oz (fixed frame)"),
    signal(OUTPUT, Group.MOTION, "input_speed", "rad/s", 100.0, "speed of the input shaft at this instant: what omega1 has come to, or drive_torque has made of it", at_start=("omega1",)),
    signal(OUTPUT, Group.MEANS, "mesh_torque_mean", "N.m", 100.0, "mean torque of the gear mesh on link 2 over the last communication step: M2, impulses included", late=True, at_start=()),
    signal(OUTPUT, Group.MEANS, "housing_torque_mean", "N.m", 100.0, "mean torque in the housing freewheel over the last communication step: Th, impulses included", late=True, at_start=()),
    signal(OUTPUT, Group.MOTION, "input_acceleration", "rad/s2", 1e3, "acceleration of the input shaft at this instant, jumps of omega1 apart", late=True, needs=(PULSES,)),
    signal(OUTPUT, Group.MOTION, "output_acceleration", "rad/s2", 1e3, "acceleration of the output shaft (driven mass if elastic) at this instant", late=True, needs=(SOLVED, PULSES)),
    signal(OUTPUT, Group.MOTION, "output_angle", "rad", 1.0, "angle of the output shaft (driven mass if elastic) since the start without output_turns whole turns", 0.0, follows=SINCE_START, needs=(SOLVED,), at_start=()),
    _counter(Group.MOTION, "output_turns", "whole turns of the output shaft taken off output_angle", None, OUTPUT, needs=(SOLVED,), at_start=()),
    signal(OUTPUT, Group.MOTION, "input_flange_angle", "rad", 1.0, "angle of the input flange, phi1 of link 1, since the start, whole turns included", follows=SINCE_START, at_start=()),
    signal(OUTPUT, Group.MOTION, "output_flange_angle", "rad", 1.0, "angle of the output flange, phi2 of the output shaft (driven mass if elastic), since the start, whole turns included", follows=SINCE_START, needs=(SOLVED,), at_start=()),
    signal(OUTPUT, Group.ENERGY, "loss_power_mean", "W", 1e3, "mean power lost over the last communication step: energy_lost gained over its length", late=True, at_start=()),
    _imbalance(OUTPUT, "satellite_force", "N", 1e3, DRIVE_ANGLE, "force of imbalance 0 on the bearing of its satellite, m |a|, at this instant", 0.0),
    _imbalance(OUTPUT, "satellite_force_peak", "N", 1e3, DRIVE_ANGLE, "largest satellite_force seen over the last communication step", 0.0),
    _imbalance(OUTPUT, "shaking_force_x", "N", 1e3, DRIVE_ANGLE, "force of all imbalances on the mount along the central axis Ox (fixed frame)"),
    _imbalance(OUTPUT, "shaking_force_y", "N", 1e3, LINK1_ANGLE, "force of all imbalances on the mount along Oy"),
    _imbalance(OUTPUT, "shaking_force_z", "N", 1e3, LINK1_ANGLE, "force of all imbalances on the mount along Oz"),
    _imbalance(OUTPUT, "shaking_moment_x", "N.m", 100.0, DRIVE_ANGLE, "moment of all imbalances, satellites and drives on the mount about Ox"),
    _imbalance(OUTPUT, "shaking_moment_y", "N.m", 100.0, LINK1_ANGLE, "moment of all imbalances, satellites and drives on the mount about Oy"),
    _imbalance(OUTPUT, "shaking_moment_z", "N.m", 100.0, LINK1_ANGLE, "moment of all imbalances, satellites and drives on the mount about Oz"),
    signal(LOCAL, Group.MOTION, "drive_angle", "rad", 1.0, "angle q of the drive without drive_turns whole turns: q = drive_angle + 2 pi drive_turns", 0.0, follows=DRIVE_ANGLE, needs=(PHASE,)),
    _counter(Group.MOTION, "drive_turns", "whole turns of the drive taken off drive_angle (a multiple of the turns in one period of the motion)", None, needs=(PHASE,)),
    signal(LOCAL, Group.MOTION, "input_angle", "rad", 1.0, "angle of the input shaft, theta1 of link 1, without input_turns whole turns", 0.0, follows=SINCE_START),
    _counter(Group.MOTION, "input_turns", "whole turns of the input shaft taken off input_angle", None),
    Variable("contact_mode", Group.FREEWHEELS, ENUMERATION, LOCAL, "discrete", "", None, 0, 3, "which freewheels are engaged", enumeration="ContactMode", needs=(PULSES,)),
    signal(LOCAL, Group.MOTION, "omega_hub", "rad/s", 100.0, "speed omega3 of the output shaft behind the freewheel", needs=(SOLVED,)),
    signal(LOCAL, Group.MOTION, "shaft_twist", "rad", 1e-2, "twist of the elastic output shaft (0 if rigid)", needs=(TWIST,)),
    _imbalance(LOCAL, "imbalance_x", "m", 0.1, DRIVE_ANGLE, "position of imbalance 0 of module 0 along the central axis Ox (fixed frame)"),
    _imbalance(LOCAL, "imbalance_y", "m", 0.1, LINK1_ANGLE, "position of imbalance 0 of module 0 along Oy"),
    _imbalance(LOCAL, "imbalance_z", "m", 0.1, LINK1_ANGLE, "position of imbalance 0 of module 0 along Oz"),
    _imbalance(LOCAL, "imbalance_velocity_x", "m/s", 10.0, DRIVE_ANGLE, "absolute velocity of imbalance 0 of module 0 along Ox"),
    _imbalance(LOCAL, "imbalance_velocity_y", "m/s", 10.0, LINK1_ANGLE, "absolute velocity of imbalance 0 of module 0 along Oy"),
    _imbalance(LOCAL, "imbalance_velocity_z", "m/s", 10.0, LINK1_ANGLE, "absolute velocity of imbalance 0 of module 0 along Oz"),
    signal(LOCAL, Group.ENERGY, "energy_in", "J", 1e3, "work of the input torque since the start", follows=SINCE_START),
    signal(LOCAL, Group.ENERGY, "energy_out", "J", 1e3, "work done on the load since the start", follows=SINCE_START),
    signal(LOCAL, Group.ENERGY, "energy_stored", "J", 1e3, "kinetic energy of the mechanism now, and the energy of a twisted shaft", late=True),
    signal(LOCAL, Group.ENERGY, "energy_lost", "J", 1e3, "energy lost since the start to damping and friction, less the work of the balancer (ideal freewheels and rigid shafts lose none)", follows=SINCE_START),
    signal(LOCAL, Group.ENERGY, "energy_lost_viscous", "J", 1e3, "part of energy_lost that viscous friction of links, drives and output shaft took", follows=SINCE_START),
    signal(LOCAL, Group.ENERGY, "energy_lost_shaft", "J", 1e3, "part of energy_lost that the elastic shaft and the friction of the driven mass took, less the work of the balancer", follows=SINCE_START),
    signal(LOCAL, Group.ENERGY, "energy_lost_mesh", "J", 1e3, "part of energy_lost that the meshes took", follows=SINCE_START),
    signal(LOCAL, Group.ENERGY, "energy_lost_journal", "J", 1e3, "part of energy_lost that the bearings of the satellites took", follows=SINCE_START),
    signal(LOCAL, Group.ENERGY, "energy_lost_freewheel", "J", 1e3, "part of energy_lost that drag and wind-up of the freewheels took", follows=SINCE_START),
    signal(LOCAL, Group.ENERGY, "energy_lost_windage", "J", 1e3, "part of energy_lost that the air about the satellites took", follows=SINCE_START),
    signal(LOCAL, Group.ENERGY, "energy_residual", "J", 1.0, "energy audit: in - out - lost - gain of stored, the error of the integration", follows=SINCE_START, late=True),
    signal(LOCAL, Group.RIPPLE, "torque_ripple", "N.m", 100.0, "ripple of the output torque over the last communication step: RMS of Tc about its mean, impulses apart", 0.0, late=True, needs=(PULSES,)),
    signal(LOCAL, Group.RIPPLE, "torque_peak", "N.m", 100.0, "largest magnitude of the output torque Tc over the last communication step, impulses apart", 0.0, late=True, needs=(PULSES,)),
    _counter(Group.FREEWHEELS, "contact_switches", "changes of the contact mode since the start", 0.0, variability="discrete", needs=(PULSES,)),
    _counter(Group.FREEWHEELS, "rhs_evaluations", "evaluations of the mechanism since the start: the cost", 0.0),
    _choice(Group.LAYOUT, "layout", "Layout", 0, "layout of the differential", in_map=True),
    _parameter(Group.BEVEL, "z2", "", 20, 1, 1000000, "teeth of wheel 2, fixed to link 2 (bevel)", INTEGER, in_map=True),
    _parameter(Group.BEVEL, "z16", "", 20, 1, 1000000, "teeth of the wheel of drive 16 (bevel)", INTEGER, in_map=True),
    _parameter(Group.BEVEL, "z17", "", 34, 1, 1000000, "teeth of the reactive wheel 17 (bevel)", INTEGER, in_map=True),
    _parameter(Group.BEVEL, "z6", "", 20, 1, 1000000, "teeth of satellite 6 (bevel)", INTEGER, in_map=True),
    _parameter(Group.BEVEL, "shaft_angle", "rad", math.pi / 2, 1e-6, 3.141591, "angle between the axes of satellite 6 and drive 16: Sigma (bevel)", in_map=True),
    _parameter(Group.BEVEL, "wheel_radius", "m", 0.08, 1e-6, 1e3, "pitch radius r17 of wheel 17 (bevel)", in_map=True),
    _parameter(Group.BEVEL, "a", "1", 1.0, 0.0, 100.0, "distance of the imbalance from the axis of its satellite, AD, over the pitch radius of the satellite (bevel)", in_map=True),
    _parameter(Group.BEVEL, "b", "1", 1.0, 0.0, 100.0, "distance of the imbalance from the apex of the pitch cones along the axis of its satellite, QA, over the height of the satellite's cone (bevel)", in_map=True),
    _parameter(Group.BEVEL, "c", "1", 1.0, 0.0, 100.0, "distance of the apex of the pitch cones from the central axis, OQ, over the height of the cone of wheel 17 (bevel)", in_map=True),
    _parameter(Group.BEVEL, "epsilon", "rad", 0.0, -1e3, 1e3, "angle of the imbalance about the axis of its satellite at drive angle 0 (bevel)", in_map=True),
    _parameter(Group.BEVEL, "gamma", "rad", 0.0, -1e3, 1e3, "angle of the satellite about the axis of the drive at drive angle 0 (bevel)", in_map=True),
    _parameter(Group.PLANAR, "sun_radius", "m", 0.05, 1e-6, 1e3, "radius R0 of the sun wheel, link 2 (planar)", in_map=True),
    _parameter(Group.PLANAR, "satellite_radius", "m", 0.03, 1e-6, 1e3, "radius r of a satellite (planar)", in_map=True),
    _parameter(Group.PLANAR, "eccentricity", "m", 0.02, 0.0, 1e3, "distance l of the imbalance from the axis of its satellite (planar)", in_map=True),
    _parameter(Group.MASSES, "imbalance_mass", "kg", 1.0, 0.0, 1e9, "mass m of one imbalance", in_map=True),
    _parameter(Group.LAYOUT, "modules", "", 1, 1, 1000, "number of modules, alike, about the central axis", INTEGER, in_map=True),
    _parameter(Group.LAYOUT, "satellites", "", 1, 1, 1000, "number of satellites (imbalances) in one module, evenly spread", INTEGER, in_map=True),
    _parameter(Group.MASSES, "drive_inertia", "kg.m2", 0.0, 0.0, _INERTIA_LIMIT, "inertia J16 of all drives about their axes", in_map=True),
    _parameter(Group.MASSES, "input_inertia", "kg.m2", 0.0, 0.0, _INERTIA_LIMIT, "inertia J1 of link 1 (with drive = torque that of the engine or motor too)", in_map=True),
    _parameter(Group.MASSES, "link2_inertia", "kg.m2", 0.005, 0.0, _INERTIA_LIMIT, "inertia J2 of link 2", in_map=True),
    _parameter(Group.MASSES, "output_inertia", "kg.m2", 0.5, 1e-12, _INERTIA_LIMIT, "inertia J3 of the output shaft (hub if elastic)"),
    _parameter(Group.ELASTIC, "driven_inertia", "kg.m2", 0.5, 1e-12, _INERTIA_LIMIT, "inertia J4 of the driven mass (elastic)"),
    _parameter(Group.ELASTIC, "shaft_stiffness", "N.m/rad", 400.0, 1e-6, 1e15, "stiffness c of the output shaft (elastic)", idle=True),
    _tunable(Group.ELASTIC, "shaft_damping", "N.m.s/rad", 0.05, 0.0, 1e12, "damping d of the output shaft (elastic)", idle=True),
    _tunable(Group.ELASTIC, "driven_friction", "N.m.s/rad", 0.0, 0.0, 1e12, "viscous friction f of the driven mass (elastic)"),
    _tunable(Group.ELASTIC, "balancer", "1", 0.0, -10.0, 10.0, "gain beta of the balancer (elastic)"),
    _tunable(Group.LOSSES, "input_friction", "N.m.s/rad", 0.0, 0.0, 1e3, "viscous friction b1 of link 1"),
    _tunable(Group.LOSSES, "drive_friction", "N.m.s/rad", 0.0, 0.0, 1e3, "viscous friction bq of all drives and satellites, as a torque against q", in_map=True),
    _tunable(Group.LOSSES, "link2_friction", "N.m.s/rad", 0.0, 0.0, 1e3, "viscous friction b2 of link 2", in_map=True),
    _tunable(Group.LOSSES, "output_friction", "N.m.s/rad", 0.0, 0.0, 1e3, "viscous friction b3 of the output shaft (hub if elastic)", in_map=True),
    _parameter(Group.LOSSES, "mesh_efficiency", "1", 1.0, 0.1, 1.0, "efficiency of the mesh of link 2 with the drives, gears turning, link 1 at rest", in_map=True),
    _parameter(Group.LOSSES, "satellite_mesh_efficiency", "1", 1.0, 0.1, 1.0, "efficiency of the mesh of the satellites with wheel 17 (bevel)", in_map=True),
    _tunable(Group.LOSSES, "journal_friction", "m", 0.0, 0.0, 1e3, "coefficient of friction of a satellite's bearing times the radius of its journal", in_map=True),
    _tunable(Group.LOSSES, "windage", "kg.m2", 0.0, 0.0, 1e3, "drag of the air on one satellite, as a torque over the square of its absolute angular speed", in_map=True),
    _tunable(Group.LOSSES, "housing_drag", "N.m", 0.0, 0.0, 1e9, "drag of the overrunning housing freewheel", in_map=True),
    _tunable(Group.LOSSES, "housing_drag_viscous", "N.m.s/rad", 0.0, 0.0, 1e3, "drag of the overrunning housing freewheel that grows with the speed of link 2, over that speed", in_map=True),
    _tunable(Group.LOSSES, "output_drag", "N.m", 0.0, 0.0, 1e9, "drag of the overrunning output freewheel", in_map=True),
    _tunable(Group.LOSSES, "output_drag_viscous", "N.m.s/rad", 0.0, 0.0, 1e3, "drag of the overrunning output freewheel that grows with the speed of the output shaft over link 2, over that speed", in_map=True),
    _parameter(Group.ELASTIC, "housing_stiffness", "N.m/rad", 0.0, 0.0, 1e15, "stiffness of the locked housing freewheel, 0: rigid (elastic)"),
    _tunable(Group.ELASTIC, "housing_damping", "N.m.s/rad", 0.0, 0.0, 1e12, "damping of the locked housing freewheel (elastic)"),
    _parameter(Group.ELASTIC, "freewheel_stiffness", "N.m/rad", 0.0, 0.0, 1e15, "stiffness of the locked output freewheel, 0: rigid (elastic)"),
    _tunable(Group.ELASTIC, "freewheel_damping", "N.m.s/rad", 0.0, 0.0, 1e12, "damping of the locked output freewheel (elastic)"),
    _parameter(Group.MASSES, "satellite_inertia", "kg.m2", 0.0, 0.0, _INERTIA_LIMIT, "inertia Ja of one satellite gear, imbalance apart, about its own axis", in_map=True),
    _parameter(Group.MASSES, "satellite_transverse_inertia", "kg.m2", 0.0, 0.0, _INERTIA_LIMIT, "inertia Jt of one satellite gear, imbalance apart, about any axis across its own (bevel)", in_map=True),
    _parameter(Group.MASSES, "gravity", "m/s2", 0.0, 0.0, 1e3, "gravity on the imbalances, along -Oz (the central axis Ox is level)"),
    _parameter(Group.LAYOUT, "housing_freewheel", "", 1.0, None, None, "whether link 2 has a freewheel to the housing", BOOLEAN),
    _parameter(Group.LAYOUT, "output_freewheel", "", 1.0, None, None, "whether link 2 has a freewheel to the output shaft, else it is rigid with it", BOOLEAN),
    _choice(Group.SOLVER, "fidelity", "Fidelity", 2, "what is modelled"),
    _choice(Group.SOLVER, "method", "Method", 0, "how it is integrated", idle=True),
    _choice(Group.FLANGES, "drive", "Drive", 0, "what is given at the input shaft, link 1: its speed or its torque", in_map=True),
    _choice(Group.SOLVER, "input_hold", "InputHold", 0, "speed omega1 between communication points", idle=True),
    _parameter(Group.SOLVER, "tolerance", "1", 1e-6, 1e-13, 0.1, "relative tolerance; that of the host's experiment wins", nominal=1e-6, idle=True),
    _parameter(Group.SOLVER, "max_step", "s", 0.0, 0.0, LARGEST_STEP, "longest internal step, 0 for no limit (timestepping: the communication step)", idle=True),
    _tunable(Group.SOLVER, "kinematic_ratio", "1", 0.0, -10.0, 10.0, "ratio of the speeds of link 2 and link 1, prescribed: omega2/omega1 (kinematic)"),
    _parameter(Group.START, "omega2_start", "rad/s", 0.0, -_SPEED_START_LIMIT, _SPEED_START_LIMIT, "speed of link 2 at the start"),
    _parameter(Group.START, "omega_out_start", "rad/s", 0.0, -_SPEED_START_LIMIT, _SPEED_START_LIMIT, "speed of the output shaft at the start"),
    _parameter(Group.START, "drive_angle_start", "rad", 0.0, -1e6, 1e6, "angle q of the drive at the start"),
)  # fmt: skip

BY_NAME: dict[str, Variable] = {variable.name: variable for variable in VARIABLES}

# parts of energy_lost by what they begin with: what follows is the cause
LOST_TO = "energy_lost_"
LOSSES: tuple[str, ...] = tuple(name for name in BY_NAME if name.startswith(LOST_TO))
# parameters that the torque map of fidelity averaged depends on
MAP_KEY: tuple[str, ...] = tuple(variable.name for variable in VARIABLES if variable.in_map)


def with_causality(*causalities: str, table: Iterable[Variable] = VARIABLES) -> Iterator[Variable]:
    """Variables of these causalities, in the order of the table."""
    return (variable for variable in table if variable.causality in causalities)


# names of the variables that the module computes
COMPUTED = tuple(variable.name for variable in with_causality(OUTPUT, LOCAL))


def default_parameters() -> dict[str, float]:
    """Start values of all parameters of the module by name: scene R1."""
    return {variable.name: float(variable.start or 0.0) for variable in with_causality(PARAMETER)}


def refused_parameters(values: Mapping[str, float], table: Iterable[Variable] = VARIABLES) -> list[str]:
    """One message for each parameter that is out of its own range."""
    return [
        must_be(variable.name, variable.allowed, values[variable.name])
        for variable in with_causality(PARAMETER, table=table)
        # start values are allowed, and most parameters have theirs
        if values[variable.name] != variable.start and not variable.accepts(values[variable.name])
    ]
