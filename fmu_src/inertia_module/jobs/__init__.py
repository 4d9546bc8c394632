"""Engineering tasks: sweep, design, fit, orders, batch; the commands have the same arguments."""

from .batch import batch
from .design import DesignResult, design
from .fit import fit
from .fit_result import FitResult
from .orders import Orders, orders
from .sweep import SweepResult, sweep

__all__ = ["DesignResult", "FitResult", "Orders", "SweepResult", "batch", "design", "fit", "orders", "sweep"]
