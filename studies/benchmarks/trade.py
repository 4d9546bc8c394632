"""The trade of speed for accuracy, written into docs/tradeoff_*.csv and a plot.

`inertia-module tradeoff SCENE` measures a scene alike.
"""

from pathlib import Path

from inertia_module.fidelity.plots import work_precision
from inertia_module.fidelity.rows import write_rows
from inertia_module.fidelity.trials import trial_rows
from inertia_module.harness.results import write_figure
from inertia_module.harness.simulate import progress_bar
from inertia_module.scene import load_scene
from studies.benchmarks.figures import DOCS
from studies.peers import PEERS
from studies.reference.open_loop import R1, R1_ELASTIC, open_study

SCENE = Path(__file__).parents[2] / "examples" / "urban.toml"


def main():
    with progress_bar("scene R1 and the peers") as progress:
        rigid = open_study(R1, "Scene R1", PEERS, progress)
    with progress_bar("scene R1 with an elastic output") as progress:
        elastic = open_study(R1_ELASTIC, "Scene R1, elastic", (), progress)
    with progress_bar("urban scene") as progress:
        urban = trial_rows(load_scene(SCENE), progress)
    write_rows(DOCS / "tradeoff_r1.csv", rigid.rows)
    write_rows(DOCS / "tradeoff_elastic.csv", elastic.rows)
    write_rows(DOCS / "tradeoff_urban.csv", urban)
    write_figure(DOCS / "tradeoff_r1.png", work_precision(rigid.rows, rigid.plotted, rigid.title))
    print("\n".join([*rigid.closing_lines(None), *elastic.closing_lines(None)]))


if __name__ == "__main__":
    main()
