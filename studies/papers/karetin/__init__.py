"""Karetin (2020): kinematics of the imbalance of the bevel inertia module, equations 1 to 33.

V. Karetin, Kinematic study of the standard layout circuit of the inertia module,
Scientific Horizons 07 (92), 2020, 104-111, doi 10.33249/2663-2144-2020-92-7-104-111.
"""

from ..report import claims_in
from . import claims
from .equations import EQUATIONS
from .exact import exact
from .geometry import Geometry
from .motion import Motion, dynamic_mode, stop_mode

CLAIMS = claims_in(claims)

__all__ = ["CLAIMS", "EQUATIONS", "Geometry", "Motion", "dynamic_mode", "exact", "stop_mode"]
