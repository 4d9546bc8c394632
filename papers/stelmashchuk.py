"""Stelmashchuk's stepping mechanism of partially-toothed wheels with a balancing device.

S. H. Stelmashchuk, stepping mechanism of partially-toothed wheels with a balancing device; the first page is
missing. The motion of the driven mass, equation (3), in closed form for every damping, dwell and balancer;
the equations as printed, errors kept, judged at nu = 8, Pi = 0.5, kappa2 = 1; claims.

The equation is solved for the twist e = a - a_k of the shaft. What drives it is small where the shaft is
stiff, so that nothing is lost when nu is large, and with the balancer and without friction it is zero:

    e'' + 2 Pi e' + nu^2 e = -2 Pi a_k' - (1 - beta) a_k''

The textbook forms divide by nu1 = sqrt(nu^2 - Pi^2), by nu^2 and by nu0^2 + (4 pi Pi)^2: they fail or
lose digits at critical damping, for slow systems and at resonance. All of them are divided differences
of exp(lambda kappa) over the characteristic numbers and the number of the forcing, and those stay finite
when points meet. Motion from rest under the forcing exp(mu kappa) is the second divided difference over
(slow, fast, mu), the impulse response the first over (slow, fast).

The page calls v what is nu here. It does not say what nu0, chi and nu1 are; the names in the table reproduce
every printed R. It covers only Pi < nu, and no resonance without friction.

kappa: relative time t/T, from the beginning of a phase where a phase is given, numbers or arrays of shape
(n,), as the results, all without unit; kappa2: length of phase II, from 0 on, 1 where not told; beta: gain of
the balancer, 1 the paper's, 0 for none; phase: 0 to 3; C: constants (C1, C2) of a phase.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from inertia_module.scene.shaft import stepping_speed

from .engine import Equation, Forms, compared, largest, tables

TWO_PI = 2.0 * np.pi
# kappa_1 and kappa_3 of the paper: the lengths of phases I and III
HALF = 0.5
PHASES = ("I", "II", "III", "IV")
# phase IV has no end: it is watched for this many units of kappa
WATCHED = 2.0
# the dwell of the paper's figures is not given: peaks are looked for over these
KAPPA2, DWELLS = 1.0, np.linspace(0.25, 3.0, 111)
TIMES = np.linspace(0.0, 6.0, 4001)
STIFFNESSES = (4.4, 8.0, 100.0)
DAMPINGS = (5.0, 2.0, 1.0, 0.5, 0.1)
# phases in which the driving wheel changes its speed, and in which it does not
DRIVEN, COASTING = [0, 2], [1, 3]


# --- the law of motion of the driving wheel ---


def phase_starts(kappa2: float) -> Any:
    """Starts of phases I to IV, in kappa, shape (4,)."""
    return np.array([0.0, HALF, HALF + kappa2, HALF + kappa2 + HALF])


def phase_of(kappa: Any, kappa2: float) -> Any:
    """Number of the phase, 0 to 3, at each kappa (a boundary counts to the later phase)."""
    return np.searchsorted(phase_starts(kappa2)[1:], np.asarray(kappa, dtype=np.float64), side="right")


def law_of_motion(kappa: Any, kappa2: float) -> tuple[Any, Any, Any]:
    """Angle of the driving wheel and its derivatives in kappa, (a_k, a_k', a_k''), as invariants.

    Phase I: a = kappa - sin(2 pi kappa) / (2 pi); II: 0.5 + 2 kappa; III: mirrors I; IV: rest, kappa
    counted from the beginning of the phase. Before kappa = 0 the wheel rests as well. a_k'' is the
    sinusoid S_k the paper compares with, 2 pi at its peaks.
    """
    time, starts, phase = np.asarray(kappa, dtype=np.float64), phase_starts(kappa2), phase_of(kappa, kappa2)
    # each phase adds what it has run through, so that no phase has to be picked
    up = np.clip(time, 0.0, starts[1])
    steady = np.clip(time - starts[1], 0.0, kappa2)
    down = np.clip(time - starts[2], 0.0, HALF)
    angle = up - np.sin(TWO_PI * up) / TWO_PI + 2.0 * steady + down + np.sin(TWO_PI * down) / TWO_PI
    wave = (phase == 0) * np.sin(TWO_PI * up) - (phase == 2) * np.sin(TWO_PI * down)
    return angle, stepping_speed(time, kappa2), TWO_PI * wave


# --- the driven mass ---


class Criteria(NamedTuple):
    """The two criteria of equation (3), made with the time T of an acceleration and a deceleration.

    Attributes:
        nu: criterion of frequency similarity, nu^2 = c T^2 / J4, with the stiffness c of the shaft and the
            driven inertia J4: the frequency of the undamped oscillation in rad per unit of kappa; above 0.
        Pi: damping criterion, 2 Pi = f T / J4, with the viscous friction f of the driven mass; from 0 on.
            The oscillation is aperiodic from Pi = nu on.
    """

    nu: float
    Pi: float

    def characteristic_numbers(self) -> tuple[complex, complex]:
        """Roots (slow, fast) of lambda^2 + 2 Pi lambda + nu^2: conjugate, equal or both real."""
        fast = -self.Pi - np.sqrt(complex((self.Pi - self.nu) * (self.Pi + self.nu)))
        return self.nu**2 / fast, fast


def first_difference(one: complex, two: complex, kappa: Any) -> Any:
    """(exp(one kappa) - exp(two kappa)) / (one - two), kappa exp(one kappa) where they meet."""
    half = 0.5 * (one - two) * kappa
    # neither form cancels where it is taken
    near = np.abs(half) < 0.5
    argument = np.where(near & (half != 0.0), half, 1.0)
    ratio = np.where(half == 0.0, 1.0, np.sinh(argument) / argument)
    product = kappa * np.exp(0.5 * (one + two) * kappa) * ratio
    distance = one - two if one != two else 1.0
    return np.where(near, product, (np.exp(one * kappa) - np.exp(two * kappa)) / distance)


def second_difference(points: tuple[complex, complex, complex], kappa: Any) -> Any:
    """Second divided difference of exp(lambda kappa): one over the distance of the points farthest apart."""
    orders = ((0, 1, 2), (0, 2, 1), (1, 0, 2))
    ends = max(orders, key=lambda order: abs(points[order[0]] - points[order[2]]))
    left, middle, right = (points[place] for place in ends)
    return (first_difference(left, middle, kappa) - first_difference(middle, right, kappa)) / (left - right)


def forcing(criteria: Criteria, beta: float, phase: int) -> tuple[float, complex]:
    """Forcing of the twist in a phase: steady + Re(wave exp(2 pi i kappa)), kappa from its beginning."""
    wave = complex(2.0 * criteria.Pi, TWO_PI * (1.0 - beta))
    return (-2.0, -4.0, -2.0, 0.0)[phase] * criteria.Pi, (wave, 0j, -wave, 0j)[phase]


def twist_in_phase(criteria: Criteria, beta: float, phase: int, start: tuple[float, float], time: Any) -> Any:
    """Twist and its two derivatives (e, e', e'') within a phase, shape (3, n).

    start: twist (e, e') at the beginning of the phase. time: kappa from its beginning, shape (n,).
    """
    slow, fast = criteria.characteristic_numbers()
    fading, impulse = np.exp(fast * time), first_difference(slow, fast, time)
    impulse_rate = fading + slow * impulse
    impulse_rate2 = slow * impulse_rate + fast * fading
    # free motion from the start: of a step in the angle and of one in the speed
    nu2, (e, e_rate) = criteria.nu * criteria.nu, start
    motion = [
        e * (fading - fast * impulse) + e_rate * impulse,
        e_rate * impulse_rate - e * nu2 * impulse,
        e_rate * impulse_rate2 - e * nu2 * impulse_rate,
    ]
    # motion from rest, differentiated through the forcing, y' = mu y + g with g the impulse response:
    # exact, and no stiff number multiplies a difference
    for amplitude, mu in zip(forcing(criteria, beta, phase), (0j, complex(0.0, TWO_PI)), strict=True):
        answer = second_difference((slow, fast, mu), time)
        rate = mu * answer + impulse.real
        for n, part in enumerate((answer, rate, mu * rate + impulse_rate.real)):
            motion[n] = motion[n].real + (amplitude * part).real
    return np.stack(motion)


def twist_at_starts(criteria: Criteria, kappa2: float, beta: float = 1.0) -> list[tuple[float, float]]:
    """Twist (e, e') with which phases I to IV begin; the constants C1, C2 of the paper stand for these."""
    starts = [(0.0, 0.0)]
    for phase, length in enumerate((HALF, kappa2, HALF)):
        twist, rate, _ = twist_in_phase(criteria, beta, phase, starts[-1], length)
        starts.append((float(twist), float(rate)))
    return starts


class Response(NamedTuple):
    """Motion of the driven mass as the paper's invariants; arrays of the shape of kappa.

    Attributes:
        angle: a, in units of phi_engage. velocity: a'. acceleration: a'', the invariant the paper plots.
        twist: e = a - a_k of the shaft.
    """

    angle: Any
    velocity: Any
    acceleration: Any
    twist: Any


def response(kappa: Any, criteria: Criteria, kappa2: float, beta: float = 1.0) -> Response:
    """Motion of the driven mass from rest, equation (3), continuous up to a'' from phase to phase.

    Args:
        kappa: relative time t/T, any shape; before 0 everything rests.
        criteria: nu and Pi; under-, critically and overdamped alike, resonance nu = 2 pi included.
    """
    time = np.asarray(kappa, dtype=np.float64)
    begins, number = phase_starts(kappa2), phase_of(time, kappa2)
    twist = np.zeros((3, *time.shape))
    for phase, start in enumerate(twist_at_starts(criteria, kappa2, beta)):
        chosen = (number == phase) & (time >= 0.0)
        twist[:, chosen] = twist_in_phase(criteria, beta, phase, start, time[chosen] - begins[phase])
    angle, velocity, acceleration = law_of_motion(time, kappa2) + twist
    return Response(angle, velocity, acceleration, twist[0])


def constants(criteria: Criteria, kappa2: float, beta: float = 1.0) -> list[tuple[float, float]]:
    """C1 and C2 of phases I to IV: a = exp(-Pi kappa)(C1 sin nu1 kappa + C2 cos nu1 kappa) + R.

    The motion itself needs none of them: as nu1 goes to zero C1 has no limit. Only for Pi < nu, and not at
    resonance without friction (nu = 2 pi), where R does not exist.
    """
    nu, Pi = criteria
    stiffness = complex(nu * nu - TWO_PI**2, 2.0 * TWO_PI * Pi)
    nu1 = np.sqrt((nu - Pi) * (nu + Pi))
    pairs = []
    for phase, (twist, rate) in enumerate(twist_at_starts(criteria, kappa2, beta)):
        steady, wave = forcing(criteria, beta, phase)
        answer = wave / stiffness
        C2 = twist - steady / (nu * nu) - answer.real
        pairs.append((float((rate - (TWO_PI * 1j * answer).real + Pi * C2) / nu1), float(C2)))
    return pairs


def free_oscillation(
    criteria: Criteria, kappa2: float, beta: float = 1.0, phase: int = 1
) -> tuple[float, float]:
    """Free oscillation of a'' in phase II (1) or IV (3), where a'' of the driving wheel is zero.

    Returns:
        Amplitude at the beginning of the phase, of the envelope A exp(-Pi kappa), or, where nothing
        oscillates (Pi >= nu), of a'' itself; and the largest |a''| in the phase.
    """
    length = kappa2 if phase == 1 else WATCHED
    kappa = phase_starts(kappa2)[phase] + np.linspace(0.0, length, 20001)
    swing = np.abs(response(kappa, criteria, kappa2, beta).acceleration)
    amplitude = swing[0]
    if criteria.Pi < criteria.nu:
        # differentiating exp(lambda kappa) twice multiplies its amplitude by |lambda|^2 = nu^2
        amplitude = criteria.nu**2 * np.hypot(*constants(criteria, kappa2, beta)[phase])
    return float(amplitude), float(swing.max())


# --- as printed ---


def printed(criteria: Criteria, kappa2: float, **known: Any) -> Forms:
    """Results of the page, each fed with the printed ones before it.

    Args:
        criteria: nu and Pi. kappa2: length of phase II. known: quantities in place of the printed; B is not
            defined on the page: the velocity of phase II, 2, makes a continuous; kappa and C within a phase.
    """
    return Forms(PRINTED, **{**criteria._asdict(), "kappa2": kappa2, "B": 2.0} | known)


def free_part(kappa: Any, C: tuple[Any, Any], nu1: float, Pi: float) -> tuple[Any, Any]:
    """exp(-Pi kappa)(C1 sin nu1 kappa + C2 cos nu1 kappa), the solution of (4) less R, and its derivative."""
    fading, sine, cosine = np.exp(-Pi * kappa), np.sin(nu1 * kappa), np.cos(nu1 * kappa)
    swing = C[0] * sine + C[1] * cosine
    return fading * swing, fading * (nu1 * (C[0] * cosine - C[1] * sine) - Pi * swing)


ROWS, PRINTED, EXACT = tables("stelmashchuk", globals())


def acceleration(s: Forms, kappa: Any) -> Any:
    """Invariant a'' of the driven mass with the balancer: (5) with everything printed below it, in a row.

    Args:
        s: see printed. kappa: relative time, shape (n,), >= 0.
    """
    number = phase_of(kappa, s.kappa2)
    local = kappa - phase_starts(s.kappa2)[number]
    phases = [s.replaced(kappa=local, C=s[f"C_{phase}"]) for phase in PHASES]
    free = np.choose(number, [phase.free_acceleration for phase in phases])
    return free + np.choose(number, [1.0, 0.0, -1.0, 0.0]) * phases[0].particular_acceleration


# the case of figure 2 that the text compares
REFERENCE = Criteria(nu=8.0, Pi=0.5)
RISE = np.linspace(0.0, 0.5, 3001)[:-1]
DWELL = np.linspace(0.0, KAPPA2, 3001)[:-1]
# the abbreviations of the page with the right constants, in phases I and II
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
    """Largest magnitude in each of phases I to IV, shape (4,); values over TIMES, shape (4001,)."""
    phase = phase_of(TIMES, kappa2)
    return np.array([largest(values[phase == number]) for number in range(4)])


def over_times(criteria: Criteria, beta: float = 1.0, kappa2: float = KAPPA2) -> Any:
    """Invariant a'', exact, over TIMES, shape (4001,)."""
    return response(TIMES, criteria, kappa2, beta).acceleration


def deviation(criteria: Criteria, beta: float = 1.0) -> Any:
    """Difference of a'' from the sine a_k'', over the peak 2 pi of the sine, over TIMES, shape (4001,)."""
    return (over_times(criteria, beta) - law_of_motion(TIMES, KAPPA2)[2]) / TWO_PI


def lowered(criteria: Criteria, phase: int = 1) -> Any:
    """Factors by which the balancer lowers amplitude and peak of the free oscillation."""
    without, balanced = (free_oscillation(criteria, KAPPA2, beta, phase) for beta in (0.0, 1.0))
    return np.array(without) / balanced
