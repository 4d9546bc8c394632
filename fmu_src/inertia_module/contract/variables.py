"""The tables of variables of the models: all that is stated of a variable is in its row.

The kernel's records have fields of these names (models.interface). The description and the shell of the FMU,
argument checks, documentation and the page are made from it. Names and meanings are the contract of the
models.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import partial
from typing import Any, NamedTuple

from ..common.errors import Refused, must_be
from ..common.units import BOOLEANS, number_of, parse_unit
from ..kernel import limits
from ..kernel.codes import AVERAGED, KINEMATIC, RIGID

REAL = "Real"
INTEGER = "Integer"
BOOLEAN = "Boolean"
ENUMERATION = "Enumeration"

INPUT = "input"
OUTPUT = "output"
LOCAL = "local"
PARAMETER = "parameter"

# variabilities of parameters
FIXED = "fixed"
TUNABLE = "tunable"

# what a value depends on besides the speeds: the start, whence it is a sum, or an angle
SINCE_START = "a sum since the start"
LINK1_ANGLE = "the angle of link 1"
DRIVE_ANGLE = "the angle of the drive"


class Group(StrEnum):
    """Groups that variables are listed in, in this order: no host can make a tree of their flat names."""

    FLANGES = "Given at the flanges"
    MOTION = "Speeds, angles, accelerations"
    MEANS = "Torques, mean over the step"
    INSTANT = "Torques at this instant"
    RIPPLE = "Ripple"
    IMBALANCE = "Imbalance, bearing and mount"
    ENERGY = "Energy"
    FREEWHEELS = "Freewheels and cost"
    LAYOUT = "Layout"
    BEVEL = "Bevel layout"
    PLANAR = "Planar layout"
    MASSES = "Masses and gravity"
    ELASTIC = "Elastic output"
    LOSSES = "Losses"
    SOLVER = "Model and solver"
    START = "Start"


class Need(NamedTuple):
    """Part of the model without which a variable means nothing.

    Attributes:
        lacking: fidelities without it. reason: why they are, after "fidelity averaged".
    """

    lacking: tuple[int, ...]
    reason: str


SOLVED = Need((KINEMATIC,), "prescribes the motion instead of solving it")
PULSES = Need((AVERAGED,), "has no pulses, only their mean")
PHASE = Need((AVERAGED,), "has no drive angle, so it does not know where the imbalance is")
TWIST = Need((AVERAGED, RIGID), "has no elastic shaft")

# what the kernel takes for absurd
LARGEST_SPEED: float = limits.LARGEST_SPEED
LARGEST_TORQUE: float = limits.LARGEST_TORQUE
LARGEST_STEP: float = limits.LARGEST_STEP

# units in the order of the description, by their exponents of kg, m, s, rad
UNITS: dict[str, dict[str, int]] = {
    unit: parse_unit(unit)[1]
    for unit in (
        *("1", "rad", "rad/s", "rad/s2", "m", "m/s", "m/s2", "s", "kg", "kg.m2"),
        *("N.m", "N.m/rad", "N.m.s/rad", "J", "N", "W"),
    )
}

# display units: name and factor from the base unit
DISPLAY_UNITS: dict[str, tuple[str, float]] = {
    "rad": ("deg", 180.0 / math.pi),
    "rad/s": ("rpm", 30.0 / math.pi),
}

ENUMERATIONS: dict[str, tuple[tuple[str, int, str], ...]] = {
    "Layout": (
        ("bevel", 0, "bevel differential, satellites on a bevel wheel (Karetin)"),
        ("planar", 1, "planar differential, satellites rolling on a sun wheel (Lysenko)"),
    ),
    "Fidelity": (
        ("kinematic", 0, "speed ratio prescribed, torques by inverse dynamics"),
        ("averaged", 1, "mean torques and speeds"),
        ("rigid", 2, "pulses and freewheels, rigid shafts"),
        ("elastic", 3, "rigid, with an elastic output shaft and a driven mass behind it"),
    ),
    "Method": (
        ("event", 0, "high order between located events"),
        ("timestepping", 1, "fixed steps of max_step, complementarity on impulses"),
    ),
    "Drive": (
        ("speed", 0, "omega1 is given, the input torque follows"),
        ("torque", 1, "drive_torque is given, the speed of link 1 follows"),
    ),
    "InputHold": (
        ("constant", 0, "omega1 constant between communication points"),
        ("linear", 1, "omega1 extrapolated linearly from the last two values"),
    ),
    "ContactMode": (
        ("held", 0, "link 2 held by the housing freewheel, output shaft coasting"),
        ("free", 1, "both freewheels open"),
        ("driving", 2, "link 2 drives the output shaft"),
        ("held_driving", 3, "link 2 and the output shaft both at rest"),
    ),
}


@dataclass(frozen=True)
class Variable:
    """One variable of the module.

    Attributes:
        name: name in the FMU. group: that it is listed in. kind: Real, Integer, Boolean or Enumeration.
        causality, variability: as in FMI 2.0. unit: of UNITS ("" where it has none).
        start: start value (None: calculated). minimum, maximum, nominal: or None.
        description: one sentence. enumeration: name in ENUMERATIONS, or "".
        follows: what it depends on besides the speeds: SINCE_START, LINK1_ANGLE, DRIVE_ANGLE, or "".
        late: whether the kernel's STEP_ONLY leaves it out, for it takes more work than some steps do.
        needs: parts of the model without which it means nothing; a fidelity that lacks one has it not.
        at_start: of an output, all that it depends on at initialisation; None: on all but what is idle.
        idle: whether no output depends on this parameter at initialisation.
        in_map: whether the torque map of fidelity averaged depends on this parameter.
    """

    name: str
    group: str
    kind: str
    causality: str
    variability: str
    unit: str
    start: float | None
    minimum: float | None
    maximum: float | None
    description: str
    nominal: float | None = None
    enumeration: str = ""
    follows: str = ""
    late: bool = False
    needs: tuple[Need, ...] = ()
    at_start: tuple[str, ...] | None = None
    idle: bool = False
    in_map: bool = False

    @property
    def is_tunable(self) -> bool:
        """Tell whether it is a parameter that may change between steps."""
        return self.variability == TUNABLE

    @property
    def ends(self) -> tuple[float, float]:
        """Ends of its range; the numbers of an enumeration have no gaps."""
        if self.kind == BOOLEAN:
            return 0.0, 1.0
        low = -math.inf if self.minimum is None else self.minimum
        return low, math.inf if self.maximum is None else self.maximum

    @property
    def allowed(self) -> str:
        """The allowed values, as they follow "must be"."""
        if self.kind == BOOLEAN:
            return "true or false"
        if self.kind == ENUMERATION:
            *others, last = (f"{number} ({name})" for name, number, _ in ENUMERATIONS[self.enumeration])
            return f"{', '.join(others)} or {last}"
        low, high = self.ends
        unit = f" {self.unit}" if self.unit not in ("", "1") else ""
        number = "a whole number " if self.kind == INTEGER else ""
        return f"{number}between {low:.16g} and {high:.16g}{unit}"

    @property
    def items(self) -> Mapping[str, float] | None:
        """Numbers by name, where it is an enumeration or a Boolean."""
        if self.kind == BOOLEAN:
            return BOOLEANS
        if self.kind == ENUMERATION:
            return {name: float(number) for name, number, _ in ENUMERATIONS[self.enumeration]}
        return None

    def number(self, value: Any) -> float:
        """The number that it accepts for a value: a number, a string with a unit, the name of an item.

        Raises:
            Refused: it is none of these, or out of its range.
        """
        try:
            number = value if isinstance(value, float) else number_of(value, self.unit or "1", self.items)
        except ValueError:
            raise Refused(must_be(self.name, self.allowed, repr(value))) from None
        if not self.accepts(number):
            raise Refused(must_be(self.name, self.allowed, number))
        return number

    def accepts(self, value: float) -> bool:
        """Tell whether a value is finite, whole where it has to be, and within the range."""
        low, high = self.ends
        return math.isfinite(value) and low <= value <= high and (self.kind == REAL or value % 1.0 == 0.0)


# --- the module ---


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
    _tunable(Group.LOSSES, "input_friction", "N.m.s/rad", 0.0, 0.0, 1e3, "viscous friction b1 of link 1", in_map=True),
    _tunable(Group.LOSSES, "drive_friction", "N.m.s/rad", 0.0, 0.0, 1e3, "viscous friction bq of all drives and satellites, as a torque against q", in_map=True),
    _tunable(Group.LOSSES, "link2_friction", "N.m.s/rad", 0.0, 0.0, 1e3, "viscous friction b2 of link 2", in_map=True),
    _tunable(Group.LOSSES, "output_friction", "N.m.s/rad", 0.0, 0.0, 1e3, "viscous friction b3 of the output shaft (hub if elastic)", in_map=True),
    _parameter(Group.LOSSES, "mesh_efficiency", "1", 1.0, 0.1, 1.0, "efficiency of the mesh of link 2 with the drives, gears turning, link 1 at rest", in_map=True),
    _parameter(Group.LOSSES, "satellite_mesh_efficiency", "1", 1.0, 0.1, 1.0, "efficiency of the mesh of the satellites with wheel 17 (bevel)", in_map=True),
    _tunable(Group.LOSSES, "journal_friction", "m", 0.0, 0.0, 1e3, "coefficient of friction of a satellite's bearing times the radius of its journal", in_map=True),
    _tunable(Group.LOSSES, "windage", "kg.m2", 0.0, 0.0, 1e3, "drag of the air on one satellite, as a torque over the square of its absolute angular speed", nominal=1e-4),
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


# --- the driven shaft ---


def _as_in_module(of_module: str, text: str = "", **columns: Any) -> Variable:
    """A variable of the shaft alone: that of the module; without "(elastic)", for there nothing else is."""
    known = BY_NAME[of_module]
    own: dict[str, Any] = {"late": False, "in_map": False, "idle": False, "needs": ()} | columns
    return replace(known, description=text or known.description.replace(" (elastic)", ""), **own)


# the driven shaft alone; inputs are at rest unless they are set, as the driven mass is: a hub that jumps is a shock
OF_SHAFT: tuple[Variable, ...] = (
    _as_in_module("omega1", "speed of the hub, where the shaft is driven", name="hub_speed", start=0.0),
    _as_in_module("load_torque", "torque of the load on the driven mass, positive against positive speed", start=0.0),
    signal(OUTPUT, Group.INSTANT, "shaft_torque", "N.m", 100.0, "torque of spring and damper at this instant: Ts, drives the driven mass, brakes the hub", at_start=("hub_speed", "shaft_stiffness", "shaft_damping", "omega_out_start", "twist_start")),
    signal(OUTPUT, Group.MEANS, "shaft_torque_mean", "N.m", 100.0, "mean torque of spring and damper over the last communication step: Ts", at_start=()),
    _as_in_module("omega_out", "speed omega4 of the driven mass", at_start=("omega_out_start",)),
    signal(OUTPUT, Group.MOTION, "driven_acceleration", "rad/s2", 100.0, "angular acceleration of the driven mass at this instant"),
    signal(OUTPUT, Group.MOTION, "twist", "rad", 1e-2, "twist of the shaft: angle of the hub less that of the driven mass", at_start=("twist_start",)),
    _as_in_module("energy_in", "work of the hub on the shaft since the start"),
    _as_in_module("energy_out", "work done on the load since the start"),
    _as_in_module("energy_stored", "kinetic energy of the driven mass and energy of the twist now"),
    _as_in_module("energy_lost", "energy turned to heat by damping and friction since the start, less the work of the balancer"),
    _as_in_module("energy_residual", "energy audit: in - out - lost - gain of stored, rounding only"),
    _as_in_module("driven_inertia"),
    _as_in_module("shaft_stiffness", "stiffness c of the shaft"),
    _as_in_module("shaft_damping", "damping d of the shaft"),
    _as_in_module("driven_friction"),
    _as_in_module("balancer", "gain beta of the balancer: the driven mass is pushed by beta J4 times the hub's acceleration", idle=True),
    _as_in_module("input_hold", "speed of the hub between communication points", idle=True),
    _as_in_module("omega_out_start", "speed of the driven mass at the start"),
    Variable("twist_start", Group.START, REAL, PARAMETER, FIXED, "rad", 0.0, -1e6, 1e6, "twist of the shaft at the start"),
)  # fmt: skip
