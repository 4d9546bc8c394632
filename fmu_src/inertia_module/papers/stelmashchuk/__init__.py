"""Stelmashchuk's stepping mechanism of partially-toothed wheels with a balancing device.

criteria: nu and Pi. law: motion of the driving wheel. modes, exact: motion of the driven mass in closed
form. oscillation: its free part. as_printed: the formulas of the page. equations, claims, page.md: what
was found of each, and its words.
"""

from ..report import claims_in
from . import claims
from .equations import EQUATIONS

CLAIMS = claims_in(claims)

__all__ = ["CLAIMS", "EQUATIONS"]
