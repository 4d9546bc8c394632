"""Extremes of the mechanism: inertias, masses, teeth, satellites, freewheels, the elastic shaft."""

from __future__ import annotations

import math
from collections.abc import Iterator

from .case import ELASTIC_RUNGS, Extreme
from .mechanisms import TRAVEL, Mechanism, imbalance_inertia

RATIOS = (1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9)
INERTIAS = {"J1": "input_inertia", "J2": "link2_inertia", "J3": "output_inertia", "J16": "drive_inertia"}


def inertia_ratio(mechanism: Mechanism) -> Iterator[Extreme]:
    """Each inertia against that of the imbalances behind link 2."""
    imbalance = imbalance_inertia(mechanism)
    for symbol, name in INERTIAS.items():
        for ratio in RATIOS:
            parameters = mechanism.with_values(**{name: ratio * imbalance})
            yield Extreme(f"{symbol} {ratio:g}", parameters, mechanism.turning())
    for ratio in RATIOS:
        parameters = mechanism.with_values(driven_inertia=ratio * imbalance)
        yield Extreme(f"J4 {ratio:g}", parameters, mechanism.turning(), rungs=ELASTIC_RUNGS)


def mass(mechanism: Mechanism) -> Iterator[Extreme]:
    """Mass of an imbalance, the load in proportion and not; none at all."""
    for value in (1e-12, 1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9):
        parameters = mechanism.with_values(imbalance_mass=value)
        yield Extreme(f"{value:g} kg", parameters, mechanism.turning())
        segments = mechanism.turning(load=mechanism.load * value)
        yield Extreme(f"{value:g} kg, load in proportion", parameters, segments)
    yield Extreme("0 kg", mechanism.with_values(imbalance_mass=0.0), mechanism.turning())


def no_link2_inertia(mechanism: Mechanism) -> Iterator[Extreme]:
    """J2 = 0, towards the cusp: where the imbalance rests in link 1 nothing is left behind link 2."""
    bare = mechanism.with_values(link2_inertia=0.0)
    if mechanism.layout == "bevel":
        for part in (0.0, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1):
            yield Extreme(f"a = 1, b = 1 + {part:g}", bare | {"b": 1.0 + part}, mechanism.turning())
        yield Extreme("a = b = 0.7", bare | {"a": 0.7, "b": 0.7}, mechanism.turning())
    else:
        yield Extreme("J2 = 0", bare, mechanism.turning())
        for arm in (0.0, 1e-9, 1e-6, 1e-3, 0.03):
            yield Extreme(f"l = {arm:g} m", bare | {"eccentricity": arm}, mechanism.turning())
    for inertia in (1e-12, 1e-9, 1e-6, 1e-3):
        yield Extreme(f"J16 = {inertia:g} kg.m2", bare | {"drive_inertia": inertia}, mechanism.turning())
    for inertia in (1e-12, 1e-9, 1e-6):
        parameters = mechanism.with_values(link2_inertia=inertia)
        yield Extreme(f"J2 = {inertia:g} kg.m2", parameters, mechanism.turning())
    yield Extreme("no output freewheel", bare | {"output_freewheel": False}, mechanism.turning())


def teeth(mechanism: Mechanism) -> Iterator[Extreme]:
    """Ratios 1/200 to 200, of few teeth and of many coprime ones (planar: ratios of the radii)."""
    if mechanism.layout == "planar":
        for ratio in (1 / 200, 1 / 20, 20.0, 200.0):
            parameters = mechanism.with_values(sun_radius=0.03 * ratio, satellite_radius=0.03)
            yield Extreme(
                f"R0/r {ratio:g}", parameters, mechanism.turning(duration=TRAVEL / mechanism.omega1 / 4)
            )
        return
    duration = TRAVEL / mechanism.omega1 / 4
    for z17, z6 in ((1, 200), (200, 1), (4999, 999983), (999983, 4999), (999983, 1000000), (1000000, 999983)):
        parameters = mechanism.with_values(z17=z17, z6=z6)
        yield Extreme(f"z17/z6 {z17}/{z6}", parameters, mechanism.turning(duration=duration))
    for z2, z16 in ((1, 200), (200, 1)):
        parameters = mechanism.with_values(z2=z2, z16=z16)
        yield Extreme(f"z2/z16 {z2}/{z16}", parameters, mechanism.turning(duration=duration))


def satellites(mechanism: Mechanism) -> Iterator[Extreme]:
    """From one imbalance to 64 thousand."""
    for count in (1, 2, 3, 4, 8, 16, 32, 64):
        yield Extreme(f"{count}", mechanism.with_values(satellites=count), mechanism.turning())
    for modules in (2, 10, 1000):
        parameters = mechanism.with_values(satellites=64, modules=modules)
        yield Extreme(f"64 in {modules} modules", parameters, mechanism.turning())


def freewheels(mechanism: Mechanism) -> Iterator[Extreme]:
    """Freewheels left out, under loads of both signs."""
    for housing, output in ((False, True), (True, False), (False, False)):
        left_out = [name for name, there in (("housing", housing), ("output", output)) if not there]
        parameters = mechanism.with_values(housing_freewheel=housing, output_freewheel=output)
        for torque in (mechanism.load, 0.0, 1e3, -1e3):
            load = "ordinary load" if torque == mechanism.load else f"{torque:g} N.m"
            value = f"no {', no '.join(left_out)}, {load}"
            yield Extreme(value, parameters, mechanism.turning(load=torque, duration=0.5))


def shaft(mechanism: Mechanism) -> Iterator[Extreme]:
    """The elastic shaft, soft to stiff, undamped to overdamped, and its ends."""
    reduced = 0.02 * 0.5 / (0.02 + 0.5)
    common = {"output_inertia": 0.02, "driven_inertia": 0.5}
    for exponent in (-3, 0, 3, 6, 9, 12):
        stiffness = float(f"1e{exponent}")
        critical = 2.0 * math.sqrt(stiffness * reduced)
        for word, part in (("no damping", 0.0), ("under", 0.1), ("critical", 1.0), ("over", 10.0)):
            parameters = mechanism.with_values(
                **common, shaft_stiffness=stiffness, shaft_damping=part * critical
            )
            yield Extreme(f"c {stiffness:g}, {word}", parameters, mechanism.turning(), rungs=ELASTIC_RUNGS)
    others: dict[str, dict[str, float]] = {
        "damping 1e12": {"shaft_damping": 1e12},
        "hub 1e-9 kg.m2": {"output_inertia": 1e-9},
        "driven mass 1e-9 kg.m2": {"driven_inertia": 1e-9},
        "friction 1e9": {"driven_friction": 1e9},
        "balancer 10": {"balancer": 10.0},
        "balancer -10": {"balancer": -10.0},
    }
    for value, changes in others.items():
        yield Extreme(
            value, mechanism.with_values(**(common | changes)), mechanism.turning(), rungs=ELASTIC_RUNGS
        )
