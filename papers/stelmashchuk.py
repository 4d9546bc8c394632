"""Stelmashchuk's stepping mechanism of partially-toothed wheels with a balancing device.

S. H. Stelmashchuk, stepping mechanism of partially-toothed wheels with a balancing device; the first page is
missing. This file contains:

- the motion of the driven mass, equation (3), in closed form for every damping, dwell and balancer,
- the printed equations with their errors, tested at nu = 8, Pi = 0.5, kappa2 = 1,
- functions for the claims.

The equation is solved for the twist e = a - a_k of the shaft. Its forcing is small if the shaft is stiff, so
that no digits are lost if nu is large. With the balancer and without friction it is zero:

    e'' + 2 Pi e' + nu^2 e = -2 Pi a_k' - (1 - beta) a_k''

The textbook forms divide by nu1 = sqrt(nu^2 - Pi^2), by nu^2 and by nu0^2 + (4 pi Pi)^2. They fail or lose
digits at critical damping, for slow systems and at resonance. Here they are divided differences of
exp(lambda kappa) over the characteristic numbers and the exponent of the forcing, which stay finite if points
coincide. Motion from rest under the forcing exp(mu kappa) is the second divided difference over
(slow, fast, mu). The impulse response is the first divided difference over (slow, fast).

The page writes v for nu. It does not define nu0, chi and nu1; the definitions in the table reproduce every
printed R. It covers only Pi < nu, without resonance of an undamped shaft.

Symbols, all without unit:

- kappa: relative time t/T, in functions with a phase from the start of the phase; number or shape (n,).
- kappa2: length of phase II, at least 0; default 1.
- beta: gain of the balancer; 1 in the paper, 0 without balancer.
- phase: number of the phase, 0 to 3.
- C: constants (C1, C2) of a phase.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from inertia_module.scene.shaft import stepping_speed

from .engine import Equation, Forms, compared, max_abs, tables

TWO_PI = 2.0 * np.pi
# lengths kappa_1 and kappa_3 of phases I and III
HALF = 0.5
PHASES = ("I", "II", "III", "IV")
# evaluated length of phase IV, which has no end
FINAL_LENGTH = 2.0
# the paper does not state the dwell of its figures: peaks are searched over these dwells
KAPPA2, DWELLS = 1.0, np.linspace(0.25, 3.0, 111)
TIMES = np.linspace(0.0, 6.0, 4001)
STIFFNESSES = (4.4, 8.0, 100.0)
DAMPINGS = (5.0, 2.0, 1.0, 0.5, 0.1)
# phases with changing and with constant speed of the driving wheel
DRIVEN, COASTING = [0, 2], [1, 3]


# --- the law of motion of the driving wheel ---


def phase_starts(kappa2: float) -> Any:
    """Return the starts of phases I to IV, shape (4,).

    Args:
        kappa2: Length of phase II.
    """
    return np.array([0.0, HALF, HALF + kappa2, HALF + kappa2 + HALF])


def phase_of(kappa: Any, kappa2: float) -> Any:
    """Return the number of the phase, 0 to 3; a boundary belongs to the later phase.

    Args:
        kappa: Relative time, any shape.
        kappa2: Length of phase II.
    """
    return np.searchsorted(phase_starts(kappa2)[1:], np.asarray(kappa, dtype=np.float64), side="right")


def law_of_motion(kappa: Any, kappa2: float) -> tuple[Any, Any, Any]:
    """Return angle of the driving wheel and derivatives (a_k, a_k', a_k'') as invariants.

    With kappa from the start of the phase: I: a = kappa - sin(2 pi kappa) / (2 pi); II: 0.5 + 2 kappa; III:
    mirror image of I; IV: rest. The wheel also rests before kappa = 0. a_k'' is the sine S_k of the paper
    with amplitude 2 pi.

    Args:
        kappa: Relative time, any shape.
        kappa2: Length of phase II.
    """
    time, starts, phase = np.asarray(kappa, dtype=np.float64), phase_starts(kappa2), phase_of(kappa, kappa2)
    # sum of the angles of all phases
    up = np.clip(time, 0.0, starts[1])
    steady = np.clip(time - starts[1], 0.0, kappa2)
    down = np.clip(time - starts[2], 0.0, HALF)
    angle = up - np.sin(TWO_PI * up) / TWO_PI + 2.0 * steady + down + np.sin(TWO_PI * down) / TWO_PI
    wave = (phase == 0) * np.sin(TWO_PI * up) - (phase == 2) * np.sin(TWO_PI * down)
    return angle, stepping_speed(time, kappa2), TWO_PI * wave


# --- the driven mass ---


class Criteria(NamedTuple):
    """The two criteria of equation (3). T is the time of an acceleration and a deceleration.

    Attributes:
        nu: Criterion of frequency similarity, nu^2 = c T^2 / J4, with the stiffness c of the shaft and the
            driven inertia J4: frequency of the undamped oscillation, rad per unit of kappa; above 0.
        Pi: Damping criterion, 2 Pi = f T / J4, with the viscous friction f of the driven mass; at least 0.
            The motion is aperiodic if Pi >= nu.
    """

    nu: float
    Pi: float

    def characteristic_numbers(self) -> tuple[complex, complex]:
        """Return the roots (slow, fast) of lambda^2 + 2 Pi lambda + nu^2: conjugate, equal or both real."""
        fast = -self.Pi - np.sqrt(complex((self.Pi - self.nu) * (self.Pi + self.nu)))
        return self.nu**2 / fast, fast


def first_difference(a: complex, b: complex, kappa: Any) -> Any:
    """Return (exp(a kappa) - exp(b kappa)) / (a - b), or kappa exp(a kappa) if a = b.

    Args:
        a: First exponent.
        b: Second exponent.
        kappa: Relative time, shape (n,).
    """
    half = 0.5 * (a - b) * kappa
    # each form is used where it has no cancellation
    near = np.abs(half) < 0.5
    argument = np.where(near & (half != 0.0), half, 1.0)
    ratio = np.where(half == 0.0, 1.0, np.sinh(argument) / argument)
    product = kappa * np.exp(0.5 * (a + b) * kappa) * ratio
    distance = a - b if a != b else 1.0
    return np.where(near, product, (np.exp(a * kappa) - np.exp(b * kappa)) / distance)


def second_difference(points: tuple[complex, complex, complex], kappa: Any) -> Any:
    """Return the second divided difference of exp(lambda kappa).

    It divides by the difference of the two most distant points.

    Args:
        points: The three exponents.
        kappa: Relative time, shape (n,).
    """
    orders = ((0, 1, 2), (0, 2, 1), (1, 0, 2))
    ends = max(orders, key=lambda order: abs(points[order[0]] - points[order[2]]))
    left, middle, right = (points[place] for place in ends)
    return (first_difference(left, middle, kappa) - first_difference(middle, right, kappa)) / (left - right)


def forcing(criteria: Criteria, beta: float, phase: int) -> tuple[float, complex]:
    """Return the forcing (steady, wave) of the twist in a phase: steady + Re(wave exp(2 pi i kappa)).

    Args:
        criteria: nu and Pi.
        beta: Gain of the balancer.
        phase: Number of the phase.
    """
    wave = complex(2.0 * criteria.Pi, TWO_PI * (1.0 - beta))
    return (-2.0, -4.0, -2.0, 0.0)[phase] * criteria.Pi, (wave, 0j, -wave, 0j)[phase]


def twist_in_phase(criteria: Criteria, beta: float, phase: int, start: tuple[float, float], time: Any) -> Any:
    """Return the twist and its two derivatives (e, e', e'') within a phase, shape (3, n).

    Args:
        criteria: nu and Pi.
        beta: Gain of the balancer.
        phase: Number of the phase.
        start: Twist (e, e') at the start of the phase.
        time: kappa from the start of the phase, shape (n,).
    """
    slow, fast = criteria.characteristic_numbers()
    fading, impulse = np.exp(fast * time), first_difference(slow, fast, time)
    impulse_rate = fading + slow * impulse
    impulse_rate2 = slow * impulse_rate + fast * fading
    # free motion from the start values: responses to a step in the angle and in the speed
    nu2, (e, e_rate) = criteria.nu * criteria.nu, start
    motion = [
        e * (fading - fast * impulse) + e_rate * impulse,
        e_rate * impulse_rate - e * nu2 * impulse,
        e_rate * impulse_rate2 - e * nu2 * impulse_rate,
    ]
    # motion from rest; its derivative is y' = mu y + g with the impulse response g, so that no large number
    # multiplies a difference
    for amplitude, mu in zip(forcing(criteria, beta, phase), (0j, complex(0.0, TWO_PI)), strict=True):
        response_to_forcing = second_difference((slow, fast, mu), time)
        rate = mu * response_to_forcing + impulse.real
        for n, derivative in enumerate((response_to_forcing, rate, mu * rate + impulse_rate.real)):
            motion[n] = motion[n].real + (amplitude * derivative).real
    return np.stack(motion)


def twist_at_starts(criteria: Criteria, kappa2: float, beta: float = 1.0) -> list[tuple[float, float]]:
    """Return the twist (e, e') at the starts of phases I to IV; the paper uses the constants C1, C2 instead.

    Args:
        criteria: nu and Pi.
        kappa2: Length of phase II.
        beta: Gain of the balancer.
    """
    starts = [(0.0, 0.0)]
    for phase, length in enumerate((HALF, kappa2, HALF)):
        twist, rate, _ = twist_in_phase(criteria, beta, phase, starts[-1], length)
        starts.append((float(twist), float(rate)))
    return starts


class Response(NamedTuple):
    """Motion of the driven mass as invariants of the paper; arrays of the shape of kappa.

    Attributes:
        angle: Angle a, in units of phi_engage.
        velocity: Velocity a'.
        acceleration: Acceleration a'', the invariant in the figures of the paper.
        twist: Twist e = a - a_k of the shaft.
    """

    angle: Any
    velocity: Any
    acceleration: Any
    twist: Any


def response(kappa: Any, criteria: Criteria, kappa2: float, beta: float = 1.0) -> Response:
    """Return the motion of the driven mass from rest, equation (3); a'' is continuous between phases.

    Args:
        kappa: Relative time t/T, any shape; all parts rest before 0.
        criteria: nu and Pi, with any damping, including resonance nu = 2 pi.
        kappa2: Length of phase II.
        beta: Gain of the balancer.
    """
    time = np.asarray(kappa, dtype=np.float64)
    starts, number = phase_starts(kappa2), phase_of(time, kappa2)
    twist = np.zeros((3, *time.shape))
    for phase, start in enumerate(twist_at_starts(criteria, kappa2, beta)):
        inside = (number == phase) & (time >= 0.0)
        twist[:, inside] = twist_in_phase(criteria, beta, phase, start, time[inside] - starts[phase])
    angle, velocity, acceleration = law_of_motion(time, kappa2) + twist
    return Response(angle, velocity, acceleration, twist[0])


def constants(criteria: Criteria, kappa2: float, beta: float = 1.0) -> list[tuple[float, float]]:
    """Return C1 and C2 of phases I to IV: a = exp(-Pi kappa)(C1 sin nu1 kappa + C2 cos nu1 kappa) + R.

    Requires Pi < nu, and no resonance without friction (nu = 2 pi), where R does not exist. The motion (see
    response) does not use C1, which has no limit for nu1 = 0.

    Args:
        criteria: nu and Pi.
        kappa2: Length of phase II.
        beta: Gain of the balancer.
    """
    nu, Pi = criteria
    stiffness = complex(nu * nu - TWO_PI**2, 2.0 * TWO_PI * Pi)
    nu1 = np.sqrt((nu - Pi) * (nu + Pi))
    pairs = []
    for phase, (twist, rate) in enumerate(twist_at_starts(criteria, kappa2, beta)):
        steady, wave = forcing(criteria, beta, phase)
        amplitude = wave / stiffness
        C2 = twist - steady / (nu * nu) - amplitude.real
        pairs.append((float((rate - (TWO_PI * 1j * amplitude).real + Pi * C2) / nu1), float(C2)))
    return pairs


def free_oscillation(
    criteria: Criteria, kappa2: float, beta: float = 1.0, phase: int = 1
) -> tuple[float, float]:
    """Return the free oscillation of a'' in a phase in which a'' of the driving wheel is zero.

    Args:
        criteria: nu and Pi.
        kappa2: Length of phase II.
        beta: Gain of the balancer.
        phase: 1 for phase II, 3 for phase IV.

    Returns:
        Amplitude of the envelope A exp(-Pi kappa) at the start of the phase, or |a''| if the motion is
        aperiodic (Pi >= nu); and the maximum |a''| in the phase.
    """
    length = kappa2 if phase == 1 else FINAL_LENGTH
    kappa = phase_starts(kappa2)[phase] + np.linspace(0.0, length, 20001)
    swing = np.abs(response(kappa, criteria, kappa2, beta).acceleration)
    amplitude = swing[0]
    if criteria.Pi < criteria.nu:
        # differentiating exp(lambda kappa) twice multiplies its amplitude by |lambda|^2 = nu^2
        amplitude = criteria.nu**2 * np.hypot(*constants(criteria, kappa2, beta)[phase])
    return float(amplitude), float(swing.max())


# --- as printed ---


def printed(criteria: Criteria, kappa2: float, **values: Any) -> Forms:
    """Return the results of the printed equations, with printed results as inputs.

    The page does not define B. With the velocity of phase II, 2, the angle a is continuous.

    Args:
        criteria: nu and Pi.
        kappa2: Length of phase II.
        values: Values that override printed formulas; kappa and C within a phase.
    """
    return Forms(PRINTED, **{**criteria._asdict(), "kappa2": kappa2, "B": 2.0} | values)


def free_part(kappa: Any, C: tuple[Any, Any], nu1: float, Pi: float) -> tuple[Any, Any]:
    """Return the solution of (4) without R, and its derivative.

    The solution is exp(-Pi kappa)(C1 sin nu1 kappa + C2 cos nu1 kappa).

    Args:
        kappa: Relative time, shape (n,).
        C: Constants (C1, C2) of the phase.
        nu1: Damped frequency, rad per unit of kappa.
        Pi: Damping criterion.
    """
    fading, sine, cosine = np.exp(-Pi * kappa), np.sin(nu1 * kappa), np.cos(nu1 * kappa)
    swing = C[0] * sine + C[1] * cosine
    return fading * swing, fading * (nu1 * (C[0] * cosine - C[1] * sine) - Pi * swing)


ROWS, PRINTED, EXACT = tables("stelmashchuk", globals())


def acceleration(s: Forms, kappa: Any) -> Any:
    """Return the invariant a'' of the driven mass with the balancer by the printed equations, shape (n,).

    Args:
        s: Printed forms (see printed).
        kappa: Relative time, at least 0, shape (n,).
    """
    number = phase_of(kappa, s.kappa2)
    local = kappa - phase_starts(s.kappa2)[number]
    phases = [s.replaced(kappa=local, C=s[f"C_{phase}"]) for phase in PHASES]
    free = np.choose(number, [phase.free_acceleration for phase in phases])
    return free + np.choose(number, [1.0, 0.0, -1.0, 0.0]) * phases[0].particular_acceleration


# case of figure 2 in the text
REFERENCE = Criteria(nu=8.0, Pi=0.5)
RISE = np.linspace(0.0, 0.5, 3001)[:-1]
DWELL = np.linspace(0.0, KAPPA2, 3001)[:-1]
# printed abbreviations with the exact constants, in phases I and II
CONSTANTS = dict(zip([f"C_{phase}" for phase in PHASES], constants(REFERENCE, KAPPA2), strict=True))
RIGHT = Forms(EXACT, **printed(REFERENCE, KAPPA2, **CONSTANTS))
RISING, DWELLING = (
    RIGHT.replaced(kappa=kappa, C=C, motion=response(start + kappa, REFERENCE, KAPPA2))
    for kappa, C, start in zip((RISE, DWELL), CONSTANTS.values(), phase_starts(KAPPA2), strict=False)
)

EQUATIONS = {
    "(3)": compared("law_of_motion", PRINTED, RISING),
    "(4)": compared("law_of_motion", PRINTED, RISING),
    "(5)": Equation("free_acceleration", lambda: (DWELLING.free_acceleration, DWELLING.motion.acceleration)),
    "R″": compared("particular_acceleration", PRINTED, RISING),
    **{f"C {phase}": compared(f"C_{phase}", PRINTED, RIGHT) for phase in PHASES},
}


# --- claims ---


def phase_peaks(values: Any, kappa2: float = KAPPA2) -> Any:
    """Return the maximum magnitude in each of phases I to IV, shape (4,).

    Args:
        values: Values over TIMES, shape (4001,).
        kappa2: Length of phase II.
    """
    phase = phase_of(TIMES, kappa2)
    return np.array([max_abs(values[phase == number]) for number in range(4)])


def acceleration_over_times(criteria: Criteria, beta: float = 1.0, kappa2: float = KAPPA2) -> Any:
    """Return the exact invariant a'' over TIMES, shape (4001,).

    Args:
        criteria: nu and Pi.
        beta: Gain of the balancer.
        kappa2: Length of phase II.
    """
    return response(TIMES, criteria, kappa2, beta).acceleration


def deviation(criteria: Criteria, beta: float = 1.0) -> Any:
    """Return the difference of a'' and the sine a_k'' over the amplitude 2 pi, over TIMES, shape (4001,).

    Args:
        criteria: nu and Pi.
        beta: Gain of the balancer.
    """
    return (acceleration_over_times(criteria, beta) - law_of_motion(TIMES, KAPPA2)[2]) / TWO_PI


def reduction_factors(criteria: Criteria, phase: int = 1) -> Any:
    """Return the factors by which the balancer reduces amplitude and maximum of the free oscillation.

    Args:
        criteria: nu and Pi.
        phase: 1 for phase II, 3 for phase IV.
    """
    without, balanced = (free_oscillation(criteria, KAPPA2, beta, phase) for beta in (0.0, 1.0))
    return np.array(without) / balanced
