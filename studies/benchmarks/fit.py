"""How often the 95 % intervals of a fit hold the truth: 100 measurements that differ in their noise alone.

The measurements are those of examples/fit_rig.csv with other seeds; the search begins at the values of
examples/fit_rig.toml. Run: python -m studies.benchmarks.fit [SETS]
"""

import sys
import tempfile
from pathlib import Path

from rich.progress import track

from inertia_module import jobs
from inertia_module.fmu.builder import current_fmu
from inertia_module.harness.results import write_columns
from inertia_module.scene import load_scene
from studies import fit_rig_data as data

EXAMPLES = Path(__file__).parents[2] / "examples"
SETS = 100
FREE = ("imbalance_mass", "link2_inertia")


def held(sets, folder):
    """Tell of each set whether the interval of each free key holds the truth."""
    true, scene, fmu = data.true_speeds(), load_scene(EXAMPLES / "fit_rig.toml"), current_fmu(folder=folder)
    rows = []
    for seed in track(range(sets), "fitting"):
        file = write_columns(folder / "measured.csv", data.measured(true, seed))
        found = jobs.fit(file, scene, FREE, output=folder, fmu=fmu)
        intervals = [found[name].interval for name in FREE]
        rows.append(
            [low <= data.TRUE[name] <= high for name, (low, high) in zip(FREE, intervals, strict=True)]
        )
    return rows


def main():
    sets = int(sys.argv[1]) if len(sys.argv) > 1 else SETS
    with tempfile.TemporaryDirectory() as folder:
        rows = held(sets, Path(folder))
    for place, name in enumerate(FREE):
        print(f"{name}: the interval holds the truth in {sum(row[place] for row in rows)} of {sets} sets")
    print(f"both: in {sum(map(all, rows))} of {sets}")


if __name__ == "__main__":
    main()
