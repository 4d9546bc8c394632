"""What one trial at an extreme is: a mechanism, a rung of the ladder, what is put in, and how long."""

from __future__ import annotations

from dataclasses import dataclass

KINEMATIC, AVERAGED, RIGID, ELASTIC = range(4)
EVENT, TIMESTEPPING = range(2)


@dataclass(frozen=True)
class Rung:
    """A fidelity and a method."""

    name: str
    fidelity: int
    method: int


RIGID_RUNGS = (
    Rung("kinematic", KINEMATIC, EVENT),
    Rung("averaged", AVERAGED, EVENT),
    Rung("rigid, event", RIGID, EVENT),
    Rung("rigid, timestepping", RIGID, TIMESTEPPING),
)
ELASTIC_RUNGS = (
    Rung("elastic, event", ELASTIC, EVENT),
    Rung("elastic, timestepping", ELASTIC, TIMESTEPPING),
)
RUNGS = RIGID_RUNGS + ELASTIC_RUNGS
TIMESTEPPING_RUNGS = tuple(rung for rung in RIGID_RUNGS + ELASTIC_RUNGS if rung.method == TIMESTEPPING)


@dataclass(frozen=True)
class Segment:
    """A stretch of time with given inputs.

    Attributes:
        duration: s. omega1: at its beginning, rad/s. load: N m. slope: of omega1, rad/s^2.
        steps: communication steps it takes at least (a step may be up to 1e6 s long).
        whole: whether its steps stay as they are in the run of many short ones.
    """

    duration: float
    omega1: float
    load: float
    slope: float = 0.0
    steps: int = 1
    whole: bool = False


@dataclass(frozen=True)
class Extreme:
    """One value on an axis, for one layout.

    Attributes:
        value: how it is called. parameters: over the defaults. segments: the inputs over time.
        split: short communication steps that replace each long one.
        turns: whole turns already on the counters of the drive and of link 1.
        slow: whether it is left out of a quick run.
        rungs: fidelities it says something about.
    """

    value: str
    parameters: dict[str, float]
    segments: tuple[Segment, ...]
    split: int = 50
    turns: float = 0.0
    slow: bool = False
    rungs: tuple[Rung, ...] = RUNGS


@dataclass(frozen=True)
class Case:
    """An extreme on one rung."""

    axis: str
    layout: str
    rung: Rung
    extreme: Extreme

    @property
    def name(self) -> str:
        """Axis, value, layout and rung in one line."""
        return f"{self.axis}: {self.extreme.value}, {self.layout}, {self.rung.name}"
