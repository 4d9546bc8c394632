"""The axes of the map: each makes the extremes of one mechanism. Their docstrings are printed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from .case import ELASTIC_LEVELS, TIMESTEPPING_LEVELS, Case, Segment
from .loss_axes import ELASTIC_OUTPUT, LOSS_AXES, Extremes
from .mechanisms import MECHANISMS, TRAVEL, Mechanism, grazing_speed, imbalance_inertia, largest_held_torque

SPEEDS = (1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e4, 1e5)
RATIOS = (1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9)
# distances from a critical value, relative
NEAR = (1e-15, 1e-12, 1e-9, 1e-6, 1e-3)
INERTIAS = {"J1": "input_inertia", "J2": "link2_inertia", "J3": "output_inertia", "J16": "drive_inertia"}


def signed(sizes: tuple[float, ...]) -> Iterator[float]:
    """Each size with both signs."""
    for size in sizes:
        yield size
        yield -size


def around_peak() -> Iterator[tuple[str, float]]:
    """A critical value and its neighbours on both sides: how each is called, and its factor."""
    for part in (0.0, *signed(NEAR)):
        yield f"peak x (1 {'-' if part < 0.0 else '+'} {abs(part):g})", 1.0 + part


# --- inputs and numerical settings ---


def input_speed(mechanism: Mechanism) -> Extremes:
    """The same motion, faster and slower: the load goes with the square of the speed."""
    for omega1 in signed(SPEEDS):
        load = mechanism.load * (omega1 / mechanism.omega1) ** 2
        time = min(TRAVEL / abs(omega1), 1e8)
        split = 1 if abs(omega1) < 1e-3 else 50
        yield mechanism.extreme(f"{omega1:g} rad/s", omega1=omega1, load=load, duration=time, split=split)


def input_speed_under_load(mechanism: Mechanism) -> Extremes:
    """Speeds under the ordinary load: too slow to move it, too fast to feel it."""
    for omega1 in signed((*SPEEDS, 2e-150, 1e-200, 1e-313)):
        time = min(TRAVEL / abs(omega1), 1e3)
        yield mechanism.extreme(f"{omega1:g} rad/s", omega1=omega1, duration=time)


def reversal(mechanism: Mechanism) -> Extremes:
    """omega1 through zero: jumps and ramps, fast and slow."""
    speed, load = mechanism.omega1, mechanism.load
    for low in (0.0, -speed, -1e-9, -1e5):
        there = Segment(0.2, speed, load)
        back = Segment(0.2 * speed / max(speed, abs(low)), low, load)
        yield mechanism.extreme(f"jumps {speed:g} to {low:g} rad/s", None, there, back, there, back)
    for duration in (1e-6, 1e-3, 1.0, 100.0):
        slope = -2.0 * speed / duration
        # the module takes the slope from two points of the line, so it has to see a first one
        first = 1e-3 * duration
        yield mechanism.extreme(
            f"ramp through zero in {duration:g} s",
            {"input_hold": 1},
            Segment(0.1, speed, load),
            Segment(first, speed, load, whole=True),
            Segment(duration - first, speed + slope * first, load, slope),
            slow=duration > 10.0,
        )


def load(mechanism: Mechanism) -> Extremes:
    """Loads of both signs, none, and far more than the mechanism can move."""
    for torque in (0.0, *signed((1e-9, 1e-3, 1.0, 100.0, 1e3, 1e6, 1e9))):
        yield mechanism.extreme(f"{torque:g} N.m", load=torque)


def stall_torque(mechanism: Mechanism) -> Extremes:
    """Load at the largest torque link 2 has while held, and next to it on both sides."""
    for value, factor in around_peak():
        yield mechanism.extreme(value, load=factor * largest_held_torque(mechanism))


def grazing(mechanism: Mechanism) -> Extremes:
    """The shaft coasts at the speed link 2 only just reaches, and next to it on both sides."""
    for value, factor in around_peak():
        yield mechanism.extreme(value, {"omega_out_start": factor * grazing_speed(mechanism)}, load=0.0)


def output_locked(mechanism: Mechanism) -> Extremes:
    """An output that cannot move."""
    heavy = {"output_inertia": 1e9, "driven_inertia": 1e9}
    yield mechanism.extreme("inertia 1e9 kg.m2", heavy)
    yield mechanism.extreme("load 1e9 N.m", load=1e9)
    yield mechanism.extreme("both", heavy, load=1e9)
    yield mechanism.extreme("inertia 1e9 kg.m2, no load", heavy, load=0.0)


def communication_step(mechanism: Mechanism) -> Extremes:
    """From a nanosecond to a quarter of an hour."""
    speed, torque = mechanism.omega1, mechanism.load
    warm = Segment(0.0123, speed, torque)
    for step in (1e-9, 1e-6, 1e-3, 1.0, 10.0, 100.0, 1e3):
        split = 1000 if step < 1e-3 else 100
        # the long run takes in one step what the short one takes in steps of this length
        whole = Segment(step * split if step < 1.0 else step, speed, torque)
        yield mechanism.extreme(f"{step:g} s", None, warm, whole, split=split, slow=step > 10.0)


def fixed_step(mechanism: Mechanism) -> Extremes:
    """Internal steps of method timestepping, from fine to many pulses in one."""
    d = mechanism.derived
    rate = float(d.harmonic * d.k) * mechanism.omega1
    for phase in (0.01, 0.03, 0.1, 0.3, 1.0, 10.0, 100.0):
        yield mechanism.extreme(f"{phase:g} rad", {"max_step": phase / rate}, levels=TIMESTEPPING_LEVELS)


def turns(mechanism: Mechanism) -> Extremes:
    """Counters that are far already, and link 1 turned very often past a drive that hardly turns."""
    for count in (1e6, 1e9, 1e15):
        yield mechanism.extreme(f"{count:g} turns before", turns=count)
    slow = (
        {"z2": 1, "z16": 1000000}
        if mechanism.layout == "bevel"
        else {"sun_radius": 1e-6, "satellite_radius": 1.0}
    )
    duration = 2e9 * math.pi / 1e5
    moved, held = Segment(duration, 1e5, mechanism.load), Segment(duration, 1e5, 1e12, steps=63)
    yield mechanism.extreme("1e+09 turns of link 1", slow, moved, slow=True)
    yield mechanism.extreme("1e+09 turns of the drive", None, held, slow=True)


def tolerance(mechanism: Mechanism) -> Extremes:
    """All of the allowed range."""
    for exponent in range(-1, -14, -1):
        value = float(f"1e{exponent}")
        yield mechanism.extreme(f"{value:g}", {"tolerance": value})


# --- the mechanism ---


def inertia_ratio(mechanism: Mechanism) -> Extremes:
    """Each inertia against that of the imbalances behind link 2."""
    imbalance = imbalance_inertia(mechanism.derived)
    for symbol, name in INERTIAS.items():
        for ratio in RATIOS:
            yield mechanism.extreme(f"{symbol} {ratio:g}", {name: ratio * imbalance})
    for ratio in RATIOS:
        yield mechanism.extreme(f"J4 {ratio:g}", {"driven_inertia": ratio * imbalance}, levels=ELASTIC_LEVELS)


def mass(mechanism: Mechanism) -> Extremes:
    """Mass of an imbalance, the load in proportion and not; none at all."""
    for value in (1e-12, 1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9):
        heavy = {"imbalance_mass": value}
        yield mechanism.extreme(f"{value:g} kg", heavy)
        yield mechanism.extreme(f"{value:g} kg, load in proportion", heavy, load=mechanism.load * value)
    yield mechanism.extreme("0 kg", {"imbalance_mass": 0.0})


def no_inertia_of_link_2(mechanism: Mechanism) -> Extremes:
    """J2 = 0, towards the cusp: where the imbalance rests in link 1 nothing is left behind link 2."""
    bare = {"link2_inertia": 0.0}
    if mechanism.layout == "bevel":
        for part in (0.0, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1):
            yield mechanism.extreme(f"a = 1, b = 1 + {part:g}", bare | {"b": 1.0 + part})
        yield mechanism.extreme("a = b = 0.7", bare | {"a": 0.7, "b": 0.7})
    else:
        yield mechanism.extreme("J2 = 0", bare)
        for arm in (0.0, 1e-9, 1e-6, 1e-3, 0.03):
            yield mechanism.extreme(f"l = {arm:g} m", bare | {"eccentricity": arm})
    for inertia in (1e-12, 1e-9, 1e-6, 1e-3):
        yield mechanism.extreme(f"J16 = {inertia:g} kg.m2", bare | {"drive_inertia": inertia})
    for inertia in (1e-12, 1e-9, 1e-6):
        yield mechanism.extreme(f"J2 = {inertia:g} kg.m2", {"link2_inertia": inertia})
    yield mechanism.extreme("no output freewheel", bare | {"output_freewheel": False})


def teeth(mechanism: Mechanism) -> Extremes:
    """Ratios 1/200 to 200, of few teeth and of many coprime ones (planar: ratios of the radii)."""
    duration = TRAVEL / mechanism.omega1 / 4
    if mechanism.layout == "planar":
        for ratio in (1 / 200, 1 / 20, 20.0, 200.0):
            radii = {"sun_radius": 0.03 * ratio, "satellite_radius": 0.03}
            yield mechanism.extreme(f"R0/r {ratio:g}", radii, duration=duration)
        return
    for z17, z6 in ((1, 200), (200, 1), (4999, 999983), (999983, 4999), (999983, 1000000), (1000000, 999983)):
        yield mechanism.extreme(f"z17/z6 {z17}/{z6}", {"z17": z17, "z6": z6}, duration=duration)
    for z2, z16 in ((1, 200), (200, 1)):
        yield mechanism.extreme(f"z2/z16 {z2}/{z16}", {"z2": z2, "z16": z16}, duration=duration)


def satellites(mechanism: Mechanism) -> Extremes:
    """From one imbalance to 64 thousand."""
    for count in (1, 2, 3, 4, 8, 16, 32, 64):
        yield mechanism.extreme(f"{count}", {"satellites": count})
    for modules in (2, 10, 1000):
        yield mechanism.extreme(f"64 in {modules} modules", {"satellites": 64, "modules": modules})


def freewheels(mechanism: Mechanism) -> Extremes:
    """Freewheels left out, under loads of both signs."""
    for left_out in (("housing",), ("output",), ("housing", "output")):
        without = {f"{name}_freewheel": False for name in left_out}
        for torque in (mechanism.load, 0.0, 1e3, -1e3):
            loaded = "ordinary load" if torque == mechanism.load else f"{torque:g} N.m"
            value = f"no {', no '.join(left_out)}, {loaded}"
            yield mechanism.extreme(value, without, load=torque, duration=0.5)


def shaft(mechanism: Mechanism) -> Extremes:
    """The elastic shaft, soft to stiff, undamped to overdamped, and its ends."""
    hub, driven = ELASTIC_OUTPUT.values()
    reduced = hub * driven / (hub + driven)
    tried: dict[str, dict[str, float]] = {}
    for exponent in (-3, 0, 3, 6, 9, 12):
        stiffness = float(f"1e{exponent}")
        critical = 2.0 * math.sqrt(stiffness * reduced)
        for damped, part in (("no damping", 0.0), ("under", 0.1), ("critical", 1.0), ("over", 10.0)):
            values = {"shaft_stiffness": stiffness, "shaft_damping": part * critical}
            tried[f"c {stiffness:g}, {damped}"] = values
    tried |= {
        **{"damping 1e12": {"shaft_damping": 1e12}, "hub 1e-9 kg.m2": {"output_inertia": 1e-9}},
        **{"driven mass 1e-9 kg.m2": {"driven_inertia": 1e-9}, "friction 1e9": {"driven_friction": 1e9}},
        **{"balancer 10": {"balancer": 10.0}, "balancer -10": {"balancer": -10.0}},
    }
    for value, changes in tried.items():
        yield mechanism.extreme(value, ELASTIC_OUTPUT | changes, levels=ELASTIC_LEVELS)


_NAMED = (
    *(input_speed, input_speed_under_load, reversal, load, stall_torque, grazing, output_locked),
    *(communication_step, fixed_step, turns, tolerance, inertia_ratio, mass, no_inertia_of_link_2),
    *(teeth, satellites, freewheels, shaft, *LOSS_AXES),
)
AXES: dict[str, Callable[[Mechanism], Extremes]] = {axis.__name__.replace("_", " "): axis for axis in _NAMED}


def cases(name: str, quick: bool = False) -> list[Case]:
    """All cases of an axis: layout by layout, value by value, level by level.

    Args:
        name: in AXES. quick: leave out those that take long.
    """
    return [
        Case(name, mechanism.layout, level, extreme)
        for mechanism in MECHANISMS
        for extreme in AXES[name](mechanism)
        if not (quick and extreme.slow)
        for level in extreme.levels
    ]
