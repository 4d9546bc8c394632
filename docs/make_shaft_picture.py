"""Draws fmu_src/inertia_module/fmu/driven_shaft.png: hub, twisted shaft, driven mass."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

TARGET = Path(__file__).parent.parent / "fmu_src" / "inertia_module" / "fmu" / "driven_shaft.png"


def main():
    figure = Figure(figsize=(4, 4), dpi=100)
    axes = figure.add_axes((0, 0.04, 1, 0.96))
    along = np.linspace(1.0, 5.0, 400)
    turned = 6.0 * np.pi * (along - 1.0)
    axes.plot(along, 0.45 * np.sin(turned), color="#802020", linewidth=2)
    axes.plot([-0.9, 0.2], [0, 0], color="#404040", linewidth=4)
    axes.add_patch(Rectangle((0.2, -1.1), 0.8, 2.2, color="#4878a8"))
    axes.add_patch(Rectangle((5.0, -2.0), 1.1, 4.0, color="#d08c3c"))
    axes.plot([6.1, 7.1], [0, 0], color="#404040", linewidth=4)
    axes.text(0.6, -1.6, "hub", ha="center", fontsize=11)
    axes.text(5.55, -2.5, "driven mass", ha="center", fontsize=11)
    axes.set_xlim(-1.2, 7.4)
    axes.set_ylim(-4.0, 4.0)
    axes.set_aspect("equal")
    axes.set_axis_off()
    figure.text(0.5, 0.06, "driven shaft", ha="center", fontsize=14)
    figure.savefig(TARGET)


if __name__ == "__main__":
    main()
