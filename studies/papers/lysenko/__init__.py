"""The planetary wheel mechanism with an imbalance of Lysenko, Praliev, Suleimenov and Baubekov."""

from .claims import findings
from .equations import EQUATIONS

__all__ = ["EQUATIONS", "findings"]
