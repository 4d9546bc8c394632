"""Fidelity levels of a scene: fidelities with their tolerances, from coarse to fine."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from ..common.equality import ByContent
from ..interface.variables import ENUMERATIONS, VARIABLES
from ..kernel.codes import AVERAGED, ELASTIC, RIGID
from ..scene import Scene
from ..scene.schema import at_fidelity, is_elastic

FIDELITIES = {number: name for name, number, _ in ENUMERATIONS["Fidelity"]}

# outputs that a fidelity does not model, with the reason
NOT_MODELLED: Mapping[int, Mapping[str, str]] = {
    fidelity: {row.name: need.reason for row in VARIABLES for need in row.needs if fidelity in need.lacking}
    for fidelity in FIDELITIES
}


@dataclass(frozen=True, eq=False)
class Level(ByContent):
    """Fidelity level with its settings.

    Attributes:
        fidelity: Number of the fidelity.
        setting: Printed text of the setting, such as "tolerance 1e-06".
        parameters: Parameters of the setting, by name.
    """

    fidelity: int
    setting: str = ""
    parameters: Mapping[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Return the name of the fidelity."""
        return FIDELITIES[self.fidelity]

    @property
    def label(self) -> str:
        """Return fidelity and setting."""
        return f"{self.name}, {self.setting}"

    @property
    def values(self) -> dict[str, float]:
        """Return the parameters of the module for this level, by name."""
        return {"fidelity": float(self.fidelity), **self.parameters}


def event_level(fidelity: int, tolerance: float) -> Level:
    """Make an event-driven level.

    Args:
        fidelity: Number of the fidelity.
        tolerance: Relative tolerance.
    """
    return Level(fidelity, f"tolerance {tolerance:.0e}", {"tolerance": tolerance})


# tolerances of the levels that are measured to choose one
TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9)
REFERENCE_TOLERANCE = 1e-12


def all_levels(elastic: bool, tolerances: Sequence[float] = TOLERANCES) -> Iterator[Level]:
    """Yield the levels except kinematic, from coarse to fine.

    Args:
        elastic: True to include fidelity elastic.
        tolerances: Relative tolerances of rigid and elastic.
    """
    yield Level(AVERAGED, "map")
    for fidelity in (RIGID, ELASTIC) if elastic else (RIGID,):
        for tolerance in tolerances:
            yield event_level(fidelity, tolerance)


def reference_level(scene: Scene) -> Level:
    """Return the finest level of a scene: elastic if it has parameters of an elastic output, else rigid.

    Args:
        scene: The scene.
    """
    return event_level(ELASTIC if is_elastic(scene.explicit_parameters) else RIGID, REFERENCE_TOLERANCE)


def candidates(scene: Scene) -> list[Level]:
    """Return the levels that are measured to choose one for a scene.

    Args:
        scene: The scene.
    """
    return list(all_levels(is_elastic(scene.explicit_parameters)))


def at_level(scene: Scene, level: Level) -> Scene:
    """Return a copy of a scene at a level; unless it is elastic, the driven mass is rigid with the hub.

    Args:
        scene: The scene.
        level: The level.

    Raises:
        SceneError: The new scene is invalid.
    """
    values = {
        **at_fidelity(scene.explicit_parameters, level.fidelity),
        "method": None,
        "max_step": None,
        **level.values,
    }
    tolerance = values.pop("tolerance", None)
    return scene.replaced(mechanism=values, accuracy={"tolerance": tolerance})
