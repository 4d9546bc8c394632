"""Truncated Taylor series in time: they carry out the d/dt of the printed equations (6) and (32).

The printed forms are not the motion of a mechanism, so there is no closed form to take their rates from;
series arithmetic differentiates them without differences (Griewank and Walther 2008, chapter 13).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Series(NDArrayOperatorsMixin):
    """f(t + h) = c0 + c1 h + c2 h^2 + ... at n times t.

    Sums, products, quotients, np.sqrt, np.sin, np.cos, np.arctan, np.arctan2 and np.arccos of series are
    series, as long as the shortest of them; plain numbers and arrays are constant in time.

    Args:
        coefficients: c0, c1, ..., each of shape (n,).
    """

    def __init__(self, coefficients: list[Any]) -> None:
        self.c = coefficients

    @property
    def value(self) -> Array:
        """The function itself, shape (n,)."""
        result: Array = self.c[0]
        return result

    def rate(self) -> Series:
        """The time derivative: a series shorter by one."""
        return Series([n * c for n, c in enumerate(self.c)][1:])

    def integral(self, start: Any) -> Series:
        """The series with this rate and the value start: longer by one."""
        return Series([start, *(c / n for n, c in enumerate(self.c, 1))])

    def __array_ufunc__(self, function: Any, method: str, *operands: Any, **options: Any) -> Any:
        rule = _RULES.get(function)
        if rule is None or method != "__call__" or options:
            return NotImplemented
        size = min(len(u.c) for u in operands if isinstance(u, Series))
        return rule(*(u if isinstance(u, Series) else Series([u, *[0.0] * (size - 1)]) for u in operands))


def _linear(function: Any) -> Any:
    """The rule of a function that is taken coefficient by coefficient."""
    return lambda *series: Series([function(*terms) for terms in zip(*(u.c for u in series), strict=False)])


def _multiply(u: Series, v: Series) -> Series:
    size = min(len(u.c), len(v.c))
    return Series([sum(u.c[j] * v.c[n - j] for j in range(n + 1)) for n in range(size)])


def _divide(u: Series, v: Series) -> Series:
    quotient: list[Any] = []
    for n in range(min(len(u.c), len(v.c))):
        known = sum(quotient[j] * v.c[n - j] for j in range(n))
        quotient.append((u.c[n] - known) / v.c[0])
    return Series(quotient)


def _sqrt(u: Series) -> Series:
    root: list[Any] = [np.sqrt(u.c[0])]
    for n in range(1, len(u.c)):
        known = sum(root[j] * root[n - j] for j in range(1, n))
        root.append((u.c[n] - known) / (2.0 * root[0]))
    return Series(root)


def _sine_and_cosine(u: Series) -> tuple[Series, Series]:
    sine, cosine = [np.sin(u.c[0])], [np.cos(u.c[0])]
    for n in range(1, len(u.c)):
        sine.append(sum(j * u.c[j] * cosine[n - j] for j in range(1, n + 1)) / n)
        cosine.append(-sum(j * u.c[j] * sine[n - j] for j in range(1, n + 1)) / n)
    return Series(sine), Series(cosine)


def _from_rate(function: Any, rate: Any) -> Any:
    """The rule of a function of which the rate is known."""
    return lambda *series: rate(*series).integral(function(*(u.value for u in series)))


_RULES: dict[Any, Any] = {
    np.add: _linear(np.add),
    np.subtract: _linear(np.subtract),
    np.negative: _linear(np.negative),
    np.multiply: _multiply,
    np.divide: _divide,
    np.sqrt: _sqrt,
    np.sin: lambda u: _sine_and_cosine(u)[0],
    np.cos: lambda u: _sine_and_cosine(u)[1],
    np.arctan: _from_rate(np.arctan, lambda u: u.rate() / (1.0 + u * u)),
    np.arctan2: _from_rate(np.arctan2, lambda v, u: (u * v.rate() - v * u.rate()) / (u * u + v * v)),
    np.arccos: _from_rate(np.arccos, lambda u: -u.rate() / np.sqrt(1.0 - u * u)),
}
