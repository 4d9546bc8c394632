"""Verdicts of a fit on measurements that are right, and on those that are not as the scene has it.

The measurements are those of examples/fit_rig.csv with other seeds: as they are, and with an offset of a sensor,
a shift of the clock or of a sensor, a loss that is not modelled, numbers of one column or both in another
unit. The search begins at the values of examples/fit_rig.toml. Run: python -m studies.benchmarks.fit
"""

import tempfile
from pathlib import Path

import numpy as np
from rich.progress import track

from inertia_module import example, jobs
from inertia_module.common.errors import Refused
from inertia_module.fmu.builder import current_fmu
from inertia_module.harness.results import write_columns
from inertia_module.scene import load_scene
from studies import fit_rig_data as data

SETS = 100
FREE = ("imbalance_mass", "link2_inertia")
COLUMNS = [f"{name} [rpm]" for name in data.NOISE]
TIME = "time [ms]"
# losses, least and greatest
LOSSES = {"link2_friction": (0.01, 0.1), "output_friction": (0.01, 0.1), "mesh_efficiency": (0.9, 0.99)}
UNITS = {"rad/s": np.pi / 30.0, "deg/s": 6.0}


def as_it_is(true, seed, _):
    """Nothing is wrong: no cause is to be named."""
    return data.measured(true, seed), set()


def offset(true, seed, chance):
    """A sensor is off by 1 to 20 rpm."""
    columns, name = data.measured(true, seed), chance.choice(COLUMNS)
    columns[name] = columns[name] + chance.choice([-1.0, 1.0]) * chance.uniform(1.0, 20.0)
    return columns, {f"offset.{name.split()[0]}"}


def shift(true, seed, chance):
    """The clock of the file is off by 0.5 to 5 ms."""
    columns = data.measured(true, seed)
    late = chance.choice([-1.0, 1.0]) * chance.uniform(0.5, 5.0)
    kept = columns[TIME] + late >= 0.0
    columns[TIME] = columns[TIME] + late
    return {name: values[kept] for name, values in columns.items()}, {"shift.time"}


def friction(_, seed, chance):
    """The machine has a loss that the scene has not."""
    name = chance.choice(list(LOSSES))
    true = data.true_speeds(**{name: chance.uniform(*LOSSES[name])})
    return data.measured(true, seed), {f"mechanism.{name}"}


def unit(true, seed, chance):
    """Numbers of one column or both are in another unit than their heading says."""
    columns, other = data.measured(true, seed), chance.choice(list(UNITS))
    wrong = [COLUMNS, COLUMNS[:1], COLUMNS[1:]][chance.integers(3)]
    for name in wrong:
        columns[name] = columns[name] * UNITS[other]
    return columns, {f"in {other}, not in"}


KINDS = (as_it_is, offset, shift, friction, unit)


def told(kind, true, seed, scene, folder, fmu):
    """Tell of a set if the intervals hold the truth, the cause is named, or another; if the narrow ones do."""
    columns, causes = kind(true, seed, np.random.default_rng([seed, KINDS.index(kind)]))
    try:
        found = jobs.fit(write_columns(folder / "measured.csv", columns), scene, FREE, output=folder, fmu=fmu)
    except Refused as refused:
        return False, any(cause in str(refused) for cause in causes), False, False

    def hold(which):
        ends = [getattr(found[name], which) for name in FREE]
        return all(low <= data.TRUE[name] <= high for name, (low, high) in zip(FREE, ends, strict=True))

    names = {one.name for one in found.causes}
    named = bool(names & causes) or any(cause in line for cause in causes for line in found.warnings)
    return hold("interval"), named, bool(names) and not named, hold("narrow")


def main():
    scene, true = load_scene(example("fit_rig")).replaced(run={"stop_time": 0.6}), data.true_speeds()
    with tempfile.TemporaryDirectory() as folder:
        fmu = current_fmu(folder=Path(folder))
        for kind in KINDS:
            rows = [
                told(kind, true, seed, scene, Path(folder), fmu) for seed in track(range(SETS), kind.__name__)
            ]
            holds, named, other, narrow = np.sum(rows, axis=0)
            neither = [seed for seed, row in enumerate(rows) if not (row[0] or row[1])]
            print(
                f"{kind.__name__}: of {SETS} sets the intervals hold the truth in {holds}, the cause is named in"
                f" {named}, either in {SETS - len(neither)} (not in {neither}); only another cause is named in {other}; if"
                f" all else is right they hold it in {narrow}",
                flush=True,
            )


if __name__ == "__main__":
    main()
