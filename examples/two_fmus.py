"""Inertia module and elastic shaft as two FMUs, coupled at the communication points.

The rigid module drives the hub (its output shaft, J3); DrivenShaft is the shaft behind it with the driven
mass. Speed goes one way, mean torque the other, both FMUs step at the same time:

    omega_out of the module          ->  hub_speed of the shaft
    shaft_torque_mean of the shaft   ->  load_torque of the module

Run `inertia-module build` first. The error falls with the communication step; the last line is the
elastic module in one piece.
"""

from pathlib import Path

from inertia_module.wired import JACOBI, Node, WiredFmus
from inertia_module.wiring import Wire

BUILD = Path(__file__).parent.parent / "build"
MODULE = {"output_inertia": 0.02, "fidelity": "rigid"}
SHAFT = {"driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
LOAD = 10.0  # N.m
WIRES = (
    Wire("module", "omega_out", "shaft", "hub_speed"),
    Wire("shaft", "shaft_torque_mean", "module", "load_torque"),
)
ONE_PIECE = 3.908460340, 16.766411224  # rad/s, hub and driven mass


def simulate(step, stop=1.0, folder=BUILD, order=JACOBI):
    """Speeds of hub and driven mass after stop seconds, rad/s."""
    nodes = {
        "module": Node(folder / "InertiaModule.fmu", MODULE, {"omega1": 100.0}, tolerance=1e-9),
        "shaft": Node(folder / "DrivenShaft.fmu", SHAFT, {"load_torque": LOAD}),
    }
    with WiredFmus(nodes, WIRES, step, order) as system:
        for _ in range(round(stop / step)):
            system.advance()
        return system.fmus["module"]["omega_out"], system.fmus["shaft"]["omega_out"]


if __name__ == "__main__":
    print("step, s     hub, rad/s  driven mass, rad/s")
    for step in (1e-3, 1e-4, 1e-5):
        hub, driven = simulate(step)
        print(f"{step:<10g} {hub:11.6f}  {driven:18.6f}")
    print(f"one piece  {ONE_PIECE[0]:11.6f}  {ONE_PIECE[1]:18.6f}")
