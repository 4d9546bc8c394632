"""The records of DrivenShaft (see :mod:`.fields`)."""

PARAMETERS = (
    *("driven_inertia", "shaft_stiffness", "shaft_damping", "driven_friction", "balancer", "input_hold"),
    *("omega_out_start", "twist_start"),
)
INPUTS = (
    *("hub_speed", "load_torque", "hub_speed_rate", "load_torque_rate"),
    *("hub_speed_rate_given", "load_torque_rate_given"),
)
OUTPUTS = (
    *("shaft_torque", "shaft_torque_mean", "omega_out", "driven_acceleration", "twist"),
    *("energy_in", "energy_out", "energy_stored", "energy_lost", "energy_residual"),
)
STATE = (
    *("twist", "twist_low", "slip", "slip_low", "omega4", "omega4_low"),
    *("hub_slope", "held_input", "held_step", "load_torque", "shaft_torque_mean", "energy_start"),
    *("energy_in", "energy_in_low", "energy_out", "energy_out_low", "energy_lost", "energy_lost_low"),
)
# all per inertia: the characteristic equation is lambda^2 + rate lambda + square = 0; what swing, slow and
# fast are tells propagator.characteristic. Then the step last taken, the responses to it and its Gramian
CONSTANTS = ("rate", "square", "swing", "slow", "fast", "step", ("responses", 7), ("gramian", 16))
# z1 to z4 of the motions over the step in hand, room for the Gramian (motion), the state before the step
WORKSPACE = (
    *(("twist", 4), ("slip", 4), ("slip_rate", 4), ("speed", 4), ("speed_rate", 4)),
    *(("move", 16), ("product", 16), ("before", STATE)),
)
