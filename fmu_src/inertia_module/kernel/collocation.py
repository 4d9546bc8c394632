"""Radau IIA collocation: tables, sums over stages, small linear systems (five unknowns)."""

from .radau_table import *
from .slots import *


def derive_collocation(d):
    """Put the matrix A, its square and the Lagrange polynomials where they can be indexed fast."""
    for i in range(STAGES):
        for j in range(STAGES):
            d[D_RADAU + STAGES * i + j] = MATRIX[i][j]
            d[D_LAGRANGE + STAGES * i + j] = LAGRANGE[i][j]
            square = 0.0
            for n in range(STAGES):
                square += MATRIX[i][n] * MATRIX[n][j]
            d[D_RADAU_SQUARE + STAGES * i + j] = square


def row(a, matrix, i, b, vector):
    """Row i of the matrix at a[matrix] times the vector at b[vector]."""
    start = matrix + STAGES * i
    return (
        a[start] * b[vector]
        + a[start + 1] * b[vector + 1]
        + a[start + 2] * b[vector + 2]
        + a[start + 3] * b[vector + 3]
        + a[start + 4] * b[vector + 4]
    )


def mean(d, w, vector):
    """Mean over the step of the quantity whose stages are at w[vector] (order 9)."""
    return row(d, D_RADAU, STAGES - 1, w, vector)


def embedded_error(start, w, vector):
    """Error, over the step size, of the change of a quantity with these rates (embedded formula, order 5)."""
    total = GAMMA * start
    for i in range(STAGES):
        total += ERROR[i] * w[vector + i]
    return total


def eliminate(w, matrix, width, target):
    """Solve with the matrix at w[matrix] for the columns at w[target], by Gauss with row pivots, in place."""
    for i in range(STAGES):
        pivot = i
        for n in range(i + 1, STAGES):
            if abs(w[matrix + STAGES * n + i]) > abs(w[matrix + STAGES * pivot + i]):
                pivot = n
        if pivot != i:
            swap_rows(w, matrix, STAGES, i, pivot)
            swap_rows(w, target, width, i, pivot)
        scale = 1.0 / w[matrix + STAGES * i + i]
        for n in range(i + 1, STAGES):
            factor = scale * w[matrix + STAGES * n + i]
            for m in range(i + 1, STAGES):
                w[matrix + STAGES * n + m] -= factor * w[matrix + STAGES * i + m]
            for m in range(width):
                w[target + width * n + m] -= factor * w[target + width * i + m]
    for back in range(STAGES):
        i = STAGES - 1 - back
        scale = 1.0 / w[matrix + STAGES * i + i]
        for m in range(width):
            value = w[target + width * i + m]
            for n in range(i + 1, STAGES):
                value -= w[matrix + STAGES * i + n] * w[target + width * n + m]
            w[target + width * i + m] = scale * value


def swap_rows(w, base, width, i, n):
    """Exchange rows i and n."""
    for m in range(width):
        kept = w[base + width * i + m]
        w[base + width * i + m] = w[base + width * n + m]
        w[base + width * n + m] = kept


def fit(d, w, vector, target):
    """Coefficients at w[target], by ascending power, of the polynomial through the stages at w[vector]."""
    for m in range(STAGES):
        value = 0.0
        for j in range(STAGES):
            value += d[D_LAGRANGE + STAGES * j + m] * w[vector + j]
        w[target + m] = value


def fit_integral(d, w, vector, start, h, target):
    """The same (six coefficients) of start plus the integral of the rates at w[vector]."""
    fit(d, w, vector, target + 1)
    w[target] = start
    for m in range(STAGES):
        w[target + 1 + m] *= h / (m + 1.0)


def polynomial(w, base, size, sigma):
    """Value and derivative of the polynomial at w[base] at the fraction sigma of the step."""
    value = w[base + size - 1]
    slope = 0.0
    for back in range(2, size + 1):
        slope = slope * sigma + value
        value = value * sigma + w[base + size - back]
    return value, slope
