"""Stelmashchuk's stepping mechanism of partially-toothed wheels with a balancing device.

criteria: nu and Pi. law: motion of the driving wheel. exact: motion of the driven mass in closed form.
as_printed: the formulas of the page. equations, claims: what was found out about them.
"""

from .claims import CLAIMS
from .equations import EQUATIONS

__all__ = ["CLAIMS", "EQUATIONS"]
