"""Reliability of fits: ten kinds of data sets whose true values are known.

The data sets resemble examples/fit_rig.csv with other seeds. They come from the independent reference. A fit is
correct if the intervals of all free keys contain the true values, if it reports that they are not identifiable, or
if it names the cause. Run: python -m benchmarks.fit [SETS [KIND ...]]
"""

import functools
import sys
import tempfile
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from rich.progress import track
from scipy.integrate import cumulative_trapezoid

from benchmarks import fit_rig_data as data
from inertia_module import example, studies
from inertia_module.common.errors import InertiaModuleError
from inertia_module.fmi.results import write_columns
from inertia_module.fmu.builder import current_fmu
from inertia_module.scene import load_scene
from verification.reference.cases import OMEGA2, OMEGA3
from verification.reference.motion import Reference

SETS = 100
FREE = {"imbalance_mass": None, "link2_inertia": None}
COLUMNS = [f"{name} [rpm]" for name in data.NOISE]
TIME = "time [ms]"
# losses, least and greatest
LOSSES = {"link2_friction": (0.01, 0.1), "output_friction": (0.01, 0.1), "mesh_efficiency": (0.9, 0.99)}
# ranges of keys of which the data determine only ratios
ALL_MASSES = {
    "imbalance_mass": (0.5, 20.0),
    "output_inertia": (0.2, 10.0),
    "load.torque": (2.0, 300.0),
    "link2_inertia": (0.001, 0.2),
}
COLLINEAR = {"imbalance_mass": (0.5, 2.0), "output_inertia": (0.2, 1.0), "load.torque": (2.0, 30.0)}
TRUE = {**data.TRUE, "load.torque": data.LOAD_TORQUE}
# counts per revolution, and the time over which they are counted, s
COUNTS, WINDOW = 4096, 2e-3
QUADRATURE_STEP = 1e-4
PLANAR = {
    "layout": "planar",
    "sun_radius": 0.07,
    "satellite_radius": 0.03,
    "eccentricity": 0.02,
    "imbalance_mass": 1.07,
    "satellites": 3,
    "link2_inertia": 0.0062,
    "output_inertia": 0.5,
}


class Set(NamedTuple):
    """A data set: columns of the file, names of causes, free keys, and changes of the scene."""

    columns: dict[str, np.ndarray]
    causes: frozenset[str] = frozenset()
    free: object = FREE
    changes: MappingProxyType = MappingProxyType({})


def nothing_wrong(true, seed, _):
    """The scene is complete."""
    return Set(data.measured(true, seed))


def offset(true, seed, random):
    """A sensor has an offset of 1 to 20 rpm."""
    columns, name = data.measured(true, seed), random.choice(COLUMNS)
    columns[name] = columns[name] + random.choice([-1.0, 1.0]) * random.uniform(1.0, 20.0)
    return Set(columns, frozenset({f"offset.{name.split()[0]}"}))


def clock_shift(true, seed, random):
    """The clock of the file is shifted by 0.5 to 5 ms."""
    columns = data.measured(true, seed)
    late = random.choice([-1.0, 1.0]) * random.uniform(0.5, 5.0)
    rows = columns[TIME] + late >= 0.0
    columns[TIME] = columns[TIME] + late
    return Set({name: values[rows] for name, values in columns.items()}, frozenset({"shift.time"}))


def gain(true, seed, random):
    """The gain of a sensor is 2 to 20 % too large or too small."""
    columns, name = data.measured(true, seed), random.choice(COLUMNS)
    columns[name] = columns[name] * (1.0 + random.choice([-1.0, 1.0]) * random.uniform(0.02, 0.2))
    return Set(columns, frozenset({f"gain.{name.split()[0]}"}))


def unmodelled_friction(_, seed, random):
    """The machine has a loss that the scene lacks."""
    name = random.choice(list(LOSSES))
    true = data.true_speeds(**{name: random.uniform(*LOSSES[name])})
    return Set(data.measured(true, seed), frozenset({f"mechanism.{name}"}))


def wrong_radius(_, seed, random):
    """The sun gear of a planar machine is 1 to 4 % larger or smaller than in the scene."""
    factor = 1.0 + random.choice([-1.0, 1.0]) * random.uniform(0.01, 0.04)
    changed = {"layout": 1.0, "sun_radius": factor * PLANAR["sun_radius"]}
    true = data.true_speeds(**PLANAR | changed)
    nominal = {**PLANAR, "imbalance_mass": 1.0, "link2_inertia": 0.005}
    changes = {f"mechanism.{name}": value for name, value in nominal.items()}
    return Set(data.measured(true, seed), frozenset({"mechanism.sun_radius"}), FREE, changes)


def degenerate(true, seed, _):
    """All masses and the load are free: the data determine only ratios, and searches end at a bound."""
    return Set(data.measured(true, seed), free=ALL_MASSES)


def collinear(true, seed, _):
    """Three nearly collinear keys are free, and the inertia that sets their scale is wrong in the scene."""
    return Set(data.measured(true, seed), frozenset({"mechanism.link2_inertia"}), COLLINEAR)


@functools.cache
def true_angles():
    """Return times, s, and angles of link 2 and of the output shaft there, rad, by quadrature of the speeds."""
    motion, speeds = Reference(data.TRUE, data.OMEGA1, data.LOAD_TORQUE), []
    times = QUADRATURE_STEP * np.arange(round(data.TIMES[-1] / QUADRATURE_STEP) + 1)
    for time in times:
        motion.advance(time)
        speeds.append(motion.state[[OMEGA2, OMEGA3]])
    return times, cumulative_trapezoid(speeds, times, axis=0, initial=0.0)


def counted_encoder(_, seed, random):
    """Both speeds are counts over 2 ms, so that they are quantised, averaged and 1 ms late."""
    (every, angles), times = true_angles(), data.TIMES[data.TIMES >= WINDOW]
    columns = {TIME: np.round(1e3 * times, 3)}
    for name, angle in zip(COLUMNS, angles.T, strict=True):
        counts = COUNTS / (2.0 * np.pi) * angle + random.uniform()
        ends, begins = (np.floor(np.interp(at, every, counts)) for at in (times, times - WINDOW))
        columns[name] = 60.0 / (COUNTS * WINDOW) * (ends - begins)
    return Set(columns, frozenset({"shift.time", "shift.omega2", "shift.omega_out"}))


def missing_rows(true, seed, random):
    """30 % of the rows are missing."""
    columns = data.measured(true, seed)
    rows = random.uniform(size=data.TIMES.size) > 0.3
    return Set({name: values[rows] for name, values in columns.items()})


KINDS = (
    nothing_wrong,
    offset,
    clock_shift,
    gain,
    unmodelled_friction,
    wrong_radius,
    degenerate,
    collinear,
    counted_encoder,
    missing_rows,
)


class Verdict(NamedTuple):
    """Verdict on a fit: each field is 0 or 1."""

    contained: bool
    unidentifiable: bool
    named: bool
    other_named: bool
    contained_if_exact: bool

    @property
    def is_correct(self):
        """Return True if the fit is right or reports that it may not be."""
        return self.contained or self.unidentifiable or self.named


def verdict(kind, true, seed, folder, fmu):
    """Fit a data set of a kind and judge the result."""
    one = kind(true, seed, np.random.default_rng([seed, KINDS.index(kind)]))
    scene = load_scene(example("fit_rig")).replaced(run={"stop_time": 0.6}).with_keys(one.changes)
    try:
        result = studies.fit(
            write_columns(folder / "measured.csv", one.columns), scene, one.free, output=folder, fmu=fmu
        )
    except InertiaModuleError:
        return Verdict(False, False, False, False, False)

    def contains(which):
        return [
            low <= TRUE[name] <= high for name in one.free for low, high in [getattr(result[name], which)]
        ]

    inside = contains("interval")
    unknown = "only ratios of" in " ".join(result.warnings) or all(
        ok or "not identifiable" in result[name].doubt for name, ok in zip(one.free, inside, strict=True)
    )
    names = {cause.name for cause in result.causes}
    named = bool(names & one.causes)
    return Verdict(
        all(inside),
        unknown and not all(inside),
        named,
        bool(names) and not named,
        all(contains("interval_if_exact")),
    )


def run(kind, sets, folder, fmu):
    """Judge data sets of a kind, 0 to SETS - 1."""
    true = data.true_speeds()
    return [verdict(kind, true, seed, folder, fmu) for seed in track(range(sets), kind.__name__)]


def main(sets=SETS, kinds=()):
    print(
        "kind | sets | correct | interval contains truth | not identifiable | cause named | only another cause | if exact"
    )
    with tempfile.TemporaryDirectory() as folder:
        fmu = current_fmu(folder=Path(folder))
        for kind in KINDS:
            if kinds and kind.__name__ not in kinds:
                continue
            verdicts = run(kind, sets, Path(folder), fmu)
            contained, unidentifiable, named, other, exact = np.sum(verdicts, axis=0).tolist()
            wrong = [seed for seed, one in enumerate(verdicts) if not one.is_correct]
            print(
                f"{kind.__name__} | {sets} | {sets - len(wrong)} | {contained} | {unidentifiable} | {named} | {other} |"
                f" {exact}  wrong: {wrong}",
                flush=True,
            )


if __name__ == "__main__":
    main(int(sys.argv[1]) if sys.argv[1:] else SETS, sys.argv[2:])
