"""Mean speeds of fidelity averaged against rigid where the input torque is given, over the inertia of link 1.

The averaged map is that of constant omega1, and a light link 1 swings within a pulse: what does that cost?
Run: python benchmarks/averaged_by_torque.py
"""

import math

from inertia_module.cosimulation.interface import interface_inertia
from inertia_module.kernel import codes
from inertia_module.module import Module

PLANAR = {
    **{
        "layout": 1,
        "sun_radius": 0.05,
        "satellite_radius": 0.03,
        "eccentricity": 0.02,
        "imbalance_mass": 0.8,
    },
    **{"satellites": 3, "link2_inertia": 0.003, "output_inertia": 0.4},
}
LAYOUTS = {"bevel (R1)": {}, "planar": PLANAR}
SHARES = (0.5, 1.0, 2.0, 5.0, 10.0, 50.0)  # J1 over the greatest inertia the module has at its input
START = {"drive": codes.DRIVE_TORQUE, "omega1": 100.0, "drive_torque": 4.0, "load_torque": 5.0}
STEP = 0.01
BEGIN, END = 2.0, 4.0  # s, of the means


def mean_speeds(fidelity, parameters):
    """Mean speeds of link 1 and of the output shaft between BEGIN and END, rad/s."""
    module = Module().start(**START, **parameters, fidelity=fidelity)
    output = []
    angle = 0.0
    for n in range(round(END / STEP)):
        if n == round(BEGIN / STEP):
            angle = module["input_angle"] + 2.0 * math.pi * module["input_turns"]
        module.advance(STEP)
        if n >= round(BEGIN / STEP):
            output.append(module["omega_out"])
    turned = module["input_angle"] + 2.0 * math.pi * module["input_turns"] - angle
    return turned / (END - BEGIN), sum(output) / len(output)


def lines():
    """Table of the page."""
    text = [
        f"A torque of {START['drive_torque']:g} N.m, a load of {START['load_torque']:g} N.m, from"
        f" {START['omega1']:g} rad/s; means from {BEGIN:g} to {END:g} s. Phi is the greatest inertia that the"
        " module has at its input. The map is that of constant omega1: a light link 1 swings within a pulse.",
        "",
        "| mechanism | J1 / Phi | omega1, rigid | averaged | % | omega_out, rigid | averaged | % |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for name, layout in LAYOUTS.items():
        greatest = interface_inertia(layout).greatest
        for share in SHARES:
            parameters = {**layout, "input_inertia": share * greatest}
            rigid = mean_speeds(codes.RIGID, parameters)
            averaged = mean_speeds(codes.AVERAGED, parameters)
            cells = [
                f"{a:.4g} | {b:.4g} | {100.0 * (b / a - 1.0):+.1f}"
                for a, b in zip(rigid, averaged, strict=True)
            ]
            text.append(f"| {name} | {share:g} | {' | '.join(cells)} |")
    return text


if __name__ == "__main__":
    print("\n".join(lines()))
