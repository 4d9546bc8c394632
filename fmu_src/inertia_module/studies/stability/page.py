"""docs/stability.md from the committed table of verdicts and the stated bounds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from ...kernel import limits
from . import bounds
from .axes import AXES
from .case import RUNGS
from .mechanisms import MECHANISMS
from .table import Cell, Row, reasons
from .verdict import BROKEN, EXACT, REFUSED, WORDS

HEAD = """\
# Stability at the extremes

Every extreme is tried on both layouts and on every rung of the ladder, with the compiled kernel. The verdicts below
are `docs/stability.csv`, written by `make stability`; this page is made from it and from the bounds in the code.
`inertia-module stability` prints the map, `-o DIR` writes it with every figure, `--quick` leaves out the long runs,
`--only AXIS` tries one axis.

![The map of verdicts](stability.png)

## What is tried

Each case runs five ways: in long communication steps, in many short ones over the same time with the same inputs, at
a tolerance 1e4 times tighter (at least {tightest:g}), and slightly changed: the angle at the start, the load and the
speed of link 1 by the tolerance, to both sides. How far the last ones end from the tight run is the sensitivity of the
motion itself: no method can do better than that. Accuracy is the tolerance for method `event`, {timestepping:g} for
`timestepping` (internal steps of {fixed_phase:g} rad of the highest harmonic), {averaged:g} for `averaged`.

## The bounds

| what | bound |
|---|---|
| every output | finite, at every communication point |
| energy residual, in long and in short steps | {energy:g} accuracy + {rounding:g}, at most {largest:g}, of the largest energy |
| long against short steps, and both against the tight run | {result:g} (accuracy + sensitivity) + {rounding:g}, at most {largest:g}, relative |
| ω2 ≥ 0, ω3 ≥ ω2, Tc ≥ 0, Th ≥ 0 | to {breach:g} of the largest speed or torque |
| right-hand sides | {step_work:g} for each communication step and {phase_work:g} tolerance^(-1/{order:g}) for each radian of the highest harmonic (`elastic`: and of the shaft); `timestepping`: {fixed_work:g} for each internal step |
| one communication step | {most:g} right-hand sides, then a refusal; the state is untouched and a good step goes on |

The largest energy is that of input, output and store in the run, or what the imbalances can have behind link 2 at the
fastest speed. Distances are relative to the fastest speed, the largest energy and impulse, and the angle gone through.
The bound on the residual is the same for one step and for thousands: a drift with the number of steps would show.

- **exact**: all bounds hold. **degraded**: finite, but a bound is missed; the cell says which.
- **sensitive**: all bounds hold but those on the distance between runs, and the sensitivity is above {largest:g}: the
  runs differ, and no method can tell which is right.
- **refused**: one message that names the value and what is allowed. Anything else, be it an exception, a hang or a
  number that is none, would be **broken**: a bug. There is none.
"""

FLOORS = """\
## Where double precision sets a floor

- **Speeds below 1e-150 rad/s count as none**: torques go with the square of the speed, and 1e-300 is about the least
  normal double. The motion scales exactly with the speed above it.
- **Tolerance**: internal steps are held to a tenth of the tolerance, but not below 1e-14. Tolerance 1e-13 is reached;
  what rounding adds over a run stays below the 1e-12 of the bounds.
- **A freewheel closes or opens within rounding**: a torque below 1e-13 of its scale and a velocity below 1e-14 of what
  link 2 and the shaft take on are zero. A load within 1e-13 of the stall torque may or may not release link 2; as the
  release is tangential, what follows differs by less than the bounds either way.
- **Angles**: whole turns are counted in a double of their own, exact to 9e15 turns. After 1e15 turns the motion is the
  same as after none. Angles themselves are held within one period, to 2e-16 of it and what compensated sums keep below.
- **The cusp, J2 = 0 and a = b**: the inertia behind link 2 goes through zero where the imbalance rests in link 1. Below
  1e-12 of its largest value it is refused: of the sum that makes it up less than four digits would be left. Above, link
  2 has spikes of speed as narrow as the square root of that ratio; steps are kept short enough to see them.
- **Communication steps**: sums are compensated, so steps of a nanosecond lose nothing. The longest steps are bounded by
  work, not by precision.
- **Method `timestepping`** is of first order: its floor is its step, not the double. Where the motion itself multiplies
  errors (heavy imbalances that throw a light link 2, hundreds of teeth) the fixed steps used here miss the bound.
  Steps far longer than the oscillation of an elastic shaft damp it away: half of its energy is gone without a loss.
- **Fast and long**: a step that takes more than the allowed right-hand sides is refused, so a billion turns of the drive
  take many steps.
"""


def _symbol(cell: Cell | None) -> str:
    if cell is None:
        return ""
    if cell.word == EXACT:
        return f"1e{cell.power:+03d}" if cell.power is not None else EXACT
    return f"**{cell.word}**" if cell.word != REFUSED else cell.word


def _axis(axis: str, rows: Sequence[Row]) -> Iterator[str]:
    columns = [rung.name for rung in RUNGS if any(rung.name in row.cells for row in rows)]
    yield f"### {axis[0].upper()}{axis[1:]}\n"
    yield f"{(AXES[axis].__doc__ or '').strip()}\n"
    yield f"| value | {' | '.join(columns)} |"
    yield f"|---|{'---|' * len(columns)}"
    layouts = [mechanism.layout for mechanism in MECHANISMS]
    values = list(dict.fromkeys(row.value for row in rows))
    for value in values:
        here = {row.layout: row for row in rows if row.value == value}
        cells = []
        for name in columns:
            found = [_symbol(here[layout].cells.get(name)) for layout in layouts if layout in here]
            cells.append(" / ".join(found) if len(set(found)) > 1 else found[0])
        note = f" ({next(iter(here))})" if len(here) == 1 else ""
        yield f"| {value}{note} | {' | '.join(cells)} |"
    yield ""
    yield from (f"- {line}" for line in reasons(rows))
    yield ""


def stability_page(rows: Sequence[Row]) -> str:
    """The page in Markdown.

    Args:
        rows: of read_rows, the committed verdicts.
    """
    from .trial import FIXED_PHASE, TIGHTEST

    counted = {rung.name: Counter[str]() for rung in RUNGS}
    for row in rows:
        for name, cell in row.cells.items():
            counted[name][cell.word] += 1
    words = [word for word in WORDS if word != BROKEN or any(count[BROKEN] for count in counted.values())]
    lines = [
        HEAD.format(
            tightest=TIGHTEST,
            timestepping=bounds.TIMESTEPPING_ACCURACY,
            averaged=bounds.AVERAGED_ACCURACY,
            energy=bounds.ENERGY_TOLERANCES,
            rounding=bounds.ROUNDING,
            result=bounds.RESULT_ACCURACIES,
            largest=bounds.LARGEST_ERROR,
            breach=bounds.BREACH,
            step_work=bounds.STEP_WORK,
            phase_work=bounds.PHASE_WORK,
            order=bounds.WORK_ORDER,
            fixed_work=bounds.FIXED_STEP_WORK,
            fixed_phase=FIXED_PHASE,
            most=limits.MAX_EVALUATIONS,
        ),
        "## The verdicts, counted\n",
        f"| rung | {' | '.join(words)} |",
        f"|---|{'---|' * len(words)}",
        *(
            f"| {name} | {' | '.join(str(count[word]) for word in words)} |"
            for name, count in counted.items()
        ),
        "",
        FLOORS,
        "## The map\n",
        "A cell gives the power of ten below which all relative errors of an exact case stayed (energy residual, long",
        "against short steps, against the tight run), or the verdict; bevel / planar where they differ.\n",
    ]
    for axis in AXES:
        lines += _axis(axis, [row for row in rows if row.axis == axis])
    return "\n".join(lines).rstrip() + "\n"
