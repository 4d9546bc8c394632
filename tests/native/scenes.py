"""Scenes that are run on other systems, for the C program and for fmpy."""

from typing import NamedTuple


class Scene(NamedTuple):
    settings: dict[str, float]
    step: float
    steps: int


_STEP, _STEPS = 0.01, 100
_ELASTIC = {
    "fidelity": 3,
    "output_inertia": 0.02,
    "driven_inertia": 0.5,
    "shaft_stiffness": 400,
    "shaft_damping": 0.05,
}
_R1 = {"omega1": 100.0, "load_torque": 10.0}
# the size of a step follows the last digits of pow, which differ: with a small tolerance little comes of it
_TORQUE = {"drive": 1, "input_inertia": 0.2, "drive_torque": 15.0, "tolerance": 1e-10}
SCENES = {
    "InertiaModule": {
        "R1": Scene(_R1, _STEP, _STEPS),
        "elastic": Scene(_R1 | _ELASTIC, _STEP, _STEPS),
        "timestepping": Scene(_R1 | {"method": 1, "max_step": 1e-4}, _STEP, _STEPS),
        "averaged": Scene(_R1 | {"fidelity": 1}, _STEP, _STEPS),
        "by_torque": Scene(_R1 | _TORQUE, _STEP, _STEPS),
        "elastic_by_torque": Scene(_R1 | _ELASTIC | _TORQUE, _STEP, _STEPS),
        "averaged_by_torque": Scene(_R1 | _TORQUE | {"fidelity": 1}, _STEP, _STEPS),
        "planar": Scene({"layout": 1, "satellites": 3, "omega1": 120.0, "load_torque": 8.0}, _STEP, _STEPS),
    },
    "DrivenShaft": {
        "shaft": Scene({"hub_speed": 50.0, "load_torque": 3.0}, _STEP, _STEPS),
        "overdamped": Scene({"hub_speed": 50.0, "shaft_damping": 100.0}, _STEP, _STEPS),
    },
}


def header(identifier, library=""):
    """C source of the scenes of an FMU, and of the path of its library."""
    lines = [
        "struct setting {\n    const char *name;\n    double value;\n};",
        "struct scene {\n    const char *name;\n    const struct setting *settings;\n"
        "    double step;\n    int steps;\n};",
        f'#define LIBRARY "{library}"',
    ]
    for name, scene in SCENES[identifier].items():
        settings = ", ".join(f'{{"{key}", {float(value)!r}}}' for key, value in scene.settings.items())
        lines.append(f"static const struct setting of_{name}[] = {{{settings}, {{0, 0.0}}}};")
    lines.append("static const struct scene scenes[] = {")
    lines += [
        f'    {{"{name}", of_{name}, {scene.step!r}, {scene.steps}}},'
        for name, scene in SCENES[identifier].items()
    ]
    return "\n".join([*lines, "};", ""])
