"""Functions of time with their first two rates: they carry out the d/dt of the printed equations.

The printed forms are not the motion of a mechanism, so there is no closed form to take their rates from;
the product and chain rules give them without differences.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin


class Jet(NDArrayOperatorsMixin):
    """f, f' and f'' at n times.

    Sums, products, quotients, np.sqrt, np.sin, np.cos, np.arctan and np.arccos of jets are
    jets, with as many rates as the shortest has; plain numbers and arrays are constant in time.

    Args:
        orders: f, f', f'', or less, each of shape (n,), or vectors with the components first.
    """

    def __init__(self, *orders: Any) -> None:
        self.orders = orders

    def __getitem__(self, component: int) -> Jet:
        return Jet(*(order[component] for order in self.orders))

    @property
    def value(self) -> Any:
        """The function itself."""
        return self.orders[0]

    def __array_ufunc__(self, function: Any, method: str, *operands: Any, **options: Any) -> Any:
        if function not in _RULES or method != "__call__" or options:
            return NotImplemented
        size = min(len(u.orders) for u in operands if isinstance(u, Jet))
        padded = ([*u.orders, 0.0, 0.0][:3] if isinstance(u, Jet) else [u, 0.0, 0.0] for u in operands)
        return Jet(*_RULES[function](*padded)[:size])


def rate(f: Jet) -> Jet:
    """The time derivative: it has one rate less."""
    return Jet(*f.orders[1:])


def value(f: Any) -> Any:
    """What a jet is at the times; anything else as it is."""
    return f.value if isinstance(f, Jet) else f


def vector(*components: Any) -> Any:
    """A vector of components of shape (n,), or numbers or jets: shape (3, n), or a jet of such."""
    jets = [c for c in components if isinstance(c, Jet)]
    if not jets:
        return np.stack(np.broadcast_arrays(*components))
    size = min(len(jet.orders) for jet in jets)
    orders = ([c.orders[n] if isinstance(c, Jet) else c * (n == 0) for c in components] for n in range(size))
    return Jet(*(np.stack(np.broadcast_arrays(*order)) for order in orders))


def _product(u: Any, v: Any) -> list[Any]:
    return [u[0] * v[0], u[1] * v[0] + u[0] * v[1], u[2] * v[0] + 2.0 * u[1] * v[1] + u[0] * v[2]]


def _chain(f: Any, slope: Any, curvature: Any) -> Any:
    """The rule of a function of one jet, from its first two derivatives."""
    return lambda u: [f(u[0]), slope(u[0]) * u[1], curvature(u[0]) * u[1] * u[1] + slope(u[0]) * u[2]]


_inverse = _chain(lambda u: 1.0 / u, lambda u: -1.0 / u**2, lambda u: 2.0 / u**3)


_RULES: dict[Any, Any] = {
    np.add: lambda u, v: [p + q for p, q in zip(u, v, strict=True)],
    np.subtract: lambda u, v: [p - q for p, q in zip(u, v, strict=True)],
    np.negative: lambda u: [-p for p in u],
    np.multiply: _product,
    np.divide: lambda u, v: _product(u, _inverse(v)),
    np.sqrt: _chain(np.sqrt, lambda u: 0.5 / np.sqrt(u), lambda u: -0.25 * u**-1.5),
    np.sin: _chain(np.sin, np.cos, lambda u: -np.sin(u)),
    np.cos: _chain(np.cos, lambda u: -np.sin(u), lambda u: -np.cos(u)),
    np.arctan: _chain(np.arctan, lambda u: 1.0 / (1.0 + u * u), lambda u: -2.0 * u / (1.0 + u * u) ** 2),
    np.arccos: _chain(np.arccos, lambda u: -((1.0 - u * u) ** -0.5), lambda u: -u * (1.0 - u * u) ** -1.5),
}
