"""The engineer's jobs, one call each; the commands take the same arguments."""

from .order_run import orders
from .spectra import Orders

__all__ = ["Orders", "orders"]
