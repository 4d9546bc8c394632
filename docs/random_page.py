"""Figures of docs/random.md: the committed counts of the random motions, and the bounds in the code."""

import csv
from itertools import groupby
from operator import itemgetter
from pathlib import Path

from studies.stability import random_motions, verdicts

HERE = Path(__file__).parent
# columns of the table of random motions: all runs, and of them those beyond the bound asked for
COUNTS = "runs", "explained", "sensitive", "failed"


def share(row):
    """How much of its bound the worst value has, -1 where there is none."""
    return float(row["worst"]) / max(float(row["bound"]), 1e-300) if row["worst"] else -1.0


def random_rows(rows):
    """A line for each invariant of the random motions: counts over all levels, and the worst of them."""
    for name, group in groupby(sorted(rows, key=itemgetter("invariant")), itemgetter("invariant")):
        found = list(group)
        worst = max(found, key=share)
        counts = (str(sum(int(row[head]) for row in found)) for head in COUNTS)
        cells = (name, *counts, worst["worst"], worst["bound"], worst["level"], worst["number"])
        yield f"| {' | '.join(cells if worst['worst'] else (*cells[:5], '', '', '', ''))} |"


def random_counts(rows, reference):
    """What the motions count to: tried, refused, and those within the error of this reference."""

    def count(head, *invariants, levels=None):
        chosen = (
            row for row in rows if row["invariant"] in invariants and (not levels or row["level"] in levels)
        )
        return sum(int(row[head]) for row in chosen)

    compared = count("runs", reference)
    beyond = {head: count(head, reference) for head in COUNTS[1:]}
    levels = {row["level"] for row in rows if row["invariant"] == reference}
    counters = random_motions.SHORT, random_motions.TAKEN
    return {
        "drawn": count("runs", random_motions.TAKEN),
        "refused": count("failed", random_motions.TAKEN),
        "failed": count("failed", *{row["invariant"] for row in rows}.difference(counters)),
        "compared": compared,
        "by_events": count("runs", random_motions.TAKEN, levels=levels),
        "within": 1.0 - sum(beyond.values()) / compared,
        "beyond": ", ".join(f"{head}: {number}" for head, number in beyond.items()),
    }


def of_campaign(file, reference):
    """Table and counts of a campaign, held to this reference."""
    drawn = list(csv.DictReader((HERE / file).read_text().splitlines()))
    return {"rows": "\n".join(random_rows(drawn)), **random_counts(drawn, reference)}


def values():
    """What the template has places for."""
    lossy = of_campaign("random_losses.csv", random_motions.VIRTUAL_WORK)
    return {
        **of_campaign("random.csv", random_motions.REFERENCE),
        **{f"losses_{name}": value for name, value in lossy.items()},
        "losses_work": random_motions.MOST_WITH_LOSSES,
        "reference_tolerance": random_motions.REFERENCE_TOLERANCE,
        "reference_error": random_motions.REFERENCE_ERROR,
        "reference_work": random_motions.MOST_EVALUATIONS,
        "long": random_motions.LONGEST,
        "friction": random_motions.FRICTION_SHARE,
        "losses_share": random_motions.LOSS_SHARE,
        "play_share": random_motions.PLAY_SHARE,
        "explained": random_motions.EXPLAINED,
        "swinging": random_motions.SWINGING,
        "split": random_motions.SPLIT,
        "rounding": verdicts.ROUNDING,
        "of_fastest": random_motions.OF_FASTEST,
        "largest": verdicts.LARGEST_ERROR,
    }
