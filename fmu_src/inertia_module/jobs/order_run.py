"""Orders of a scene: it is run, and its signals are looked at over the angle of link 1 or over the pulses."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..common.errors import Refused, must_be
from ..harness.simulate import Progress, Result, communication_points
from ..kernel.codes import AVERAGED
from ..kernel.inertia import reduced_inertia
from ..loops.sources import evaluate
from ..memory import Module
from ..scene import Scene, run_scene
from .evaluator import read
from .spectra import BASES, LINK1, PULSES, Array, Orders, highest_order, resolution, rounding, spectra

# what an order is counted over: the angle, without whole turns, and these
DRIVE = "drive"
_ANGLES = {LINK1: ("input_angle", "input_turns"), DRIVE: ("drive_angle", "drive_turns")}
_ANGLES[PULSES] = _ANGLES[DRIVE]
# steps that are tried before the run
TRIED = 20
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
    if of not in BASES:
        raise Refused(must_be("orders", " or ".join(BASES), repr(of)))
    scene, _ = read(scene)
    if scene.parameters().get("fidelity") == AVERAGED:
        raise Refused(
            "fidelity must be kinematic, rigid or elastic for orders, is averaged: it has no pulses"
        )
    last = scene.run.stop_time if end is None else end
    if not 0.0 <= begin < last <= scene.run.stop_time:
        limits = f"in order and within 0 to {scene.run.stop_time:g} s"
        raise Refused(must_be("times", limits, f"{begin:g} to {last:g} s"))
    looked = SIGNALS if signals is None else tuple(dict.fromkeys(signals))
    wanted = list(dict.fromkeys([*looked, "input_speed", *_ANGLES[LINK1], *_ANGLES[PULSES]]))
    scene = scene.replaced(run={"outputs": wanted})
    _check_before(scene, fmu_path, of, highest, turns, begin, last)
    record = run_scene(scene, fmu_path, progress).record
    part = _part(record.time, begin, last)
    table = Result({name: values[part] for name, values in record.columns.items()}, record.units)
    turned = _turned(table, of, scene)
    swinging = [name for name in looked if np.ptp(table[name]) > rounding(table, name)]
    if not swinging:
        raise Refused(f"signals must swing, of {', '.join(looked)} none does")
    drive = _turned(table, DRIVE, scene)
    names = swinging if signals is None else looked
    return spectra(table, turned, names, of, highest, turns, drive)


def _part(time: Array, begin: float, last: float) -> NDArray[np.bool_]:
    return (time >= begin - 1e-9) & (time <= last + 1e-9)


def _turned(table: Result, of: str, scene: Scene) -> Array:
    """Turns of link 1, of the drive, or pulses, up to each row, counted the way it turns."""
    angle, whole = _ANGLES[of]
    turned = table[angle] / math.tau + table[whole]
    each = pulses_a_turn(scene.parameters()) if of == PULSES else 1.0
    return each * math.copysign(1.0, turned[-1] - turned[0]) * turned


def _check_before(
    scene: Scene,
    fmu_path: Path | str | None,
    of: str,
    highest: float | None,
    turns: float | None,
    begin: float,
    last: float,
) -> None:
    """Refuse what is sure to be refused after the run: by the speed that is given, by the first steps.

    Raises:
        Refused: as spectra.
    """
    run = scene.run
    times = communication_points(run.stop_time, run.communication_step)
    times = times[_part(times, begin, last)]
    signal = scene.drive.prescribed().get("omega1")
    if signal is not None and not scene.parameters().get("input_hold"):
        turned = np.cumsum([evaluate(signal, at) for at in times]) * run.communication_step / math.tau
        turned = np.append(0.0, turned[:-1])  # the speed is held over a step
        turned *= math.copysign(1.0, turned[-1])
        if of == LINK1:
            resolution(times, turned, of, highest, turns)
        else:
            highest_order(times, turned, None)
    tried = TRIED * run.communication_step
    if begin == 0.0 and tried < last:
        table = run_scene(scene.replaced(run={"stop_time": tried}), fmu_path).record
        highest_order(table.time, _turned(table, of, scene), highest)
