"""The engineer's jobs, one call each; the commands take the same arguments."""

from .design import DesignResult, design
from .order_run import orders
from .spectra import Orders
from .sweep import SweepResult, sweep

__all__ = ["DesignResult", "Orders", "SweepResult", "design", "orders", "sweep"]
