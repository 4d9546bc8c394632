"""Mean motion over the pulses: two speeds in four regimes, by the torque map (averaged.md).

    J3 omega3' = T - b3 omega3 - load
    (J1 + e - s e' / 2) omega1' + e' omega3' / 2 = M1 - b1 omega1 - T s - R          omega1 > 0

with s = omega3 / |omega1|, the mean torque T, the power R |omega1| of all other losses, and the mean kinetic
energy (J1 + e) omega1^2 / 2 of links 1 and 2. Either omega1' or M1 is prescribed. The output shaft is in one
of four regimes:

- RESTING: at rest.
- LOCKED: locked to link 1, at the speed ratio 1.
- COASTING: faster than the last ratio of the map; the output freewheel overruns.
- SLIPPING: driven by the mean torque at a ratio within the map.
"""

from ..accumulate import clear, total
from ..codes import DRIVING, FREE, HELD_DRIVING
from ..equations.losses import FREEWHEEL, VISCOUS
from ..records import Constants, Mean, Outputs, Side, State, Steady
from .torque_map import look_up, look_up_energy, look_up_pulses

RESTING, LOCKED, COASTING, SLIPPING = 0, 1, 2, 3
# Contact mode that represents each regime
MODES = (HELD_DRIVING, DRIVING, FREE, DRIVING)
# Time of the difference for the acceleration of link 2, over the speeds divided by their accelerations
DIFFERENCE_FRACTION = 1e-6
# Speed ratio while link 1 rests
MAX_RATIO = 1e30


def side_of(d: Constants, omega1: float, trend: float) -> Side:
    """Return the map for the sign of omega1; at rest for the sign of ``trend``, its rate or torque."""
    direction = omega1 if omega1 != 0.0 else trend
    return d.forward if direction >= 0.0 else d.backward


def side_now(d: Constants, x: State) -> Side:
    """Return the map for the present state."""
    return side_of(d, x.omega1, x.drive_torque if d.by_torque != 0.0 else x.alpha1)


def speed_ratio(omega3: float, speed: float) -> float:
    """Return omega3 / |omega1|, at most MAX_RATIO; 0 for an output shaft at rest."""
    if omega3 <= 0.0:
        return 0.0
    return omega3 / speed if omega3 < MAX_RATIO * speed else MAX_RATIO


def reaches_link1(side: Side) -> bool:
    """Return True if the last ratio is 1, at which link 2 turns with link 1."""
    return side.end == 1.0 and side.direction > 0.0


def free_torque(d: Constants, side: Side, torque: float) -> float:
    """Return the torque on an output shaft that overruns, at the last ratio of the map, N m.

    Args:
        d: Constants.
        side: Map for the sign of omega1.
        torque: Mean torque at the last ratio, N m.
    """
    return 0.0 - d.output_drag if reaches_link1(side) else min(torque, 0.0)


def write_locked_losses(d: Constants, speed: float, steady: Steady) -> None:
    """Write the losses while link 2 turns with link 1: its friction and the drag of the housing freewheel.

    Args:
        d: Constants.
        speed: Magnitude of omega1, rad/s.
        steady: Record that is written (fields.STEADY).
    """
    clear(steady.lost)
    steady.lost[VISCOUS] = d.b2 * speed
    steady.lost[FREEWHEEL] = d.housing_drag + d.housing_drag_viscous * speed
    steady.resistance = total(steady.lost)
    steady.omega2 = speed


def write_steady(d: Constants, side: Side, regime: int, speed: float, s: float) -> None:
    """Write the steady means of a regime at an input speed and a speed ratio into d.steady.

    Args:
        d: Constants.
        side: Map for the sign of omega1.
        regime: RESTING, LOCKED, COASTING or SLIPPING.
        speed: Magnitude of omega1, rad/s.
        s: omega3 / |omega1|.
    """
    at_end = regime == LOCKED or regime == COASTING
    look_up(d, side, speed, side.end if at_end else s, d.steady)
    if at_end and reaches_link1(side):
        write_locked_losses(d, speed, d.steady)
    if regime != SLIPPING:
        d.steady.slope = 0.0


def write_mean_rates(
    d: Constants, side: Side, x: State, regime: int, omega1: float, omega3: float, m: Mean
) -> None:
    """Write rates and torques of the mean motion in a regime.

    Args:
        d: Constants; d.steady is written.
        side: Map for the sign of omega1.
        x: State with the inputs and a prescribed acceleration alpha1.
        regime: RESTING, LOCKED, COASTING or SLIPPING.
        omega1: Input speed, rad/s. A trial step may have reversed it.
        omega3: Speed of the output shaft, rad/s. A trial step may have reversed it.
        m: Record that is written (fields.MEAN).
    """
    direction, steady = side.direction, d.steady
    forward = direction * omega1
    speed = max(forward, 0.0)
    x.step_evaluations += 1.0
    if regime == RESTING:
        omega3 = 0.0
    elif regime == LOCKED:
        omega3 = forward
    s = speed_ratio(omega3, speed)
    write_steady(d, side, regime, speed, s)
    s = min(s, side.end)
    load = x.load_torque + d.b3 * omega3
    torque, transmitted, locked_inertia = steady.torque, steady.torque * s, 0.0
    if regime == RESTING:
        torque, transmitted = load, 0.0
    elif regime == LOCKED:
        transmitted, locked_inertia = load, d.J3
    elif regime == COASTING:
        torque = free_torque(d, side, torque) - d.output_drag_viscous * (omega3 - side.end * forward)
        transmitted = torque * side.end
    rate3 = (torque - load) / d.J3
    inertia, slope = d.J1 + steady.inertia - 0.5 * s * steady.slope, 0.5 * steady.slope
    rate = direction * x.alpha1
    if d.by_torque != 0.0:
        driving = direction * x.drive_torque - d.b1 * forward
        rate = (driving - transmitted - steady.resistance - slope * rate3) / (inertia + locked_inertia)
        if omega1 == 0.0:
            rate = max(rate, 0.0)  # Friction holds link 1 at rest
    if regime == LOCKED:
        rate3 = rate
        torque = transmitted = load + d.J3 * rate3
    consumed = 0.0 if speed == 0.0 and rate == 0.0 else transmitted + steady.resistance
    m.omega1, m.omega3 = direction * rate, rate3
    m.theta1, m.theta2, m.theta3 = omega1, steady.omega2, omega3
    m.drive = x.drive_torque
    if d.by_torque == 0.0:
        m.drive = direction * (inertia * rate + slope * rate3 + consumed + d.b1 * forward)
    m.mesh, m.output = direction * consumed, torque
    for cause in range(len(m.lost)):
        m.lost[cause] = steady.lost[cause] * speed
    m.lost[VISCOUS] += d.b3 * omega3 * omega3 + d.b1 * forward * forward
    if regime == COASTING:
        m.lost[FREEWHEEL] -= torque * (omega3 - side.end * forward)


def max_locked_torque(d: Constants, side: Side, x: State, speed: float) -> float:
    """Return the maximum torque that a shaft locked to link 1 can transmit, N m.

    It is the lock-up torque of the ideal mechanism minus the resistance of link 2, and at least the mean
    torque at ratio 1.

    Args:
        d: Constants; d.steady is written.
        side: Map for the sign of omega1.
        x: State.
        speed: Magnitude of omega1, rad/s.
    """
    x.step_evaluations += 1.0
    look_up(d, side, speed, side.end, d.steady)
    if side.locks == 0.0:
        return d.steady.torque
    lock_torque = d.map_lock * speed * speed - d.housing_drag - (d.b2 + d.housing_drag_viscous) * speed
    return max(lock_torque, d.steady.torque)


def torque_at_rest(d: Constants, side: Side, x: State, speed: float) -> float:
    """Return the mean torque on a resting output shaft minus its load, N m. The shaft rests up to 0.

    Args:
        d: Constants; d.steady is written.
        side: Map for the sign of omega1.
        x: State.
        speed: Magnitude of omega1, rad/s.
    """
    x.step_evaluations += 1.0
    look_up(d, side, speed, 0.0, d.steady)
    torque = d.steady.torque
    if x.omega1 == 0.0 and (x.drive_torque if d.by_torque != 0.0 else x.alpha1) == 0.0:
        # Link 1 remains at rest, so a shaft that begins to turn overruns
        look_up(d, side, speed, side.end, d.steady)
        torque = min(torque, free_torque(d, side, d.steady.torque))
    return torque - x.load_torque


def regime_indicator(d: Constants, side: Side, x: State, regime: int, omega1: float, omega3: float) -> float:
    """Return the event indicator of a regime, which is positive after the end of the regime.

    Args:
        d: Constants; d.steady and d.mean are written.
        side: Map for the sign of omega1.
        x: State.
        regime: RESTING, LOCKED, COASTING or SLIPPING.
        omega1: Input speed, rad/s.
        omega3: Speed of the output shaft, rad/s.
    """
    speed = side.direction * omega1
    # Torque-driven, the regime also ends when link 1 comes to rest
    stopped = -speed if d.by_torque != 0.0 and x.omega1 != 0.0 else -1e300
    if regime == SLIPPING:
        return max(stopped, omega3 - side.end * speed, -omega3)
    if regime == COASTING:
        return max(stopped, side.end * speed - omega3)
    if regime == RESTING:
        return max(stopped, torque_at_rest(d, side, x, max(speed, 0.0)))
    write_mean_rates(d, side, x, LOCKED, omega1, omega3, d.mean)
    torque = d.mean.output
    excess = torque - max_locked_torque(d, side, x, speed)
    return max(stopped, excess, -torque - d.output_drag)


def can_lock(side: Side, x: State) -> bool:
    """Return True if the output shaft turns with link 1 and may be locked to it."""
    return reaches_link1(side) and x.omega1 > 0.0 and x.omega3 == x.omega1


def choose_regime(d: Constants, side: Side, x: State) -> int:
    """Return the regime by the speeds, and at the limit between two regimes by torques and accelerations.

    Args:
        d: Constants; d.steady and d.mean are written.
        side: Map for the sign of omega1.
        x: State.
    """
    speed = abs(x.omega1)
    gap = x.omega3 - side.end * speed
    if x.omega3 == 0.0:
        driving = torque_at_rest(d, side, x, speed)
        if driving == 0.0:
            write_mean_rates(d, side, x, RESTING, x.omega1, 0.0, d.mean)
            driving = side.direction * d.mean.omega1
        if driving <= 0.0 or (gap >= 0.0 and speed > 0.0):
            return RESTING
    if can_lock(side, x) and regime_indicator(d, side, x, LOCKED, x.omega1, x.omega3) <= 0.0:
        return LOCKED
    if gap == 0.0:
        write_mean_rates(d, side, x, COASTING, x.omega1, x.omega3, d.mean)
        gap = d.mean.omega3 - side.end * side.direction * d.mean.omega1
        return COASTING if gap >= 0.0 else SLIPPING
    return COASTING if gap > 0.0 else SLIPPING


def set_regime(d: Constants, side: Side, x: State) -> int:
    """Choose the regime, write its contact mode and count a change of the contact mode."""
    regime = choose_regime(d, side, x)
    mode = MODES[regime]
    if mode != x.mode:
        x.mode = mode
        x.switches += 1.0
    return regime


def energy_of_mechanism(d: Constants, side: Side, x: State, omega1: float, omega3: float) -> float:
    """Return the mean kinetic energy of links 1 and 2 and the imbalances, J.

    Args:
        d: Constants; d.steady is written.
        side: Map for the sign of omega1.
        x: State.
        omega1: Input speed, rad/s.
        omega3: Speed of the output shaft, rad/s.
    """
    speed = abs(omega1)
    look_up_energy(side, speed_ratio(omega3, speed), d.steady)
    return 0.5 * speed * speed * (d.J1 + d.steady.inertia)


def averaged_energy(d: Constants, x: State) -> float:
    """Return the mean kinetic energy of the mechanism and the output shaft, J."""
    links = energy_of_mechanism(d, side_now(d, x), x, x.omega1, x.omega3)
    return links + 0.5 * d.J3 * x.omega3 * x.omega3


def takes_up_jump(d: Constants, x: State, jump: float, h: float) -> bool:
    """Return True if a shaft locked to link 1 can follow a jump of omega1 as a ramp over the step h, s."""
    if not (can_lock(d.forward, x) and min(x.omega1, x.omega1 + x.alpha1 * h + jump) > 0.0):
        return False
    before = x.alpha1
    locked = regime_indicator(d, d.forward, x, LOCKED, x.omega1, x.omega3) <= 0.0
    x.alpha1 = before + jump / h
    locked = locked and regime_indicator(d, d.forward, x, LOCKED, x.omega1 + x.alpha1 * h, x.omega3) <= 0.0
    x.alpha1 = before
    return locked


def jump_averaged(d: Constants, x: State, jump: float) -> float:
    """Apply a jump of omega1. The output shaft keeps its speed, and the mean energy of the mechanism changes.

    Args:
        d: Constants.
        x: State.
        jump: Change of omega1, rad/s.

    Returns:
        Impulse of the input torque, N m s: change of energy over mean speed, for each sign of omega1.
    """
    start, end = x.omega1, x.omega1 + jump
    before = energy_of_mechanism(d, side_of(d, start, jump), x, start, x.omega3)
    after = energy_of_mechanism(d, side_of(d, end, -jump), x, end, x.omega3)
    x.energy_in += after - before
    x.omega1 = end
    if start * end > 0.0:
        return 2.0 * (after - before) / (start + end)
    impulse = 2.0 * after / end if end != 0.0 else 0.0
    return impulse - (2.0 * before / start if start != 0.0 else 0.0)


def update_end(d: Constants, x: State) -> None:
    """Write the mean speed of link 2, and torque-driven the acceleration of link 1, at the end of a step."""
    side = side_now(d, x)
    regime = set_regime(d, side, x)
    write_mean_rates(d, side, x, regime, x.omega1, x.omega3, d.mean)
    x.omega2 = d.mean.theta2
    if d.by_torque != 0.0:
        x.alpha1 = d.mean.omega1


def write_averaged(d: Constants, x: State, y: Outputs) -> float:
    """Write mean torques, ripple and peak at the present speeds.

    The mesh transmits a part of the mean output torque, and the housing supports the remainder.

    Returns:
        Mean acceleration of link 2, rad/s^2.
    """
    side, m = side_now(d, x), d.mean
    regime = set_regime(d, side, x)
    write_mean_rates(d, side, x, regime, x.omega1, x.omega3, m)
    x.omega2 = m.theta2
    y.input_torque = m.drive
    y.mesh_torque = m.mesh
    y.output_torque = m.output
    y.output_acceleration = m.omega3
    y.housing_torque = m.output + d.b2 * x.omega2 - m.mesh
    y.torque_ripple, y.torque_peak = 0.0, abs(m.output)
    if regime == COASTING or regime == SLIPPING:
        speed = abs(x.omega1)
        y.torque_ripple, y.torque_peak = look_up_pulses(side, speed, speed_ratio(x.omega3, speed))
    rate1, rate3 = m.omega1, m.omega3
    if rate1 == 0.0 and rate3 == 0.0:
        return 0.0
    speeds = abs(x.omega1) + x.omega3
    time = DIFFERENCE_FRACTION * (speeds / (abs(rate1) + abs(rate3)) if speeds > 0.0 else 1.0)
    write_mean_rates(d, side, x, regime, x.omega1 + rate1 * time, x.omega3 + rate3 * time, m)
    return (m.theta2 - x.omega2) / time
