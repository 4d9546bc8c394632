"""Orders of a scene: it is run, and its signals are looked at over the angle of link 1 or over the pulses."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..common.errors import Refused, must_be
from ..harness.simulate import Progress, Result
from ..kernel.codes import AVERAGED
from ..kernel.inertia import reduced_inertia
from ..memory.instances import Module
from ..scene import Scene, run_scene
from .evaluator import read
from .spectra import LINK1, PULSES, Orders, rounding, spectra

# what an order is counted over: the angle, without whole turns, and these
_ANGLES = {LINK1: ("input_angle", "input_turns"), PULSES: ("drive_angle", "drive_turns")}
# what is looked at where nothing is asked for
SIGNALS = (
    *("input_torque", "output_torque", "input_speed", "omega_out"),
    *("shaking_force_x", "shaking_force_y", "shaking_force_z"),
)


def pulses_a_turn(parameters: Mapping[str, float]) -> float:
    """Pulses a turn of the drive angle q, mean over its period: how often the reduced inertia I(q) begins to
    rise, for its slope is what pushes link 2.

    Args:
        parameters: of the module, those that differ from the defaults.
    """
    module = Module("plain")
    module.check(**parameters)
    turns = int(module.derived.period_turns)
    angles = np.linspace(0.0, math.tau * turns, 720 * turns, endpoint=False)
    slopes = [reduced_inertia(module.derived, float(q))[1] for q in angles]  # type: ignore[no-untyped-call]
    rising = np.array(slopes) > 0.0
    return float(np.sum(rising & ~np.roll(rising, 1))) / turns


def orders(
    scene: Scene | Path | str,
    fmu_path: Path | str | None = None,
    *,
    of: str = LINK1,
    signals: Sequence[str] | None = None,
    highest: float | None = None,
    turns: float | None = None,
    begin: float = 0.0,
    end: float | None = None,
    progress: Progress | None = None,
) -> Orders:
    """Run a scene and find the orders of its signals.

    Args:
        scene: a scene or its file.
        fmu_path: the FMU of the module; None for that of the package.
        of: "link1" or "pulses".
        signals: names of outputs, locals or signals of the loop; without them those of SIGNALS that swing.
        highest: as in spectra.
        turns: as in spectra.
        begin: of the part of the run that is looked at, s.
        end: of that part, s.
        progress: told how much of the run is done (0 to 1).

    Raises:
        SceneError: the scene cannot be, or has no such signal.
        Refused: as spectra; fidelity averaged, which has no pulses; times not in order.
    """
    if of not in _ANGLES:
        raise Refused(must_be("orders", " or ".join(_ANGLES), repr(of)))
    scene, _ = read(scene)
    if scene.parameters().get("fidelity") == AVERAGED:
        raise Refused(
            "fidelity must be kinematic, rigid or elastic for orders, is averaged: it has no pulses"
        )
    last = scene.run.stop_time if end is None else end
    if not 0.0 <= begin < last <= scene.run.stop_time:
        limits = f"in order and within 0 to {scene.run.stop_time:g} s"
        raise Refused(must_be("times", limits, f"{begin:g} to {last:g} s"))
    angle, whole = _ANGLES[of]
    looked = SIGNALS if signals is None else tuple(dict.fromkeys(signals))
    wanted = list(dict.fromkeys([*looked, "input_speed", angle, whole, *_ANGLES[PULSES]]))
    record = run_scene(scene.replaced(run={"outputs": wanted}), fmu_path, progress).record
    part = (record.time >= begin - 1e-9) & (record.time <= last + 1e-9)
    table = Result({name: values[part] for name, values in record.columns.items()}, record.units)
    turned = table[angle] / math.tau + table[whole]
    if of == PULSES:
        turned = turned * pulses_a_turn(scene.parameters())
    swinging = [name for name in looked if np.ptp(table[name]) > rounding(table, name)]
    if not swinging:
        raise Refused(f"signals must swing, of {', '.join(looked)} none does")
    drive = table["drive_angle"] / math.tau + table["drive_turns"]
    names = swinging if signals is None else looked
    forwards = np.sign(turned[-1] - turned[0])
    return spectra(table, forwards * turned, names, of, highest, turns, drive)
