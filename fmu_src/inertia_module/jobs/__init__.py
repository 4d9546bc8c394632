"""The engineer's jobs, one call each; the commands take the same arguments."""

from .spectra import Orders, orders

__all__ = ["Orders", "orders"]
