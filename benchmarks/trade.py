"""Measures the trade of speed for accuracy; writes its part and its plots into docs/performance.md.

Run: python benchmarks/trade.py
"""

import math
import os
import platform
from pathlib import Path

import averaged
import averaged_by_torque

from inertia_module.drive import progress_bar
from inertia_module.results import write_figure, write_text
from inertia_module.scene import load_scene
from inertia_module.studies import tradeoff
from inertia_module.studies.choice import NoneMeets, recommend
from inertia_module.studies.errors import MEASURES
from inertia_module.studies.peers import PEERS
from inertia_module.studies.plots import all_errors, curves, work_precision
from inertia_module.studies.report import failure_lines, markdown_table
from inertia_module.studies.trials import trial_rows

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGE = DOCS / "performance.md"
HEADING = "## The trade of speed for accuracy"
LEVELS = (1e-2, 1e-4, 1e-6)
SCENES = {"examples/urban.toml": (0.01, ((), ("imbalance_acceleration",)))}


def kept_part(page=PAGE):
    """The part of the page that this file writes, for the other that rewrites the rest."""
    _, found, part = page.read_text().partition(HEADING) if page.exists() else ("", "", "")
    return found + part


def number(value):
    return "-" if not math.isfinite(value) else f"{value:.3g}"


def levels_table(rows, error):
    """For each curve the cheapest run within each level, ms per simulated second; else its best error."""
    heads = [f"within {level:.0e}" for level in LEVELS]
    lines = [
        f"| ms per simulated second | {' | '.join(heads)} | best error |",
        f"|{'---|' * (len(heads) + 2)}",
    ]
    for name, curve in curves(rows).items():
        known = [row for row in curve if row.errors[error] >= 0.0]
        if not known:
            continue
        cells = []
        for level in LEVELS:
            times = [row.wall_time for row in known if row.errors[error] <= level]
            cells.append(number(1e3 * min(times)) if times else "never")
        best = min(row.errors[error] for row in known)
        lines.append(f"| {name} | {' | '.join(cells)} | {best:.1e} |")
    return lines


def ratio_lines(rows, error):
    """How the best peer compares with the module at each level."""
    for level in LEVELS:
        ours, peers = (
            [row for row in rows if row.errors.get(error, math.nan) <= level and (row.rung == "peer") is peer]
            for peer in (False, True)
        )
        if not ours:
            continue
        best = min(ours, key=lambda row: row.wall_time)
        if peers:
            other = min(peers, key=lambda row: row.wall_time)
            yield (
                f"- Within {level:.0e}: {other.label} takes {other.wall_time / best.wall_time:.0f} times as long"
                f" as {best.label}."
            )
        else:
            yield f"- Within {level:.0e}: no peer gets there; {best.label} does."


def case_part(title, stem, study):
    """Lines and plots of an open-loop case."""
    error = study.plotted
    write_figure(DOCS / f"{stem}.png", work_precision(study.rows, error, title))
    write_figure(DOCS / f"{stem}_errors.png", all_errors(study.rows, study.names, title))
    return [
        f"### {title}",
        "",
        *(
            f"{line[0].upper()}{line[1:]}.\n"
            for line in tradeoff.closing_lines(study, None)
            if "failed" not in line
        ),
        f"![error against cost]({stem}.png)",
        "",
        f"![all errors against wall time]({stem}_errors.png)",
        "",
        f"The cheapest run within an error in `{error}`:",
        "",
        *levels_table(study.rows, error),
        "",
        *ratio_lines(study.rows, error),
        "",
        "All runs:",
        "",
        *markdown_table(study.rows, study.names),
        "",
        *(f"- {line}" for line in failure_lines(study.rows)),
        "",
    ]


def scene_part(name, error, additions):
    """What `fidelity = "auto"` chooses for a scene."""
    lines = [f"### {name} under `auto` with an error of {100 * error:g} %", ""]
    for more in additions:
        scene = load_scene(ROOT / name)
        scene = scene.replaced(run={"outputs": [*scene.run.outputs, *more]})
        with progress_bar(name) as progress:
            rows = trial_rows(scene, progress)
        lines += [f"Wanted: {', '.join(f'`{output}`' for output in scene.run.outputs)}.", ""]
        try:
            lines += [f"- {line}" for line in recommend(rows, error, scene.run.outputs).lines()]
        except NoneMeets as reason:
            lines.append(f"- {reason}")
        lines.append("")
    return lines


def trade_part():
    """The lines of the part."""
    with progress_bar("scene R1 and the peers") as progress:
        rigid = tradeoff.open_study(tradeoff.R1, "Scene R1", PEERS, progress)
    with progress_bar("scene R1 with an elastic output") as progress:
        elastic = tradeoff.open_study(tradeoff.R1_ELASTIC, "Scene R1, elastic", (), progress)
    return [
        HEADING,
        "",
        "Printed by `make bench` (`python benchmarks/trade.py`) on"
        f" {os.cpu_count()} cores, Python {platform.python_version()}.",
        "`inertia-module tradeoff` measures the same. The errors, against the converged reference:",
        "",
        *(f"- `{name}`: {text}{f', {unit}' if unit else ''}" for name, (text, unit) in MEASURES.items()),
        "",
        *case_part("Scene R1, the ladder and its peers", "tradeoff_r1", rigid),
        *case_part("Scene R1 behind an elastic output shaft", "tradeoff_elastic", elastic),
        *(line for name, asked in SCENES.items() for line in scene_part(name, *asked)),
        "### Kernel time of averaged against rigid",
        "",
        "The drive and load of the urban scene, recorded, played to the compiled kernel in a compiled loop.",
        "",
        *averaged.lines(averaged.rows()),
        "",
        "### Averaged against rigid, driven by torque",
        "",
        *averaged_by_torque.lines(),
    ]


def main():
    lines = trade_part()
    before, _, _ = PAGE.read_text().partition(HEADING)
    write_text(PAGE, before.rstrip() + "\n\n" + "\n".join(lines).rstrip() + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
