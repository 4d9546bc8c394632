"""Draw docs/verification/stability.png: the verdicts on extremes and random machines by fidelity level."""

from collections import Counter
from pathlib import Path

from matplotlib.patches import Patch
from stability_page import extreme_rows, machine_rows

from inertia_module.common.colours import BLUE, GREEN, ORANGE, VERMILION, Picture, styled
from verification.stability.motion import LEVELS
from verification.stability.verdicts import BROKEN, DEGRADED, EXACT, REJECTED, SENSITIVE

PICTURE = Path(__file__).parent / "verification" / "stability.png"
COLOURS = {EXACT: GREEN, SENSITIVE: BLUE, DEGRADED: ORANGE, REJECTED: "#BBBBBB", BROKEN: VERMILION}
NAMES = [level.name for level in LEVELS]


def outcomes():
    """Return the outcomes by name of the row and fidelity level."""
    table = {}
    for row in extreme_rows():
        for level, cell in row.cells.items():
            table.setdefault(row.axis, {}).setdefault(level, []).append(cell.outcome)
    for row in machine_rows():
        table.setdefault("random machines", {}).setdefault(row.level, []).append(row.verdict)
    return table


@styled()
def picture():
    """Return the figure: a bar for each row and level, divided by verdicts."""
    table = outcomes()
    figure = Picture(figsize=(8.5, 1.0 + 0.24 * len(table)), dpi=120, layout="constrained")
    axes = figure.subplots()
    for y, levels in enumerate(table.values()):
        for level, results in levels.items():
            x, count, left = NAMES.index(level), Counter(results), 0.03
            for outcome, colour in COLOURS.items():
                width = 0.94 * count[outcome] / len(results)
                axes.barh(y, width, left=x + left, color=colour, height=0.84)
                left += width
            label = f"{count[EXACT]} of {len(results)}"
            axes.text(x + 0.5, y, label, ha="center", va="center", fontsize=6.5)
    axes.set_xlim(0, len(NAMES))
    axes.set_ylim(len(table) - 0.5, -0.5)
    axes.set_xticks([x + 0.5 for x in range(len(NAMES))], NAMES)
    axes.set_yticks(range(len(table)), list(table))
    axes.xaxis.tick_top()
    axes.tick_params(length=0, labelsize=8)
    axes.spines[:].set_visible(False)
    axes.grid(visible=False)
    drawn = {name for levels in table.values() for results in levels.values() for name in results}
    handles = [Patch(color=colour, label=name) for name, colour in COLOURS.items() if name in drawn]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure


if __name__ == "__main__":
    picture().savefig(PICTURE)
    print(f"wrote {PICTURE}")
