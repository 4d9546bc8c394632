"""Stelmashchuk's stepping mechanism of partially-toothed wheels with a balancing device."""

from .claims import findings
from .equations import EQUATIONS

__all__ = ["EQUATIONS", "findings"]
