"""Draws fmu_src/inertia_module/fmu/model.png: pitch cones and the path of the imbalance in the stop mode."""

import math
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from inertia_module.kernel import layout
from inertia_module.memory.instances import Module

TARGET = Path(__file__).parent.parent / "fmu_src" / "inertia_module" / "fmu" / "model.png"


def cone(axis_point, direction, radius, height, n=60):
    """Surface of a pitch cone with its tip at axis_point, opening along direction."""
    direction = direction / np.linalg.norm(direction)
    first = np.cross(direction, [0.0, 1.0, 0.0])
    first /= np.linalg.norm(first)
    second = np.cross(direction, first)
    angle, part = np.meshgrid(np.linspace(0, 2 * math.pi, n), np.linspace(0, 1, 2))
    rim = radius * (np.cos(angle)[..., None] * first + np.sin(angle)[..., None] * second)
    points = axis_point + part[..., None] * (height * direction + rim)
    return points[..., 0], points[..., 1], points[..., 2]


def main():
    module = Module("plain").start()
    parameters, d = module.parameters, module.derived
    q = np.linspace(0, d.period, 3000)
    path = np.array([layout.imbalance(d, angle, 0.0)[:3] for angle in q])
    ratio = parameters.z17 / parameters.z6
    phi = math.atan2(1.0, ratio)
    psi = math.pi / 2 - phi
    pitch = parameters.wheel_radius / math.sin(psi)
    tip = np.array([0.0, 0.0, 0.0])
    figure = Figure(figsize=(4, 4), dpi=100)
    axes = figure.add_subplot(projection="3d")
    axes.plot_surface(
        *cone(tip, np.array([0, 0, 1.0]), pitch * math.sin(psi), pitch * math.cos(psi)),
        color="#4878a8",
        alpha=0.35,
        linewidth=0,
    )
    axes.plot_surface(
        *cone(tip, np.array([1.0, 0, 0]), pitch * math.sin(phi), pitch * math.cos(phi)),
        color="#d08c3c",
        alpha=0.45,
        linewidth=0,
    )
    axes.plot(path[:, 0], path[:, 1], path[:, 2], color="#802020", linewidth=0.8)
    axes.set_box_aspect((1, 1, 0.8))
    axes.set_axis_off()
    axes.view_init(25, -50)
    figure.text(0.5, 0.03, "inertia module", ha="center", fontsize=14)
    figure.subplots_adjust(0, 0.04, 1, 1)
    figure.savefig(TARGET)


if __name__ == "__main__":
    main()
