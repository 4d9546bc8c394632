"""The engineer's jobs, one call each; the commands take the same arguments."""

from .spectra import Orders, orders
from .sweep import SweepResult, sweep

__all__ = ["Orders", "SweepResult", "orders", "sweep"]
