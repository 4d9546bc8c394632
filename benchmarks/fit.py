"""Reliability of fits: ten kinds of data sets with known true values.

The data sets resemble examples/fit_rig.csv with other seeds. They come from the independent reference. A fit
is correct if the intervals of all free keys contain the true values, if it reports that they are not
identifiable, or if it names the cause. Run: python -m benchmarks.fit [SETS [KIND ...]]
"""

import functools
import sys
import tempfile
from collections.abc import Mapping
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

N_SETS = 100
FREE = {"imbalance_mass": None, "link2_inertia": None}
COLUMNS = [f"{name} [rpm]" for name in data.NOISE]
TIME = "time [ms]"
# ranges of the losses
LOSSES = {"link2_friction": (0.01, 0.1), "output_friction": (0.01, 0.1), "mesh_efficiency": (0.9, 0.99)}
# ranges of keys; the data determine only their ratios
ALL_MASSES = {
    "imbalance_mass": (0.5, 20.0),
    "output_inertia": (0.2, 10.0),
    "load.torque": (2.0, 300.0),
    "link2_inertia": (0.001, 0.2),
}
COLLINEAR = {"imbalance_mass": (0.5, 2.0), "output_inertia": (0.2, 1.0), "load.torque": (2.0, 30.0)}
TRUE = {**data.TRUE, "load.torque": data.LOAD_TORQUE}
# encoder: counts per revolution, and length of the counting window, s
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


class DataSet(NamedTuple):
    """Data set of a kind.

    Attributes:
        columns: Columns of the measurement file, by heading.
        causes: Names of the causes that a correct fit may report.
        free: Free keys of the fit, or their ranges by key.
        changes: Values that replace values of the scene, by key.
    """

    columns: dict[str, np.ndarray]
    causes: frozenset[str] = frozenset()
    free: object = FREE
    changes: Mapping[str, object] = MappingProxyType({})


def complete_scene(true, seed, _):
    """Make a data set of the machine that the scene describes."""
    return DataSet(data.measured(true, seed))


def offset(true, seed, random):
    """Make a data set in which one sensor has an offset of 1 to 20 rpm."""
    columns, name = data.measured(true, seed), random.choice(COLUMNS)
    columns[name] = columns[name] + random.choice([-1.0, 1.0]) * random.uniform(1.0, 20.0)
    return DataSet(columns, frozenset({f"offset.{name.split()[0]}"}))


def clock_shift(true, seed, random):
    """Make a data set with times shifted by 0.5 to 5 ms."""
    columns = data.measured(true, seed)
    delay = random.choice([-1.0, 1.0]) * random.uniform(0.5, 5.0)
    rows = columns[TIME] + delay >= 0.0
    columns[TIME] = columns[TIME] + delay
    return DataSet({name: values[rows] for name, values in columns.items()}, frozenset({"shift.time"}))


def gain(true, seed, random):
    """Make a data set in which the gain of one sensor is 2 to 20 % too large or too small."""
    columns, name = data.measured(true, seed), random.choice(COLUMNS)
    columns[name] = columns[name] * (1.0 + random.choice([-1.0, 1.0]) * random.uniform(0.02, 0.2))
    return DataSet(columns, frozenset({f"gain.{name.split()[0]}"}))


def unmodelled_friction(_, seed, random):
    """Make a data set of a machine with a loss that the scene lacks."""
    name = random.choice(list(LOSSES))
    true = data.true_speeds(**{name: random.uniform(*LOSSES[name])})
    return DataSet(data.measured(true, seed), frozenset({f"mechanism.{name}"}))


def wrong_radius(_, seed, random):
    """Make a data set of a planar machine whose sun gear is 1 to 4 % larger or smaller than in the scene."""
    factor = 1.0 + random.choice([-1.0, 1.0]) * random.uniform(0.01, 0.04)
    actual = {"layout": 1.0, "sun_radius": factor * PLANAR["sun_radius"]}
    true = data.true_speeds(**PLANAR | actual)
    nominal = {**PLANAR, "imbalance_mass": 1.0, "link2_inertia": 0.005}
    changes = {f"mechanism.{name}": value for name, value in nominal.items()}
    return DataSet(data.measured(true, seed), frozenset({"mechanism.sun_radius"}), FREE, changes)


def degenerate(true, seed, _):
    """Make a data set with free masses and load: only ratios are determined, so searches end at a bound."""
    return DataSet(data.measured(true, seed), free=ALL_MASSES)


def collinear(true, seed, _):
    """Make a data set with three nearly collinear free keys and a wrong inertia that scales them."""
    return DataSet(data.measured(true, seed), frozenset({"mechanism.link2_inertia"}), COLLINEAR)


@functools.cache
def true_angles():
    """Return times, s, and the angles of link 2 and of the output shaft, rad, by quadrature of the speeds."""
    motion, speeds = Reference(data.TRUE, data.OMEGA1, data.LOAD_TORQUE), []
    times = QUADRATURE_STEP * np.arange(round(data.TIMES[-1] / QUADRATURE_STEP) + 1)
    for time in times:
        motion.advance(time)
        speeds.append(motion.state[[OMEGA2, OMEGA3]])
    return times, cumulative_trapezoid(speeds, times, axis=0, initial=0.0)


def counted_encoder(_, seed, random):
    """Make a data set of speeds counted over 2 ms, which are quantised, averaged and 1 ms late."""
    (fine_times, angles), times = true_angles(), data.TIMES[data.TIMES >= WINDOW]
    columns = {TIME: np.round(1e3 * times, 3)}
    for name, angle in zip(COLUMNS, angles.T, strict=True):
        counts = COUNTS / (2.0 * np.pi) * angle + random.uniform()
        ends, begins = (np.floor(np.interp(edges, fine_times, counts)) for edges in (times, times - WINDOW))
        columns[name] = 60.0 / (COUNTS * WINDOW) * (ends - begins)
    return DataSet(columns, frozenset({"shift.time", "shift.omega2", "shift.omega_out"}))


def missing_rows(true, seed, random):
    """Make a data set without 30 % of the rows."""
    columns = data.measured(true, seed)
    rows = random.uniform(size=data.TIMES.size) > 0.3
    return DataSet({name: values[rows] for name, values in columns.items()})


KINDS = (
    complete_scene,
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
    """Verdict on a fit.

    Attributes:
        contains_truth: All intervals contain the true values.
        reports_unidentifiable: The fit reports that the other keys are not identifiable.
        reports_cause: The fit reports a correct cause.
        reports_other_cause: The fit reports only other causes.
        contains_truth_if_exact: All intervals that assume an exact model contain the true values.
    """

    contains_truth: bool
    reports_unidentifiable: bool
    reports_cause: bool
    reports_other_cause: bool
    contains_truth_if_exact: bool

    @property
    def is_correct(self):
        """Return True if the fit is right or reports that it can be wrong."""
        return self.contains_truth or self.reports_unidentifiable or self.reports_cause


def verdict(kind, true, seed, folder, fmu):
    """Fit a data set and judge the result.

    Args:
        kind: Function that makes the data set.
        true: Exact speeds of the nominal machine, rad/s, by name.
        seed: Number of the data set.
        folder: Folder to write into.
        fmu: FMU to run.
    """
    data = kind(true, seed, np.random.default_rng([seed, KINDS.index(kind)]))
    scene = load_scene(example("fit_rig")).replaced(run={"stop_time": 0.6}).with_keys(data.changes)
    try:
        result = studies.fit(
            write_columns(folder / "measured.csv", data.columns), scene, data.free, output=folder, fmu=fmu
        )
    except InertiaModuleError:
        return Verdict(False, False, False, False, False)

    def contains(interval):
        pairs = [(name, *getattr(result[name], interval)) for name in data.free]
        return [low <= TRUE[name] <= high for name, low, high in pairs]

    inside = contains("interval")
    is_unidentifiable = "only ratios of" in " ".join(result.warnings) or all(
        ok or "not identifiable" in result[name].doubt for name, ok in zip(data.free, inside, strict=True)
    )
    names = {cause.name for cause in result.causes}
    reports_cause = bool(names & data.causes)
    return Verdict(
        all(inside),
        is_unidentifiable and not all(inside),
        reports_cause,
        bool(names) and not reports_cause,
        all(contains("interval_if_exact")),
    )


def run(kind, sets, folder, fmu):
    """Judge data sets 0 to sets - 1 of a kind.

    Args:
        kind: Function that makes a data set.
        sets: Number of data sets.
        folder: Folder to write into.
        fmu: FMU to run.
    """
    true = data.true_speeds()
    return [verdict(kind, true, seed, folder, fmu) for seed in track(range(sets), kind.__name__)]


def main(sets=N_SETS, kinds=()):
    """Judge data sets and print a line for each kind.

    Args:
        sets: Number of data sets of each kind.
        kinds: Names of the kinds; () for all.
    """
    headings = ("kind", "sets", "correct", "interval contains truth", "not identifiable")
    print(" | ".join((*headings, "cause named", "only another cause", "interval if exact")))
    with tempfile.TemporaryDirectory() as folder:
        fmu = current_fmu(folder=Path(folder))
        for kind in KINDS:
            if kinds and kind.__name__ not in kinds:
                continue
            verdicts = run(kind, sets, Path(folder), fmu)
            contains_truth, reports_unidentifiable, reports_cause, other, exact = np.sum(
                verdicts, axis=0
            ).tolist()
            wrong = [seed for seed, result in enumerate(verdicts) if not result.is_correct]
            print(
                f"{kind.__name__} | {sets} | {sets - len(wrong)} | {contains_truth} |"
                f" {reports_unidentifiable} | {reports_cause} | {other} | {exact}  wrong: {wrong}",
                flush=True,
            )


if __name__ == "__main__":
    main(int(sys.argv[1]) if sys.argv[1:] else N_SETS, sys.argv[2:])
