"""Karetin (2020): kinematics of the imbalance of the bevel inertia module, equations 1 to 33.

V. Karetin, Kinematic study of the standard layout circuit of the inertia module,
Scientific Horizons 07 (92), 2020, 104-111, doi 10.33249/2663-2144-2020-92-7-104-111.

``geometry`` and ``motion`` say which mechanism and how it turns, ``exact`` and ``projections`` what
follows. ``as_printed`` are the equations of the page with their errors; ``equations``, ``conclusions``,
``claims`` and ``page.md`` what was found of each, and its words.
"""

from ..report import claims_in
from . import claims
from .equations import EQUATIONS
from .exact import Kinematics
from .geometry import Geometry
from .motion import Motion, dynamic_mode, stop_mode

CLAIMS = claims_in(claims)

__all__ = [
    "CLAIMS",
    "EQUATIONS",
    "Geometry",
    "Kinematics",
    "Motion",
    "dynamic_mode",
    "stop_mode",
]
