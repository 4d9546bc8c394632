"""A satellite as a body: a gear and its weight by sizes and materials, in place of a point and inertias."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any

from ..common.errors import must_be
from ..common.units import allowed_number
from ..contract.variables import default_parameters
from .keys import InUnit, SceneError, Strict, checked, quantity

# kg/m3; tungsten as the heavy alloy that weights are made of
MATERIALS = {"polyamide": 1140.0, "aluminium": 2700.0, "steel": 7850.0, "brass": 8500.0, "tungsten": 17000.0}
# parameters that follow from it, and so are not given beside it
FOLLOWING = ("imbalance_mass", "eccentricity", "a", "satellite_inertia", "satellite_transverse_inertia")


def _density(value: Any) -> float:
    """Density, kg/m3, of a material by its name, or given."""
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
    """A satellite: a disc of its pitch radius and, as its weight, half discs about its axis on both faces.

    Attributes:
        width: of the gear. material: density of the gear, kg/m3. weight_radius: of the half discs.
        weight_width: of both together. weight_material: their density; without it that of the gear.
    """

    width: Length
    material: Material
    weight_radius: Length
    weight_width: Length
    weight_material: Material | None = None

    def parameters(self, given: Mapping[str, float]) -> dict[str, float]:
        """Those of the module that follow (docs/mechanics.md, Satellite from dimensions): FOLLOWING.

        The point mass is the whole satellite in its centre of mass, the inertias are about that. None of them
        may be among the parameters given.
        """
        for name in FOLLOWING:
            if name in given:
                raise SceneError(
                    f"mechanism.{name} is not allowed with [mechanism.satellite] (got {given[name]:g})."
                    " It is calculated from the satellite."
                )
        known = {**default_parameters(), **given}
        planar = known["layout"] != 0.0
        pitch = known["satellite_radius"] if planar else known["wheel_radius"] * known["z6"] / known["z17"]
        radius, width, thickness = self.weight_radius, self.width, self.weight_width
        if radius > pitch:
            allowed = f"at most {pitch:g} m, the pitch radius of the satellite"
            raise SceneError(must_be("mechanism: satellite.weight_radius", allowed, f"{radius:g} m"))
        gear = self.material * math.pi * pitch**2 * width
        weight = (self.weight_material or self.material) * math.pi * radius**2 * thickness / 2.0
        mass, moment = gear + weight, weight * 4.0 * radius / (3.0 * math.pi)
        own = (gear * pitch**2 + weight * radius**2) / 2.0
        apart = (3.0 * width * (width + thickness) + thickness**2) / 12.0
        across = gear * (pitch**2 / 4.0 + width**2 / 12.0) + weight * (radius**2 / 4.0 + apart)
        offset = moment / mass
        found = {"imbalance_mass": mass, "satellite_inertia": own - moment * offset}
        if planar:
            return {**found, "eccentricity": offset}
        # across, the inertia swings by this much about its mean as the satellite turns
        mean = across - moment * offset / 2.0
        return {**found, "a": offset / pitch, "satellite_transverse_inertia": mean}
