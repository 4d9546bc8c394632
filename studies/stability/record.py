"""What one run shows at its communication points: the largest of everything that is held to a bound."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from inertia_module.contract.variables import LOSSES
from inertia_module.kernel.codes import ELASTIC, RIGID
from inertia_module.memory import Module

from .mechanisms import imbalance_inertia

# what is compared at the end of a run; and the torques whose largest is its scale
SPEEDS = ("omega2", "omega_out")
ENERGIES = ("energy_in", "energy_out")
IMPULSES = ("input_torque_mean", "output_torque_mean")
TORQUES = ("load_torque", "input_torque", "mesh_torque", "output_torque", "housing_torque")


@dataclass
class Run:
    """What one run showed.

    Attributes:
        end: values at the end: speeds, energies, drive angle gone through, impulses of the torques.
        finite: whether every output was, at every communication point.
        residual: largest energy residual, J. gained: largest energy from nowhere, J. speed, torque: largest
            seen, rad/s, N.m.
        energy: largest of input, output, stored, and what the imbalances can have at the speeds seen, J.
        reversal: deepest breach of omega2 >= 0 or omega3 >= omega2, rad/s.
        pull: deepest breach of Tc >= 0 or Th >= 0, N.m.
        slipping: largest power of a freewheel, torque by slip, W; all three without its drag.
        lost: energy lost so far by cause, but the shaft's, J. regained: the most that one of them fell, J.
        phase: advance of what has to be followed, rad. evaluations, steps: what it took.
        fixed_steps: internal steps of method timestepping.
        refused: message of the refusal that ended it, or "".
        broken: what must never happen and did, such as an exception that is no refusal, or "".
    """

    end: dict[str, float] = field(default_factory=dict)
    finite: bool = True
    residual: float = 0.0
    gained: float = 0.0
    energy: float = 0.0
    speed: float = 0.0
    torque: float = 0.0
    reversal: float = 0.0
    pull: float = 0.0
    slipping: float = 0.0
    lost: dict[str, float] = field(default_factory=dict)
    regained: float = 0.0
    phase: float = 0.0
    fixed_steps: int = 0
    evaluations: float = 0.0
    steps: int = 0
    refused: str = ""
    broken: str = ""


def input_speed(module: Module) -> float:
    """Speed of link 1, rad/s: at the beginning of the step where it is given."""
    return module["input_speed" if module["drive"] else "omega1"]


def look(run: Run, module: Module) -> None:
    """Take note of what shows at a communication point."""
    run.finite = run.finite and all(map(math.isfinite, module.outputs.numbers))
    run.residual = max(run.residual, abs(module["energy_residual"]))
    run.gained = max(run.gained, -module["energy_residual"])
    link1 = input_speed(module)
    fastest = max(abs(link1), abs(module["omega2"]))
    possible = 0.5 * imbalance_inertia(module.derived) * fastest * fastest
    run.energy = max(run.energy, possible, *(abs(module[name]) for name in (*ENERGIES, "energy_stored")))
    run.speed = max(run.speed, abs(link1), *(abs(module[name]) for name in SPEEDS))
    run.torque = max(run.torque, *(abs(module[name]) for name in TORQUES))
    # not the shaft's: a balancer gives energy, and of a shaft too stiff to be followed it is a difference
    parts = [name for name in LOSSES if name != "energy_lost_shaft"]
    before, run.lost = run.lost, {name: module[name] for name in parts}
    run.regained = max(run.regained, *(before.get(name, 0.0) - lost for name, lost in run.lost.items()))
    if module["fidelity"] not in (RIGID, ELASTIC):
        return
    if module["housing_freewheel"]:
        _look_at_freewheel(run, module, "housing", module["omega2"], module["housing_stiffness"])
    if module["output_freewheel"]:
        slip = module["omega_hub"] - module["omega2"]
        _look_at_freewheel(run, module, "output", slip, module["freewheel_stiffness"])


def _look_at_freewheel(run: Run, module: Module, name: str, slip: float, stiffness: float) -> None:
    """Take note of its slip, and of its torque beside its drag; while it winds up it may turn backwards."""
    overrunning = module[f"{name}_drag"] + module[f"{name}_drag_viscous"] * max(slip, 0.0)
    held = module[f"{name}_torque"] + overrunning
    run.pull = max(run.pull, -held)
    if module["fidelity"] != ELASTIC or stiffness == 0.0:
        run.reversal = max(run.reversal, -slip)
        run.slipping = max(run.slipping, slip * held)
