"""Work-precision diagram: errors of fidelity levels and other integrators over their cost."""

from __future__ import annotations

import math
from collections.abc import Sequence

from matplotlib.figure import Figure

from ..common.colours import styled
from ..fidelity.rows import PEER, Row
from .panels import MAX_LINEAR_RATIO, new_figure

# label of a cost, and factor to its displayed unit
_AXES = {
    "wall_time": ("kernel time [ms per simulated second]", 1e3),
    "evaluations": ("right-hand-side evaluations", 1.0),
}


@styled()
def work_precision(rows: Sequence[Row], outputs: Sequence[str], title: str) -> Figure:
    """Draw the maximum error over run time and over right-hand-side evaluations.

    Axes are logarithmic; costs within a decade have a linear axis.

    Runs of the module are dots, runs of peers are crosses, in the colour of the level.

    Args:
        rows: Measured rows.
        outputs: Names of the outputs.
        title: Title of the figure.
    """
    levels: dict[str, list[Row]] = {}
    for row in rows:
        if 0.0 < row.max_error(outputs) < math.inf:
            name = row.method.partition(",")[0] if row.fidelity == PEER else row.level
            levels.setdefault(name, []).append(row)
    figure = new_figure(f"{title}: accuracy against run time", height=6.0)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, (cost, (label, factor)) in zip(panels, _AXES.items(), strict=True):
        for name, level in levels.items():
            costs, errors = (
                [factor * getattr(row, cost) for row in level],
                [row.max_error(outputs) for row in level],
            )
            axes.loglog(costs, errors, "x" if level[0].fidelity == PEER else "o", markersize=5, label=name)
        low, high = axes.dataLim.intervalx
        if high < MAX_LINEAR_RATIO * low:
            axes.set_xscale("linear")
        axes.set_xlabel(label)
    panels[0].set_ylabel("maximum relative error")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=6)
    return figure
