"""Values for docs/random.md: the committed counts of the random motions, and the bounds in the code."""

import csv
from itertools import groupby
from operator import itemgetter
from pathlib import Path

from verification.stability import random_motions, verdicts

HERE = Path(__file__).parent
# Count columns of the tables: all runs, and the groups beyond the plain bound.
COUNTS = "runs", "explained", "sensitive", "failed"


def bound_fraction(row):
    """Return the worst value of a row divided by its bound, -1 if there is no value."""
    return float(row["worst"]) / max(float(row["bound"]), 1e-300) if row["worst"] else -1.0


def table_rows(rows):
    """Yield a line for each invariant: the counts over all levels, and the run closest to its bound."""
    for name, group in groupby(sorted(rows, key=itemgetter("invariant")), itemgetter("invariant")):
        levels = list(group)
        worst = max(levels, key=bound_fraction)
        counts = (str(sum(int(row[column]) for row in levels)) for column in COUNTS)
        cells = (name, *counts, worst["worst"], worst["bound"], worst["level"], worst["number"])
        yield f"| {' | '.join(cells if worst['worst'] else (*cells[:5], '', '', '', ''))} |"


def totals(rows, reference):
    """Count motions drawn, rejected and failed, and the motions that agree with this reference."""

    def count(column, *invariants, levels=None):
        selected = (
            row for row in rows if row["invariant"] in invariants and (not levels or row["level"] in levels)
        )
        return sum(int(row[column]) for row in selected)

    compared = count("runs", reference)
    beyond = {column: count(column, reference) for column in COUNTS[1:]}
    levels = {row["level"] for row in rows if row["invariant"] == reference}
    counters = random_motions.COMPLETE, random_motions.ACCEPTED
    return {
        "drawn": count("runs", random_motions.ACCEPTED),
        "rejected": count("failed", random_motions.ACCEPTED),
        "failed": count("failed", *{row["invariant"] for row in rows}.difference(counters)),
        "compared": compared,
        "event_driven": count("runs", random_motions.ACCEPTED, levels=levels),
        "within": 1.0 - sum(beyond.values()) / compared,
        "beyond": ", ".join(f"{column}: {number}" for column, number in beyond.items()),
    }


def campaign(file, reference):
    """Return table and counts of a campaign that was compared with this reference."""
    rows = list(csv.DictReader((HERE / file).read_text().splitlines()))
    return {"rows": "\n".join(table_rows(rows)), **totals(rows, reference)}


def values():
    """Return the values of the template's placeholders."""
    with_losses = campaign("random_losses.csv", random_motions.VIRTUAL_WORK)
    return {
        **campaign("random.csv", random_motions.REFERENCE),
        **{f"losses_{name}": value for name, value in with_losses.items()},
        "losses_work": random_motions.MOST_WITH_LOSSES,
        "reference_tolerance": random_motions.REFERENCE_TOLERANCE,
        "reference_error": random_motions.REFERENCE_ERROR,
        "reference_work": random_motions.MOST_EVALUATIONS,
        "long": random_motions.LONGEST,
        "friction": random_motions.FRICTION_SHARE,
        "losses_share": random_motions.LOSS_SHARE,
        "engagement_share": random_motions.PLAY_SHARE,
        "explained": random_motions.EXPLAINED,
        "swinging": random_motions.SWINGING,
        "split": random_motions.SPLIT,
        "rounding": verdicts.ROUNDING,
        "of_fastest": random_motions.OF_FASTEST,
        "largest": verdicts.LARGEST_ERROR,
    }
