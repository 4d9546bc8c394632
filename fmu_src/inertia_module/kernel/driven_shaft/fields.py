"""The records of DrivenShaft (see :mod:`.fields`)."""

STATE = (
    *("twist", "twist_low", "slip", "slip_low", "omega4", "omega4_low"),
    *("hub_slope", "held_input", "held_step", "load_torque", "shaft_torque_mean", "energy_start"),
    *("energy_in", "energy_in_low", "energy_out", "energy_out_low", "energy_lost", "energy_lost_low"),
)
# all per inertia: the characteristic equation is lambda^2 + rate lambda + square = 0; what swing, slow and
# fast are tells motion.characteristic. Then the step last taken, the responses to it and its Gramian
CONSTANTS = ("rate", "square", "swing", "slow", "fast", "step", ("responses", 7), ("gramian", 16))
# z1 to z4 of the motions over the step in hand, room for the Gramian (motion), the state before the step
WORKSPACE = (
    *(("twist", 4), ("slip", 4), ("slip_rate", 4), ("speed", 4), ("speed_rate", 4)),
    *(("move", 16), ("product", 16), ("before", STATE)),
)
