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
    *("twist", "twist_low", "omega4", "omega4_low", "hub_speed", "hub_speed_low", "hub_slope"),
    *("held_input", "held_step", "load_torque", "acceleration", "shaft_torque_mean"),
    *("energy_in", "energy_in_low", "energy_out", "energy_out_low", "energy_lost", "energy_lost_low"),
    "energy_start",
)
# all per inertia: the characteristic equation is lambda^2 + rate lambda + square = 0; what swing, slow
# and fast
# are tells propagator.characteristic. Then the communication step last taken, the answers to it and at
# the nodes
# within it (kept_responses)
CONSTANTS = ("rate", "square", "swing", "slow", "fast", "step", ("responses", 7), ("nodes", 48))
# the motion over the step in hand. From impulse, its rate slope and its integrals one, two ... of
# propagator.responses, both speeds are
#     slip = w.slip slope + w.slip_pull impulse + w.slip_ramp one
#     omega4 = w.omega4 + w.speed_rate impulse + w.speed_pull one + w.speed_ramp two
#            = w.omega4 slope + w.fresh_rate impulse + w.fresh_pull one + w.speed_ramp two
# and the twist follows as the integral of the slip, or anew from the twist at the beginning:
#     twist = (twist) step + w.slip impulse + w.twist_push one + w.slip_ramp two
WORKSPACE = (
    *("slip", "slip_pull", "slip_ramp", "omega4", "speed_rate", "speed_pull", "speed_ramp"),
    *("fresh_rate", "fresh_pull", "twist_push"),
    ("before", STATE),
)
