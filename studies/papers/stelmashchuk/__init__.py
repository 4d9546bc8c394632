"""Stelmashchuk's stepping mechanism of partially-toothed wheels with a balancing device."""

from ..report import claims_in
from . import claims
from .equations import EQUATIONS

CLAIMS = claims_in(claims)

__all__ = ["CLAIMS", "EQUATIONS"]
