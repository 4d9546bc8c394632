"""The trade of speed for accuracy, written into docs/tradeoff_*.csv and a plot.

`inertia-module tradeoff` measures the same. Run: python benchmarks/trade.py
"""

from pathlib import Path

from figures import DOCS

from inertia_module.harness.results import write_figure
from inertia_module.harness.simulate import progress_bar
from inertia_module.scene import load_scene
from inertia_module.studies import tradeoff
from inertia_module.studies.peers import PEERS
from inertia_module.studies.plots import work_precision
from inertia_module.studies.rows import write_rows
from inertia_module.studies.trials import trial_rows

SCENE = Path(__file__).parents[1] / "examples" / "urban.toml"


def main():
    with progress_bar("scene R1 and the peers") as progress:
        rigid = tradeoff.open_study(tradeoff.R1, "Scene R1", PEERS, progress)
    with progress_bar("scene R1 with an elastic output") as progress:
        elastic = tradeoff.open_study(tradeoff.R1_ELASTIC, "Scene R1, elastic", (), progress)
    with progress_bar("urban scene") as progress:
        urban = trial_rows(load_scene(SCENE), progress)
    write_rows(DOCS / "tradeoff_r1.csv", rigid.rows)
    write_rows(DOCS / "tradeoff_elastic.csv", elastic.rows)
    write_rows(DOCS / "tradeoff_urban.csv", urban)
    write_figure(DOCS / "tradeoff_r1.png", work_precision(rigid.rows, rigid.plotted, rigid.title))
    print("\n".join([*rigid.closing_lines(None), *elastic.closing_lines(None)]))


if __name__ == "__main__":
    main()
