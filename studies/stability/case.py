"""What one trial at an extreme is: a mechanism, a level of fidelity, its inputs, and how long it takes."""

from __future__ import annotations

from dataclasses import dataclass

from inertia_module.contract.variables import BY_NAME
from inertia_module.fidelity.levels import Level
from inertia_module.kernel.codes import AVERAGED, ELASTIC, EVENT, KINEMATIC, RIGID, TIMESTEPPING

# what the fixed steps of timestepping and the torque map of averaged are trusted to, relative
TIMESTEPPING_ACCURACY = 0.02
AVERAGED_ACCURACY = 0.005

ELASTIC_LEVELS = (Level(ELASTIC, EVENT), Level(ELASTIC, TIMESTEPPING))
LEVELS = (
    Level(KINEMATIC, EVENT),
    Level(AVERAGED, EVENT),
    Level(RIGID, EVENT),
    Level(RIGID, TIMESTEPPING),
    *ELASTIC_LEVELS,
)
TIMESTEPPING_LEVELS = tuple(level for level in LEVELS if level.method == TIMESTEPPING)


@dataclass(frozen=True)
class Segment:
    """A stretch of time with given inputs.

    Attributes:
        duration: s. omega1: at its beginning, rad/s. load: N.m. slope: of omega1, rad/s^2.
        drive: torque on link 1, where the drive gives one, N.m.
        steps: communication steps it takes at least (a step may be up to 1e6 s long).
        whole: whether its steps stay as they are in the run of many short ones.
    """

    duration: float
    omega1: float
    load: float
    slope: float = 0.0
    drive: float = 0.0
    steps: int = 1
    whole: bool = False


@dataclass(frozen=True)
class Extreme:
    """One value on an axis, for one layout.

    Attributes:
        value: how it is called. parameters: over the defaults. segments: the inputs over time.
        split: short communication steps that replace each long one.
        turns: whole turns already on the counters of the drive and of link 1.
        slow: whether it is left out of a quick run. levels: those it says something about.
    """

    value: str
    parameters: dict[str, float]
    segments: tuple[Segment, ...]
    split: int = 50
    turns: float = 0.0
    slow: bool = False
    levels: tuple[Level, ...] = LEVELS


@dataclass(frozen=True)
class Case:
    """An extreme at one level of fidelity."""

    axis: str
    layout: str
    level: Level
    extreme: Extreme

    def parameter(self, name: str) -> float:
        """Value of a parameter."""
        return float(self.extreme.parameters.get(name, BY_NAME[name].start or 0.0))

    @property
    def accuracy(self) -> float:
        """Relative accuracy asked for: the tolerance, or what method and fidelity can give."""
        least = TIMESTEPPING_ACCURACY if self.level.method == TIMESTEPPING else 0.0
        if self.level.fidelity == AVERAGED:
            least = max(least, AVERAGED_ACCURACY)
        return max(self.parameter("tolerance"), least)
