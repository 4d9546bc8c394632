"""Draw docs/explanation/mount.png: modules about the axis, and the force of one module on the mounting."""

import math
from pathlib import Path

import numpy as np

from inertia_module.common.colours import BLUE, GREY, ORANGE, VERMILION, Picture, styled
from inertia_module.kernel import layout
from inertia_module.model import Module

TARGET = Path(__file__).parent / "explanation" / "mount.png"
MODULES = 3
TURN = 2.0 * math.pi
SAMPLES = 4000
# pinion-shaft angle in the drawing, rad, and length of the arrow of the maximum force, m
ANGLE, ARROW_LENGTH = 1.0, 0.12


def draw_modules(axes):
    """Draw modules of scene R1, Ox towards the reader, with paths and forces of the unbalanced masses."""
    module = Module("plain").start(omega1=100.0)
    d, k = module.derived, module.derived.k
    motion = (100.0, 0.0, 0.5 * k * 100.0, 0.0, 0.0)
    path = np.linspace(0.0, TURN, SAMPLES)
    max_acceleration = max(math.hypot(*layout.imbalance_motion(d, q, 0.0, *motion)[7:]) for q in path)
    for n in range(MODULES):
        turned = TURN * n / MODULES
        along = np.array([-math.sin(turned), math.cos(turned)])
        axes.plot(*np.outer(along, [0.0, 2.5 * d.axial]), color=GREY, linewidth=1, dashes=(8, 3, 2, 3))
        places = np.array(
            [layout.to_fixed_frame(turned, *layout.imbalance_position(d, q, 0.0)[:3]) for q in path]
        )
        axes.plot(places[:, 1], places[:, 2], color=ORANGE, linewidth=0.7)
        here = layout.imbalance_motion(d, ANGLE, turned, *motion)
        force = -np.array(here[7:]) * ARROW_LENGTH / max_acceleration
        axes.plot(here[1], here[2], "o", color=VERMILION, markersize=7)
        axes.arrow(
            *here[1:3], *force, color=VERMILION, width=1e-3, head_width=8e-3, length_includes_head=True
        )
        axes.text(*(2.7 * d.axial * along), f"module {n}", ha="center", va="center", color=BLUE)
    for label, direction in (("Oy", (1.0, 0.0)), ("Oz", (0.0, 1.0))):
        end = 0.6 * d.axial * np.array(direction)
        axes.annotate("", end, (0.0, 0.0), arrowprops={"arrowstyle": "->"})
        axes.text(*(1.2 * end), label, ha="center", va="center")
    axes.set_title(
        "three modules, turned by 120° each, pinion shafts in phase;\n"
        "Ox towards the reader, θ1 = 0; arrows: −m a,\n"
        "lines: one turn of the pinion shafts"
    )
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_xlim(-0.16, 0.16)
    axes.set_ylim(-0.12, 0.18)


def draw_forces(axes):
    """The force that one module leaves, turning with link 1, by its number of satellites."""
    for satellites, colour in ((3, ORANGE), (1, BLUE), (2, VERMILION)):
        module = Module("plain").start(satellites=satellites, omega1=100.0, fidelity=0, kinematic_ratio=0.5)
        points = []
        for _ in range(SAMPLES):
            module.advance(TURN / 50.0 / SAMPLES)
            _, y, z = (module[f"shaking_force_{axis}"] for axis in "xyz")
            points.append((y / 1e3, z / 1e3))
        label = f"{satellites} satellite" + "s" * (satellites > 1)
        axes.plot(*np.transpose(points), color=colour, linewidth=0.8, label=label)
    axes.set_title("one module: its force on the mount, ω2 = ω1/2,\ntwo turns of link 1")
    axes.set_xlabel("Fy [kN]")
    axes.set_ylabel("Fz [kN]")
    axes.set_aspect("equal")


@styled()
def main():
    figure = Picture(figsize=(10, 5), dpi=100, layout="constrained")
    left, right = figure.subplots(1, 2)
    draw_modules(left)
    draw_forces(right)
    figure.legend(*right.get_legend_handles_labels(), loc="outside lower right", ncols=3)
    figure.savefig(TARGET)


if __name__ == "__main__":
    main()
