"""Variables in groups, for documentation: their names are flat, so no host can make a tree of them."""

from __future__ import annotations

from ..contract.models import Model
from ..contract.variable import INPUT, LOCAL, OUTPUT, PARAMETER, Variable

HEADINGS = {INPUT: "Inputs", OUTPUT: "Outputs", LOCAL: "Locals", PARAMETER: "Parameters"}

GROUPS = {
    "Given at the flanges": "omega1 hub_speed drive_torque load_torque",
    "Speeds, angles, accelerations": (
        "omega2 omega_out omega_hub input_speed input_acceleration output_acceleration driven_acceleration"
        " input_flange_angle output_flange_angle output_angle output_turns input_angle input_turns"
        " drive_angle drive_turns shaft_twist twist"
    ),
    "Torques, mean over the step": (
        "input_torque_mean output_torque_mean mesh_torque_mean housing_torque_mean shaft_torque_mean"
    ),
    "Torques at this instant": "input_torque mesh_torque output_torque housing_torque shaft_torque",
    "Ripple": "torque_ripple torque_peak",
    "Imbalance, bearing and mount": (
        "imbalance_x imbalance_y imbalance_z imbalance_velocity_x imbalance_velocity_y imbalance_velocity_z"
        " imbalance_acceleration imbalance_acceleration_x imbalance_acceleration_y imbalance_acceleration_z"
        " satellite_force satellite_force_peak shaking_force_x shaking_force_y shaking_force_z"
        " shaking_moment_x shaking_moment_y shaking_moment_z"
    ),
    "Energy": (
        "loss_power_mean energy_in energy_out energy_stored energy_lost energy_lost_viscous energy_lost_shaft"
        " energy_lost_mesh energy_lost_journal energy_lost_freewheel energy_residual"
    ),
    "Freewheels and cost": "contact_mode contact_switches rhs_evaluations",
    "Layout": "layout modules satellites housing_freewheel output_freewheel",
    "Bevel layout": "z2 z16 z17 z6 shaft_angle wheel_radius a b c epsilon gamma",
    "Planar layout": "sun_radius satellite_radius eccentricity",
    "Masses and gravity": (
        "imbalance_mass input_inertia drive_inertia link2_inertia output_inertia satellite_inertia"
        " satellite_transverse_inertia gravity"
    ),
    "Elastic output": (
        "driven_inertia shaft_stiffness shaft_damping driven_friction balancer housing_stiffness"
        " housing_damping freewheel_stiffness freewheel_damping"
    ),
    "Losses": (
        "mesh_efficiency satellite_mesh_efficiency journal_friction input_friction drive_friction"
        " link2_friction output_friction housing_drag housing_drag_viscous output_drag output_drag_viscous"
    ),
    "Model and solver": "fidelity method drive input_hold tolerance max_step kinematic_ratio",
    "Start": "omega2_start omega_out_start drive_angle_start twist_start",
}
_GROUP = {name: heading for heading, names in GROUPS.items() for name in names.split()}


def grouped(model: Model) -> dict[str, dict[str, list[Variable]]]:
    """Variables of a model by the heading of their causality, then of their group, in the order above.

    Raises:
        KeyError: a variable is in no group.
    """
    found: dict[str, dict[str, list[Variable]]] = {heading: {} for heading in HEADINGS.values()}
    order = {name: n for n, name in enumerate(_GROUP)}
    for variable in sorted(model.variables, key=lambda variable: order[variable.name]):
        groups = found[HEADINGS[variable.causality]]
        groups.setdefault(_GROUP[variable.name], []).append(variable)
    return found
