"""The planetary wheel mechanism with an imbalance of Lysenko, Praliev, Suleimenov and Baubekov."""

from ..report import claims_in
from . import claims, machine
from .equations import EQUATIONS

CLAIMS = claims_in(claims) + claims_in(machine)

__all__ = ["CLAIMS", "EQUATIONS"]
