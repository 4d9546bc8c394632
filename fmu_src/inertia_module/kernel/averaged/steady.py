"""Steady motion with the output speed held, over a true period of the drive, by the general equations of
motion.

All goes with a speed v that is 1 here: that of link 1, or under its torque that of the energy of links 1, 2
and imbalances, map_inertia v^2 / 2 in the mean. What loads lose is the same at every speed; friction and drag
are those of an input speed, scaled: b / |v| and drag / v^2.
"""

import math

from ..accumulate import TWO_PI, clear, copy
from ..equations.choice import choose_next_states, choose_states
from ..equations.states import CLOSING
from ..events.advance import advance_general
from ..events.step_size import AFRESH
from ..inertia import reduced_inertia
from ..inputs import begin_sums
from ..links import inertia_of_link1, kinetic_energy

# inertia that holds the output speed, over that of the mechanism
HEAVY = 1e30
# share of the map's error that a step of it may have
TOLERANCE = 1e-3
# periods until it comes back to where it was: the mean torque that turns link 2 meanwhile, over the largest
# of the mesh, or how near it is known, rad/s
PERIODS = 60
BACK = 1e-6
NEAR = 1e-5
# ... and until the input torque keeps the energy, by this share of it; and the mean of v^2 is 1 by twice that
ROUNDS = 24
KEPT = 5e-5
# ... or so nearly, where link 2 begins at one speed or another, but not in between
NEARLY = 2e-2
# ... found by moves so many times what is missing, at most
LARGEST_MOVE = 4.0
LEAST_ENERGY = 1e-3
LEAST_FADING = 1e-3
# ... after one to the right energy and torque at once, where more is missing of it or gained than this
FAR = 0.5
SPENT = 0.1
# ... where omega2 comes back by this, over v
OTHERWISE = 1e-2
# internal steps before a period is given up, evaluations before one sign of omega1 is, and the share of a
# period that is as good as its end
MOST_STEPS = 200000
MOST_EVALUATIONS = 3e7
END = 1e-9
NO_LIMIT = 1e9
# slip below this fraction of the speeds: the drive comes to rest in link 1
AT_REST = 1e-9
# phase of the highest harmonic, at the speed of link 1, in the first step after an event
FIRST_PHASE = 1.0
# the motion begins so much phase of the highest harmonic before link 2 is thrown hardest
HEAD_START = 0.5
# steps in a row after each of which the drive has not come further, until it does not come to the end
MOST_IDLE = 1000
# what is looked for the largest of: torque of lock-up, momentum of link 2 at rest; thrown from there its
# speed, and how near it comes to that of link 1
LOCK, MOMENTUM, THROWN, NEAREST = 0, 1, 2, 3
# ... looks in one cycle of the highest harmonic, and parabolas that each are so much narrower
LOOKS_PER_CYCLE = 12.0
REFINED = 6
NEARER = 0.2
# cycles of the highest harmonic that one mean is taken over at most; beyond them at least so many parts,
# spread evenly over the relative phase of drive and satellite, each after another that is not counted
LARGEST_CYCLES = 800.0
PARTS = 16
# ... share of them over which a motion is taken
COUNTED = 0.25


def hold_output(d, w, error):
    """Set the constants of the mechanism d behind an output that nothing moves.

    Args:
        w: workspace; constants and tolerance are written. error: that the map may have, in stall torques.
    """
    held = w.held
    copy(held.numbers, d.numbers)
    held.J3 = HEAVY * (d.J2 + d.F_by_alpha1)
    w.tolerance = TOLERANCE * error
    held.max_step = NO_LIMIT
    held.b3 = 0.0


def set_losses(p, d, slowness):
    """Set the friction and drag that links of speed 1 have for the input speed 1 / slowness, into d = w.held.

    Friction of link 1 is known as it is where its speed is given.
    """
    square = slowness * slowness
    d.b1 = slowness * p.input_friction if d.by_torque != 0.0 else 0.0
    d.bq = slowness * p.drive_friction
    d.b2 = slowness * p.link2_friction
    d.housing_drag_viscous = slowness * p.housing_drag_viscous
    d.output_drag_viscous = slowness * p.output_drag_viscous
    d.housing_drag = square * p.housing_drag
    d.output_drag = square * p.output_drag


def period_of_map(d):
    """Angle of the drive in which everything comes back, rad."""
    # with three or more satellites the drive's own turn leaves nothing in the reduced inertia
    return TWO_PI / d.s if d.satellites > 2.0 and d.planar == 0.0 else d.period


def parts_of_period(d, cycles):
    """Length, rad, and number of the parts that stand for a period: one, unless it is long.

    The satellite meets the drive at every relative phase, evenly, so turns of the drive at evenly
    spread phases are as good as all turns of the period. Where a turn itself is long, parts of it.

    Args:
        cycles: of the highest harmonic in the parts of a long period together.
    """
    if period_of_map(d) * d.harmonic <= TWO_PI * LARGEST_CYCLES:
        return period_of_map(d), 1
    part = min(TWO_PI, cycles / PARTS * TWO_PI / d.harmonic)
    return part, int(cycles * TWO_PI / (d.harmonic * part))


def go_to_part(d, phase, part, parts, n):
    """Set the relative phase of part n. Returns the drive angle where it begins."""
    d.phase_b = phase + n * (TWO_PI / parts)
    return n * (TWO_PI / parts) if part < TWO_PI else 0.0


def momentum(d, direction, q):
    """Energy or momentum of links 1 and 2, link 2 at rest, that only what holds it raises, at the speed v."""
    i, _, b, _, g, _ = reduced_inertia(d, q)
    if d.by_torque == 0.0:
        return direction * (i - d.k * d.k * g)
    # at constant energy
    return direction * (d.J1 + i + d.k * b) / math.sqrt(inertia_of_link1(d, i, b, g))


def thrown(d, side, q):
    """Motion without losses and load of a link 2 thrown from rest, its momentum being side.thrown.

    Returns:
        (omega2, square of the slip, below 0 where it is not that slow), at the speed v.
    """
    i, _, b, _, g, _ = reduced_inertia(d, q)
    k = d.k
    if d.by_torque == 0.0:
        # Jacobi's integral
        square = (d.J2 + i - side.direction * side.thrown) / (d.J2 + k * k * g)
        return side.direction * (1.0 - math.sqrt(max(square, 0.0))), square
    whole = d.J1 + i + d.J2
    coupling = k * b - d.J2
    angular = side.thrown * math.sqrt(d.map_inertia)
    square = whole * d.map_inertia - angular * angular
    square /= whole * (k * k * g + d.J2) - coupling * coupling
    slip = side.direction * math.sqrt(max(square, 0.0))
    return (angular - coupling * slip) / whole - slip, square


def quantity(d, side, which, q):
    """Quantity that is looked at over a period: LOCK, MOMENTUM, THROWN or NEAREST."""
    if which == LOCK:
        return -reduced_inertia(d, q)[1]
    if which == MOMENTUM:
        return momentum(d, side.direction, q)
    omega2, square = thrown(d, side, q)
    return omega2 if which == THROWN else -square


def find_largest(d, side, which):
    """Drive angle, rad, at which a quantity is largest in the whole period or its parts, and how large."""
    part, parts = parts_of_period(d, LARGEST_CYCLES)
    phase = d.phase_b
    looks = int(math.ceil(part * d.harmonic / TWO_PI * LOOKS_PER_CYCLE)) + 2
    width = part / looks
    best = -1e300
    best_q = best_phase = 0.0
    for n in range(parts):
        begin = go_to_part(d, phase, part, parts, n)
        before = quantity(d, side, which, begin - width)
        here = quantity(d, side, which, begin)
        for look in range(looks):
            after = quantity(d, side, which, begin + (look + 1) * width)
            if before <= here >= after:
                curve = before - 2.0 * here + after
                top = here - ((after - before) * (after - before) / (8.0 * curve) if curve < 0.0 else 0.0)
                if top > best:
                    best, best_q, best_phase = top, begin + look * width, d.phase_b
            before = here
            here = after
    d.phase_b = best_phase
    for _ in range(REFINED):
        before = quantity(d, side, which, best_q - width)
        after = quantity(d, side, which, best_q + width)
        curve = before - 2.0 * quantity(d, side, which, best_q) + after
        if curve < 0.0:
            # top of the parabola through the three
            best_q += max(-width, min(width, 0.5 * width * (before - after) / curve))
        width *= NEARER
    best = quantity(d, side, which, best_q)
    d.phase_b = phase
    return best_q, best


def angle_travelled(x, direction):
    """Angle of the drive since the sums were begun, rad, in its direction."""
    return direction * (x.q - x.begin_q + TWO_PI * (x.drive_turns - x.begin_drive_turns))


def follow(d, x, w, length):
    """Follow the motion in x over so much angle of the drive.

    Returns:
        (the time it takes, or -1, integral of the energy of links 1, 2 and imbalances over it).
    """
    direction = math.copysign(1.0, x.omega1 - x.omega2)
    time = energy = 0.0
    left = least = length
    limit = NO_LIMIT
    idle = 0
    for _ in range(MOST_STEPS):
        copy(w.kept.numbers, x.numbers)
        passed, event = advance_general(d, x, w, limit)
        if passed < 0.0:
            return -1.0, 0.0
        rest = length - angle_travelled(x, direction)
        slip = direction * (x.omega1 - x.omega2)
        if rest < -END * length:
            # back, and no further than at the present speed: exact where link 2 is held or drives
            copy(x.numbers, w.kept.numbers)
            x.rates_cached = 0.0
            limit = min(0.5 * limit, left / (d.k * abs(x.omega1 - x.omega2)))
            continue
        # in its play link 2 may be as fast as link 1 or faster for a while: the drive rests, or turns back;
        # or they stick together until link 2 meets the output or the housing
        still = AT_REST * (abs(x.omega1) + abs(x.omega2))
        stays = event or slip < -still or min(x.housing_state, x.output_state) == CLOSING
        waits = d.plays != 0.0 and idle < MOST_IDLE and stays
        if not slip > still and not waits:
            return -1.0, 0.0
        idle = idle + 1 if rest > least else 0
        least = min(least, rest)
        if event:
            choose_next_states(d, x)
            # what was locked for long moves at once now: the size of its last steps, long ago, says nothing
            x.sized_mode = x.mode
            x.step_size = min(AFRESH * x.step_size, FIRST_PHASE / (d.harmonic * d.k))
        time += passed
        energy += w.change.turned3
        left = rest
        if left <= END * length:
            return time, energy
        if limit < NO_LIMIT:
            limit = left / (d.k * abs(slip))
    return -1.0, 0.0


def speed_of_energy(d, x, direction, energy):
    """Speed of link 1 with which links 1, 2 and imbalances have this energy."""
    i, _, b, _, g, _ = reduced_inertia(d, x.q)
    phi = inertia_of_link1(d, i, b, g)
    coupled = direction * d.k * (b + d.k * g) * x.omega2
    left = 2.0 * energy - (d.J2 + d.k * d.k * g) * x.omega2 * x.omega2
    return direction * (coupled + math.sqrt(max(coupled * coupled + phi * left, 0.0))) / phi


def add_part(d, x, w, side, q, length, before):
    """Add the motion over an angle of the drive to the sums in w; it begins at q with x.omega2 and x.omega3.

    Args:
        before: whether another part goes before, not counted.

    Returns:
        Whether it comes to its end: the drive does not come to rest in link 1.
    """
    omega2, omega3 = x.omega2, x.omega3
    play_housing, play_output = x.play_housing, x.play_output
    clear(x.numbers)
    x.play_housing, x.play_output = play_housing, play_output
    x.q = q % d.period
    x.omega1 = side.direction
    x.omega2, x.omega3 = omega2, omega3
    if d.by_torque != 0.0:
        x.omega1 = speed_of_energy(d, x, side.direction, 0.5 * w.begin_energy * d.map_inertia)
        x.drive_torque = w.drive
    w.prescribed = x.drive_torque
    choose_states(d, x, 0.0)
    time = energy = start = 0.0
    for _ in range(2 if before else 1):
        begin_sums(x)
        clear(x.lost)
        clear(x.lost_low)
        start = kinetic_energy(d, x.q, x.omega1, x.omega2, 0.0)
        time, energy = follow(d, x, w, length)
        d.map_evaluations += x.step_evaluations
        if time < 0.0:
            return False
    turned = side.direction * time
    if d.by_torque != 0.0:
        turned = x.theta1 - x.begin_theta1 + TWO_PI * (x.input_turns - x.begin_input_turns)
    w.sum_time += time
    w.sum_torque += x.output_impulse
    w.sum_square += x.output_square
    w.sum_energy += energy
    w.sum_gain += kinetic_energy(d, x.q, x.omega1, x.omega2, 0.0) - start
    w.sum_omega1 += turned
    w.sum_omega2 += turned - side.direction * angle_travelled(x, side.direction) / d.k
    w.sum_peak = max(w.sum_peak, x.torque_peak)
    for cause in range(len(x.lost)):
        w.sum_lost[cause] += x.lost[cause]
    return True


def add_period(d, x, w, side, ratio, begin):
    """Set the sums in w to those over a period, or the parts that stand for it, in which omega2 begins so.

    Returns:
        Whether the motion comes there; x is at its end.
    """
    w.sum_time = w.sum_torque = w.sum_square = w.sum_energy = w.sum_gain = 0.0
    w.sum_omega1 = w.sum_omega2 = w.sum_peak = 0.0
    clear(w.sum_lost)
    x.omega2 = begin
    x.omega3 = ratio
    part, parts = parts_of_period(d, COUNTED * LARGEST_CYCLES)
    phase = d.phase_b
    through = True
    for n in range(parts):
        q = go_to_part(d, phase, part, parts, n) if parts > 1 else side.start
        through = through and add_part(d, x, w, side, q, part, parts > 1)
    d.phase_b = phase
    return through


def find_steady(p, w, side, ratio, slowness):
    """Set the sums in w to those of the steady motion: omega2 is at the end of a period what it began with.

    What it ends with never falls with what it begins with, and between 0 and the speed of the output there is
    such a motion. If link 2 comes to rest in it, a motion from rest becomes it; if it drives, one that begins
    with the speed of the output does. Under the torque of link 1 this torque and the energy at the beginning
    are found as well, w.drive and w.begin_energy over that of v = 1: so that the energy is kept, and v is 1.

    Args:
        w: workspace; w.held has the constants (see hold_output), w.part is the state that is followed.
        ratio: of the speeds. slowness: friction and drag are as at the speed 1 / slowness.

    Returns:
        Whether it is found.
    """
    d, x = w.held, w.part
    set_losses(p, d, slowness)
    w.load = 0.0
    low = gain = loss = 0.0
    begin = min(w.begin_omega2, ratio) if d.by_torque != 0.0 else 0.0
    high = ratio
    inertia = d.J2 + d.F_by_alpha1
    tried = 0
    rounds = 0
    # Broyden's method: what is gained and missed of the energy of v = 1, by the work of the torque and by the
    # energy at the beginning
    gain_by_work = gain_by_energy = energy_by_work = energy_by_energy = 0.0
    work = energy = fading = 0.0
    # link 2 rests, the output overruns
    x.play_housing = 0.0
    x.play_output = d.output_engagement_angle
    for _ in range(PERIODS):
        if d.map_evaluations > MOST_EVALUATIONS or not add_period(d, x, w, side, ratio, begin):
            return False
        # (within its play it may be faster than the output for a moment)
        w.begin_omega2 = min(x.omega2, ratio)
        change = w.begin_omega2 - begin
        if d.by_torque != 0.0:
            gained = 2.0 * w.sum_gain / d.map_inertia
            speed = speed_of_sums(d, w)
            missed = speed * speed - 1.0
            if abs(gained) > KEPT or abs(missed) > 2.0 * KEPT:
                rounds += 1
                if rounds > ROUNDS:
                    return abs(gained) + abs(missed) < NEARLY
                begin = w.begin_omega2
                if abs(missed) > FAR or abs(gained) > SPENT:
                    # the torque that was needed, and the energy it came to; torques and losses by load go
                    # with the energy: another speed of the same motion
                    w.drive = (w.drive - w.sum_gain / w.sum_omega1) / (1.0 + missed)
                    w.begin_energy = max((w.begin_energy + gained) / (1.0 + missed), LEAST_ENERGY)
                    work = energy = 0.0
                    continue
                moved = work * work + energy * energy
                if fading == 0.0:
                    # energy fades at the rate of the power that keeps it
                    fading = LEAST_FADING + 2.0 * abs(w.drive * w.sum_omega1) / d.map_inertia
                    gain_by_work = energy_by_energy = -math.expm1(-fading) / fading
                    gain_by_energy = math.expm1(-fading)
                    energy_by_work = (1.0 - gain_by_work) / fading
                if abs(change) > OTHERWISE:
                    # link 2 moves otherwise than was thought: what was found says little
                    work = energy = 0.0
                    continue
                if moved > 0.0:
                    gain_by_work += gained * work / moved
                    gain_by_energy += gained * energy / moved
                    energy_by_work += missed * work / moved
                    energy_by_energy += missed * energy / moved
                determinant = gain_by_work * energy_by_energy - gain_by_energy * energy_by_work
                work = (gain_by_energy * missed - energy_by_energy * gained) / determinant
                energy = (energy_by_work * gained - gain_by_work * missed) / determinant
                most = LARGEST_MOVE * (1.0 + fading) * (abs(gained) + abs(missed))
                if abs(work) + abs(energy) > most:
                    part = most / (abs(work) + abs(energy))
                    work *= part
                    energy *= part
                w.drive += 0.5 * work * d.map_inertia / w.sum_omega1
                w.begin_energy = max(w.begin_energy + energy, LEAST_ENERGY)
                continue
            work = energy = 0.0
        if abs(change) * inertia <= BACK * d.F_by_speed * w.sum_time or high - low <= NEAR:
            return True
        if change > 0.0:
            low = begin
            gain = change
        else:
            high = begin
            loss = change
        if tried == 1:
            begin = ratio
        elif tried < 3:
            begin = w.begin_omega2
        else:
            share = gain / (gain - loss) if tried % 2 == 1 else 0.5
            begin = low + share * (high - low)
        tried += 1
    return False


def speed_of_sums(d, w):
    """The speed v of the motion in the sums."""
    if d.by_torque == 0.0:
        return 1.0
    return math.sqrt(2.0 * w.sum_energy / (w.sum_time * d.map_inertia))
