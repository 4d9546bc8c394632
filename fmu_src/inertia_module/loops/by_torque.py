"""An engine whose rotor is in the module: what is exchanged is its torque, and its speed comes back.

With drive = torque the speed of link 1 is a state of the FMU, and input_inertia carries the rotor of the
engine too. What is left of the engine is its map and its sampled governor, which see input_speed at
communication points. Between two samples the torque is constant, so with steps that end at every sample (its
sample time is a whole number of them) the two FMUs do exactly what one piece would do, whatever the step and
the inertia. With longer steps the governor sees the speed late; no energy is lost by that.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from ..harness.fmu import Fmu
from ..kernel.codes import DRIVE_TORQUE
from .engine import Engine
from .plant import EnginePlant, Exchange

_ANSWERS = ("input_speed", "input_angle", "input_turns", "energy_in")


def torque_driven(parameters: Mapping[str, float], inertia: float) -> dict[str, float]:
    """Parameters of a module that is driven by torque and carries the rotor of its engine.

    Args:
        parameters: of the module, those that differ from the defaults. inertia: of the engine, kg.m2.
    """
    own = parameters.get("input_inertia", 0.0)
    return {**parameters, "drive": float(DRIVE_TORQUE), "input_inertia": own + inertia}


class TorqueDrivenEngine(EnginePlant):
    """An engine in front of a module driven by torque; from outside its omega1 is the speed asked for.

    A step may be of any length. The governor takes the samples that are due in it with the speed at its
    beginning, and the module gets the mean of the torques.

    Args:
        fmu: a started FMU of the module (see torque_driven) with omega1 = speed of the engine.
        engine: at the same speed; its inertia is in input_inertia of the FMU.
        substeps: equal communication steps between engine and module in each step of the plant.

    Attributes:
        ledger: sums over the run. Of the readings, engine_work_out is all that the torque has done (the
            rotor takes none of it), and engine_energy, the rotor's, is a part of energy_stored of the FMU.

    Raises:
        ValueError: a module driven by speed, or one that cannot carry the rotor; speeds that differ; no
            substeps.
    """

    def __init__(self, fmu: Fmu, engine: Engine, substeps: int = 1) -> None:
        super().__init__(fmu, engine, DRIVE_TORQUE, substeps)
        inertia = fmu["input_inertia"]
        if inertia < engine.inertia * (1.0 - 1e-9):
            raise ValueError(
                f"input_inertia of the FMU must be at least {engine.inertia:g} kg.m2, for it carries the"
                f" engine's rotor too, is {inertia:g}"
            )
        self._last = fmu.read(_ANSWERS)

    @property
    def energy_stored(self) -> float:
        """Kinetic energy of engine and module together, J."""
        return self.fmu["energy_stored"]

    def _exchange(self, h: float) -> Exchange:
        before, after = self.engine.state, self.engine.at_held_speed(h)
        torque = (after.impulse_out - before.impulse_out) / h
        self.fmu.set(drive_torque=torque)
        self.fmu.advance(h)
        self.ledger.fmu_steps += 1
        speed, angle, turns, energy = answers = self.fmu.read(_ANSWERS)
        _, last_angle, last_turns, last_energy = self._last
        turned = (angle - last_angle) + 2.0 * math.pi * (turns - last_turns)
        work = torque * turned
        self._last = answers
        self.engine.state = after._replace(
            speed=speed,
            angle=before.angle + turned,
            work_in=before.work_in + work,
            work_out=before.work_out + work,
        )
        return Exchange(h, torque, torque, work, energy - last_energy)
