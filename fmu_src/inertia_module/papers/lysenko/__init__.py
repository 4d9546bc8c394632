"""The planetary wheel mechanism with an imbalance of Lysenko, Praliev, Suleimenov and Baubekov.

mechanism: dimensions. exact: forces, moments, powers. motion: with a drive and without one, energy.
as_printed: the formulas of the page. equations, claims, page.md: what was found of each, and its words.
"""

from ..report import claims_in
from . import claims
from .equations import EQUATIONS

CLAIMS = claims_in(claims)

__all__ = ["CLAIMS", "EQUATIONS"]
