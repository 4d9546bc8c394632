"""Random mechanisms with random inputs, as plain numbers that can be printed and pasted."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, fields
from random import Random
from typing import Any, Self

from inertia_module.contract.variables import BY_NAME, default_parameters
from inertia_module.fidelity.levels import Level
from inertia_module.kernel.codes import AVERAGED, DRIVE_TORQUE, ELASTIC, EVENT, KINEMATIC, TIMESTEPPING

from ..reference.geometry import ratio, satellite_ratio
from .case import LEVELS, Segment
from .trial import Parameters

# digits of every number
DIGITS = 5
# viscous friction of the links, the drives and the output shaft; the share of the motions that have some
FRICTIONS = ("input_friction", "drive_friction", "link2_friction", "output_friction")
FRICTION_SHARE, MOST_FRICTION = 0.3, 100.0
# losses by load, drag, gravity: the share of the motions that have each, efficiencies
LOSS_SHARE, EFFICIENCIES = 0.5, (0.5, 0.9, 0.97, 0.99, 1.0 - 1e-12)
# how often each of LEVELS is drawn
WEIGHTS = (1, 3, 5, 3, 4, 2)


@dataclass(frozen=True)
class Motion:
    """A module and its inputs over time.

    Attributes:
        parameters: over the defaults. segments: each a communication step, or split into many.
    """

    parameters: Parameters
    segments: tuple[Segment, ...]

    @classmethod
    def of(cls, values: dict[str, Any]) -> Self:
        """The motion that as_dict has written."""
        return cls(values["parameters"], tuple(Segment(**part) for part in values["segments"]))

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers, without those at their defaults."""
        default = {field.name: field.default for field in fields(Segment)}
        kept = [
            {name: value for name, value in asdict(part).items() if value != default[name]}
            for part in self.segments
        ]
        return {"parameters": self.parameters, "segments": kept}

    def __getitem__(self, name: str) -> float:
        """Value of a parameter."""
        return float(self.parameters.get(name, BY_NAME[name].start or 0.0))

    @property
    def level(self) -> Level:
        """Its level of fidelity."""
        return Level(int(self["fidelity"]), int(self["method"]))

    @property
    def inertia(self) -> float:
        """About that of link 2 and the imbalances about the central axis, kg m^2."""
        length = self["sun_radius"] + self["satellite_radius"] if self["layout"] else self["wheel_radius"]
        mass = self["satellites"] * self["modules"] * self["imbalance_mass"]
        return mass * length**2 + self["link2_inertia"]


def rounded(value: float, digits: int = DIGITS) -> float:
    """The number to so many digits."""
    return float(f"{value:.{digits}g}")


class Draw(Random):
    """Random numbers of few digits."""

    def decades(self, low: float, high: float) -> float:
        """Any power of ten between as likely as any other."""
        return rounded(10.0 ** self.uniform(math.log10(low), math.log10(high)))

    def between(self, low: float, high: float) -> float:
        """Any as likely."""
        return rounded(self.uniform(low, high))


def _mechanism(draw: Draw) -> Parameters:
    p: Parameters = {
        **{"satellites": draw.choice([1, 2, 3, 4, 5]), "modules": draw.choice([1, 1, 2, 5])},
        **{"imbalance_mass": draw.choice([0.0, *[draw.decades(0.01, 100.0)] * 9])},
        **{"drive_inertia": draw.choice([0.0, draw.decades(1e-6, 1.0)])},
        **{"link2_inertia": draw.decades(1e-6, 1.0), "output_inertia": draw.decades(1e-4, 100.0)},
        **{"drive_angle_start": draw.choice([0.0, draw.between(-10.0, 10.0)])},
    }
    if draw.random() < 0.5:
        p |= {"layout": 1, "sun_radius": draw.decades(0.01, 0.5), "satellite_radius": draw.decades(0.01, 0.5)}
        return p | {"eccentricity": rounded(draw.choice([0.0, *[draw.random()] * 9]) * p["satellite_radius"])}
    p |= {name: draw.choice([draw.randint(1, 200), draw.randint(12, 60)]) for name in ("z2", "z16")}
    p |= {name: draw.randint(8, 80) for name in ("z17", "z6")}
    p |= {name: draw.choice([0.0, 1.0, draw.between(0.0, 1.5)]) for name in "abc"}
    p |= {name: draw.choice([0.0, draw.between(0.0, 6.3)]) for name in ("epsilon", "gamma")}
    angle = draw.choice([rounded(math.pi / 2.0), draw.between(0.1, 3.0)])
    return p | {"wheel_radius": draw.decades(0.02, 0.5), "shaft_angle": angle}


def _drive_and_output(draw: Draw, level: Level, omega: float) -> Parameters:
    by_torque = level.fidelity != KINEMATIC and draw.random() < 0.5
    inertia = draw.decades(1e-4, 100.0)
    p = {**level.values, "input_inertia": inertia if by_torque else draw.choice([0.0, inertia])}
    p |= {"drive": float(by_torque), "tolerance": draw.decades(1e-10, 1e-4)}
    if level.fidelity == KINEMATIC:
        return p | {"kinematic_ratio": draw.between(-2.0, 2.0)}
    left_out = [] if level.fidelity == AVERAGED else [(0, 1), (1, 0), (0, 0)]
    housing, output = draw.choice([(1, 1)] * 4 + left_out)
    omega_out = rounded(omega * draw.choice([0.0, 0.0, draw.uniform(0.0, 1.5)]))
    omega2 = omega_out * draw.choice([0.0, 1.0]) if output else omega_out
    p |= {"housing_freewheel": housing, "output_freewheel": output}
    p |= {"omega_out_start": omega_out, "omega2_start": omega2}
    if level.fidelity == ELASTIC:
        p |= {"driven_inertia": draw.decades(1e-3, 100.0), "shaft_stiffness": draw.decades(1.0, 1e6)}
        p |= {"shaft_damping": draw.choice([0.0, draw.decades(1e-3, 10.0)])}
        p |= {"driven_friction": draw.choice([0.0, 0.0, draw.decades(1e-4, 1.0)])}
        p |= {"balancer": draw.choice([0.0, 0.0, draw.between(-0.9, 0.9)])}
    return p


def _friction(draw: Draw, scale: float) -> Parameters:
    """Of some links, up to a scale, N.m.s/rad."""
    if draw.random() >= FRICTION_SHARE:
        return {}
    drawn = {name: draw.choice([0.0, draw.decades(1e-5, 1.0)]) * scale for name in FRICTIONS}
    return {name: min(rounded(value), MOST_FRICTION) for name, value in drawn.items()}


def _losses(draw: Draw, motion: Motion, torque: float, omega: float) -> Parameters:
    """Each on or off: by load, drag, gravity, bodies and, elastic by events, freewheels that wind up."""

    def some(**values: float) -> Parameters:
        return values if draw.random() < LOSS_SHARE else {}

    def part(low: float, high: float, of: float, most: float) -> float:
        return min(rounded(draw.decades(low, high) * of), most)

    p = some(mesh_efficiency=draw.choice(EFFICIENCIES))
    p |= some(satellite_mesh_efficiency=draw.choice(EFFICIENCIES))
    p |= some(journal_friction=draw.decades(1e-6, 0.1), gravity=draw.choice([0.0, 9.81, 60.0]))
    inertia = motion.inertia / (motion["satellites"] * motion["modules"])
    p |= some(satellite_inertia=part(1e-6, 1.0, inertia, 1e9))
    p |= some(satellite_transverse_inertia=part(1e-6, 1.0, inertia, 1e9))
    for wheel, spring in (("housing", "housing"), ("output", "freewheel")):
        p |= some(**{f"{wheel}_drag": part(1e-6, 1.0, torque, 1e7)})
        p |= some(**{f"{wheel}_drag_viscous": part(1e-6, 0.1, torque / omega, MOST_FRICTION)})
        stiffness = draw.decades(1e2, 1e6)
        damping = rounded(stiffness * draw.choice([0.0, 1e-4, 1e-3]))
        wound = some(**{f"{spring}_stiffness": stiffness, f"{spring}_damping": damping})
        p |= wound if (motion.level.fidelity, motion.level.method) == (ELASTIC, EVENT) else {}
    return p


def draw_motion(seed: int, number: int, losses: bool = False) -> Motion:
    """The motion of this number in the campaign of this seed; losses: by load, drag and gravity besides."""
    draw = Draw(f"{seed}/{number}")
    (level,) = draw.choices(LEVELS, WEIGHTS)
    omega = draw.decades(1.0, 300.0)
    motion = Motion(_mechanism(draw) | _drive_and_output(draw, level, omega), ())
    torque = motion.inertia * omega**2
    full = {**default_parameters(), **motion.parameters}
    rate = omega * ratio(full) * (2.0 + 2.0 * satellite_ratio(full))
    travel, segments = draw.decades(0.3, 60.0), []
    by_torque, omega1 = motion["drive"] == DRIVE_TORQUE, omega * draw.choice([1.0, 1.0, -1.0, 0.0])
    for _ in range(draw.randint(1, 6)):
        duration = rounded(travel * draw.random() / rate + 1e-9)
        load, push = (draw.choice([0.0, 1.0, 1.0, -0.5]) * draw.decades(1e-3, 1.0) * torque for _ in range(2))
        slope = 0.0 if by_torque else draw.choice([0.0, 0.0, draw.between(-1.0, 1.0)]) * omega / duration
        drive = rounded(push) if by_torque else 0.0
        segments.append(Segment(duration, rounded(omega1), rounded(load), rounded(slope), drive))
        omega1 = draw.choice([omega1, omega1, omega1 + slope * duration, omega * draw.uniform(-1.0, 1.0)])
    if level.method == TIMESTEPPING:
        motion.parameters["max_step"] = draw.decades(0.003, 3.0) / rate
    # averaged by torque refuses them; without losses no motion of averaged has friction
    rough = level.fidelity != AVERAGED or (losses and not by_torque)
    friction = _friction(draw, torque / omega) if rough else {}
    lossy = _losses(draw, motion, torque, omega) if losses and rough else {}
    return Motion(motion.parameters | friction | lossy, tuple(segments))
