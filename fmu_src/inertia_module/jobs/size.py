"""Room and size of a mechanism: its envelope and the mass of its imbalances, from the geometry alone."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ..common.errors import Refused
from ..memory import Module


def _farthest(d: Any) -> float:
    """Largest distance of an imbalance from the central axis, m, at any drive angle.

    Planar: R0 + r + l. Bevel: with R, T and z of the layout (Karetin 2020, equation 2) R^2 + T^2 + z^2 is
    linear in cos B, hence largest where that is 1 or -1.

    Args:
        d: derived constants of the kernel.
    """
    if d.planar != 0.0:
        return float(d.axial + d.radial)
    swing = abs(d.radial * d.radial_cos + d.axial * d.axial_cos)
    return math.sqrt(d.radial**2 + d.axial**2 + d.arm**2 + 2.0 * swing)


def envelope_diameter(parameters: Mapping[str, float | str]) -> float:
    """Diameter about the central axis that imbalances and pitch circles of the satellites need, m.

    Args:
        parameters: of the module by name, those that differ from the defaults.

    Raises:
        Refused: the parameters cannot be.
    """
    module = Module("plain")
    module.check(**parameters)
    # the rim of a satellite is where an imbalance on its pitch circle would be
    rim = Module("plain")
    rim.check(**{**parameters, "a": 1.0, "b": 1.0, "eccentricity": module["satellite_radius"]})
    return 2.0 * max(_farthest(module.derived), _farthest(rim.derived))


def check_room(parameters: Mapping[str, float | str]) -> None:
    """Refuse what can be computed but not built.

    Args:
        parameters: as in envelope_diameter.

    Raises:
        Refused: the module warns that there is no room for its parts, or that they are no bodies.
    """
    module = Module("plain")
    module.check(**parameters)
    found = module.warnings()
    if found:
        raise Refused("; ".join(found))


def total_imbalance_mass(parameters: Mapping[str, float | str]) -> float:
    """Mass of the imbalances of all satellites of all modules, kg.

    Args:
        parameters: as in envelope_diameter.
    """
    module = Module("plain")
    module.set(**parameters)
    return math.prod(module[name] for name in ("modules", "satellites", "imbalance_mass"))
