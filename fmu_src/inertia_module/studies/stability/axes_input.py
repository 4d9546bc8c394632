"""Extremes of what is put in: speed, reversal, load, steps of communication, turns, tolerance."""

from __future__ import annotations

from collections.abc import Iterator

from .case import TIMESTEPPING_RUNGS, Extreme, Segment
from .mechanisms import TRAVEL, Mechanism, grazing_speed, pulse_rate, stall_torque


def signed(sizes: tuple[float, ...]) -> Iterator[float]:
    """Each size with both signs."""
    for size in sizes:
        yield size
        yield -size


SPEEDS = (1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e4, 1e5)


def input_speed(mechanism: Mechanism) -> Iterator[Extreme]:
    """The same motion, faster and slower: the load goes with the square of the speed."""
    for omega1 in signed(SPEEDS):
        load = mechanism.load * (omega1 / mechanism.omega1) ** 2
        segments = mechanism.turning(duration=min(TRAVEL / abs(omega1), 1e8), omega1=omega1, load=load)
        yield Extreme(f"{omega1:g} rad/s", mechanism.with_values(), segments, 1 if abs(omega1) < 1e-3 else 50)


def speed_under_load(mechanism: Mechanism) -> Iterator[Extreme]:
    """Speeds under the ordinary load: too slow to move it, too fast to feel it."""
    for omega1 in signed((*SPEEDS, 2e-150, 1e-200, 1e-313)):
        duration = min(TRAVEL / abs(omega1), 1e3)
        segments = mechanism.turning(duration=duration, omega1=omega1)
        yield Extreme(f"{omega1:g} rad/s", mechanism.with_values(), segments)


def reversal(mechanism: Mechanism) -> Iterator[Extreme]:
    """omega1 through zero: jumps and ramps, fast and slow."""
    speed, load = mechanism.omega1, mechanism.load
    for low in (0.0, -speed, -1e-9, -1e5):
        there = Segment(0.2, speed, load)
        back = Segment(0.2 * speed / max(speed, abs(low)), low, load)
        yield Extreme(
            f"jumps {speed:g} to {low:g} rad/s", mechanism.with_values(), (there, back, there, back)
        )
    for duration in (1e-6, 1e-3, 1.0, 100.0):
        slope = -2.0 * speed / duration
        # the module takes the slope from two points of the line, so it has to see a first one
        first = 1e-3 * duration
        segments = (
            Segment(0.1, speed, load),
            Segment(first, speed, load, whole=True),
            Segment(duration - first, speed + slope * first, load, slope),
        )
        yield Extreme(
            f"ramp through zero in {duration:g} s",
            mechanism.with_values(input_hold=1),
            segments,
            slow=duration > 10.0,
        )


def load(mechanism: Mechanism) -> Iterator[Extreme]:
    """Loads of both signs, none, and far more than the mechanism can move."""
    for torque in (0.0, *signed((1e-9, 1e-3, 1.0, 100.0, 1e3, 1e6, 1e9))):
        yield Extreme(f"{torque:g} N.m", mechanism.with_values(), mechanism.turning(load=torque))


def communication_step(mechanism: Mechanism) -> Iterator[Extreme]:
    """From a nanosecond to a quarter of an hour."""
    speed, torque = mechanism.omega1, mechanism.load
    warm = Segment(0.0123, speed, torque)
    for step in (1e-9, 1e-6, 1e-3, 1.0, 10.0, 100.0, 1e3):
        split = 1000 if step < 1e-3 else 100
        # the long run takes in one step what the short one takes in steps of this length
        duration = step * split if step < 1.0 else step
        yield Extreme(
            f"{step:g} s",
            mechanism.with_values(),
            (warm, Segment(duration, speed, torque)),
            split,
            slow=step > 10.0,
        )


def turns(mechanism: Mechanism) -> Iterator[Extreme]:
    """Counters that are far already, and link 1 turned very often past a drive that hardly turns."""
    for count in (1e6, 1e9, 1e15):
        yield Extreme(f"{count:g} turns before", mechanism.with_values(), mechanism.turning(), turns=count)
    slow = (
        {"z2": 1, "z16": 1000000}
        if mechanism.layout == "bevel"
        else {"sun_radius": 1e-6, "satellite_radius": 1.0}
    )
    duration = 2e9 * 3.141592653589793 / 1e5
    segments = (Segment(duration, 1e5, mechanism.load),)
    yield Extreme("1e+09 turns of link 1", mechanism.with_values(**slow), segments, slow=True)
    yield Extreme(
        "1e+09 turns of the drive",
        mechanism.with_values(),
        (Segment(duration, 1e5, 1e12, steps=63),),
        slow=True,
    )


def tolerance(mechanism: Mechanism) -> Iterator[Extreme]:
    """All of the allowed range."""
    for exponent in range(-1, -14, -1):
        value = float(f"1e{exponent}")
        yield Extreme(f"{value:g}", mechanism.with_values(tolerance=value), mechanism.turning())


def stall(mechanism: Mechanism) -> Iterator[Extreme]:
    """Load at the largest torque link 2 has while held, and next to it on both sides."""
    peak = stall_torque(mechanism)
    for part in (0.0, *signed((1e-15, 1e-12, 1e-9, 1e-6, 1e-3))):
        value = f"peak x (1 {'-' if part < 0.0 else '+'} {abs(part):g})"
        yield Extreme(value, mechanism.with_values(), mechanism.turning(load=peak * (1.0 + part)))


def grazing(mechanism: Mechanism) -> Iterator[Extreme]:
    """The shaft coasts at the speed link 2 only just reaches, and next to it on both sides."""
    peak = grazing_speed(mechanism)
    for part in (0.0, *signed((1e-15, 1e-12, 1e-9, 1e-6, 1e-3))):
        value = f"peak x (1 {'-' if part < 0.0 else '+'} {abs(part):g})"
        parameters = mechanism.with_values(omega_out_start=peak * (1.0 + part))
        yield Extreme(value, parameters, mechanism.turning(load=0.0))


def fixed_steps(mechanism: Mechanism) -> Iterator[Extreme]:
    """Internal steps of method timestepping, from fine to many pulses in one."""
    for phase in (0.01, 0.03, 0.1, 0.3, 1.0, 10.0, 100.0):
        parameters = mechanism.with_values(max_step=phase / pulse_rate(mechanism))
        yield Extreme(f"{phase:g} rad", parameters, mechanism.turning(), rungs=TIMESTEPPING_RUNGS)


def locked(mechanism: Mechanism) -> Iterator[Extreme]:
    """An output that cannot move."""
    heavy = {"output_inertia": 1e9, "driven_inertia": 1e9}
    yield Extreme("inertia 1e9 kg.m2", mechanism.with_values(**heavy), mechanism.turning())
    yield Extreme("load 1e9 N.m", mechanism.with_values(), mechanism.turning(load=1e9))
    yield Extreme("both", mechanism.with_values(**heavy), mechanism.turning(load=1e9))
    yield Extreme("inertia 1e9 kg.m2, no load", mechanism.with_values(**heavy), mechanism.turning(load=0.0))
