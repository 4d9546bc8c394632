"""Satellite from dimensions and materials of its gear and weight, instead of a point mass and inertias."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any

from ..common.errors import SceneError, must_be
from ..common.units import allowed_number
from ..interface.variables import default_parameters
from .keys import InUnit, Strict, checked, quantity

# density, kg/m3; tungsten is the heavy alloy that balance weights are made of
MATERIALS = {"polyamide": 1140.0, "aluminium": 2700.0, "steel": 7850.0, "brass": 8500.0, "tungsten": 17000.0}
# parameters of the module that are calculated from the satellite, so a scene must not contain them
CALCULATED = ("imbalance_mass", "eccentricity", "a", "satellite_inertia", "satellite_transverse_inertia")


def _density(value: Any) -> float:
    """Return the density, kg/m3, of a material by name, or a density with its unit in SI."""
    if isinstance(value, str) and value in MATERIALS:
        return MATERIALS[value]
    try:
        return checked(value, "kg/m3", above=0.0)
    except ValueError:
        allowed = f"one of {', '.join(MATERIALS)}, or its density, {allowed_number('kg/m3', above=0.0)}"
        raise ValueError(f"must be {allowed} (got {value!r})") from None


Length = Annotated[float, quantity("m", maximum=1e3, above=0.0)]
Material = Annotated[float, InUnit(_density, "kg/m3")]


class Satellite(Strict):
    """A satellite: a disc of its pitch radius, and half discs about its axis on both faces as its weight.

    Attributes:
        width: Width of the gear, m.
        material: Density of the gear, kg/m3.
        weight_radius: Radius of the half discs, m.
        weight_width: Total width of both half discs, m.
        weight_material: Density of the half discs, kg/m3; None for the density of the gear.
    """

    width: Length
    material: Material
    weight_radius: Length
    weight_width: Length
    weight_material: Material | None = None

    def parameters(self, mechanism: Mapping[str, float]) -> dict[str, float]:
        """Return the parameters of the module that describe the satellite (CALCULATED).

        Equations: mechanics.md, Satellite from dimensions. The point mass is the mass of the whole
        satellite in its centre of mass. The inertias are about the centre of mass.

        Args:
            mechanism: Parameters in the scene file, SI, by name. Those in CALCULATED are not allowed.

        Raises:
            SceneError: A parameter contradicts the satellite.
        """
        for name in CALCULATED:
            if name in mechanism:
                raise SceneError(
                    f"mechanism.{name} is not allowed with [mechanism.satellite] (got {mechanism[name]:g})."
                    " It is calculated from the satellite."
                )
        values = {**default_parameters(), **mechanism}
        planar = values["layout"] != 0.0
        pitch = (
            values["satellite_radius"] if planar else values["wheel_radius"] * values["z6"] / values["z17"]
        )
        radius, width, thickness = self.weight_radius, self.width, self.weight_width
        if radius > pitch:
            allowed = f"at most {pitch:g} m, the pitch radius of the satellite"
            raise SceneError(must_be("mechanism: satellite.weight_radius", allowed, f"{radius:g} m"))
        gear = self.material * math.pi * pitch**2 * width
        weight = (self.weight_material or self.material) * math.pi * radius**2 * thickness / 2.0
        mass, moment = gear + weight, weight * 4.0 * radius / (3.0 * math.pi)
        polar = (gear * pitch**2 + weight * radius**2) / 2.0
        offset_term = (3.0 * width * (width + thickness) + thickness**2) / 12.0
        transverse = gear * (pitch**2 / 4.0 + width**2 / 12.0) + weight * (radius**2 / 4.0 + offset_term)
        offset = moment / mass
        results = {"imbalance_mass": mass, "satellite_inertia": polar - moment * offset}
        if planar:
            return {**results, "eccentricity": offset}
        # The transverse inertia oscillates by half this term about its mean as the satellite rotates.
        mean = transverse - moment * offset / 2.0
        return {**results, "a": offset / pitch, "satellite_transverse_inertia": mean}
