"""Variables of a model: group, kind, causality, unit, range, and what their values depend on."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
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
