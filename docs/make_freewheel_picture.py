"""Measure losses and torque over the engagement angle of the freewheels; write freewheels.csv and .png."""

import csv
import math
from pathlib import Path

import numpy as np

from inertia_module.common.colours import BLACK, BLUE, GREEN, VERMILION, Picture, styled
from inertia_module.model import Module

HERE = Path(__file__).parent / "explanation"
PICTURE, TABLE = HERE / "freewheels.png", HERE / "freewheels.csv"
DEGREES = (0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0)
RATIOS = (0.2, 0.5, 0.8)
COLOURS = (BLUE, GREEN, VERMILION)
ANGLES = ("housing_engagement_angle", "output_engagement_angle")
# output inertia that keeps the speed of the shaft constant, kg m^2
HELD = 1e5
# R1, R1 with three satellites of a third of the mass each, the planar module, R1 with compliant freewheels
MECHANISMS = {
    "R1": {},
    "R1, three satellites": {"satellites": 3, "imbalance_mass": 1.0 / 3.0},
    "planar": {"layout": "planar", "satellites": 3, "imbalance_mass": 0.8, "link2_inertia": 0.003},
    "R1, springs": {
        **{"fidelity": "elastic", "driven_inertia": HELD, "shaft_stiffness": 1e6, "shaft_damping": 20.0},
        **{"housing_stiffness": 2e4, "housing_damping": 2.0},
        **{"freewheel_stiffness": 2e4, "freewheel_damping": 2.0},
    },
}
STYLES = {"R1": "-", "planar": "--", "R1, springs": ":"}
# rad/s; without springs torques and losses scale with its square
SPEED = 100.0
# revolutions of link 1 to settle and to evaluate
SETTLING_TURNS, TURNS = 100, 600
# largest indexing frequencies of sprag clutches, Hz: tension springs, meander springs
LIMITS = {"tension springs": 10.0, "meander springs": 60.0}
COLUMNS = (
    *("mechanism", "ratio", "angle [deg]", "output torque [N.m]", "power lost [W]", "efficiency [1]"),
    "engagements of the housing freewheel per turn [1]",
    "engagements of the output freewheel per turn [1]",
)


def measured(ratio, **parameters):
    """Measure mean output torque, N m, power loss, W, engagements of both freewheels per turn of link 1."""
    module = Module().start(
        omega1=SPEED, load_torque=0.0, omega_out_start=ratio * SPEED, output_inertia=HELD, **parameters
    )
    turn = 2.0 * math.pi / SPEED
    module.advance(SETTLING_TURNS * turn)
    counts = ("energy_lost", "housing_engagements", "output_engagements")
    before = np.array(module.read(counts))
    torque = 0.0
    for _ in range(TURNS):
        module.advance(turn)
        torque += module["output_torque_mean"] / TURNS
    lost, housing, output = (np.array(module.read(counts)) - before) / TURNS
    return torque, lost / turn, housing, output


def rows():
    """Yield the rows of COLUMNS; the efficiency is empty if no torque is transmitted."""
    for name, mechanism in MECHANISMS.items():
        for ratio in RATIOS:
            for degrees in DEGREES:
                angles = dict.fromkeys(ANGLES, math.radians(degrees))
                torque, lost, housing, output = measured(ratio, **mechanism, **angles)
                out = torque * ratio * SPEED
                efficiency = out / (out + lost) if out > 0.0 else ""
                yield name, ratio, degrees, torque, lost, efficiency, housing, output


def read():
    """Read the committed table: {(mechanism, ratio): columns from the angle on, shape (n, 6)}."""
    table = {}
    with TABLE.open(encoding="utf-8", newline="") as file:
        _, *lines = csv.reader(file)
    for name, ratio, *cells in lines:
        table.setdefault((name, float(ratio)), []).append([float(cell or "nan") for cell in cells])
    return {key: np.array(part) for key, part in table.items()}


@styled()
def draw(table):
    """Draw efficiency and output torque over the engagement angle, engagement frequency over the speed."""
    figure = Picture(figsize=(11.0, 4.3), layout="constrained")
    efficiency, torque, frequency = figure.subplots(1, 3)
    for (name, ratio), columns in table.items():
        if name not in STYLES:
            continue
        look = {"color": COLOURS[RATIOS.index(ratio)], "linestyle": STYLES[name]}
        degrees = columns[:, 0]
        efficiency.plot(degrees, 100.0 * columns[:, 3], **look, label=f"{name}, {ratio:g}")
        torque.plot(degrees, columns[:, 1] / columns[0, 1], **look)
    rpm = np.array([0.0, 3000.0])
    for name in ("R1", "planar"):
        for ratio in RATIOS:
            turn = table[name, ratio][DEGREES.index(1.0), 4:].max()
            look = {"color": COLOURS[RATIOS.index(ratio)], "linestyle": STYLES[name]}
            frequency.plot(rpm, turn * rpm / 60.0, **look)
    for name, limit in LIMITS.items():
        frequency.axhline(limit, color=BLACK, linewidth=0.8)
        frequency.text(3050.0, limit, name.replace(" ", "\n"), ha="left", va="center", fontsize=9)
    efficiency.set(xlabel="engagement angle [deg]", ylabel="efficiency [%]")
    torque.set(xlabel="engagement angle [deg]", ylabel="output torque over torque at 0 deg", ylim=(0.0, None))
    frequency.set(
        xlabel="input speed [rpm]",
        ylabel="engagement frequency at 1 deg [Hz]",
        ylim=(0.0, None),
        xlim=(0.0, 3000.0),
    )
    handles, labels = efficiency.get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside lower center", ncols=len(RATIOS) * len(STYLES), title="speed ratio"
    )
    figure.savefig(PICTURE, dpi=110)


if __name__ == "__main__":
    with TABLE.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for row in rows():
            writer.writerow(f"{cell:.4g}" if isinstance(cell, float) else cell for cell in row)
    draw(read())
