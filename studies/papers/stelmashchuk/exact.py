"""Motion of the driven mass, equation (3), in closed form: every damping, dwell and balancer.

The equation is solved for the twist e = a - a_k of the shaft. What drives it is small where the shaft is
stiff, so that nothing is lost when nu is large, and with the balancer and without friction it is zero:

    e'' + 2 Pi e' + nu^2 e = -2 Pi a_k' - (1 - beta) a_k''

The textbook forms divide by nu1 = sqrt(nu^2 - Pi^2), by nu^2 and by nu0^2 + (4 pi Pi)^2: they fail or
lose digits at critical damping, for slow systems and at resonance. All of them are divided differences
of exp(lambda kappa) over the characteristic numbers and the number of the forcing, and those stay finite
when points meet. Motion from rest under the forcing exp(mu kappa) is the second divided difference over
(slow, fast, mu), the impulse response the first over (slow, fast).

kappa2: length of phase II, from 0 on; beta: gain of the balancer, 1 the paper's, 0 for none; phase: 0 to 3.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from inertia_module.loops.stepping import HALF, TWO_PI, law_of_motion, phase_of, phase_starts

# phase IV has no end: it is watched for this many units of kappa
WATCHED = 2.0


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
    begins, starts, number = (
        phase_starts(kappa2),
        twist_at_starts(criteria, kappa2, beta),
        phase_of(time, kappa2),
    )
    twist = np.zeros((3, *time.shape))
    for phase, start in enumerate(starts):
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
