"""The engineer's jobs, one call each; the commands take the same arguments."""

from .design import DesignResult, design
from .fit import fit
from .fitted import FitResult
from .order_run import orders
from .spectra import Orders
from .sweep import SweepResult, sweep

__all__ = ["DesignResult", "FitResult", "Orders", "SweepResult", "design", "fit", "orders", "sweep"]
