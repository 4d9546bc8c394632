"""The tables of variables of the models: a row contains all properties of a variable.

The records of the kernel (models.interface), the FMU with its description, argument checks, documentation and
the viewer are made from the tables. Names and meanings are the contract of the models.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import partial
from typing import Any, NamedTuple

from ..common.errors import ParameterError, must_be
from ..common.units import BOOLEANS, number_of, parse_unit, with_reason
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

# dependencies of a value in addition to the speeds: a sum depends on its start, other values on an angle
SINCE_START = "a cumulative value since the start"
LINK1_ANGLE = "the carrier angle"
DRIVE_ANGLE = "the pinion-shaft angle"


class Group(StrEnum):
    """Groups of variables in the order of the documentation; FMUs have flat names, so they show no groups."""

    FLANGES = "Inputs at the flanges"
    MOTION = "Speeds, angles, accelerations"
    MEANS = "Step-averaged torques"
    INSTANT = "Instantaneous torques"
    RIPPLE = "Torque ripple and peaks"
    IMBALANCE = "Unbalanced mass, bearing and mounting forces"
    ENERGY = "Energy"
    FREEWHEELS = "Freewheels and computational cost"
    LAYOUT = "Layout"
    BEVEL = "Bevel layout"
    PLANAR = "Planar layout"
    MASSES = "Masses, inertias and gravity"
    ELASTIC = "Elastic output"
    LOSSES = "Losses"
    SOLVER = "Model and solver"
    START = "Initial values"


class Need(NamedTuple):
    """Part of the model that a variable requires.

    Attributes:
        lacking: fidelities without this part.
        reason: reason of the lack, as it follows the name of a fidelity such as "fidelity averaged".
    """

    lacking: tuple[int, ...]
    reason: str


SOLVED = Need((KINEMATIC,), "prescribes the motion instead of solving it")
PULSES = Need((AVERAGED,), "has no pulses, only their mean")
PHASE = Need((AVERAGED,), "has no pinion-shaft angle, so the position of the unbalanced mass is undefined")
TWIST = Need((AVERAGED, RIGID), "has no elastic shaft")

# limits of the inputs in the kernel: rad/s, N m, s
LARGEST_SPEED: float = inputs.MAX_SPEED
LARGEST_TORQUE: float = inputs.MAX_TORQUE
LARGEST_STEP: float = inputs.MAX_STEP

# exponents of kg, m, s, rad of each unit, in the order of the model description
UNITS: dict[str, dict[str, int]] = {
    unit: parse_unit(unit)[1]
    for unit in (
        *("1", "rad", "rad/s", "rad/s2", "m", "m/s", "m/s2", "s", "kg", "kg.m2"),
        *("N.m", "N.m/rad", "N.m.s/rad", "J", "N", "W"),
    )
}

# display unit of a unit: its name and the factor to it
DISPLAY_UNITS: dict[str, tuple[str, float]] = {
    "rad": ("deg", 180.0 / math.pi),
    "rad/s": ("rpm", 30.0 / math.pi),
}

ENUMERATIONS: dict[str, tuple[tuple[str, int, str], ...]] = {
    "Layout": (
        ("bevel", 0, "bevel differential, satellites roll on bevel gear 17 (Karetin)"),
        ("planar", 1, "planar differential, satellites roll on a sun gear (Lysenko)"),
    ),
    "Fidelity": (
        ("kinematic", 0, "prescribed speed ratio, torques by inverse dynamics"),
        ("averaged", 1, "mean torques and speeds, without torque pulses"),
        ("rigid", 2, "torque pulses and freewheels, rigid shafts"),
        ("elastic", 3, "as rigid, with an elastic output shaft that drives a mass"),
    ),
    "Method": (
        ("event", 0, "high-order integration between located freewheel switching events"),
        ("timestepping", 1, "deprecated, no longer available: the module uses event and logs a warning"),
    ),
    "Drive": (
        ("speed", 0, "omega1 is the input, the input torque is computed"),
        ("torque", 1, "drive_torque is the input, the input speed is computed"),
    ),
    "InputHold": (
        ("zero_order", 0, "speed constant between communication points (zero-order hold)"),
        ("linear", 1, "speed extrapolated linearly from the last two values (first-order hold)"),
    ),
    "ContactMode": (
        ("held", 0, "housing freewheel locked: link 2 at rest, output shaft coasting"),
        ("free", 1, "both freewheels unlocked"),
        ("driving", 2, "output freewheel locked: link 2 drives the output shaft"),
        ("held_driving", 3, "both freewheels locked: link 2 and output shaft at rest"),
    ),
}


@dataclass(frozen=True)
class Variable:
    """One variable of the module.

    Attributes:
        reference: value reference in the FMUs. Other programs store it, so it never changes. A new row takes
            the lowest number above all numbers of its model, the number of the time included.
        name: name in the FMU.
        group: group in the documentation.
        unit: one of UNITS, or "" without a unit.
        description: one sentence without its full stop.
        start: start value in the unit, or None for a calculated variable.
        minimum: minimum in the unit, or None.
        maximum: maximum in the unit, or None.
        nominal: nominal value in the unit, or None.
        causality: causality of FMI 2.0: INPUT, OUTPUT, LOCAL or PARAMETER; independent for the time.
        variability: variability of FMI 2.0. A discrete variable changes only at freewheel switching events,
            because FMI 3.0 allows changes of discrete variables only in events.
        kind: REAL, INTEGER, BOOLEAN or ENUMERATION.
        enumeration: name in ENUMERATIONS, or "".
        follows: dependency in addition to the speeds: SINCE_START, LINK1_ANGLE, DRIVE_ANGLE, or "".
        of_step: True for a mean or a peak of the last step, which has no rate.
        late: True if the kernel's operation STEP_ONLY omits the variable, because it is expensive.
        needs: required parts of the model; a fidelity without one of them does not compute the variable.
        at_start: for an output, names of all variables that it depends on at initialisation; None for all
            inputs and parameters that are not idle.
        idle: True if no output depends on this parameter at initialisation.
        in_map: True if the torque map of fidelity averaged depends on this parameter.
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
        """True for a parameter that may change between steps."""
        return self.variability == TUNABLE

    @property
    def ends(self) -> tuple[float, float]:
        """Minimum and maximum, infinite without a limit; the numbers of an enumeration have no gaps."""
        if self.kind == BOOLEAN:
            return 0.0, 1.0
        low = -math.inf if self.minimum is None else self.minimum
        return low, math.inf if self.maximum is None else self.maximum

    @property
    def allowed(self) -> str:
        """Allowed values, as they follow "must be"."""
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
        """Numbers by name for an enumeration or a Boolean; None for other kinds."""
        if self.kind == BOOLEAN:
            return BOOLEANS
        if self.kind == ENUMERATION:
            return {name: float(number) for name, number, _ in ENUMERATIONS[self.enumeration]}
        return None

    def number(self, value: Any) -> float:
        """Convert a value to a number in the unit of the variable and check its range.

        Args:
            value: a number, a string with a unit, or the name of an item.

        Raises:
            ParameterError: the value has another type, or is out of range.
        """
        try:
            number = value if isinstance(value, float) else number_of(value, self.unit or "1", self.items)
        except ValueError as error:
            message = must_be(self.name, self.allowed, repr(value))
            raise ParameterError(with_reason(message, error, value, self.items)) from None
        if not self.accepts(number):
            raise ParameterError(must_be(self.name, self.allowed, number))
        return number

    def accepts(self, value: float) -> bool:
        """Return True if a number is finite, in the range and, except for a Real, an integer.

        Args:
            value: number in the unit of the variable.
        """
        low, high = self.ends
        return math.isfinite(value) and low <= value <= high and (self.kind == REAL or value % 1.0 == 0.0)


# --- the module ---

_input = partial(Variable, causality=INPUT)
_output = partial(Variable, causality=OUTPUT)
_local = partial(Variable, causality=LOCAL)
_parameter = partial(Variable, causality=PARAMETER, variability=FIXED)
_tunable = partial(Variable, causality=PARAMETER, variability=TUNABLE)

# Ranges of real machines plus about two decades. Beyond them explicit steps get expensive or lose digits.
_INERTIA_LIMIT = 1e5
_SATELLITE_INERTIA_LIMIT = 1.0  # kg m^2: 100 times a gear with 0.1 m radius and a mass of 2 kg
_SPEED_START_LIMIT = 1e4  # rad/s
_MIN_TEETH = 5
_BEARING_LIMIT = 10.0  # N m s/rad: 100 times the bearings and clutches of a truck
_FRICTION_LIMIT = 1e3  # N m s/rad: also a load that is proportional to the speed
_DAMPING_LIMIT = 1e3  # N m s/rad: 100 times a rubber coupling

VARIABLES: tuple[Variable, ...] = (
    _input(0, "omega1", Group.FLANGES, "rad/s", "speed of the input shaft (carrier, link 1); with drive = torque only its initial value", 100.0, -LARGEST_SPEED, LARGEST_SPEED, nominal=100.0),
    _input(1, "load_torque", Group.FLANGES, "N.m", "torque of the load on the output shaft, positive against positive speed", 10.0, -LARGEST_TORQUE, LARGEST_TORQUE, nominal=10.0),
    _input(2, "drive_torque", Group.FLANGES, "N.m", "torque on the input shaft (carrier, link 1); used only with drive = torque", 0.0, -LARGEST_TORQUE, LARGEST_TORQUE, nominal=10.0),
    _output(3, "omega2", Group.MOTION, "rad/s", "speed of link 2, the output gear of the differential", nominal=100.0, needs=(SOLVED, PULSES)),
    _output(4, "omega_out", Group.MOTION, "rad/s", "speed of the output shaft (of the driven mass if elastic)", nominal=100.0, needs=(SOLVED,), at_start=("omega1", "fidelity", "kinematic_ratio", "omega_out_start")),
    _output(5, "input_torque", Group.INSTANT, "N.m", "instantaneous torque M1 that drives the input shaft", nominal=100.0, late=True, needs=(PULSES,)),
    _output(6, "mesh_torque", Group.INSTANT, "N.m", "instantaneous torque M2 of the gear mesh on link 2", nominal=100.0, late=True, needs=(PULSES,)),
    _output(7, "output_torque", Group.INSTANT, "N.m", "instantaneous torque Tc of the output freewheel, which drives the output shaft", nominal=100.0, late=True, needs=(PULSES,)),
    _output(8, "housing_torque", Group.INSTANT, "N.m", "instantaneous torque Th of the housing freewheel, which supports link 2", nominal=100.0, late=True, needs=(PULSES,)),
    _output(9, "input_torque_mean", Group.MEANS, "N.m", "mean torque M1 that drives the input shaft over the last communication step, including impulses", nominal=100.0, of_step=True, at_start=()),
    _output(10, "output_torque_mean", Group.MEANS, "N.m", "mean torque Tc of the output freewheel over the last communication step, including impulses", nominal=100.0, of_step=True, at_start=()),
    _output(11, "imbalance_acceleration", Group.IMBALANCE, "m/s2", "magnitude of the absolute acceleration of the reference mass (unbalanced mass of satellite 0, module 0)", nominal=1e3, minimum=0.0, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _output(12, "imbalance_acceleration_x", Group.IMBALANCE, "m/s2", "absolute acceleration of the reference mass (satellite 0, module 0) along the central axis Ox (fixed frame)", nominal=1e3, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _output(13, "imbalance_acceleration_y", Group.IMBALANCE, "m/s2", "absolute acceleration of the reference mass (satellite 0, module 0) along Oy (fixed frame)", nominal=1e3, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _output(14, "imbalance_acceleration_z", Group.IMBALANCE, "m/s2", "absolute acceleration of the reference mass (satellite 0, module 0) along Oz (fixed frame)", nominal=1e3, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _output(15, "input_speed", Group.MOTION, "rad/s", "instantaneous speed of the input shaft, prescribed by omega1 or computed from drive_torque", nominal=100.0, at_start=("omega1",)),
    _output(16, "mesh_torque_mean", Group.MEANS, "N.m", "mean torque M2 of the gear mesh on link 2 over the last communication step, including impulses", nominal=100.0, of_step=True, late=True, at_start=()),
    _output(17, "housing_torque_mean", Group.MEANS, "N.m", "mean torque Th of the housing freewheel over the last communication step, including impulses", nominal=100.0, of_step=True, late=True, at_start=()),
    _output(18, "input_acceleration", Group.MOTION, "rad/s2", "instantaneous acceleration of the input shaft, without jumps of omega1", nominal=1e3, late=True, needs=(PULSES,)),
    _output(19, "output_acceleration", Group.MOTION, "rad/s2", "instantaneous acceleration of the output shaft (of the driven mass if elastic)", nominal=1e3, late=True, needs=(SOLVED, PULSES)),
    _output(20, "output_angle", Group.MOTION, "rad", "angle of the output shaft (of the driven mass if elastic) since the start, without the whole revolutions in output_turns", nominal=1.0, minimum=0.0, follows=SINCE_START, needs=(SOLVED,), at_start=()),
    _output(21, "output_turns", Group.MOTION, "1", "whole revolutions of the output shaft that output_angle does not include", follows=SINCE_START, needs=(SOLVED,), at_start=()),
    _output(22, "input_flange_angle", Group.MOTION, "rad", "angle phi1 of the input flange (carrier, link 1) since the start, including whole revolutions", nominal=1.0, follows=SINCE_START, at_start=()),
    _output(23, "output_flange_angle", Group.MOTION, "rad", "angle phi2 of the output flange (output shaft, driven mass if elastic) since the start, including whole revolutions", nominal=1.0, follows=SINCE_START, needs=(SOLVED,), at_start=()),
    _output(24, "loss_power_mean", Group.ENERGY, "W", "mean power loss over the last communication step: increase of energy_lost divided by the step length", nominal=1e3, of_step=True, late=True, at_start=()),
    _output(25, "satellite_force", Group.IMBALANCE, "N", "instantaneous force m |a| of the reference mass (satellite 0, module 0) on the bearing of its satellite", nominal=1e3, minimum=0.0, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _output(26, "satellite_force_peak", Group.IMBALANCE, "N", "maximum satellite_force over the last communication step, interpolated by a parabola in each internal step", nominal=1e3, minimum=0.0, of_step=True, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _output(27, "shaking_force_x", Group.IMBALANCE, "N", "force of all unbalanced masses on the mounting along the central axis Ox (fixed frame)", nominal=1e3, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _output(28, "shaking_force_y", Group.IMBALANCE, "N", "force of all unbalanced masses on the mounting along Oy (fixed frame)", nominal=1e3, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _output(29, "shaking_force_z", Group.IMBALANCE, "N", "force of all unbalanced masses on the mounting along Oz (fixed frame)", nominal=1e3, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _output(30, "shaking_moment_x", Group.IMBALANCE, "N.m", "moment of all unbalanced masses, satellites and pinion shafts on the mounting about Ox", nominal=100.0, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _output(31, "shaking_moment_y", Group.IMBALANCE, "N.m", "moment of all unbalanced masses, satellites and pinion shafts on the mounting about Oy", nominal=100.0, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _output(32, "shaking_moment_z", Group.IMBALANCE, "N.m", "moment of all unbalanced masses, satellites and pinion shafts on the mounting about Oz", nominal=100.0, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _output(33, "housing_torque_peak", Group.RIPPLE, "N.m", "maximum magnitude of the housing freewheel torque Th over the last communication step, without impulses", nominal=100.0, minimum=0.0, of_step=True, late=True, needs=(SOLVED, PULSES)),
    _output(34, "housing_slip_peak", Group.FREEWHEELS, "rad/s", "maximum overrunning speed of the housing freewheel over the last communication step: omega2", nominal=100.0, minimum=0.0, of_step=True, late=True, needs=(SOLVED, PULSES)),
    _output(35, "output_slip_peak", Group.FREEWHEELS, "rad/s", "maximum overrunning speed of the output freewheel over the last communication step: omega_hub - omega2", nominal=100.0, minimum=0.0, of_step=True, late=True, needs=(SOLVED, PULSES)),
    _output(36, "housing_engagements", Group.FREEWHEELS, "1", "number of engagements of the housing freewheel since the start", minimum=0.0, variability="discrete", follows=SINCE_START, needs=(SOLVED, PULSES), at_start=()),
    _output(37, "output_engagements", Group.FREEWHEELS, "1", "number of engagements of the output freewheel since the start", minimum=0.0, variability="discrete", follows=SINCE_START, needs=(SOLVED, PULSES), at_start=()),
    _local(38, "drive_angle", Group.MOTION, "rad", "angle q of the pinion shaft without the whole revolutions in drive_turns: q = drive_angle + 2 pi drive_turns", nominal=1.0, minimum=0.0, follows=DRIVE_ANGLE, needs=(PHASE,)),
    _local(39, "drive_turns", Group.MOTION, "1", "whole revolutions of the pinion shaft that drive_angle does not include (a multiple of the revolutions in one period of the motion)", follows=SINCE_START, needs=(PHASE,)),
    _local(40, "input_angle", Group.MOTION, "rad", "angle theta1 of the input shaft (carrier, link 1) without the whole revolutions in input_turns", nominal=1.0, minimum=0.0, follows=SINCE_START),
    _local(41, "input_turns", Group.MOTION, "1", "whole revolutions of the input shaft that input_angle does not include", follows=SINCE_START),
    _local(42, "contact_mode", Group.FREEWHEELS, "", "state of the two freewheels", minimum=0, maximum=3, kind=ENUMERATION, variability="discrete", enumeration="ContactMode", needs=(PULSES,)),
    _local(43, "omega_hub", Group.MOTION, "rad/s", "speed omega3 of the output shaft at the output freewheel (of the hub if elastic)", nominal=100.0, needs=(SOLVED,)),
    _local(44, "shaft_twist", Group.MOTION, "rad", "twist of the elastic output shaft (0 if rigid)", nominal=1e-2, needs=(TWIST,)),
    _local(45, "imbalance_x", Group.IMBALANCE, "m", "position of the reference mass (satellite 0, module 0) along the central axis Ox (fixed frame)", nominal=0.1, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _local(46, "imbalance_y", Group.IMBALANCE, "m", "position of the reference mass (satellite 0, module 0) along Oy (fixed frame)", nominal=0.1, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _local(47, "imbalance_z", Group.IMBALANCE, "m", "position of the reference mass (satellite 0, module 0) along Oz (fixed frame)", nominal=0.1, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _local(48, "imbalance_velocity_x", Group.IMBALANCE, "m/s", "absolute velocity of the reference mass (satellite 0, module 0) along Ox (fixed frame)", nominal=10.0, follows=DRIVE_ANGLE, late=True, needs=(PHASE,)),
    _local(49, "imbalance_velocity_y", Group.IMBALANCE, "m/s", "absolute velocity of the reference mass (satellite 0, module 0) along Oy (fixed frame)", nominal=10.0, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _local(50, "imbalance_velocity_z", Group.IMBALANCE, "m/s", "absolute velocity of the reference mass (satellite 0, module 0) along Oz (fixed frame)", nominal=10.0, follows=LINK1_ANGLE, late=True, needs=(PHASE,)),
    _local(51, "energy_in", Group.ENERGY, "J", "work of the input torque since the start", nominal=1e3, follows=SINCE_START),
    _local(52, "energy_out", Group.ENERGY, "J", "work done on the load since the start", nominal=1e3, follows=SINCE_START),
    _local(53, "energy_stored", Group.ENERGY, "J", "energy stored in the mechanism: kinetic, elastic (output shaft, freewheels) and potential (gravity)", nominal=1e3, late=True),
    _local(54, "energy_lost", Group.ENERGY, "J", "energy lost to friction, drag, damping and impacts since the start, minus the work of the balancer", nominal=1e3, follows=SINCE_START),
    _local(55, "energy_lost_viscous", Group.ENERGY, "J", "part of energy_lost due to viscous friction of links, pinion shafts and output shaft", nominal=1e3, follows=SINCE_START),
    _local(56, "energy_lost_shaft", Group.ENERGY, "J", "part of energy_lost due to damping of the elastic shaft and friction of the driven mass, minus the work of the balancer", nominal=1e3, follows=SINCE_START),
    _local(57, "energy_lost_mesh", Group.ENERGY, "J", "part of energy_lost due to friction in the gear meshes", nominal=1e3, follows=SINCE_START),
    _local(58, "energy_lost_journal", Group.ENERGY, "J", "part of energy_lost due to friction in the satellite bearings", nominal=1e3, follows=SINCE_START),
    _local(59, "energy_lost_freewheel", Group.ENERGY, "J", "part of energy_lost due to drag, wind-up and impacts of the freewheels", nominal=1e3, follows=SINCE_START),
    _local(60, "energy_lost_windage", Group.ENERGY, "J", "part of energy_lost due to windage of the satellites", nominal=1e3, follows=SINCE_START),
    _local(61, "energy_residual", Group.ENERGY, "J", "energy balance error (integration error): energy_in - energy_out - energy_lost - change in stored energy", nominal=1.0, follows=SINCE_START, late=True),
    _local(62, "torque_ripple", Group.RIPPLE, "N.m", "torque ripple over the last communication step: RMS of Tc about its mean, without impulses", nominal=100.0, minimum=0.0, of_step=True, late=True, needs=(PULSES,)),
    _local(63, "torque_peak", Group.RIPPLE, "N.m", "maximum magnitude of the output torque Tc over the last communication step, without impulses", nominal=100.0, minimum=0.0, of_step=True, late=True, needs=(PULSES,)),
    _local(64, "contact_switches", Group.FREEWHEELS, "1", "number of changes of contact_mode since the start", minimum=0.0, variability="discrete", follows=SINCE_START, needs=(PULSES,)),
    _local(65, "rhs_evaluations", Group.FREEWHEELS, "1", "number of right-hand-side evaluations since the start (computational cost)", minimum=0.0, follows=SINCE_START),
    _parameter(66, "layout", Group.LAYOUT, "", "layout of the differential", 0, 0, 1, kind=ENUMERATION, enumeration="Layout", in_map=True),
    _parameter(67, "z2", Group.BEVEL, "", "teeth of gear 2, which is fixed to link 2 (bevel)", 20, _MIN_TEETH, 1000, kind=INTEGER, in_map=True),
    _parameter(68, "z16", Group.BEVEL, "", "teeth of pinion 16 (bevel)", 20, _MIN_TEETH, 1000, kind=INTEGER, in_map=True),
    _parameter(69, "z17", Group.BEVEL, "", "teeth of gear 17, on which the satellites roll (bevel)", 34, _MIN_TEETH, 1000, kind=INTEGER, in_map=True),
    _parameter(70, "z6", Group.BEVEL, "", "teeth of satellite gear 6 (bevel)", 20, _MIN_TEETH, 1000, kind=INTEGER, in_map=True),
    _parameter(71, "shaft_angle", Group.BEVEL, "rad", "angle Sigma between the axes of satellite gear 6 and the pinion shaft (bevel)", math.pi / 2, 1e-6, 3.141591, in_map=True),
    _parameter(72, "wheel_radius", Group.BEVEL, "m", "pitch radius r17 of gear 17 (bevel)", 0.08, 1e-4, 10.0, in_map=True),
    _parameter(73, "a", Group.BEVEL, "1", "distance AD of the unbalanced mass from the satellite axis, relative to the pitch radius of the satellite (bevel)", 1.0, 0.0, 10.0, in_map=True),
    _parameter(74, "b", Group.BEVEL, "1", "distance QA of the unbalanced mass from the apex of the pitch cones along the satellite axis, relative to the height of the satellite's pitch cone (bevel)", 1.0, 0.0, 10.0, in_map=True),
    _parameter(75, "c", Group.BEVEL, "1", "distance OQ of the apex of the pitch cones from the central axis, relative to the height of the pitch cone of gear 17 (bevel)", 1.0, 0.0, 10.0, in_map=True),
    _parameter(76, "epsilon", Group.BEVEL, "rad", "angle of the unbalanced mass about the satellite axis at pinion-shaft angle 0 (bevel)", 0.0, -1e3, 1e3, in_map=True),
    _parameter(77, "gamma", Group.BEVEL, "rad", "angle of the satellite about the pinion-shaft axis at pinion-shaft angle 0 (bevel)", 0.0, -1e3, 1e3, in_map=True),
    _parameter(78, "sun_radius", Group.PLANAR, "m", "radius R0 of the sun gear, link 2 (planar)", 0.05, 1e-4, 10.0, in_map=True),
    _parameter(79, "satellite_radius", Group.PLANAR, "m", "radius r of a satellite (planar)", 0.03, 1e-4, 10.0, in_map=True),
    _parameter(80, "eccentricity", Group.PLANAR, "m", "distance l of the unbalanced mass from the satellite axis (planar)", 0.02, 0.0, 10.0, in_map=True),
    _parameter(81, "imbalance_mass", Group.MASSES, "kg", "mass m of each unbalanced mass", 1.0, 0.0, 1e5, in_map=True),
    _parameter(82, "modules", Group.LAYOUT, "", "number of identical modules, evenly spaced about the central axis", 1, 1, 24, kind=INTEGER, in_map=True),
    _parameter(83, "satellites", Group.LAYOUT, "", "number of satellites (and unbalanced masses) per module, evenly spaced", 1, 1, 24, kind=INTEGER, in_map=True),
    _parameter(84, "drive_inertia", Group.MASSES, "kg.m2", "total inertia J16 of all pinion shafts about their own axes", 0.0, 0.0, _INERTIA_LIMIT, in_map=True),
    _parameter(85, "input_inertia", Group.MASSES, "kg.m2", "inertia J1 of the carrier, link 1 (with drive = torque including the engine or motor)", 0.0, 0.0, _INERTIA_LIMIT, in_map=True),
    _parameter(86, "link2_inertia", Group.MASSES, "kg.m2", "inertia J2 of link 2", 0.005, 0.0, _INERTIA_LIMIT, in_map=True),
    _parameter(87, "output_inertia", Group.MASSES, "kg.m2", "inertia J3 of the output shaft (of the hub if elastic)", 0.5, 1e-9, _INERTIA_LIMIT),
    _parameter(88, "driven_inertia", Group.ELASTIC, "kg.m2", "inertia J4 of the driven mass (elastic)", 0.5, 1e-6, _INERTIA_LIMIT),
    _parameter(89, "shaft_stiffness", Group.ELASTIC, "N.m/rad", "stiffness c of the output shaft (elastic)", 400.0, 1e-2, 1e8, idle=True),
    _tunable(90, "shaft_damping", Group.ELASTIC, "N.m.s/rad", "damping d of the output shaft (elastic)", 0.05, 0.0, _DAMPING_LIMIT, idle=True),
    _tunable(91, "driven_friction", Group.ELASTIC, "N.m.s/rad", "viscous friction f of the driven mass (elastic)", 0.0, 0.0, _FRICTION_LIMIT),
    _tunable(92, "balancer", Group.ELASTIC, "1", "gain beta of the balancer, a feed-forward inertia compensation (elastic)", 0.0, -10.0, 10.0),
    _tunable(93, "input_friction", Group.LOSSES, "N.m.s/rad", "viscous friction b1 of the carrier, link 1", 0.0, 0.0, _FRICTION_LIMIT, in_map=True),
    _tunable(94, "drive_friction", Group.LOSSES, "N.m.s/rad", "viscous friction bq of all pinion shafts and satellites, relative to the pinion-shaft speed", 0.0, 0.0, _BEARING_LIMIT, in_map=True),
    _tunable(95, "link2_friction", Group.LOSSES, "N.m.s/rad", "viscous friction b2 of link 2", 0.0, 0.0, _BEARING_LIMIT, in_map=True),
    _tunable(96, "output_friction", Group.LOSSES, "N.m.s/rad", "viscous friction b3 of the output shaft (of the hub if elastic)", 0.0, 0.0, _FRICTION_LIMIT, in_map=True),
    _parameter(97, "mesh_efficiency", Group.LOSSES, "1", "efficiency of the mesh between link 2 and the pinions, with the carrier at rest", 1.0, 0.3, 1.0, in_map=True),
    _parameter(98, "satellite_mesh_efficiency", Group.LOSSES, "1", "efficiency of the mesh between the satellites and gear 17 (bevel)", 1.0, 0.3, 1.0, in_map=True),
    _tunable(99, "journal_friction", Group.LOSSES, "m", "friction coefficient of a satellite bearing times its journal radius", 0.0, 0.0, 10.0, in_map=True),
    _tunable(100, "windage", Group.LOSSES, "kg.m2", "windage torque on one satellite divided by the square of its absolute angular speed", 0.0, 0.0, 0.1, nominal=1e-4),
    _tunable(101, "housing_drag", Group.LOSSES, "N.m", "constant drag torque of the overrunning housing freewheel", 0.0, 0.0, LARGEST_TORQUE, in_map=True),
    _tunable(102, "housing_drag_viscous", Group.LOSSES, "N.m.s/rad", "viscous drag of the overrunning housing freewheel: torque per speed of link 2", 0.0, 0.0, _BEARING_LIMIT, in_map=True),
    _tunable(103, "output_drag", Group.LOSSES, "N.m", "constant drag torque of the overrunning output freewheel", 0.0, 0.0, LARGEST_TORQUE, in_map=True),
    _tunable(104, "output_drag_viscous", Group.LOSSES, "N.m.s/rad", "viscous drag of the overrunning output freewheel: torque per speed of the output shaft relative to link 2", 0.0, 0.0, _BEARING_LIMIT, in_map=True),
    _parameter(105, "housing_stiffness", Group.ELASTIC, "N.m/rad", "stiffness of the locked housing freewheel, 0 = rigid (elastic)", 0.0, 0.0, 1e8),
    _tunable(106, "housing_damping", Group.ELASTIC, "N.m.s/rad", "damping of the locked housing freewheel (elastic)", 0.0, 0.0, _DAMPING_LIMIT),
    _parameter(107, "freewheel_stiffness", Group.ELASTIC, "N.m/rad", "stiffness of the locked output freewheel, 0 = rigid (elastic)", 0.0, 0.0, 1e8),
    _tunable(108, "freewheel_damping", Group.ELASTIC, "N.m.s/rad", "damping of the locked output freewheel (elastic)", 0.0, 0.0, _DAMPING_LIMIT),
    _parameter(109, "housing_engagement_angle", Group.LOSSES, "rad", "angle by which the housing freewheel rotates backward after overrunning before it locks, 0 = locks at once", 0.0, 0.0, 0.5, in_map=True),
    _parameter(110, "output_engagement_angle", Group.LOSSES, "rad", "angle by which the output freewheel rotates backward after overrunning before it locks, 0 = locks at once", 0.0, 0.0, 0.5, in_map=True),
    _parameter(111, "satellite_inertia", Group.MASSES, "kg.m2", "inertia Ja of one satellite gear about its own axis, without the unbalanced mass", 0.0, 0.0, _SATELLITE_INERTIA_LIMIT, in_map=True),
    _parameter(112, "satellite_transverse_inertia", Group.MASSES, "kg.m2", "inertia Jt of one satellite gear about any transverse axis, without the unbalanced mass (bevel)", 0.0, 0.0, _SATELLITE_INERTIA_LIMIT, in_map=True),
    _parameter(113, "gravity", Group.MASSES, "m/s2", "gravitational acceleration of the unbalanced masses along -Oz (the central axis Ox is horizontal)", 0.0, 0.0, 1e3),
    _parameter(114, "housing_freewheel", Group.LAYOUT, "", "true if link 2 has a freewheel (one-way clutch) to the housing", 1.0, kind=BOOLEAN),
    _parameter(115, "output_freewheel", Group.LAYOUT, "", "true if link 2 drives the output shaft through a freewheel, false if it is rigidly connected to the shaft", 1.0, kind=BOOLEAN),
    _parameter(116, "fidelity", Group.SOLVER, "", "fidelity level of the model", 2, 0, 3, kind=ENUMERATION, enumeration="Fidelity"),
    _parameter(117, "method", Group.SOLVER, "", "integration method; timestepping is deprecated", 0, 0, 1, kind=ENUMERATION, enumeration="Method", idle=True),
    _parameter(118, "drive", Group.FLANGES, "", "input quantity at the input shaft (carrier, link 1): its speed or its torque", 0, 0, 1, kind=ENUMERATION, enumeration="Drive", in_map=True),
    _parameter(119, "input_hold", Group.SOLVER, "", "extrapolation of omega1 between communication points", 0, 0, 1, kind=ENUMERATION, enumeration="InputHold", idle=True),
    _parameter(120, "tolerance", Group.SOLVER, "1", "relative tolerance; a tolerance set by the importer overrides it", 1e-6, 1e-12, 1e-2, nominal=1e-6, idle=True),
    _parameter(121, "max_step", Group.SOLVER, "s", "maximum internal step, 0 = no limit", 0.0, 0.0, LARGEST_STEP, idle=True),
    _tunable(122, "kinematic_ratio", Group.SOLVER, "1", "prescribed speed ratio omega2/omega1 of link 2 and the carrier (kinematic)", 0.0, -10.0, 10.0),
    _parameter(123, "omega2_start", Group.START, "rad/s", "initial speed of link 2", 0.0, -_SPEED_START_LIMIT, _SPEED_START_LIMIT),
    _parameter(124, "omega_out_start", Group.START, "rad/s", "initial speed of the output shaft", 0.0, -_SPEED_START_LIMIT, _SPEED_START_LIMIT),
    _parameter(125, "drive_angle_start", Group.START, "rad", "initial angle q of the pinion shaft", 0.0, -1e6, 1e6),
)  # fmt: skip

# only in FMI 3.0; its number follows the 126 rows of the table at the introduction of FMI 3.0
TIME = Variable(126, "time", "", "s", "simulation time", causality="independent")

BY_NAME: dict[str, Variable] = {variable.name: variable for variable in VARIABLES}

# beginning of the names of the parts of energy_lost; the cause of the loss follows
LOST_TO = "energy_lost_"
LOSSES: tuple[str, ...] = tuple(LOST_TO + cause for cause in CAUSES)
# parameters that the torque map of fidelity averaged depends on
MAP_KEY: tuple[str, ...] = tuple(variable.name for variable in VARIABLES if variable.in_map)


def with_causality(*causalities: str, table: Iterable[Variable] = VARIABLES) -> Iterator[Variable]:
    """Return the variables of these causalities in the order of the table.

    Args:
        causalities: INPUT, OUTPUT, LOCAL or PARAMETER.
        table: variables of a model.
    """
    return (variable for variable in table if variable.causality in causalities)


# names of the variables that the module computes
COMPUTED = tuple(variable.name for variable in with_causality(OUTPUT, LOCAL))


def default_parameters() -> dict[str, float]:
    """Return the start values of all parameters of the module by name: reference case R1."""
    return {variable.name: float(variable.start or 0.0) for variable in with_causality(PARAMETER)}


# --- the driven shaft ---


def _as_in_module(reference: int, of_module: str, text: str = "", **columns: Any) -> Variable:
    """Return a variable of the driven shaft, copied from the module.

    Args:
        reference: value reference.
        of_module: name of the variable of the module.
        text: description; "" for the description of the module without "(elastic)".
        columns: attributes that differ from the variable of the module.
    """
    variable = BY_NAME[of_module]
    own: dict[str, Any] = {"late": False, "in_map": False, "idle": False, "needs": ()} | columns
    own |= {"reference": reference, "description": text or variable.description.replace(" (elastic)", "")}
    return replace(variable, **own)


# Variables of the driven shaft. Hub and driven mass start at rest, because a jump of the hub speed is a shock.
# Its motion is exact, so some of its ranges are wider than in the module.
OF_SHAFT: tuple[Variable, ...] = (
    _as_in_module(0, "omega1", "speed of the hub, the driven end of the shaft", name="hub_speed", start=0.0),
    _as_in_module(1, "load_torque", "torque of the load on the driven mass, positive against positive speed", start=0.0),
    _output(2, "shaft_torque", Group.INSTANT, "N.m", "instantaneous torque Ts of spring and damper, which drives the driven mass and brakes the hub", nominal=100.0, at_start=("hub_speed", "shaft_stiffness", "shaft_damping", "omega_out_start", "twist_start")),
    _output(3, "shaft_torque_mean", Group.MEANS, "N.m", "mean torque Ts of spring and damper over the last communication step", nominal=100.0, of_step=True, at_start=()),
    _as_in_module(4, "omega_out", "speed omega4 of the driven mass", at_start=("omega_out_start",)),
    _output(5, "driven_acceleration", Group.MOTION, "rad/s2", "instantaneous acceleration of the driven mass", nominal=100.0),
    _output(6, "twist", Group.MOTION, "rad", "twist of the shaft: hub angle minus angle of the driven mass", nominal=1e-2, at_start=("twist_start",)),
    _as_in_module(7, "energy_in", "work of the hub on the shaft since the start"),
    _as_in_module(8, "energy_out", "work done on the load since the start"),
    _as_in_module(9, "energy_stored", "energy stored in the model: kinetic (driven mass) and elastic (shaft)"),
    _as_in_module(10, "energy_lost", "energy lost to damping and friction since the start, minus the work of the balancer"),
    _as_in_module(11, "energy_residual", "energy balance error (round-off only): energy_in - energy_out - energy_lost - change in stored energy"),
    _as_in_module(12, "driven_inertia", minimum=1e-9),
    _as_in_module(13, "shaft_stiffness", "stiffness c of the shaft"),
    _as_in_module(14, "shaft_damping", "damping d of the shaft", maximum=1e5),
    _as_in_module(15, "driven_friction", maximum=1e5),
    _as_in_module(16, "balancer", "gain beta of the balancer, which applies beta J4 times the hub acceleration to the driven mass", idle=True),
    _as_in_module(17, "input_hold", "extrapolation of hub_speed between communication points", idle=True),
    _as_in_module(18, "omega_out_start", "initial speed of the driven mass"),
    _parameter(19, "twist_start", Group.START, "rad", "initial twist of the shaft", 0.0, -1e6, 1e6),
)  # fmt: skip

TIME_OF_SHAFT = replace(TIME, reference=20)

# --- flanges ---

# direction of the energy at a flange with positive torque and positive speed: into the model, or out
INFLOW, OUTFLOW = "inflow", "outflow"


class Terminal(NamedTuple):
    """A rotating flange that connects models. Its speed or its torque is an input.

    Attributes:
        name: name of the flange.
        description: description for people, without a full stop.
        speed: name of the variable of the speed.
        torque: name of the variable of the torque.
        flow: INFLOW or OUTFLOW.
        angle: name of the variable of the angle, or "".
    """

    name: str
    description: str
    speed: str
    torque: str
    flow: str
    angle: str = ""


TERMINALS: tuple[Terminal, ...] = (
    Terminal("input_flange", "input shaft with prescribed speed (drive = speed), returns the torque it takes from the upstream shaft", "omega1", "input_torque_mean", INFLOW, "input_flange_angle"),
    Terminal("input_flange_by_torque", "input shaft with prescribed torque (drive = torque)", "input_speed", "drive_torque", INFLOW, "input_flange_angle"),
    Terminal("output_flange", "output shaft (driven mass if elastic) with the load torque of the downstream shaft as input", "omega_out", "load_torque", OUTFLOW, "output_flange_angle"),
    Terminal("load", "output flange without its angle, as on the driven shaft", "omega_out", "load_torque", OUTFLOW),
)  # fmt: skip

TERMINALS_OF_SHAFT: tuple[Terminal, ...] = (
    Terminal("hub", "hub of the shaft with prescribed speed, returns the torque it takes from the upstream shaft", "hub_speed", "shaft_torque_mean", INFLOW),
    Terminal("load", "driven mass with the load torque as input", "omega_out", "load_torque", OUTFLOW),
)  # fmt: skip
