"""Karetin (2020): kinematics of the imbalance of the bevel inertia module, equations 1 to 33.

V. Karetin, Kinematic study of the standard layout circuit of the inertia module,
Scientific Horizons 07 (92), 2020, 104-111, doi 10.33249/2663-2144-2020-92-7-104-111.
"""

from .claims import findings
from .equations import EQUATIONS, exact
from .mechanism import Geometry, Motion, dynamic_mode, stop_mode

__all__ = ["EQUATIONS", "Geometry", "Motion", "dynamic_mode", "exact", "findings", "stop_mode"]
