"""The extremes: a table of axes, each with its values and what they change of two ordinary mechanisms."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from inertia_module.fidelity.trials import Level
from inertia_module.kernel.codes import AVERAGED, TIMESTEPPING
from inertia_module.memory import Module

from .motion import ELASTIC_LEVELS, LEVELS, Motion, Segment, imbalance_inertia, solve_at

# what the fixed steps of timestepping and the torque map of averaged are trusted to, relative
TIMESTEPPING_ACCURACY = 0.02
AVERAGED_ACCURACY = 0.005
# rad that link 1 turns in a trial, where nothing else is said
TRAVEL = 100.0


@dataclass(frozen=True)
class Case:
    """One value on an axis, for one layout, at one level of fidelity.

    Attributes:
        axis, value, layout: how they are called. motion: what is run.
        split: short communication steps that replace each long one.
        slow: whether it is left out of a quick run.
    """

    axis: str
    value: str
    layout: str
    motion: Motion
    split: int
    slow: bool = False

    @property
    def level(self) -> Level:
        """Level of fidelity."""
        return self.motion.level

    @property
    def accuracy(self) -> float:
        """Relative accuracy asked for: the tolerance, or what method and fidelity can give."""
        least = TIMESTEPPING_ACCURACY if self.level.method == TIMESTEPPING else 0.0
        if self.level.fidelity == AVERAGED:
            least = max(least, AVERAGED_ACCURACY)
        return max(self.motion["tolerance"], least)


@dataclass(frozen=True, eq=False)
class Mechanism:
    """A layout at ordinary values.

    Attributes:
        layout: bevel or planar. parameters: over the defaults. omega1: rad/s. load: N.m.
    """

    layout: str
    parameters: dict[str, float]
    omega1: float
    load: float

    @functools.cached_property
    def module(self) -> Module:
        """A module at the ordinary speed."""
        return Module("plain").start(**self.parameters, omega1=self.omega1)

    @property
    def derived(self) -> Any:
        """The kernel's constants."""
        return self.module.derived

    @functools.cached_property
    def imbalance(self) -> float:
        """Largest inertia of the imbalances behind link 2, kg m^2."""
        return imbalance_inertia(self.derived)

    @functools.cached_property
    def largest_held_torque(self) -> float:
        """Largest torque on link 2 while it is held at the ordinary speed, N.m: no load above it is moved.

        Looked for on a grid over a period, then on ever finer ones around the best.
        """
        d = self.derived

        def torque(q: float) -> float:
            return float(solve_at(self.module, True, False, q=q, omega1=self.omega1, omega2=0.0).mesh)

        count = 200 * int(d.period_turns)
        best, half = 0.5 * d.period, 0.5 * d.period
        while half > 1e-9:
            best = max((best + half * (2 * n / count - 1) for n in range(count + 1)), key=torque)
            half *= 2.0 / count
        return torque(best)

    @functools.cached_property
    def grazing_speed(self) -> float:
        """Speed of the unloaded output shaft that link 2 only just reaches in TRAVEL rad, rad/s."""
        coasting = Segment(TRAVEL / self.omega1, self.omega1, 0.0)

        def engages(speed: float) -> bool:
            values = self.parameters | {"omega_out_start": speed, "tolerance": 1e-13}
            module = Motion(values, (coasting,)).started(Module())
            module.advance(coasting.duration)
            return module["output_torque_mean"] != 0.0

        low, high = 0.0, 100.0 * self.omega1
        while True:
            middle = 0.5 * (low + high)
            if not low < middle < high:
                return middle
            low, high = (middle, high) if engages(middle) else (low, middle)


BEVEL = Mechanism("bevel", {"kinematic_ratio": 0.5}, 100.0, 10.0)
PLANAR = Mechanism(
    "planar",
    {
        **{"layout": 1, "eccentricity": 0.02, "imbalance_mass": 0.8, "satellites": 3},
        **{"link2_inertia": 0.003, "output_inertia": 0.4, "kinematic_ratio": 0.5},
    },
    120.0,
    8.0,
)
MECHANISMS = (BEVEL, PLANAR)

# --- the table: axis, each value as it is called, what it changes of a mechanism ---

# parameters and, by these names: speed of link 1, load and duration, or segments in their place; turns of
# Motion; levels that the extreme says something about; split and slow of Case
Extremes = Iterator[tuple[str, str, dict[str, Any]]]
USUAL = {"segments": (), "turns": 0.0, "levels": LEVELS, "split": 50, "slow": False}
FIXED_STEPS = tuple(level for level in LEVELS if level.method == TIMESTEPPING)
SPEED_SIZES = (1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e4, 1e5)
RATIOS = (1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9)
# of friction and drag, N.m.s/rad
VISCOUS = (1e-12, 1e-2, 1.0, 1e3)
# kg.m2
LOCKED = {"output_inertia": 1e9, "driven_inertia": 1e9}
ELASTIC_OUTPUT = {"output_inertia": 0.02, "driven_inertia": 0.5}
# each size with both signs, and shares off a critical value on both sides
SIGNED_SPEEDS = tuple(value for size in SPEED_SIZES for value in (size, -size))
SHARES = (0.0, *(value for size in (1e-15, 1e-12, 1e-9, 1e-6, 1e-3) for value in (size, -size)))


def each(axis: str, called: str, names: str, values: Iterable[Any] | dict[Any, Any], **more: Any) -> Extremes:
    """An extreme for each value of some names (parted by spaces); a dictionary says how it is called."""
    by_name = values if isinstance(values, dict) else {value: value for value in values}
    for told, value in by_name.items():
        yield axis, called.format(told), dict.fromkeys(names.split(), value) | more


def inputs(m: Mechanism) -> Extremes:
    """Speeds and loads, from nothing to far more than the mechanism can move."""
    # the same motion, faster and slower: the load goes with the square of the speed
    for omega1 in SIGNED_SPEEDS:
        same = {"load": m.load * (omega1 / m.omega1) ** 2, "split": 1 if abs(omega1) < 1e-3 else 50}
        time = min(TRAVEL / abs(omega1), 1e8)
        yield "input speed", f"{omega1:g} rad/s", {**same, "omega1": omega1, "duration": time}
    # too slow to move the load, too fast to feel it
    for omega1 in (*SIGNED_SPEEDS, 2e-150, -2e-150, 1e-200, -1e-200, 1e-313, -1e-313):
        time = min(TRAVEL / abs(omega1), 1e3)
        yield "input speed under load", f"{omega1:g} rad/s", {"omega1": omega1, "duration": time}
    for low in (0.0, -m.omega1, -1e-9, -1e5):
        there = Segment(0.2, m.omega1, m.load)
        back = Segment(0.2 * m.omega1 / max(m.omega1, abs(low)), low, m.load)
        yield "reversal", f"jumps {m.omega1:g} to {low:g} rad/s", {"segments": (there, back, there, back)}
    for time in (1e-6, 1e-3, 1.0, 100.0):
        # the module takes the slope from two points of the line, so it has to see a first one
        slope, first = -2.0 * m.omega1 / time, 1e-3 * time
        segments = (
            Segment(0.1, m.omega1, m.load),
            Segment(first, m.omega1, m.load, whole=True),
            Segment(time - first, m.omega1 + slope * first, m.load, slope),
        )
        ramp = {"input_hold": 1, "segments": segments, "slow": time > 10.0}
        yield "reversal", f"ramp through zero in {time:g} s", ramp
    loads = (value for size in (1e-9, 1e-3, 1.0, 100.0, 1e3, 1e6, 1e9) for value in (size, -size))
    yield from each("load", "{:g} N.m", "load", (0.0, *loads))
    for axis, name, peak in (
        ("stall torque", "load", m.largest_held_torque),
        ("grazing", "omega_out_start", m.grazing_speed),
    ):
        for share in SHARES:
            value = f"peak x (1 {'-' if share < 0.0 else '+'} {abs(share):g})"
            yield axis, value, {"load": 0.0, name: (1.0 + share) * peak}
    yield "output locked", "inertia 1e9 kg.m2", LOCKED
    yield "output locked", "load 1e9 N.m", {"load": 1e9}
    yield "output locked", "both", {**LOCKED, "load": 1e9}
    yield "output locked", "inertia 1e9 kg.m2, no load", {**LOCKED, "load": 0.0}


def settings(m: Mechanism) -> Extremes:
    """Steps of a nanosecond and of a quarter of an hour, counters that are far already, tolerances."""
    warm = Segment(0.0123, m.omega1, m.load)
    for step in (1e-9, 1e-6, 1e-3, 1.0, 10.0, 100.0, 1e3):
        split = 1000 if step < 1e-3 else 100
        # the long run takes in one step what the short one takes in steps of this length
        whole = Segment(step * split if step < 1.0 else step, m.omega1, m.load)
        run = {"segments": (warm, whole), "split": split, "slow": step > 10.0}
        yield "communication step", f"{step:g} s", run
    # internal steps of method timestepping, from fine to many pulses in one
    rate = float(m.derived.harmonic * m.derived.k) * m.omega1
    steps = {phase: phase / rate for phase in (0.01, 0.03, 0.1, 0.3, 1.0, 10.0, 100.0)}
    yield from each("fixed step", "{:g} rad", "max_step", steps, levels=FIXED_STEPS)
    yield from each("turns", "{:g} turns before", "turns", (1e6, 1e9, 1e15))
    # link 1 past a drive that hardly turns
    bevel = m.layout == "bevel"
    slow = {"z2": 1, "z16": 1000000} if bevel else {"sun_radius": 1e-6, "satellite_radius": 1.0}
    duration = 2e9 * math.pi / 1e5
    moved, held = Segment(duration, 1e5, m.load), Segment(duration, 1e5, 1e12, steps=63)
    yield "turns", "1e+09 turns of link 1", {**slow, "segments": (moved,), "slow": True}
    yield "turns", "1e+09 turns of the drive", {"segments": (held,), "slow": True}
    yield from each("tolerance", "{:g}", "tolerance", (float(f"1e-{digits}") for digits in range(1, 14)))


def inertias(m: Mechanism) -> Extremes:
    """Inertias against that of the imbalances behind link 2; masses; the cusp of J2 = 0."""
    ratios = {ratio: ratio * m.imbalance for ratio in RATIOS}
    links = {"J1": "input_inertia", "J2": "link2_inertia", "J3": "output_inertia", "J16": "drive_inertia"}
    for symbol, name in links.items():
        yield from each("inertia ratio", symbol + " {:g}", name, ratios)
    yield from each("inertia ratio", "J4 {:g}", "driven_inertia", ratios, levels=ELASTIC_LEVELS)
    for mass in (1e-12, 1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9):
        yield "mass", f"{mass:g} kg", {"imbalance_mass": mass}
        yield "mass", f"{mass:g} kg, load in proportion", {"imbalance_mass": mass, "load": m.load * mass}
    yield "mass", "0 kg", {"imbalance_mass": 0.0}
    # towards the cusp: where the imbalance rests in link 1 nothing is left behind link 2
    axis, bare = "no inertia of link 2", {"link2_inertia": 0.0}
    if m.layout == "bevel":
        longer = {part: 1.0 + part for part in (0.0, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1)}
        yield from each(axis, "a = 1, b = 1 + {:g}", "b", longer, **bare)
        yield axis, "a = b = 0.7", {**bare, "a": 0.7, "b": 0.7}
    else:
        yield axis, "J2 = 0", bare
        yield from each(axis, "l = {:g} m", "eccentricity", (0.0, 1e-9, 1e-6, 1e-3, 0.03), **bare)
    yield from each(axis, "J16 = {:g} kg.m2", "drive_inertia", (1e-12, 1e-9, 1e-6, 1e-3), **bare)
    yield from each(axis, "J2 = {:g} kg.m2", "link2_inertia", (1e-12, 1e-9, 1e-6))
    yield axis, "no output freewheel", {**bare, "output_freewheel": False}


def parts(m: Mechanism) -> Extremes:
    """Teeth, satellites, freewheels left out, the elastic shaft."""
    # ratios 1/200 to 200, of few teeth and of many coprime ones
    run = {"duration": TRAVEL / m.omega1 / 4}
    few = ((1, 200), (200, 1))
    many = ((4999, 999983), (999983, 4999), (999983, 1000000), (1000000, 999983))
    if m.layout == "bevel":
        for one, other, pairs in (("z17", "z6", (*few, *many)), ("z2", "z16", few)):
            for teeth in pairs:
                value = f"{one}/{other} {teeth[0]}/{teeth[1]}"
                yield "teeth", value, {**run, one: teeth[0], other: teeth[1]}
    else:
        radii = {ratio: 0.03 * ratio for ratio in (1 / 200, 1 / 20, 20.0, 200.0)}
        yield from each("teeth", "R0/r {:g}", "sun_radius", radii, **run, satellite_radius=0.03)
    yield from each("satellites", "{}", "satellites", (1, 2, 3, 4, 8, 16, 32, 64))
    yield from each("satellites", "64 in {} modules", "modules", (2, 10, 1000), satellites=64)
    for left_out in (("housing",), ("output",), ("housing", "output")):
        without = {f"{name}_freewheel": False for name in left_out}
        for torque in (m.load, 0.0, 1e3, -1e3):
            loaded = "ordinary load" if torque == m.load else f"{torque:g} N.m"
            value = f"no {', no '.join(left_out)}, {loaded}"
            yield "freewheels", value, {**without, "load": torque, "duration": 0.5}
    # soft to stiff, undamped to overdamped; extremes of its ends
    elastic = {**ELASTIC_OUTPUT, "levels": ELASTIC_LEVELS}
    hub, driven = ELASTIC_OUTPUT.values()
    for stiffness in (1e-3, 1.0, 1e3, 1e6, 1e9, 1e12):
        critical = 2.0 * math.sqrt(stiffness * (hub * driven / (hub + driven)))
        for damped, part in (("no damping", 0.0), ("under", 0.1), ("critical", 1.0), ("over", 10.0)):
            values = {"shaft_stiffness": stiffness, "shaft_damping": part * critical}
            yield "shaft", f"c {stiffness:g}, {damped}", elastic | values
    yield "shaft", "damping 1e12", elastic | {"shaft_damping": 1e12}
    yield "shaft", "hub 1e-9 kg.m2", elastic | {"output_inertia": 1e-9}
    yield "shaft", "driven mass 1e-9 kg.m2", elastic | {"driven_inertia": 1e-9}
    yield "shaft", "friction 1e9", elastic | {"driven_friction": 1e9}
    yield from each("shaft", "balancer {:g}", "balancer", (10.0, -10.0), **elastic)


def losses(m: Mechanism) -> Extremes:
    """Friction, losses by load, drag, weights, wind-up, bodies: tiny, usual and dominant; all at once."""
    bevel = m.layout == "bevel"
    for link in ("input", "drive", "link2", "output"):
        yield from each("viscous friction", link + " {:g} N.m.s/rad", f"{link}_friction", VISCOUS)
    efficiencies = {"1 - 1e-12": 1.0 - 1e-12, "0.97": 0.97, "0.5": 0.5, "0.1": 0.1}
    meshes = {"link 2": "mesh_efficiency", "satellites": "satellite_mesh_efficiency"}
    for mesh, names in (
        {**meshes, "both": " ".join(meshes.values())}.items() if bevel else [*meshes.items()][:1]
    ):
        yield from each("efficiency", mesh + " {}", names, efficiencies)
    yield from each("journal friction", "{:g} m", "journal_friction", (1e-12, 1e-3, 0.1, 1.0, 1e3))
    # links 1 and 2 locked together at the same speed by friction
    together = dict.fromkeys(("omega2_start", "omega_out_start"), m.omega1)
    for lever in (1.0, 1e3):
        stuck = {**together, "journal_friction": lever, "drive_angle_start": 3.0, "load": 1.0}
        for turned in (TRAVEL, 1e6, 1e9):
            run = {"duration": turned / m.omega1, "slow": turned >= 1e6}
            yield "stick", f"journals {lever:g} m, {turned:g} rad", stuck | run
    for wheel in ("housing", "output"):
        yield from each("drag", wheel + " {:g} N.m", f"{wheel}_drag", (1e-12, 1.0, 1e3, 1e9))
        yield from each("drag", wheel + " {:g} N.m.s/rad", f"{wheel}_drag_viscous", VISCOUS)
    # next to the acceleration of the imbalances, from nothing to a thousand times as much
    yield from each("gravity", "{:g} m/s2", "gravity", (1e-12, 9.81, 1e3))
    for omega1 in (10.0, 1.0, 1e-3):
        slow = {"gravity": 1e3, "omega1": omega1, "duration": TRAVEL / max(omega1, 1.0)}
        yield from each(
            "gravity", f"1000 m/s2 at {omega1:g} rad/s, load {{:g}} N.m", "load", (0.1, 0.0), **slow
        )
    for wheels in (("housing",), ("freewheel",), ("housing", "freewheel")):
        for stiffness in (10.0**exponent for exponent in range(2, 10)):
            for damped, part in (("no damping", 0.0), ("damped", 0.1)):
                damping = 2.0 * part * math.sqrt(stiffness * float(m.derived.J2))
                springs = {f"{wheel}_stiffness": stiffness for wheel in wheels}
                springs |= {f"{wheel}_damping": damping for wheel in wheels}
                value = f"{' and '.join(wheels)} {stiffness:g} N.m/rad, {damped}"
                more = {"duration": 0.1, "levels": ELASTIC_LEVELS}
                yield "wind up", value, {**ELASTIC_OUTPUT, **springs, **more}
    ratios = {ratio: ratio * m.imbalance for ratio in (1e-9, 1e-3, 1.0, 1e3, 1e6)}
    yield from each("satellite bodies", "Ja {:g}", "satellite_inertia", ratios)
    if bevel:
        yield from each("satellite bodies", "Jt {:g}", "satellite_transverse_inertia", ratios)
    usual = {"journal_friction": 1e-3, "gravity": 9.81, "housing_drag": 0.5, "output_drag": 0.5}
    usual |= {"input_friction": 0.01, "link2_friction": 0.01}
    for called, part in (("1e-12 of the usual", 1e-12), ("usual", 1.0), ("10 times the usual", 10.0)):
        values = {name: part * value for name, value in usual.items()}
        yield "all losses", called, {**values, "mesh_efficiency": 1.0 - 0.03 * part}


@functools.cache
def axes() -> dict[str, list[Case]]:
    """Cases by name of the axis: layout by layout, value by value, level by level."""
    found: dict[str, list[Case]] = {}
    for m, group in itertools.product(MECHANISMS, (inputs, settings, inertias, parts, losses)):
        for axis, value, changes in group(m):
            usual = {**USUAL, "omega1": m.omega1, "load": m.load, "duration": TRAVEL / m.omega1}
            run = {name: changes.get(name, ordinary) for name, ordinary in usual.items()}
            changed = {name: number for name, number in changes.items() if name not in usual}
            whole = Segment(run["duration"], run["omega1"], run["load"])
            for level in run["levels"]:
                values = {**m.parameters, **changed, **level.values}
                motion = Motion(values, run["segments"] or (whole,), run["turns"])
                case = Case(axis, value, m.layout, motion, run["split"], run["slow"])
                found.setdefault(axis, []).append(case)
    return found
