"""The planetary wheel mechanism with an imbalance of Lysenko, Praliev, Suleimenov and Baubekov.

mechanism: dimensions. exact: forces, moments, powers. motion: with a drive and without one, energy.
as_printed: the formulas of the page. equations, claims: what was found out about them.
"""

from .claims import CLAIMS
from .equations import EQUATIONS

__all__ = ["CLAIMS", "EQUATIONS"]
