"""Scenes the tests share, and what they read off a module."""

import math
from itertools import product

import pytest

from inertia_module.contract.variables import PARAMETER, with_causality
from inertia_module.memory import Module
from studies.reference.motion import Reference

REFERENCE = {"omega1": 100.0, "load_torque": 10.0}  # R1: everything else is at its default
PLANAR = {
    "layout": 1,
    "sun_radius": 0.05,
    "satellite_radius": 0.03,
    "eccentricity": 0.02,
    "imbalance_mass": 0.8,
    "satellites": 3,
    "link2_inertia": 0.003,
    "output_inertia": 0.4,
    "omega1": 120.0,
    "load_torque": 8.0,
}
SCENES = {"bevel": REFERENCE, "planar": PLANAR}
# what is built, without what is given to it
MECHANISMS = {
    layout: {name: value for name, value in scene.items() if name not in ("omega1", "load_torque")}
    for layout, scene in SCENES.items()
}
# an elastic output of the bevel one, as in the design
ELASTIC = {
    "fidelity": 3,
    "output_inertia": 0.02,
    "driven_inertia": 0.5,
    "shaft_stiffness": 400.0,
    "shaft_damping": 0.05,
}
# the same two with an engine of this inertia that gives a torque
ENGINE = {"drive": 1, "input_inertia": 0.2}
DRIVEN = {
    "bevel": {**REFERENCE, **ENGINE, "drive_torque": 15.0},
    "planar": {**PLANAR, **ENGINE, "drive_torque": 12.0},
}
# mechanisms for the equations of motion alone
LAYOUTS = {
    "bevel": {"layout": 0},
    "bevel, askew": {
        "layout": 0,
        "z2": 24,
        "z16": 18,
        "z17": 26,
        "shaft_angle": 1.1,
        "a": 0.7,
        "b": 1.4,
        "c": 0.5,
        "epsilon": 0.4,
        "gamma": -1.3,
    },
    "planar": {"layout": 1},
}
FREEWHEELS = {
    "both freewheels": {},
    "no housing freewheel": {"housing_freewheel": False},
    "no output freewheel": {"output_freewheel": False},
    "no freewheel": {"housing_freewheel": False, "output_freewheel": False},
}
TWO_PI = 2.0 * math.pi
DRIVES = {"speed": SCENES, "torque": DRIVEN}
FIXED = {"method": 1, "max_step": 1e-4}
LEVELS = {
    "kinematic": {"fidelity": 0, "kinematic_ratio": 0.4},
    "averaged": {"fidelity": 1},
    "rigid": {},
    "elastic": ELASTIC,
    "timestepping": FIXED,
    "elastic-timestepping": {**ELASTIC, **FIXED},
}
# the satellite gears' own
GEARS = {"satellite_inertia": 4e-3, "satellite_transverse_inertia": 3e-3}
LOSSES = {
    "mesh": {"mesh_efficiency": 0.97},
    "satellite_mesh": {"satellite_mesh_efficiency": 0.97},
    "journal": {"journal_friction": 1e-3},
    "housing_drag": {"housing_drag": 0.5, "housing_drag_viscous": 0.01},
    "output_drag": {"output_drag": 0.5, "output_drag_viscous": 0.01},
    "viscous": dict.fromkeys(("input_friction", "drive_friction", "link2_friction", "output_friction"), 0.01),
    "gravity": {"gravity": 9.81},
}
ALL_LOSSES = {name: value for one in LOSSES.values() for name, value in one.items()}
FRICTION = {"input_friction": 0.02, "drive_friction": 0.01, "link2_friction": 0.05, "output_friction": 0.2}
# parameters that change between steps
SHAFT = {"shaft_damping": 0.4, "driven_friction": 0.1, "balancer": 0.5}
TUNED = {**FRICTION, **SHAFT, "kinematic_ratio": 0.7}
WIND_UP = {
    "housing_stiffness": 2e4,
    "housing_damping": 2.0,
    "freewheel_stiffness": 1e4,
    "freewheel_damping": 1.0,
}
PLAY = {"housing_engagement_angle": 0.0175, "output_engagement_angle": 0.03}
ACCOUNTS = [
    f"energy_lost_{cause}" for cause in ("viscous", "shaft", "mesh", "journal", "freewheel", "windage")
]
# the account of a loss that is not its own
CAUSE = {"satellite_mesh": "mesh", "housing_drag": "freewheel", "output_drag": "freewheel"}
MOTION = (
    *("omega2", "omega_out", "input_speed", "drive_angle", "input_angle"),
    *("energy_in", "energy_out", "energy_stored"),
)
MEANS = (
    *("input_torque_mean", "output_torque_mean", "mesh_torque_mean", "housing_torque_mean"),
    "torque_ripple",
)
# what is added to the mechanism: what the ideal engines have as well, and all that asks for the general one
ADDED = {
    "ideal": {},
    "gears": GEARS,
    "friction": LOSSES["viscous"],
    "losses": ALL_LOSSES | GEARS,
    "wind-up": ALL_LOSSES | WIND_UP,
    "play": PLAY,
    "worn": ALL_LOSSES | WIND_UP | PLAY,
}


# ... only a shaft has
SPRINGS = ("wind-up", "worn")


def mechanism(text):
    """Values of parameters by name, written as what campaigns found: name=value, parted by blanks."""
    return {name: float(value) for name, value in (part.split("=") for part in text.split())}


def motions(levels=tuple(LEVELS), added=tuple(ADDED), missing=tuple(FREEWHEELS)[1:], drives=tuple(DRIVES)):
    """The table of scenes: layouts x drives x levels x what is added, or which freewheels are missing.

    Returns a decorator that calls a test with each as `scene`.
    """
    rows = []
    for layout, drive, level in product(SCENES, drives, levels):
        if (drive, level) == ("torque", "kinematic"):
            continue  # the motion is prescribed
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
    """A module started with these scenes, later ones over earlier ones, and values over all.

    What they do not give is 0: speed of link 1 and load.
    """
    settings = {"omega1": 0.0, "load_torque": 0.0}
    for scene in (*scenes, values):
        settings.update(scene)
    return Module(kernel).start(**settings)


def advanced(module, *steps, **inputs):
    """The module after these steps with these inputs."""
    module.set(**inputs)
    for step in steps:
        module.advance(step)
    return module


def parameters(**values):
    """All parameters by name, these over the defaults."""
    return {v.name: v.start for v in with_causality(PARAMETER)} | values


def drive_angle(module):
    return module["drive_angle"] + TWO_PI * module["drive_turns"]


def reference(values, duration=0.0):
    """The scene after a while by the independent reference: nothing of the kernel takes part."""
    motion = Reference(values, *(values.get(name, 0.0) for name in ("omega1", "load_torque", "drive_torque")))
    motion.advance(duration)
    return motion


def input_angle(module):
    return module["input_angle"] + TWO_PI * module["input_turns"]


def passed(module):
    """Energies that went through a module, J."""
    names = ("energy_in", "energy_out", "energy_stored", "energy_lost")
    return sum(abs(module[name]) for name in names)


def vector(module, name):
    return [module[f"{name}_{axis}"] for axis in "xyz"]
