"""Engineering tasks: sweep, design, fit, orders, batch; the commands have the same arguments."""

from .batch_run import batch
from .design_result import DesignResult
from .design_search import design
from .fit_result import FitResult
from .order_analysis import orders
from .order_result import Orders
from .parameter_fit import fit
from .parameter_sweep import SweepResult, sweep

__all__ = ["DesignResult", "FitResult", "Orders", "SweepResult", "batch", "design", "fit", "orders", "sweep"]
