"""Central differences for tests of the rates in the kernel."""

import numpy as np
import pytest


def difference(function, step=1e-3):
    """Return the derivative of a function at 0 by central differences of order 6."""
    weights = {1: 45.0, 2: -9.0, 3: 1.0}
    total = sum(
        weight * (np.array(function(n * step)) - np.array(function(-n * step)))
        for n, weight in weights.items()
    )
    return total / (60.0 * step)


def assert_rates(rates, function, step=1e-3, rel=1e-7, share=1e-8):
    """Check derivatives of a function at 0."""
    expected = difference(function, step)
    scale = np.abs(expected).max() + np.abs(function(0.0)).max()
    assert rates == pytest.approx(expected, rel=rel, abs=share * scale)
