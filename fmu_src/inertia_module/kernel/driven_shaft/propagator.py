"""Exact motion of z'' + rate z' + square z = 0, and of its integrals, in every damping regime.

Everything is a divided difference of exp(lambda t) over the two characteristic numbers and zeros:
impulse = exp[slow, fast], and integral n of it = exp[slow, fast, 0, ... n zeros]. Those stay finite where
the numbers meet each other (critical damping) or zero (soft shaft, short step), where the textbook
quotients cancel, so each region has the form that loses nothing:

- short steps: power series over a quarter of the step, then twice the addition theorem, sums of
  positive numbers;
- one number fast, the other slow: first differences of phi_n(z) = (phi_(n-1)(z) - 1/(n-1)!) / z;
- else: the equation itself, integrated, gives each integral from the one before.

The cost is the same for any step; nothing overflows, for no exponent is positive.
Moler and Van Loan, Nineteen dubious ways to compute the exponential of a matrix, SIAM Review 45 (2003),
methods 3 and 14; for phi_n Hochbruck and Ostermann, Exponential integrators, Acta Numerica 19 (2010), 2.
"""

import math

# up to this fast * t the series over a quarter of t serves
SHORT = 3.0
# below this slow * t one minus the answer to a step would cancel
SLOW = 1.0
EPSILON = 1e-18


def characteristic(rate, square):
    """Characteristic numbers of z'' + rate z' + square z, rate >= 0 and square > 0.

    Returns:
        (swing, slow, fast), 1/s. Underdamped: -slow +- i swing, and fast is their magnitude.
        Else swing = 0 and they are -slow and -fast, slow <= fast.
    """
    half = 0.5 * rate
    natural = math.sqrt(square)
    root = math.sqrt(abs(natural - half)) * math.sqrt(natural + half)
    if natural > half:
        return root, half, natural
    fast = half + root
    # the slow one by Vieta: half - root would cancel at strong damping
    return 0.0, square / fast, fast


def free(swing, slow, fast, t):
    """Answers at t to an initial displacement 1 and to an initial rate 1.

    Returns:
        (step, impulse, impulse'): z(t) from (1, 0), z(t) and z'(t) from (0, 1).
    """
    if swing > 0.0:
        fading = math.exp(-slow * t)
        cosine = fading * math.cos(swing * t)
        impulse = fading * math.sin(swing * t) / swing
        return cosine + slow * impulse, impulse, cosine - slow * impulse
    spread = fast - slow
    fading = math.exp(-fast * t)
    impulse = t * fading
    if spread > 0.0:
        impulse = math.exp(-slow * t) * -math.expm1(-spread * t) / spread
    return fading + fast * impulse, impulse, fading - slow * impulse


def by_series(rate, square, t):
    """Power series: impulse' , impulse and its first four integrals; for fast * t below one."""
    damp = rate * t
    spring = square * t * t
    before = 0.0
    term = t
    n = 1.0
    slope = 1.0
    impulse = t
    one = t * t / 2.0
    two = one * t / 3.0
    three = two * t / 4.0
    four = three * t / 5.0
    while n < 40.0:
        following = -(damp * n * term + spring * before) / (n * (n + 1.0))
        before = term
        term = following
        n += 1.0
        slope += n * term / t
        impulse += term
        part = term * t / (n + 1.0)
        one += part
        part *= t / (n + 2.0)
        two += part
        part *= t / (n + 3.0)
        three += part
        four += part * t / (n + 4.0)
        if n * (abs(term) + abs(before)) <= EPSILON * t:
            n = 40.0
    return slope, impulse, one, two, three, four


def doubled(rate, square, t, slope, impulse, one, two, three, four):
    """What by_series gives, at 2 t from that at t."""
    # integrals of the answer to a displacement 1: step = impulse' + rate impulse
    step = slope + rate * impulse
    step1 = impulse + rate * one
    step2 = one + rate * two
    step3 = two + rate * three
    step4 = three + rate * four
    return (
        slope * slope - square * impulse * impulse,
        impulse * (step + slope),
        one + impulse * step1 + slope * one,
        two + t * one + impulse * step2 + slope * two,
        three + t * (two + 0.5 * t * one) + impulse * step3 + slope * three,
        four + t * (three + t * (0.5 * two + t / 6.0 * one)) + impulse * step4 + slope * four,
    )


def phi(y):
    """phi_1 to phi_4 at -y, y >= 0: phi_1(z) = (exp(z) - 1)/z, phi_n(z) = (phi_(n-1)(z) - 1/(n-1)!)/z."""
    if y >= 1.0:
        one = -math.expm1(-y) / y
        two = (1.0 - one) / y
        three = (0.5 - two) / y
        return one, two, three, (1.0 / 6.0 - three) / y
    four = 0.0
    term = 1.0 / 24.0
    n = 5.0
    while n < 40.0:
        four += term
        term *= -y / n
        n += 1.0
        if abs(term) <= EPSILON:
            n = 40.0
    three = 1.0 / 6.0 - y * four
    two = 0.5 - y * three
    return 1.0 - y * two, two, three, four


def responses(rate, square, swing, slow, fast, t):
    """Everything a step of length t > 0 needs.

    Args:
        rate, square: of the equation, 1/s and 1/s^2. swing, slow, fast: of characteristic. t: s.

    Returns:
        (step, slope, impulse, one, two, three, four): answer to a displacement 1, rate of the answer to
        an impulse 1, this answer, and its first to fourth integrals from 0 to t.
    """
    if fast * t < SHORT:
        slope, impulse, one, two, three, four = by_series(rate, square, 0.25 * t)
        slope, impulse, one, two, three, four = doubled(
            rate, square, 0.25 * t, slope, impulse, one, two, three, four
        )
        slope, impulse, one, two, three, four = doubled(
            rate, square, 0.5 * t, slope, impulse, one, two, three, four
        )
        return slope + rate * impulse, slope, impulse, one, two, three, four
    step, impulse, slope = free(swing, slow, fast, t)
    if swing == 0.0 and slow * t < SLOW:
        spread = fast - slow
        s1, s2, s3, s4 = phi(slow * t)
        f1, f2, f3, f4 = phi(fast * t)
        power = t / spread
        one = power * (s1 - f1)
        power *= t
        two = power * (s2 - f2)
        power *= t
        three = power * (s3 - f3)
        return step, slope, impulse, one, two, three, power * t * (s4 - f4)
    one = (1.0 - step) / square
    two = (t - impulse - rate * one) / square
    three = (0.5 * t * t - one - rate * two) / square
    four = (t * t * t / 6.0 - two - rate * three) / square
    return step, slope, impulse, one, two, three, four
