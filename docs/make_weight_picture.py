"""Write docs/explanation/weight.csv and .png: changes caused by gravity and by satellite inertia."""

import csv
import math
from pathlib import Path

import numpy as np

from inertia_module.common.colours import BLACK, BLUE, GREEN, VERMILION, Picture, styled
from inertia_module.model import Module

HERE = Path(__file__).parent / "explanation"
PICTURE, TABLE = HERE / "weight.png", HERE / "weight.csv"
SPEEDS = np.geomspace(10.0, 300.0, 19)
RATIOS = (0.2, 0.5, 0.8)
GRAVITY, INERTIA = "gravity", "satellite inertia"
# without gravity and friction all four scale with omega1 squared
QUANTITIES = ("mean torque", "ripple", "peak torque", "bearing force")
READ = ("output_torque_mean", "torque_ripple", "torque_peak", "satellite_force_peak")
COLOURS = (BLUE, GREEN, VERMILION, BLACK)
# revolutions of the pinion shaft with link 2 at rest: to settle, to evaluate; steps per revolution
SETTLING_TURNS, TURNS, PARTS = 1000, 600, 40
# output inertia that keeps the speed of the shaft constant, kg m^2
HELD = 1e5
SMALL = 0.01


def disc(radius, width=0.015):
    """Return the inertias of a steel disc with the pitch radius, m: m r^2/2, m r^2/4 + m w^2/12."""
    mass = 7850.0 * math.pi * radius**2 * width
    across = mass * (radius**2 / 4.0 + width**2 / 12.0)
    return {"satellite_inertia": mass * radius**2 / 2.0, "satellite_transverse_inertia": across}


# scene R1, z6 = 20 on z17 = 34 of 80 mm, and the planar module of the defaults; one satellite each
MECHANISMS = {"R1": ({}, disc(0.08 * 20 / 34)), "planar": ({"layout": "planar"}, disc(0.03))}


def measured(omega1, ratio, **parameters):
    """Return the four quantities over omega1 squared, at an input speed, rad/s, and a fixed speed ratio."""
    load = 0.0
    for _ in range(2):  # the mean torque of the first run is the load of the second, which holds the speed
        start = {"omega1": omega1, "load_torque": load, "omega_out_start": ratio * omega1}
        module = Module().start(**start, output_inertia=HELD, **parameters)
        turn = 2.0 * math.pi / (module.derived.k * omega1)
        module.advance(SETTLING_TURNS * turn)
        load = module["output_torque_mean"]
    samples = np.empty((TURNS * PARTS, len(READ)))
    for row in samples:
        module.advance(turn / PARTS)
        row[:] = module.read(READ)
    mean, ripple, peak, force = samples.T
    about_mean = math.sqrt(np.mean(ripple**2 + mean**2) - mean.mean() ** 2)
    return np.array([mean.mean(), about_mean, peak.max(), force.max()]) / omega1**2


def rows():
    """Yield mechanism, ratio, cause, omega1 and the relative changes of the four quantities."""
    for name, (mechanism, body) in MECHANISMS.items():
        for ratio in RATIOS:
            ideal = measured(100.0, ratio, **mechanism)
            for omega1 in SPEEDS:
                heavy = measured(omega1, ratio, gravity=9.81, **mechanism)
                yield name, ratio, GRAVITY, omega1, *(heavy / ideal - 1.0)
            # scales with omega1 squared too, so two speeds are enough
            for omega1 in SPEEDS[[0, -1]]:
                inert = measured(omega1, ratio, **mechanism, **body)
                yield name, ratio, INERTIA, omega1, *(inert / ideal - 1.0)


def read():
    """Read the committed table: {(mechanism, ratio, cause): rows of omega1 and the changes, shape (n, 5)}."""
    table = {}
    with TABLE.open(encoding="utf-8", newline="") as file:
        _, *lines = csv.reader(file)
    for name, ratio, cause, *numbers in lines:
        table.setdefault((name, float(ratio), cause), []).append([float(number) for number in numbers])
    return {key: np.array(part) for key, part in table.items()}


def small_from(part):
    """Return the speed from which each quantity changes by less than SMALL, rad/s; inf if there is none."""
    large = np.abs(part[:, 1:]) >= SMALL
    return [float(np.append(part[:, 0], math.inf)[max(np.flatnonzero(c), default=-1) + 1]) for c in large.T]


def lines_of_page(table):
    """Yield the rows for losses.md: the speed from which gravity is small, the changes by the inertia."""
    for (name, ratio, cause), part in table.items():
        if cause == GRAVITY:
            speeds = (f"{speed:.0f}" if speed < math.inf else "above 300" for speed in small_from(part))
            changes = (
                f"{round(100.0 * change, 1) + 0.0:.1f}" for change in table[name, ratio, INERTIA][-1, 1:]
            )
            yield f"| {name}, {ratio:g} | {' | '.join((*speeds, *changes))} |"


@styled()
def draw(table):
    """Draw a panel for each mechanism and ratio, a line for each quantity, dashed for satellite inertia."""
    figure = Picture(figsize=(11, 6.5), dpi=100, layout="constrained")
    grid = figure.subplots(len(MECHANISMS), len(RATIOS), sharex=True, sharey=True)
    for (name, ratio, cause), part in table.items():
        axes = grid[list(MECHANISMS).index(name), RATIOS.index(ratio)]
        for label, colour, values in zip(QUANTITIES, COLOURS, part[:, 1:].T, strict=True):
            style = "-" if cause == GRAVITY else "--"
            axes.loglog(part[:, 0], 100.0 * np.abs(values), style, color=colour, label=f"{label}, {cause}")
        axes.axhline(100.0 * SMALL, color="grey", linewidth=0.7)
        axes.set_ylim(1e-3, 1e4)
        axes.set_title(f"{name}, speed ratio {ratio:g}")
    for axes in grid[-1]:
        axes.set_xlabel("ω1 [rad/s]")
    for axes in grid[:, 0]:
        axes.set_ylabel("change [%]")
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    figure.savefig(PICTURE)


def main():
    with TABLE.open("w", encoding="utf-8", newline="") as file:
        lines = csv.writer(file)
        lines.writerow(
            [
                "mechanism",
                "speed ratio",
                "cause",
                "omega1 [rad/s]",
                *(f"change of {name}" for name in QUANTITIES),
            ]
        )
        for name, ratio, cause, omega1, *changes in rows():
            lines.writerow([name, ratio, cause, f"{omega1:.5g}", *(f"{change:.6f}" for change in changes)])
    table = read()
    draw(table)
    print(*lines_of_page(table), sep="\n")


if __name__ == "__main__":
    main()
