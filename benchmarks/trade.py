"""Measure accuracy and run time of all levels and peers; write their tables and a diagram."""

from benchmarks.peers import PEERS
from benchmarks.results_table import DOCS
from benchmarks.trade_off import R1, R1_ELASTIC, converged, measure
from inertia_module.common.examples import example
from inertia_module.fidelity.measure import trial_rows
from inertia_module.fidelity.rows import failure_lines, write_rows
from inertia_module.fmi.results import write_figure
from inertia_module.fmi.simulate import progress_bar
from inertia_module.plots.fidelity import work_precision
from inertia_module.scene import load_scene


def main():
    """Measure R1, R1 with an elastic shaft and the urban scene, and write the tables and the diagram."""
    with progress_bar("scene R1 and the peers") as progress:
        rigid = measure(R1, converged(R1), peers=PEERS, progress=progress)
    with progress_bar("scene R1 with an elastic output") as progress:
        elastic = measure(R1_ELASTIC, converged(R1_ELASTIC), progress=progress)
    with progress_bar("urban scene") as progress:
        urban = trial_rows(load_scene(example("urban")), progress)
    write_rows(DOCS / "tradeoff_r1.csv", rigid)
    write_rows(DOCS / "tradeoff_elastic.csv", elastic)
    write_rows(DOCS / "tradeoff_urban.csv", urban)
    write_figure(DOCS / "tradeoff_r1.png", work_precision(rigid, ["omega_out_worst"], "Scene R1"))
    print("\n".join(failure_lines([*rigid, *elastic])))


if __name__ == "__main__":
    main()
