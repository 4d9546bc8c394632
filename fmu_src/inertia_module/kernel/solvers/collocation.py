"""Radau IIA collocation: tables, sums over stages, small linear systems (five unknowns)."""

from .radau import ERROR, GAMMA, LAGRANGE, MATRIX, STAGES


def row(matrix, i, vector):
    """Row i of the matrix times the vector."""
    start = STAGES * i
    return (
        matrix[start] * vector[0]
        + matrix[start + 1] * vector[1]
        + matrix[start + 2] * vector[2]
        + matrix[start + 3] * vector[3]
        + matrix[start + 4] * vector[4]
    )


def mean(vector):
    """Mean over the step of the quantity with these values at the stages (order 9)."""
    return row(MATRIX, STAGES - 1, vector)


def embedded_error(start, vector):
    """Error, over the step size, of the change of a quantity with these rates (embedded formula, order 5)."""
    total = GAMMA * start
    for i in range(STAGES):
        total += ERROR[i] * vector[i]
    return total


def eliminate(matrix, width, target):
    """Solve with the matrix for the columns of target, by Gauss with row pivots, both overwritten."""
    for i in range(STAGES):
        pivot = i
        for n in range(i + 1, STAGES):
            if abs(matrix[STAGES * n + i]) > abs(matrix[STAGES * pivot + i]):
                pivot = n
        if pivot != i:
            swap_rows(matrix, STAGES, i, pivot)
            swap_rows(target, width, i, pivot)
        scale = 1.0 / matrix[STAGES * i + i]
        for n in range(i + 1, STAGES):
            factor = scale * matrix[STAGES * n + i]
            for m in range(i + 1, STAGES):
                matrix[STAGES * n + m] -= factor * matrix[STAGES * i + m]
            for m in range(width):
                target[width * n + m] -= factor * target[width * i + m]
    for back in range(STAGES):
        i = STAGES - 1 - back
        scale = 1.0 / matrix[STAGES * i + i]
        for m in range(width):
            value = target[width * i + m]
            for n in range(i + 1, STAGES):
                value -= matrix[STAGES * i + n] * target[width * n + m]
            target[width * i + m] = scale * value


def swap_rows(rows, width, i, n):
    """Exchange rows i and n."""
    for m in range(width):
        kept = rows[width * i + m]
        rows[width * i + m] = rows[width * n + m]
        rows[width * n + m] = kept


def fit(vector, target):
    """Coefficients, by ascending power, of the polynomial through these values at the stages, into target."""
    for m in range(STAGES):
        value = 0.0
        for j in range(STAGES):
            value += LAGRANGE[STAGES * j + m] * vector[j]
        target[m] = value
    target[STAGES] = 0.0


def fit_integral(rates, start, h, target):
    """Polynomial (six coefficients) of start plus the integral of these rates."""
    fit(rates, target)
    for back in range(STAGES):
        m = STAGES - 1 - back
        target[m + 1] = target[m] * (h / (m + 1.0))
    target[0] = start


def polynomial(coefficients, size, sigma):
    """Value and derivative of the polynomial of so many coefficients at the fraction sigma of the step."""
    value = coefficients[size - 1]
    slope = 0.0
    for back in range(2, size + 1):
        slope = slope * sigma + value
        value = value * sigma + coefficients[size - back]
    return value, slope


def polynomial_fourth_bound(coefficients):
    """Bound of the fourth derivative of the polynomial of six coefficients in the fraction of the step."""
    return 24.0 * abs(coefficients[STAGES - 1]) + 120.0 * abs(coefficients[STAGES])


def change(w, rates):
    """Change over the step in hand of the quantity with these rates at the stages."""
    return w.step * mean(rates)
