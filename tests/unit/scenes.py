"""Scenes of the tests, and quantities of a module."""

import math
import tomllib
from itertools import product
from pathlib import Path

import pytest

from inertia_module.interface.variables import PARAMETER, with_causality
from inertia_module.kernel.events import stages
from inertia_module.kernel.tableau import last_stage
from inertia_module.model import Module
from verification.reference.motion import Reference

# Table of scenes.
TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
SCENES, LAYOUTS, FREEWHEELS = TABLE["scenes"], TABLE["layouts"], TABLE["freewheels"]
REFERENCE, PLANAR = SCENES["bevel"], SCENES["planar"]
LOSSES, PARTS, FOUND = TABLE["losses"], TABLE["parts"], TABLE["found"]
ELASTIC, ENGINE, GEARS = (PARTS[name] for name in ("elastic", "engine", "gears"))
FRICTION, SHAFT, WIND_UP, PLAY = (PARTS[name] for name in ("friction", "shaft", "wind_up", "play"))
# Mechanisms without inputs.
MECHANISMS = {
    layout: {name: value for name, value in scene.items() if name not in ("omega1", "load_torque")}
    for layout, scene in SCENES.items()
}
# The same mechanisms with an engine.
DRIVEN = {
    "bevel": {**REFERENCE, **ENGINE, "drive_torque": 15.0},
    "planar": {**PLANAR, **ENGINE, "drive_torque": 12.0},
}
TWO_PI = 2.0 * math.pi
DRIVES = {"speed": SCENES, "torque": DRIVEN}
LEVELS = {
    "kinematic": {"fidelity": 0, "kinematic_ratio": 0.4},
    "averaged": {"fidelity": 1},
    "rigid": {},
    "elastic": ELASTIC,
}
ALL_LOSSES = {name: value for losses in LOSSES.values() for name, value in losses.items()}
# Parameters that change between steps.
TUNED = {**FRICTION, **SHAFT, "kinematic_ratio": 0.7}
ACCOUNTS = [
    f"energy_lost_{cause}" for cause in ("viscous", "shaft", "mesh", "journal", "freewheel", "windage")
]
# Account of each loss with a shared account.
CAUSE = {"satellite_mesh": "mesh", "housing_drag": "freewheel", "output_drag": "freewheel"}
MOTION = (
    *("omega2", "omega_out", "input_speed", "drive_angle", "input_angle"),
    *("energy_in", "energy_out", "energy_stored"),
)
MEANS = (
    *("input_torque_mean", "output_torque_mean", "mesh_torque_mean", "housing_torque_mean"),
    "torque_ripple",
)
# Additions to the mechanism: properties that ideal solvers support, and properties that need the general
# solver.
ADDED = {
    "ideal": {},
    "gears": GEARS,
    "friction": LOSSES["viscous"],
    "losses": ALL_LOSSES | GEARS,
    "wind-up": ALL_LOSSES | WIND_UP,
    "play": PLAY,
    "worn": ALL_LOSSES | WIND_UP | PLAY,
}


# These additions require a shaft.
SPRINGS = ("wind-up", "worn")


def mechanism(text):
    """Return values of parameters by name from a text: name=value, separated by blanks."""
    return {name: float(value) for name, value in (part.split("=") for part in text.split())}


def motions(levels=tuple(LEVELS), added=tuple(ADDED), missing=tuple(FREEWHEELS)[1:], drives=tuple(DRIVES)):
    """Parametrise a test with scenes: layouts x drives x levels x additions, or missing freewheels.

    Return a decorator that calls a test with each scene as `scene`.
    """
    rows = []
    for layout, drive, level in product(SCENES, drives, levels):
        if (drive, level) == ("torque", "kinematic"):
            continue  # The level prescribes the motion.
        scene = DRIVES[drive][layout] | LEVELS[level]
        name = f"{layout}-{drive}-{level}"
        for more in added:
            if level == "elastic" or (more not in SPRINGS and (more != "play" or level != "kinematic")):
                rows.append(pytest.param(scene | ADDED[more], id=f"{name}-{more}"))
        if level not in ("kinematic", "averaged"):
            for freewheels in missing:
                more = freewheels.replace(" ", "-")
                rows.append(pytest.param(scene | FREEWHEELS[freewheels], id=f"{name}-{more}"))
    return pytest.mark.parametrize("scene", rows)


def started(kernel, *scenes, **values):
    """Return a started module; later scenes override earlier ones, and values override all scenes.

    The default of the speed of link 1 and of the load is 0.
    """
    settings = {"omega1": 0.0, "load_torque": 0.0}
    for scene in (*scenes, values):
        settings.update(scene)
    return Module(kernel).start(**settings)


def advanced(module, *steps, **inputs):
    """Return the module after these steps with these inputs."""
    module.set(**inputs)
    for step in steps:
        module.advance(step)
    return module


def make_step(d, x, w, pair, h):
    """Make a step h by a pair (tableau.DOP853_ROW or DOPRI5_ROW)."""
    w.pair, w.step = pair, h
    stages.evaluate_stages(d, x, w, 1, last_stage(pair))
    stages.set_step_changes(d, x, w)


def parameters(**values):
    """Return all parameters by name; values override the defaults."""
    return {v.name: v.start for v in with_causality(PARAMETER)} | values


def drive_angle(module):
    return module["drive_angle"] + TWO_PI * module["drive_turns"]


def reference(values, duration=0.0):
    """Return the scene after a duration by the independent reference, without code of the kernel."""
    motion = Reference(values, *(values.get(name, 0.0) for name in ("omega1", "load_torque", "drive_torque")))
    motion.advance(duration)
    return motion


def input_angle(module):
    return module["input_angle"] + TWO_PI * module["input_turns"]


def passed(module):
    """Return the energies transmitted by a module, J."""
    names = ("energy_in", "energy_out", "energy_stored", "energy_lost")
    return sum(abs(module[name]) for name in names)


def vector(module, name):
    return [module[f"{name}_{axis}"] for axis in "xyz"]
