"""Scenes the tests share, and what they read off a module."""

import math

from inertia_module.contract.variable import PARAMETER
from inertia_module.contract.variables import with_causality
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


def vector(module, name):
    return [module[f"{name}_{axis}"] for axis in "xyz"]
