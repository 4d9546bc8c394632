"""Refusals: sentences on values and on parameters that do not go together; those of an action."""

import re

from inertia_module.common.errors import Refused

# parameters that do not go together, and how the sentence begins or what is in it
RECTIFIER = "with fidelity = 1 (averaged) housing_freewheel and output_freewheel must both be 1, are "
LINK_2 = "link2_inertia must be above 0 by more than rounding, is "
COMBINATIONS = [
    ({"fidelity": 1, "housing_freewheel": False}, RECTIFIER + "0 and 1: "),
    ({"fidelity": 1, "output_freewheel": False}, RECTIFIER + "1 and 0: "),
    ({"fidelity": 1, "housing_freewheel": False, "output_freewheel": False}, RECTIFIER + "0 and 0: "),
    ({"link2_inertia": 0.0}, LINK_2 + "0: "),
    ({"link2_inertia": 0.0, "a": 0.7, "b": 0.7, "epsilon": 1.0}, "a = 0.7, b = 0.7, "),
    ({"link2_inertia": 1e-20}, LINK_2 + f"{1e-20:.16g}: "),
    ({"link2_inertia": 0.0, "imbalance_mass": 0.0, "a": 2.0}, "imbalance_mass = 0 " + LINK_2),
    ({"link2_inertia": 0.0, "layout": 1, "eccentricity": 0.0}, "eccentricity = 0, "),
    ({"drive": 1, "input_inertia": 0.0}, "with drive = 1 (torque) input_inertia"),
    ({"drive": 1, "input_inertia": 1e-20}, "with drive = 1 (torque) input_inertia"),
    ({"drive": 1, "input_inertia": 0.2, "fidelity": 0}, "with drive = 1 (torque) fidelity must be 1"),
    ({"omega2_start": -1.0, "omega_out_start": 5.0}, "omega2_start must be at least 0, is -1"),
    ({"omega2_start": 2.0, "omega_out_start": 1.0}, "must be at least omega2_start = 2, is 1"),
    (
        {"omega2_start": 2.0, "omega_out_start": 3.0, "output_freewheel": False},
        "without the output freewheel omega_out_start must be omega2_start = 2, is 3",
    ),
]


def sentence(variable, value):
    """The whole refusal of a value, from the table of variables."""
    return f"{variable.name} must be {variable.allowed}, is {value:.16g}"


def refusal(action, *arguments, **values):
    """The line that an action is refused with; "" where it is not."""
    said = ""
    try:
        action(*arguments, **values)
    except Refused as error:
        said = str(error)
    assert "\n" not in said
    return said


def assert_refused(words, action, *arguments, **values):
    """That an action is refused in a line with these words, a regular expression."""
    said = refusal(action, *arguments, **values)
    assert re.search(words, said), said
