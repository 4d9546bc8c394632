"""Gauss-Legendre collocation in extended precision: the integrator of the second reference.

Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1.3: the s-stage method has order 2s.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

# arrays and numbers of np.longdouble
Extended = Any
Rates = Callable[[Extended], Extended]

STAGES = 8
# fixed-point iterations of the stages: each gains about a digit at the steps taken here
MAX_ITERATIONS = 200
_NEWTON_STEPS = 20


def _legendre(x: Extended, n: int) -> tuple[Extended, Extended]:
    """Legendre polynomial of degree n and its derivative, by their recurrences."""
    before, now = np.ones_like(x), x
    for m in range(2, n + 1):
        before, now = now, ((2 * m - 1) * x * now - (m - 1) * before) / m
    return now, n * (x * now - before) / (x * x - 1)


def _lagrange(at: Extended, nodes: Extended) -> Extended:
    """Values of the Lagrange polynomials of the nodes, shape (nodes, points)."""
    rows = []
    for j, node in enumerate(nodes):
        others = np.delete(nodes, j)
        rows.append(np.prod((at[None, :] - others[:, None]) / (node - others)[:, None], axis=0))
    return np.array(rows)


def tableau(stages: int = STAGES) -> tuple[Extended, Extended, Extended]:
    """Nodes c (s,), weights b (s,) and matrix a (s, s) on the interval 0 to 1."""
    roots = np.cos(np.pi * (np.arange(stages, 0, -1) - np.longdouble(0.25)) / (stages + np.longdouble(0.5)))
    for _ in range(_NEWTON_STEPS):
        value, slope = _legendre(roots, stages)
        roots = roots - value / slope
    _, slope = _legendre(roots, stages)
    nodes, weights = (1 + roots) / 2, 1 / ((1 - roots * roots) * slope * slope)
    # a_ij is the integral of the j-th Lagrange polynomial to c_i: of degree s - 1, so exact by Gauss
    matrix = np.array([c * (_lagrange(c * nodes, nodes) @ weights) for c in nodes])
    return nodes, weights, matrix


class Collocation:
    """Steps of y' = rates(y), y of shape (n,); rates takes and gives shape (n, stages)."""

    def __init__(self, stages: int = STAGES) -> None:
        self.nodes, self.weights, self.matrix = tableau(stages)
        self._rounding = 4 * np.finfo(np.longdouble).eps
        self.evaluations = 0
        self._last: tuple[Extended, Extended, Extended] | None = None

    def _covers(self, y: Extended, h: Extended) -> bool:
        """Whether the step kept was from this state and at least as long."""
        return self._last is not None and h <= self._last[1] and np.array_equal(self._last[0], y)

    def _guess(self, rates: Rates, y: Extended, h: Extended) -> Extended:
        """Rates at the stages to begin with: those of the last step, if it was from here and as long."""
        if self._covers(y, h) and self._last is not None:
            _, length, slopes = self._last
            return slopes @ _lagrange(self.nodes * (h / length), self.nodes)
        self.evaluations += 1
        return np.repeat(rates(y[:, None]), self.nodes.size, axis=1)

    def step(self, rates: Rates, y: Extended, h: np.longdouble) -> tuple[Extended, Extended]:
        """State after h, shape (n,), and at the stages, shape (n, stages).

        Raises:
            ArithmeticError: the fixed-point iteration of the stages does not converge: h is too long.
        """
        slopes = self._guess(rates, y, h)
        last = np.longdouble(np.inf)
        for _ in range(MAX_ITERATIONS):
            stages = y[:, None] + h * (slopes @ self.matrix.T)
            fresh = rates(stages)
            change = np.max(np.abs(fresh - slopes) / (1 + np.abs(fresh).max(axis=1, keepdims=True)))
            slopes = fresh
            self.evaluations += self.nodes.size
            # at the level of rounding, or, once small, no longer falling
            if change <= self._rounding or (change < 1e3 * self._rounding and change >= last):
                if not self._covers(y, h):
                    self._last = y, h, slopes
                return y + h * (slopes @ self.weights), stages
            last = change
        raise ArithmeticError(f"stages of a step of {float(h):.3g} s do not converge")
