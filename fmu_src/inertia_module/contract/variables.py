"""The table of variables of the module.

The FMU description, the argument checks and docs/variables.md use it. Names and meanings are the contract of
the module; the kernel's records have fields of these names.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

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
    REAL,
    SINCE_START,
    TUNABLE,
    Variable,
)


def _input(name: str, unit: str, start: float, limit: float, nominal: float, text: str) -> Variable:
    return Variable(name, REAL, INPUT, "continuous", unit, start, -limit, limit, nominal, text)


def _signal(
    causality: str,
    name: str,
    unit: str,
    nominal: float | None,
    text: str,
    minimum: float | None = None,
    follows: str = "",
) -> Variable:
    return Variable(
        name, REAL, causality, "continuous", unit, None, minimum, None, nominal, text, follows=follows
    )


def _counter(
    name: str,
    text: str,
    minimum: float | None = 0.0,
    causality: str = LOCAL,
    variability: str = "continuous",
) -> Variable:
    """A whole number; discrete is what changes at switches alone, for FMI 3.0 has that change in events alone."""
    return Variable(
        name, REAL, causality, variability, "1", None, minimum, None, None, text, follows=SINCE_START
    )


def _real(
    name: str,
    unit: str,
    start: float,
    low: float,
    high: float,
    text: str,
    nominal: float | None = None,
) -> Variable:
    return Variable(name, REAL, PARAMETER, FIXED, unit, start, low, high, nominal, text)


def _tunable(name: str, unit: str, start: float, low: float, high: float, text: str) -> Variable:
    """A parameter that may change between steps."""
    return replace(_real(name, unit, start, low, high, text), variability=TUNABLE)


def _whole(name: str, start: int, low: int, high: int, text: str) -> Variable:
    return Variable(name, INTEGER, PARAMETER, FIXED, "", start, low, high, None, text)


def _choice(name: str, enumeration: str, start: int, text: str) -> Variable:
    items = ENUMERATIONS[enumeration]
    return Variable(
        name,
        ENUMERATION,
        PARAMETER,
        FIXED,
        "",
        start,
        items[0][1],
        items[-1][1],
        None,
        text,
        enumeration,
    )


def _switch(name: str, start: bool, text: str) -> Variable:
    return Variable(name, BOOLEAN, PARAMETER, FIXED, "", float(start), None, None, None, text)


_INERTIA_LIMIT = 1e12
_SPEED_START_LIMIT = 1e6

VARIABLES: tuple[Variable, ...] = (
    _input("omega1", "rad/s", 100.0, LARGEST_SPEED, 100.0, "speed of the input shaft, link 1 (with drive = torque only that at the start)"),
    _input("load_torque", "N.m", 10.0, LARGEST_TORQUE, 10.0, "torque of the load on the output shaft, positive against positive speed"),
    _input("drive_torque", "N.m", 0.0, LARGEST_TORQUE, 10.0, "torque on the input shaft, link 1 (with drive = torque, else without effect)"),
    _signal(OUTPUT, "omega2", "rad/s", 100.0, "speed of link 2, the output link of the differential"),
    _signal(OUTPUT, "omega_out", "rad/s", 100.0, "speed of the output shaft (driven mass if elastic)"),
    _signal(OUTPUT, "input_torque", "N.m", 100.0, "torque that drives the input shaft at this instant: M1 on link 1"),
    _signal(OUTPUT, "mesh_torque", "N.m", 100.0, "torque of the gear mesh on link 2 at this instant: M2"),
    _signal(OUTPUT, "output_torque", "N.m", 100.0, "torque in the output freewheel at this instant: Tc, drives the output shaft"),
    _signal(OUTPUT, "housing_torque", "N.m", 100.0, "torque in the housing freewheel at this instant: Th, holds link 2"),
    _signal(OUTPUT, "input_torque_mean", "N.m", 100.0, "mean torque that drives the input shaft over the last communication step: M1, impulses included"),
    _signal(OUTPUT, "output_torque_mean", "N.m", 100.0, "mean torque in the output freewheel over the last communication step: Tc, impulses included"),
    _signal(OUTPUT, "imbalance_acceleration", "m/s2", 1e3, "magnitude of the absolute acceleration of imbalance 0 of module 0", 0.0, follows=DRIVE_ANGLE),
    _signal(OUTPUT, "imbalance_acceleration_x", "m/s2", 1e3, "absolute acceleration of imbalance 0 of module 0 along the central axis Ox (fixed frame)", follows=DRIVE_ANGLE),
    _signal(OUTPUT, "imbalance_acceleration_y", "m/s2", 1e3, "absolute acceleration of imbalance 0 of module 0 along Oy (fixed frame)", follows=LINK1_ANGLE),
    _signal(OUTPUT, "imbalance_acceleration_z", "m/s2", 1e3, "absolute acceleration of imbalance 0 of module 0 along Oz (fixed frame)", follows=LINK1_ANGLE),
    _signal(OUTPUT, "input_speed", "rad/s", 100.0, "speed of the input shaft at this instant: what omega1 has come to, or drive_torque has made of it"),
    _signal(OUTPUT, "mesh_torque_mean", "N.m", 100.0, "mean torque of the gear mesh on link 2 over the last communication step: M2, impulses included"),
    _signal(OUTPUT, "housing_torque_mean", "N.m", 100.0, "mean torque in the housing freewheel over the last communication step: Th, impulses included"),
    _signal(OUTPUT, "input_acceleration", "rad/s2", 1e3, "acceleration of the input shaft at this instant, jumps of omega1 apart"),
    _signal(OUTPUT, "output_acceleration", "rad/s2", 1e3, "acceleration of the output shaft (driven mass if elastic) at this instant"),
    _signal(OUTPUT, "output_angle", "rad", 1.0, "angle of the output shaft (driven mass if elastic) since the start without output_turns whole turns", 0.0, follows=SINCE_START),
    _counter("output_turns", "whole turns of the output shaft taken off output_angle", None, OUTPUT),
    _signal(OUTPUT, "input_flange_angle", "rad", 1.0, "angle of the input flange, phi1 of link 1, since the start, whole turns included", follows=SINCE_START),
    _signal(OUTPUT, "output_flange_angle", "rad", 1.0, "angle of the output flange, phi2 of the output shaft (driven mass if elastic), since the start, whole turns included", follows=SINCE_START),
    _signal(OUTPUT, "loss_power_mean", "W", 1e3, "mean power lost over the last communication step: energy_lost gained over its length"),
    _signal(OUTPUT, "satellite_force", "N", 1e3, "force of imbalance 0 on the bearing of its satellite, m |a|, at this instant", 0.0, follows=DRIVE_ANGLE),
    _signal(OUTPUT, "satellite_force_peak", "N", 1e3, "largest satellite_force seen over the last communication step", 0.0, follows=DRIVE_ANGLE),
    _signal(OUTPUT, "shaking_force_x", "N", 1e3, "force of all imbalances on the mount along the central axis Ox (fixed frame)", follows=DRIVE_ANGLE),
    _signal(OUTPUT, "shaking_force_y", "N", 1e3, "force of all imbalances on the mount along Oy", follows=LINK1_ANGLE),
    _signal(OUTPUT, "shaking_force_z", "N", 1e3, "force of all imbalances on the mount along Oz", follows=LINK1_ANGLE),
    _signal(OUTPUT, "shaking_moment_x", "N.m", 100.0, "moment of all imbalances, satellites and drives on the mount about Ox", follows=DRIVE_ANGLE),
    _signal(OUTPUT, "shaking_moment_y", "N.m", 100.0, "moment of all imbalances, satellites and drives on the mount about Oy", follows=LINK1_ANGLE),
    _signal(OUTPUT, "shaking_moment_z", "N.m", 100.0, "moment of all imbalances, satellites and drives on the mount about Oz", follows=LINK1_ANGLE),
    _signal(LOCAL, "drive_angle", "rad", 1.0, "angle q of the drive without drive_turns whole turns: q = drive_angle + 2 pi drive_turns", 0.0, follows=DRIVE_ANGLE),
    _counter("drive_turns", "whole turns of the drive taken off drive_angle (a multiple of the turns in one period of the motion)", None),
    _signal(LOCAL, "input_angle", "rad", 1.0, "angle of the input shaft, theta1 of link 1, without input_turns whole turns", 0.0, follows=SINCE_START),
    _counter("input_turns", "whole turns of the input shaft taken off input_angle", None),
    Variable("contact_mode", ENUMERATION, LOCAL, "discrete", "", None, 0, 3, None, "which freewheels are engaged", "ContactMode"),
    _signal(LOCAL, "omega_hub", "rad/s", 100.0, "speed omega3 of the output shaft behind the freewheel"),
    _signal(LOCAL, "shaft_twist", "rad", 1e-2, "twist of the elastic output shaft (0 if rigid)"),
    _signal(LOCAL, "imbalance_x", "m", 0.1, "position of imbalance 0 of module 0 along the central axis Ox (fixed frame)", follows=DRIVE_ANGLE),
    _signal(LOCAL, "imbalance_y", "m", 0.1, "position of imbalance 0 of module 0 along Oy", follows=LINK1_ANGLE),
    _signal(LOCAL, "imbalance_z", "m", 0.1, "position of imbalance 0 of module 0 along Oz", follows=LINK1_ANGLE),
    _signal(LOCAL, "imbalance_velocity_x", "m/s", 10.0, "absolute velocity of imbalance 0 of module 0 along Ox", follows=DRIVE_ANGLE),
    _signal(LOCAL, "imbalance_velocity_y", "m/s", 10.0, "absolute velocity of imbalance 0 of module 0 along Oy", follows=LINK1_ANGLE),
    _signal(LOCAL, "imbalance_velocity_z", "m/s", 10.0, "absolute velocity of imbalance 0 of module 0 along Oz", follows=LINK1_ANGLE),
    _signal(LOCAL, "energy_in", "J", 1e3, "work of the input torque since the start", follows=SINCE_START),
    _signal(LOCAL, "energy_out", "J", 1e3, "work done on the load since the start", follows=SINCE_START),
    _signal(LOCAL, "energy_stored", "J", 1e3, "kinetic energy of the mechanism now, and the energy of a twisted shaft"),
    _signal(LOCAL, "energy_lost", "J", 1e3, "energy lost since the start to damping and friction, less the work of the balancer (ideal freewheels and rigid shafts lose none)", follows=SINCE_START),
    _signal(LOCAL, "energy_lost_viscous", "J", 1e3, "part of energy_lost that viscous friction of links, drives and output shaft took", follows=SINCE_START),
    _signal(LOCAL, "energy_lost_shaft", "J", 1e3, "part of energy_lost that the elastic shaft and the friction of the driven mass took, less the work of the balancer", follows=SINCE_START),
    _signal(LOCAL, "energy_lost_mesh", "J", 1e3, "part of energy_lost that the meshes took", follows=SINCE_START),
    _signal(LOCAL, "energy_lost_journal", "J", 1e3, "part of energy_lost that the bearings of the satellites took", follows=SINCE_START),
    _signal(LOCAL, "energy_lost_freewheel", "J", 1e3, "part of energy_lost that drag and wind-up of the freewheels took", follows=SINCE_START),
    _signal(LOCAL, "energy_residual", "J", 1.0, "energy audit: in - out - lost - gain of stored, the error of the integration", follows=SINCE_START),
    _signal(LOCAL, "torque_ripple", "N.m", 100.0, "ripple of the output torque over the last communication step: RMS of Tc about its mean, impulses apart", 0.0),
    _signal(LOCAL, "torque_peak", "N.m", 100.0, "largest magnitude of the output torque Tc over the last communication step, impulses apart", 0.0),
    _counter("contact_switches", "changes of the contact mode since the start", variability="discrete"),
    _counter("rhs_evaluations", "evaluations of the mechanism since the start: the cost"),
    _choice("layout", "Layout", 0, "layout of the differential"),
    _whole("z2", 20, 1, 1000000, "teeth of wheel 2, fixed to link 2 (bevel)"),
    _whole("z16", 20, 1, 1000000, "teeth of the wheel of drive 16 (bevel)"),
    _whole("z17", 34, 1, 1000000, "teeth of the reactive wheel 17 (bevel)"),
    _whole("z6", 20, 1, 1000000, "teeth of satellite 6 (bevel)"),
    _real("shaft_angle", "rad", math.pi / 2, 1e-6, 3.141591, "angle between the axes of satellite 6 and drive 16: Sigma (bevel)"),
    _real("wheel_radius", "m", 0.08, 1e-6, 1e3, "pitch radius r17 of wheel 17 (bevel)"),
    _real("a", "1", 1.0, 0.0, 100.0, "distance of the imbalance from the axis of its satellite, AD, over the pitch radius of the satellite (bevel)"),
    _real("b", "1", 1.0, 0.0, 100.0, "distance of the imbalance from the apex of the pitch cones along the axis of its satellite, QA, over the height of the satellite's cone (bevel)"),
    _real("c", "1", 1.0, 0.0, 100.0, "distance of the apex of the pitch cones from the central axis, OQ, over the height of the cone of wheel 17 (bevel)"),
    _real("epsilon", "rad", 0.0, -1e3, 1e3, "angle of the imbalance about the axis of its satellite at drive angle 0 (bevel)"),
    _real("gamma", "rad", 0.0, -1e3, 1e3, "angle of the satellite about the axis of the drive at drive angle 0 (bevel)"),
    _real("sun_radius", "m", 0.05, 1e-6, 1e3, "radius R0 of the sun wheel, link 2 (planar)"),
    _real("satellite_radius", "m", 0.03, 1e-6, 1e3, "radius r of a satellite (planar)"),
    _real("eccentricity", "m", 0.02, 0.0, 1e3, "distance l of the imbalance from the axis of its satellite (planar)"),
    _real("imbalance_mass", "kg", 1.0, 0.0, 1e9, "mass m of one imbalance"),
    _whole("modules", 1, 1, 1000, "number of modules, alike, about the central axis"),
    _whole("satellites", 1, 1, 1000, "number of satellites (imbalances) in one module, evenly spread"),
    _real("drive_inertia", "kg.m2", 0.0, 0.0, _INERTIA_LIMIT, "inertia J16 of all drives about their axes"),
    _real("input_inertia", "kg.m2", 0.0, 0.0, _INERTIA_LIMIT, "inertia J1 of link 1 (with drive = torque that of the engine or motor too)"),
    _real("link2_inertia", "kg.m2", 0.005, 0.0, _INERTIA_LIMIT, "inertia J2 of link 2"),
    _real("output_inertia", "kg.m2", 0.5, 1e-12, _INERTIA_LIMIT, "inertia J3 of the output shaft (hub if elastic)"),
    _real("driven_inertia", "kg.m2", 0.5, 1e-12, _INERTIA_LIMIT, "inertia J4 of the driven mass (elastic)"),
    _real("shaft_stiffness", "N.m/rad", 400.0, 1e-6, 1e15, "stiffness c of the output shaft (elastic)"),
    _tunable("shaft_damping", "N.m.s/rad", 0.05, 0.0, 1e12, "damping d of the output shaft (elastic)"),
    _tunable("driven_friction", "N.m.s/rad", 0.0, 0.0, 1e12, "viscous friction f of the driven mass (elastic)"),
    _tunable("balancer", "1", 0.0, -10.0, 10.0, "gain beta of the balancer (elastic)"),
    _tunable("input_friction", "N.m.s/rad", 0.0, 0.0, 1e3, "viscous friction b1 of link 1"),
    _tunable("drive_friction", "N.m.s/rad", 0.0, 0.0, 1e3, "viscous friction bq of all drives and satellites, as a torque against q"),
    _tunable("link2_friction", "N.m.s/rad", 0.0, 0.0, 1e3, "viscous friction b2 of link 2"),
    _tunable("output_friction", "N.m.s/rad", 0.0, 0.0, 1e3, "viscous friction b3 of the output shaft (hub if elastic)"),
    _real("mesh_efficiency", "1", 1.0, 0.1, 1.0, "efficiency of the mesh of link 2 with the drives, gears turning, link 1 at rest"),
    _real("satellite_mesh_efficiency", "1", 1.0, 0.1, 1.0, "efficiency of the mesh of the satellites with wheel 17 (bevel)"),
    _tunable("journal_friction", "m", 0.0, 0.0, 1e3, "coefficient of friction of a satellite's bearing times the radius of its journal"),
    _tunable("housing_drag", "N.m", 0.0, 0.0, 1e9, "drag of the overrunning housing freewheel"),
    _tunable("housing_drag_viscous", "N.m.s/rad", 0.0, 0.0, 1e3, "drag of the overrunning housing freewheel that grows with the speed of link 2, over that speed"),
    _tunable("output_drag", "N.m", 0.0, 0.0, 1e9, "drag of the overrunning output freewheel"),
    _tunable("output_drag_viscous", "N.m.s/rad", 0.0, 0.0, 1e3, "drag of the overrunning output freewheel that grows with the speed of the output shaft over link 2, over that speed"),
    _real("housing_stiffness", "N.m/rad", 0.0, 0.0, 1e15, "stiffness of the locked housing freewheel, 0: rigid (elastic)"),
    _tunable("housing_damping", "N.m.s/rad", 0.0, 0.0, 1e12, "damping of the locked housing freewheel (elastic)"),
    _real("freewheel_stiffness", "N.m/rad", 0.0, 0.0, 1e15, "stiffness of the locked output freewheel, 0: rigid (elastic)"),
    _tunable("freewheel_damping", "N.m.s/rad", 0.0, 0.0, 1e12, "damping of the locked output freewheel (elastic)"),
    _real("satellite_inertia", "kg.m2", 0.0, 0.0, _INERTIA_LIMIT, "inertia Ja of one satellite gear, imbalance apart, about its own axis"),
    _real("satellite_transverse_inertia", "kg.m2", 0.0, 0.0, _INERTIA_LIMIT, "inertia Jt of one satellite gear, imbalance apart, about any axis across its own (bevel)"),
    _real("gravity", "m/s2", 0.0, 0.0, 1e3, "gravity on the imbalances, along -Oz (the central axis Ox is level)"),
    _switch("housing_freewheel", True, "whether link 2 has a freewheel to the housing"),
    _switch("output_freewheel", True, "whether link 2 has a freewheel to the output shaft, else it is rigid with it"),
    _choice("fidelity", "Fidelity", 2, "what is modelled"),
    _choice("method", "Method", 0, "how it is integrated"),
    _choice("drive", "Drive", 0, "what is given at the input shaft, link 1: its speed or its torque"),
    _choice("input_hold", "InputHold", 0, "speed omega1 between communication points"),
    _real("tolerance", "1", 1e-6, 1e-13, 0.1, "relative tolerance; that of the host's experiment wins", 1e-6),
    _real("max_step", "s", 0.0, 0.0, LARGEST_STEP, "longest internal step, 0 for no limit (timestepping: the communication step)"),
    _tunable("kinematic_ratio", "1", 0.0, -10.0, 10.0, "ratio of the speeds of link 2 and link 1, prescribed: omega2/omega1 (kinematic)"),
    _real("omega2_start", "rad/s", 0.0, -_SPEED_START_LIMIT, _SPEED_START_LIMIT, "speed of link 2 at the start"),
    _real("omega_out_start", "rad/s", 0.0, -_SPEED_START_LIMIT, _SPEED_START_LIMIT, "speed of the output shaft at the start"),
    _real("drive_angle_start", "rad", 0.0, -1e6, 1e6, "angle q of the drive at the start"),
)  # fmt: skip

BY_NAME: dict[str, Variable] = {variable.name: variable for variable in VARIABLES}

# parts of energy_lost by what they begin with: what follows is the cause
LOST_TO = "energy_lost_"
LOSSES: tuple[str, ...] = tuple(name for name in BY_NAME if name.startswith(LOST_TO))


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
