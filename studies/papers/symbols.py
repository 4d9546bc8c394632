"""What the symbols of the papers are called in the FMUs, for the page of the papers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from inertia_module.contract import driven_shaft_variables, variables
from inertia_module.contract.variable import Variable

# symbol, variable of the FMU, what of it the symbol is where it is not the variable itself
Symbols = Sequence[tuple[str, str, str]]

KARETIN: Symbols = (
    *((name, name, "") for name in ("z2", "z16", "z17", "z6")),
    ("φ + ψ", "shaft_angle", ""),
    ("O_r Π", "wheel_radius", ""),
    *((name, name, "") for name in ("a", "b", "c")),
    ("ε", "epsilon", ""),
    ("γ", "gamma", ""),
    ("i = ω1/ω2", "kinematic_ratio", "1/i; 0 in the stop mode (`fidelity` kinematic)"),
    ("ω1", "omega1", ""),
    ("ω2", "omega2", ""),
    ("angle of ω16", "drive_angle", "with `drive_turns`; ω16 = (z2/z16)(ω1 − ω2), ω6 = (z17/z6) ω16"),
    ("x, y, z of D", "imbalance_x", "`_y`, `_z`: in the fixed frame"),
    ("V", "imbalance_velocity_x", "`_y`, `_z`: the absolute velocity, (24)"),
    ("a", "imbalance_acceleration_x", "`_y`, `_z`: the absolute acceleration, (32)"),
)
LYSENKO: Symbols = (
    ("R, R0", "sun_radius", "wheel 2 is link 2, and held"),
    ("r", "satellite_radius", "b = r/R0"),
    ("l", "eccentricity", ""),
    ("m", "imbalance_mass", ""),
    (
        "inertia of the carrier",
        "input_inertia",
        "with `drive` torque, else it makes no difference to the motion",
    ),
    ("inertia of wheel 1", "drive_inertia", ""),
    ("bω", "input_speed", "speed of the carrier"),
    ("α, φ", "drive_angle", "with `drive_turns`: angle of wheel 1 on the carrier"),
    ("F1 + F2 + Fk", "satellite_force", "magnitude of their sum"),
    ("M1, moment about O1", "mesh_torque", "−M1/b"),
    ("M, moment about O", "input_torque", "`input_torque` − `mesh_torque` = −M at a steady speed"),
    ("T1, T2", "energy_stored", ""),
)
STELMASHCHUK: Symbols = (
    ("J of the driven mass", "driven_inertia", "J4"),
    ("c", "shaft_stiffness", "ν²J4/T²; `shaft.nu` of a scene"),
    ("f", "driven_friction", "2ΠJ4/T; `shaft.Pi` of a scene"),
    ("torque of the balancer", "balancer", "1 the paper's, 0 without"),
    ("a_κ′", "hub_speed", "φ a_κ′/T; `drive.T`, `drive.kappa2` and `drive.angle` = φ of a scene"),
    ("a″", "driven_acceleration", "φ a″/T²"),
    ("a_κ − a", "twist", "φ (a_κ − a)"),
)


def symbols_table(symbols: Symbols, known: Mapping[str, Variable]) -> str:
    """Table in Markdown: symbol, variable of the FMU, its meaning, and what of it the symbol is."""
    rows = ["| in the paper | in the FMU | unit | meaning | |", "|---|---|---|---|---|"]
    for symbol, name, relation in symbols:
        variable = known[name]
        meaning = variable.description.replace("|", r"\|")
        rows.append(f"| {symbol} | `{name}` | {variable.unit} | {meaning} | {relation} |")
    return "\n".join(rows)


def symbols_tables() -> dict[str, str]:
    """The tables by the names of the papers."""
    return {
        "karetin": symbols_table(KARETIN, variables.BY_NAME),
        "lysenko": symbols_table(LYSENKO, variables.BY_NAME),
        "stelmashchuk": symbols_table(STELMASHCHUK, driven_shaft_variables.BY_NAME),
    }
