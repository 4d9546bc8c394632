"""The tables of variables of the models: all that is stated of a variable is in its row.

Records of the kernel (models.interface), description and shell of the FMU, argument checks, documentation and
the page are made from it. Names and meanings are the contract of the models.
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
from ..kernel import inputs
from ..kernel.codes import AVERAGED, KINEMATIC, RIGID
from ..kernel.equations.losses import CAUSES

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
LARGEST_SPEED: float = inputs.LARGEST_SPEED
LARGEST_TORQUE: float = inputs.LARGEST_TORQUE
LARGEST_STEP: float = inputs.LARGEST_STEP

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
        ("zero_order", 0, "speed constant between communication points (zero-order hold)"),
        ("linear", 1, "speed extrapolated linearly from the last two values (first-order hold)"),
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
        reference: value reference in the FMUs. Other programs store it, so it never changes. A new row takes
            the lowest number above all numbers of its model, the number of the time included.
        name: name in the FMU. group: that it is listed in. unit: of UNITS ("" where it has none).
        description: one sentence. start: start value (None: calculated).
        minimum, maximum, nominal: or None. kind: Real, Integer, Boolean or Enumeration.
        causality, variability: as in FMI 2.0; discrete is what changes at switches alone, for FMI 3.0 has
            that change in events alone. enumeration: name in ENUMERATIONS, or "".
        follows: what it depends on besides the speeds: SINCE_START, LINK1_ANGLE, DRIVE_ANGLE, or "".
        of_step: whether it is a mean or a peak of the last step, which has no rate.
        late: whether the kernel's STEP_ONLY leaves it out, for it takes more work than some steps do.
        needs: parts of the model without which it means nothing; a fidelity that lacks one has it not.
        at_start: of an output, all that it depends on at initialisation; None: on all but what is idle.
        idle: whether no output depends on this parameter at initialisation.
        in_map: whether the torque map of fidelity averaged depends on this parameter.
    """

    reference: int
    name: str
    group: str
    unit: str
    description: str
    start: float | None = None
    minimum: float | None = None
    maximum: float | None = None
    nominal: float | None = None
    causality: str = ""
    variability: str = "continuous"
    kind: str = REAL
    enumeration: str = ""
    follows: str = ""
    of_step: bool = False
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

_input = partial(Variable, causality=INPUT)
_output = partial(Variable, causality=OUTPUT)
_local = partial(Variable, causality=LOCAL)
_parameter = partial(Variable, causality=PARAMETER, variability=FIXED)
_tunable = partial(Variable, causality=PARAMETER, variability=TUNABLE)

_INERTIA_LIMIT = 1e12
_SPEED_START_LIMIT = 1e6

VARIABLES: tuple[Variable, ...] = (
    _input(0, "omega1", Group.FLANGES, "rad/s", "speed of the input shaft, link 1 (with drive = torque only that at the start)", 100.0, -LARGEST_SPEED, LARGEST_SPEED, nominal=100.0),
    _input(1, "load_torque", Group.FLANGES, "N.m", "torque of the load on the output shaft, positive against positive speed", 10.0, -LARGEST_TORQUE, LARGEST_TORQUE, nominal=10.0),
    _input(2, "drive_torque", Group.FLANGES, "N.m", "torque on the input shaft, link 1 (with drive = torque, else without effect)", 0.0, -LARGEST_TORQUE, LARGEST_TORQUE, nominal=10.0),
    _output(3, "omega2", Group.MOTION, "rad/s", "speed of link 2, the output link of the differential", nominal=100.0, needs=(SOLVED, PULSES)),
    _output(4, "omega_out", Group.MOTION, "rad/s", "speed of the output shaft (driven mass if elastic)", nominal=100.0, needs=(SOLVED,), at_start=("omega1", "fidelity", "kinematic_ratio", "omega_out_start")),
    _output(5, "input_torque", Group.INSTANT, "N.m", "torque that drives the input shaft at this instant: M1 on link 1", nominal=100.0, late=True, needs=(PULSES,)),
    _output(6, "mesh_torque", Group.INSTANT, "N.m", "torque of the gear mesh on link 2 at this instant: M2", nominal=100.0, late=True, needs=(PULSES,)),
    _output(7, "output_torque", Group.INSTANT, "N.m", "torque in the output freewheel at this instant: Tc, drives the output shaft", nominal=100.0, late=True, needs=(PULSES,)),
    _output(8, "housing_torque", Group.INSTANT, "N.m", "torque in the housing freewheel at this instant: Th, holds link 2", nominal=100.0, late=True, needs=(PULSES,)),
    _output(9, "input_torque_mean", Group.MEANS, "N.m", "mean torque that drives the input shaft over the last communication step: M1, impulses included", nominal=100.0, of_step=True, at_start=()),
    _output(10, "output_torque_mean", Group.MEANS, "N.m", "mean torque in the output freewheel over the last communication step: Tc, impulses included", nominal=100.0, of_step=True, at_start=()),
    _output(11, "imbalance_acceleration", Group.IMBALANCE, "m/s2", "magnitude of the absolute acceleration of imbalance 0 of module 0", nominal=1e3, minimum=0.0, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _output(12, "imbalance_acceleration_x", Group.IMBALANCE, "m/s2", "absolute acceleration of imbalance 0 of module 0 along the central axis Ox (fixed frame)", nominal=1e3, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _output(13, "imbalance_acceleration_y", Group.IMBALANCE, "m/s2", "absolute acceleration of imbalance 0 of module 0 along Oy (fixed frame)", nominal=1e3, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _output(14, "imbalance_acceleration_z", Group.IMBALANCE, "m/s2", "absolute acceleration of imbalance 0 of module 0 along Oz (fixed frame)", nominal=1e3, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _output(15, "input_speed", Group.MOTION, "rad/s", "speed of the input shaft at this instant: what omega1 has come to, or drive_torque has made of it", nominal=100.0, at_start=("omega1",)),
    _output(16, "mesh_torque_mean", Group.MEANS, "N.m", "mean torque of the gear mesh on link 2 over the last communication step: M2, impulses included", nominal=100.0, of_step=True, late=True, at_start=()),
    _output(17, "housing_torque_mean", Group.MEANS, "N.m", "mean torque in the housing freewheel over the last communication step: Th, impulses included", nominal=100.0, of_step=True, late=True, at_start=()),
    _output(18, "input_acceleration", Group.MOTION, "rad/s2", "acceleration of the input shaft at this instant, jumps of omega1 apart", nominal=1e3, late=True, needs=(PULSES,)),
    _output(19, "output_acceleration", Group.MOTION, "rad/s2", "acceleration of the output shaft (driven mass if elastic) at this instant", nominal=1e3, late=True, needs=(SOLVED, PULSES)),
    _output(20, "output_angle", Group.MOTION, "rad", "angle of the output shaft (driven mass if elastic) since the start without output_turns whole turns", nominal=1.0, minimum=0.0, follows=SINCE_START, needs=(SOLVED,), at_start=()),
    _output(21, "output_turns", Group.MOTION, "1", "whole turns of the output shaft taken off output_angle", follows=SINCE_START, needs=(SOLVED,), at_start=()),
    _output(22, "input_flange_angle", Group.MOTION, "rad", "angle of the input flange, phi1 of link 1, since the start, whole turns included", nominal=1.0, follows=SINCE_START, at_start=()),
    _output(23, "output_flange_angle", Group.MOTION, "rad", "angle of the output flange, phi2 of the output shaft (driven mass if elastic), since the start, whole turns included", nominal=1.0, follows=SINCE_START, needs=(SOLVED,), at_start=()),
    _output(24, "loss_power_mean", Group.ENERGY, "W", "mean power lost over the last communication step: energy_lost gained over its length", nominal=1e3, of_step=True, late=True, at_start=()),
    _output(25, "satellite_force", Group.IMBALANCE, "N", "force of imbalance 0 on the bearing of its satellite, m |a|, at this instant", nominal=1e3, minimum=0.0, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _output(26, "satellite_force_peak", Group.IMBALANCE, "N", "largest satellite_force seen over the last communication step", nominal=1e3, minimum=0.0, of_step=True, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _output(27, "shaking_force_x", Group.IMBALANCE, "N", "force of all imbalances on the mount along the central axis Ox (fixed frame)", nominal=1e3, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _output(28, "shaking_force_y", Group.IMBALANCE, "N", "force of all imbalances on the mount along Oy", nominal=1e3, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _output(29, "shaking_force_z", Group.IMBALANCE, "N", "force of all imbalances on the mount along Oz", nominal=1e3, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _output(30, "shaking_moment_x", Group.IMBALANCE, "N.m", "moment of all imbalances, satellites and drives on the mount about Ox", nominal=100.0, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _output(31, "shaking_moment_y", Group.IMBALANCE, "N.m", "moment of all imbalances, satellites and drives on the mount about Oy", nominal=100.0, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _output(32, "shaking_moment_z", Group.IMBALANCE, "N.m", "moment of all imbalances, satellites and drives on the mount about Oz", nominal=100.0, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _output(33, "housing_torque_peak", Group.RIPPLE, "N.m", "largest magnitude of the housing torque Th over the last communication step, impulses apart", nominal=100.0, minimum=0.0, of_step=True, late=True, needs=(SOLVED, PULSES)),
    _output(34, "housing_slip_peak", Group.FREEWHEELS, "rad/s", "largest overrunning speed of the housing freewheel over the last communication step: omega2", nominal=100.0, minimum=0.0, of_step=True, late=True, needs=(SOLVED, PULSES)),
    _output(35, "output_slip_peak", Group.FREEWHEELS, "rad/s", "largest overrunning speed of the output freewheel over the last communication step: omega_hub - omega2", nominal=100.0, minimum=0.0, of_step=True, late=True, needs=(SOLVED, PULSES)),
    _output(36, "housing_engagements", Group.FREEWHEELS, "1", "engagements of the housing freewheel since the start", minimum=0.0, variability="discrete", follows=SINCE_START, needs=(SOLVED, PULSES), at_start=()),
    _output(37, "output_engagements", Group.FREEWHEELS, "1", "engagements of the output freewheel since the start", minimum=0.0, variability="discrete", follows=SINCE_START, needs=(SOLVED, PULSES), at_start=()),
    _local(38, "drive_angle", Group.MOTION, "rad", "angle q of the drive without drive_turns whole turns: q = drive_angle + 2 pi drive_turns", nominal=1.0, minimum=0.0, follows=DRIVE_ANGLE, needs=(PHASE,)),
    _local(39, "drive_turns", Group.MOTION, "1", "whole turns of the drive taken off drive_angle (a multiple of the turns in one period of the motion)", follows=SINCE_START, needs=(PHASE,)),
    _local(40, "input_angle", Group.MOTION, "rad", "angle of the input shaft, theta1 of link 1, without input_turns whole turns", nominal=1.0, minimum=0.0, follows=SINCE_START),
    _local(41, "input_turns", Group.MOTION, "1", "whole turns of the input shaft taken off input_angle", follows=SINCE_START),
    _local(42, "contact_mode", Group.FREEWHEELS, "", "which freewheels are engaged", minimum=0, maximum=3, kind=ENUMERATION, variability="discrete", enumeration="ContactMode", needs=(PULSES,)),
    _local(43, "omega_hub", Group.MOTION, "rad/s", "speed omega3 of the output shaft behind the freewheel", nominal=100.0, needs=(SOLVED,)),
    _local(44, "shaft_twist", Group.MOTION, "rad", "twist of the elastic output shaft (0 if rigid)", nominal=1e-2, needs=(TWIST,)),
    _local(45, "imbalance_x", Group.IMBALANCE, "m", "position of imbalance 0 of module 0 along the central axis Ox (fixed frame)", nominal=0.1, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _local(46, "imbalance_y", Group.IMBALANCE, "m", "position of imbalance 0 of module 0 along Oy", nominal=0.1, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _local(47, "imbalance_z", Group.IMBALANCE, "m", "position of imbalance 0 of module 0 along Oz", nominal=0.1, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _local(48, "imbalance_velocity_x", Group.IMBALANCE, "m/s", "absolute velocity of imbalance 0 of module 0 along Ox", nominal=10.0, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _local(49, "imbalance_velocity_y", Group.IMBALANCE, "m/s", "absolute velocity of imbalance 0 of module 0 along Oy", nominal=10.0, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _local(50, "imbalance_velocity_z", Group.IMBALANCE, "m/s", "absolute velocity of imbalance 0 of module 0 along Oz", nominal=10.0, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _local(51, "energy_in", Group.ENERGY, "J", "work of the input torque since the start", nominal=1e3, follows=SINCE_START),
    _local(52, "energy_out", Group.ENERGY, "J", "work done on the load since the start", nominal=1e3, follows=SINCE_START),
    _local(53, "energy_stored", Group.ENERGY, "J", "kinetic energy of the mechanism now, and the energy of a twisted shaft", nominal=1e3, late=True),
    _local(54, "energy_lost", Group.ENERGY, "J", "energy lost since the start to damping and friction, less the work of the balancer (ideal freewheels and rigid shafts lose none)", nominal=1e3, follows=SINCE_START),
    _local(55, "energy_lost_viscous", Group.ENERGY, "J", "part of energy_lost that viscous friction of links, drives and output shaft took", nominal=1e3, follows=SINCE_START),
    _local(56, "energy_lost_shaft", Group.ENERGY, "J", "part of energy_lost that the elastic shaft and the friction of the driven mass took, less the work of the balancer", nominal=1e3, follows=SINCE_START),
    _local(57, "energy_lost_mesh", Group.ENERGY, "J", "part of energy_lost that the meshes took", nominal=1e3, follows=SINCE_START),
    _local(58, "energy_lost_journal", Group.ENERGY, "J", "part of energy_lost that the bearings of the satellites took", nominal=1e3, follows=SINCE_START),
    _local(59, "energy_lost_freewheel", Group.ENERGY, "J", "part of energy_lost that drag, wind-up and impacts of the freewheels took", nominal=1e3, follows=SINCE_START),
    _local(60, "energy_lost_windage", Group.ENERGY, "J", "part of energy_lost that the air about the satellites took", nominal=1e3, follows=SINCE_START),
    _local(61, "energy_residual", Group.ENERGY, "J", "energy audit: in - out - lost - gain of stored, the error of the integration", nominal=1.0, follows=SINCE_START, late=True),
    _local(62, "torque_ripple", Group.RIPPLE, "N.m", "ripple of the output torque over the last communication step: RMS of Tc about its mean, impulses apart", nominal=100.0, minimum=0.0, of_step=True, late=True, needs=(PULSES,)),
    _local(63, "torque_peak", Group.RIPPLE, "N.m", "largest magnitude of the output torque Tc over the last communication step, impulses apart", nominal=100.0, minimum=0.0, of_step=True, late=True, needs=(PULSES,)),
    _local(64, "contact_switches", Group.FREEWHEELS, "1", "changes of the contact mode since the start", minimum=0.0, variability="discrete", follows=SINCE_START, needs=(PULSES,)),
    _local(65, "rhs_evaluations", Group.FREEWHEELS, "1", "evaluations of the mechanism since the start: the cost", minimum=0.0, follows=SINCE_START),
    _parameter(66, "layout", Group.LAYOUT, "", "layout of the differential", 0, 0, 1, kind=ENUMERATION, enumeration="Layout", in_map=True),
    _parameter(67, "z2", Group.BEVEL, "", "teeth of wheel 2, fixed to link 2 (bevel)", 20, 1, 1000000, kind=INTEGER, in_map=True),
    _parameter(68, "z16", Group.BEVEL, "", "teeth of the wheel of drive 16 (bevel)", 20, 1, 1000000, kind=INTEGER, in_map=True),
    _parameter(69, "z17", Group.BEVEL, "", "teeth of the reactive wheel 17 (bevel)", 34, 1, 1000000, kind=INTEGER, in_map=True),
    _parameter(70, "z6", Group.BEVEL, "", "teeth of satellite 6 (bevel)", 20, 1, 1000000, kind=INTEGER, in_map=True),
    _parameter(71, "shaft_angle", Group.BEVEL, "rad", "angle between the axes of satellite 6 and drive 16: Sigma (bevel)", math.pi / 2, 1e-6, 3.141591, in_map=True),
    _parameter(72, "wheel_radius", Group.BEVEL, "m", "pitch radius r17 of wheel 17 (bevel)", 0.08, 1e-6, 1e3, in_map=True),
    _parameter(73, "a", Group.BEVEL, "1", "distance of the imbalance from the axis of its satellite, AD, over the pitch radius of the satellite (bevel)", 1.0, 0.0, 100.0, in_map=True),
    _parameter(74, "b", Group.BEVEL, "1", "distance of the imbalance from the apex of the pitch cones along the axis of its satellite, QA, over the height of the satellite's cone (bevel)", 1.0, 0.0, 100.0, in_map=True),
    _parameter(75, "c", Group.BEVEL, "1", "distance of the apex of the pitch cones from the central axis, OQ, over the height of the cone of wheel 17 (bevel)", 1.0, 0.0, 100.0, in_map=True),
    _parameter(76, "epsilon", Group.BEVEL, "rad", "angle of the imbalance about the axis of its satellite at drive angle 0 (bevel)", 0.0, -1e3, 1e3, in_map=True),
    _parameter(77, "gamma", Group.BEVEL, "rad", "angle of the satellite about the axis of the drive at drive angle 0 (bevel)", 0.0, -1e3, 1e3, in_map=True),
    _parameter(78, "sun_radius", Group.PLANAR, "m", "radius R0 of the sun wheel, link 2 (planar)", 0.05, 1e-6, 1e3, in_map=True),
    _parameter(79, "satellite_radius", Group.PLANAR, "m", "radius r of a satellite (planar)", 0.03, 1e-6, 1e3, in_map=True),
    _parameter(80, "eccentricity", Group.PLANAR, "m", "distance l of the imbalance from the axis of its satellite (planar)", 0.02, 0.0, 1e3, in_map=True),
    _parameter(81, "imbalance_mass", Group.MASSES, "kg", "mass m of one imbalance", 1.0, 0.0, 1e9, in_map=True),
    _parameter(82, "modules", Group.LAYOUT, "", "number of modules, alike, about the central axis", 1, 1, 1000, kind=INTEGER, in_map=True),
    _parameter(83, "satellites", Group.LAYOUT, "", "number of satellites (imbalances) in one module, evenly spread", 1, 1, 1000, kind=INTEGER, in_map=True),
    _parameter(84, "drive_inertia", Group.MASSES, "kg.m2", "inertia J16 of all drives about their axes", 0.0, 0.0, _INERTIA_LIMIT, in_map=True),
    _parameter(85, "input_inertia", Group.MASSES, "kg.m2", "inertia J1 of link 1 (with drive = torque that of the engine or motor too)", 0.0, 0.0, _INERTIA_LIMIT, in_map=True),
    _parameter(86, "link2_inertia", Group.MASSES, "kg.m2", "inertia J2 of link 2", 0.005, 0.0, _INERTIA_LIMIT, in_map=True),
    _parameter(87, "output_inertia", Group.MASSES, "kg.m2", "inertia J3 of the output shaft (hub if elastic)", 0.5, 1e-12, _INERTIA_LIMIT),
    _parameter(88, "driven_inertia", Group.ELASTIC, "kg.m2", "inertia J4 of the driven mass (elastic)", 0.5, 1e-12, _INERTIA_LIMIT),
    _parameter(89, "shaft_stiffness", Group.ELASTIC, "N.m/rad", "stiffness c of the output shaft (elastic)", 400.0, 1e-6, 1e15, idle=True),
    _tunable(90, "shaft_damping", Group.ELASTIC, "N.m.s/rad", "damping d of the output shaft (elastic)", 0.05, 0.0, 1e12, idle=True),
    _tunable(91, "driven_friction", Group.ELASTIC, "N.m.s/rad", "viscous friction f of the driven mass (elastic)", 0.0, 0.0, 1e12),
    _tunable(92, "balancer", Group.ELASTIC, "1", "gain beta of the balancer (elastic)", 0.0, -10.0, 10.0),
    _tunable(93, "input_friction", Group.LOSSES, "N.m.s/rad", "viscous friction b1 of link 1", 0.0, 0.0, 1e3, in_map=True),
    _tunable(94, "drive_friction", Group.LOSSES, "N.m.s/rad", "viscous friction bq of all drives and satellites, as a torque against q", 0.0, 0.0, 1e3, in_map=True),
    _tunable(95, "link2_friction", Group.LOSSES, "N.m.s/rad", "viscous friction b2 of link 2", 0.0, 0.0, 1e3, in_map=True),
    _tunable(96, "output_friction", Group.LOSSES, "N.m.s/rad", "viscous friction b3 of the output shaft (hub if elastic)", 0.0, 0.0, 1e3, in_map=True),
    _parameter(97, "mesh_efficiency", Group.LOSSES, "1", "efficiency of the mesh of link 2 with the drives, gears turning, link 1 at rest", 1.0, 0.1, 1.0, in_map=True),
    _parameter(98, "satellite_mesh_efficiency", Group.LOSSES, "1", "efficiency of the mesh of the satellites with wheel 17 (bevel)", 1.0, 0.1, 1.0, in_map=True),
    _tunable(99, "journal_friction", Group.LOSSES, "m", "coefficient of friction of a satellite's bearing times the radius of its journal", 0.0, 0.0, 1e3, in_map=True),
    _tunable(100, "windage", Group.LOSSES, "kg.m2", "drag of the air on one satellite, as a torque over the square of its absolute angular speed", 0.0, 0.0, 1e3, nominal=1e-4),
    _tunable(101, "housing_drag", Group.LOSSES, "N.m", "drag of the overrunning housing freewheel", 0.0, 0.0, 1e9, in_map=True),
    _tunable(102, "housing_drag_viscous", Group.LOSSES, "N.m.s/rad", "drag of the overrunning housing freewheel that grows with the speed of link 2, over that speed", 0.0, 0.0, 1e3, in_map=True),
    _tunable(103, "output_drag", Group.LOSSES, "N.m", "drag of the overrunning output freewheel", 0.0, 0.0, 1e9, in_map=True),
    _tunable(104, "output_drag_viscous", Group.LOSSES, "N.m.s/rad", "drag of the overrunning output freewheel that grows with the speed of the output shaft over link 2, over that speed", 0.0, 0.0, 1e3, in_map=True),
    _parameter(105, "housing_stiffness", Group.ELASTIC, "N.m/rad", "stiffness of the locked housing freewheel, 0: rigid (elastic)", 0.0, 0.0, 1e15),
    _tunable(106, "housing_damping", Group.ELASTIC, "N.m.s/rad", "damping of the locked housing freewheel (elastic)", 0.0, 0.0, 1e12),
    _parameter(107, "freewheel_stiffness", Group.ELASTIC, "N.m/rad", "stiffness of the locked output freewheel, 0: rigid (elastic)", 0.0, 0.0, 1e15),
    _tunable(108, "freewheel_damping", Group.ELASTIC, "N.m.s/rad", "damping of the locked output freewheel (elastic)", 0.0, 0.0, 1e12),
    _parameter(109, "housing_engagement_angle", Group.LOSSES, "rad", "angle by which the housing freewheel turns back, once it has overrun, before it carries; 0: at once", 0.0, 0.0, 1.0, in_map=True),
    _parameter(110, "output_engagement_angle", Group.LOSSES, "rad", "angle by which the output freewheel turns back, once it has overrun, before it carries; 0: at once", 0.0, 0.0, 1.0, in_map=True),
    _parameter(111, "satellite_inertia", Group.MASSES, "kg.m2", "inertia Ja of one satellite gear, imbalance apart, about its own axis", 0.0, 0.0, _INERTIA_LIMIT, in_map=True),
    _parameter(112, "satellite_transverse_inertia", Group.MASSES, "kg.m2", "inertia Jt of one satellite gear, imbalance apart, about any axis across its own (bevel)", 0.0, 0.0, _INERTIA_LIMIT, in_map=True),
    _parameter(113, "gravity", Group.MASSES, "m/s2", "gravity on the imbalances, along -Oz (the central axis Ox is level)", 0.0, 0.0, 1e3),
    _parameter(114, "housing_freewheel", Group.LAYOUT, "", "whether link 2 has a freewheel to the housing", 1.0, kind=BOOLEAN),
    _parameter(115, "output_freewheel", Group.LAYOUT, "", "whether link 2 has a freewheel to the output shaft, else it is rigid with it", 1.0, kind=BOOLEAN),
    _parameter(116, "fidelity", Group.SOLVER, "", "what is modelled", 2, 0, 3, kind=ENUMERATION, enumeration="Fidelity"),
    _parameter(117, "method", Group.SOLVER, "", "how it is integrated", 0, 0, 1, kind=ENUMERATION, enumeration="Method", idle=True),
    _parameter(118, "drive", Group.FLANGES, "", "what is given at the input shaft, link 1: its speed or its torque", 0, 0, 1, kind=ENUMERATION, enumeration="Drive", in_map=True),
    _parameter(119, "input_hold", Group.SOLVER, "", "speed omega1 between communication points", 0, 0, 1, kind=ENUMERATION, enumeration="InputHold", idle=True),
    _parameter(120, "tolerance", Group.SOLVER, "1", "relative tolerance; that of the host's experiment wins", 1e-6, 1e-13, 0.1, nominal=1e-6, idle=True),
    _parameter(121, "max_step", Group.SOLVER, "s", "longest internal step, 0 for no limit (timestepping: the communication step)", 0.0, 0.0, LARGEST_STEP, idle=True),
    _tunable(122, "kinematic_ratio", Group.SOLVER, "1", "ratio of the speeds of link 2 and link 1, prescribed: omega2/omega1 (kinematic)", 0.0, -10.0, 10.0),
    _parameter(123, "omega2_start", Group.START, "rad/s", "speed of link 2 at the start", 0.0, -_SPEED_START_LIMIT, _SPEED_START_LIMIT),
    _parameter(124, "omega_out_start", Group.START, "rad/s", "speed of the output shaft at the start", 0.0, -_SPEED_START_LIMIT, _SPEED_START_LIMIT),
    _parameter(125, "drive_angle_start", Group.START, "rad", "angle q of the drive at the start", 0.0, -1e6, 1e6),
)  # fmt: skip

# of FMI 3.0 alone; it was numbered after the 126 rows that the table had then
TIME = Variable(126, "time", "", "s", "time since the start of the run", causality="independent")

BY_NAME: dict[str, Variable] = {variable.name: variable for variable in VARIABLES}

# parts of energy_lost, in the order of the causes: what they begin with; what follows is the cause
LOST_TO = "energy_lost_"
LOSSES: tuple[str, ...] = tuple(LOST_TO + cause for cause in CAUSES)
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


def _as_in_module(reference: int, of_module: str, text: str = "", **columns: Any) -> Variable:
    """A variable of the shaft alone: that of the module; without "(elastic)", for there nothing else is."""
    known = BY_NAME[of_module]
    own: dict[str, Any] = {"late": False, "in_map": False, "idle": False, "needs": ()} | columns
    own |= {"reference": reference, "description": text or known.description.replace(" (elastic)", "")}
    return replace(known, **own)


# the driven shaft alone; inputs are at rest unless they are set, as the driven mass is: a hub that jumps is a shock
OF_SHAFT: tuple[Variable, ...] = (
    _as_in_module(0, "omega1", "speed of the hub, where the shaft is driven", name="hub_speed", start=0.0),
    _as_in_module(1, "load_torque", "torque of the load on the driven mass, positive against positive speed", start=0.0),
    _output(2, "shaft_torque", Group.INSTANT, "N.m", "torque of spring and damper at this instant: Ts, drives the driven mass, brakes the hub", nominal=100.0, at_start=("hub_speed", "shaft_stiffness", "shaft_damping", "omega_out_start", "twist_start")),
    _output(3, "shaft_torque_mean", Group.MEANS, "N.m", "mean torque of spring and damper over the last communication step: Ts", nominal=100.0, of_step=True, at_start=()),
    _as_in_module(4, "omega_out", "speed omega4 of the driven mass", at_start=("omega_out_start",)),
    _output(5, "driven_acceleration", Group.MOTION, "rad/s2", "angular acceleration of the driven mass at this instant", nominal=100.0),
    _output(6, "twist", Group.MOTION, "rad", "twist of the shaft: angle of the hub less that of the driven mass", nominal=1e-2, at_start=("twist_start",)),
    _as_in_module(7, "energy_in", "work of the hub on the shaft since the start"),
    _as_in_module(8, "energy_out", "work done on the load since the start"),
    _as_in_module(9, "energy_stored", "kinetic energy of the driven mass and energy of the twist now"),
    _as_in_module(10, "energy_lost", "energy turned to heat by damping and friction since the start, less the work of the balancer"),
    _as_in_module(11, "energy_residual", "energy audit: in - out - lost - gain of stored, rounding only"),
    _as_in_module(12, "driven_inertia"),
    _as_in_module(13, "shaft_stiffness", "stiffness c of the shaft"),
    _as_in_module(14, "shaft_damping", "damping d of the shaft"),
    _as_in_module(15, "driven_friction"),
    _as_in_module(16, "balancer", "gain beta of the balancer: the driven mass is pushed by beta J4 times the hub's acceleration", idle=True),
    _as_in_module(17, "input_hold", "speed of the hub between communication points", idle=True),
    _as_in_module(18, "omega_out_start", "speed of the driven mass at the start"),
    _parameter(19, "twist_start", Group.START, "rad", "twist of the shaft at the start", 0.0, -1e6, 1e6),
)  # fmt: skip

TIME_OF_SHAFT = replace(TIME, reference=20)

# --- flanges ---

# what a positive torque at a flange does at positive speed: brings energy into the model, or takes it out
INFLOW, OUTFLOW = "inflow", "outflow"


class Terminal(NamedTuple):
    """A rotating flange where models are connected: its speed and its torque, of which one is an input.

    Attributes:
        name, description: for people. speed, torque: names of variables. flow: INFLOW or OUTFLOW.
        angle: name of the variable, or "".
    """

    name: str
    description: str
    speed: str
    torque: str
    flow: str
    angle: str = ""


TERMINALS: tuple[Terminal, ...] = (
    Terminal("input_flange", "input shaft, its speed given (drive = speed): the torque it takes from the shaft in front", "omega1", "input_torque_mean", INFLOW, "input_flange_angle"),
    Terminal("input_flange_by_torque", "input shaft, its torque given (drive = torque)", "input_speed", "drive_torque", INFLOW, "input_flange_angle"),
    Terminal("output_flange", "output shaft (driven mass if elastic): the torque that the shaft behind takes from it is given", "omega_out", "load_torque", OUTFLOW, "output_flange_angle"),
    Terminal("load", "the output flange for a load that needs no angle, as the driven shaft has it", "omega_out", "load_torque", OUTFLOW),
)  # fmt: skip

TERMINALS_OF_SHAFT: tuple[Terminal, ...] = (
    Terminal("hub", "hub of the shaft, its speed given: the torque it takes from the shaft in front", "hub_speed", "shaft_torque_mean", INFLOW),
    Terminal("load", "driven mass: the torque that the load takes from it is given", "omega_out", "load_torque", OUTFLOW),
)  # fmt: skip
