"""Fields of the records of the inertia module, in SI units.

- p: parameters. u: inputs, each with its rate and a flag for the rate. y: outputs and local variables.
  Their fields follow from the table of variables (interface/models.py).
- d: p, followed by CONSTANTS. x: STATE. w: WORKSPACE, whose values do not outlive a call.

A field is one of:

- a name: one double;
- a name and a length: an array of doubles;
- a name and a list of fields: an inner record;
- a name, a list of fields and a number: an array of records.

All doubles of a record are also one array, `numbers`, so a state can be copied in one piece.
"""

from .equations import losses

N_STAGES = 16  # stages of a Runge-Kutta pair, with those for its dense output
N_DENSE = 7  # coefficients of a dense output
N_INDICATORS = 6  # event indicators of freewheels, slip and mesh 2-16 (events.guards)
MAX_SATELLITES = 24  # maximum number of satellites; each has an event indicator
N_CAUSES = len(losses.CAUSES)  # causes of losses
# Size of the map of fidelity averaged (averaged.torque_map): speed ratios, slownesses, causes of losses
N_RATIOS, N_SLOWNESSES, N_LOSSES = 21, 15, 4

# Motion at the beginning of an internal step, for the peak of the bearing force (loads)
BEGINNING = (
    "q",  # rad
    *("omega1", "rate_q"),  # rad/s
    *("alpha1", "rate2_q"),  # rad/s^2
)

# Motion at an instant
MOTION = (
    "q",  # angle of the pinion shaft, rad
    "theta1",  # angle of link 1, rad
    *("omega1", "omega2", "omega3"),  # rad/s
    "twist",  # of the elastic shaft, rad
    "relative",  # slip of the elastic shaft, omega3 - omega4, rad/s
    *("wound_housing", "wound_output"),  # wind-up of the freewheels, rad
)
# Remaining engagement angle of each freewheel, rad
PLAY = ("play_housing", "play_output")
# Accelerations, torques and reduced inertia at an instant
NOW = (
    *("alpha1", "alpha2", "alpha3", "rate_relative"),  # rad/s^2
    *("drive", "mesh", "output", "housing"),  # M1, M2, Tc, Th, N m
    *("i", "b", "g"),  # I, B, G, kg m^2
)
# Sums over the communication step
SUMS = (
    *("input_impulse", "mesh_impulse", "output_impulse", "housing_impulse"),  # N m s
    *("input_jump", "output_jump"),  # impulses of M1 and Tc at a jump at the beginning of the step, N m s
    "output_square",  # integral of Tc^2, N^2 m^2 s
    "turned3",  # angle of the output, rad
    "step_lost",  # energy lost, J
    "step_evaluations",  # evaluations of the equations of motion
    "largest_square",  # maximum of |a|^2 of imbalance 0 before the last internal step, m^2/s^4
    # Length, s, and change of q, rad, of the last internal step; 0 if largest_square includes it
    *("last_step", "last_turn"),
    *("torque_peak", "housing_torque_peak"),  # N m
    *("housing_slip_peak", "output_slip_peak"),  # rad/s
)
OF_MOTION, OF_NOW, OF_SUMS = len(MOTION), len(NOW), len(SUMS)

STATE = (
    *MOTION,
    *SUMS,
    *("drive_turns", "input_turns"),  # whole revolutions taken off the angles
    "mode",  # contact mode (codes)
    "alpha1",  # acceleration of link 1, prescribed or by its torque, rad/s^2
    "last_input_speed",  # input speed of the last step, for its extrapolation, rad/s
    *("load_torque", "drive_torque"),  # means over the step, N m
    *("step_size", "short_size"),  # next step of the pairs 8(5,3) and 5(4), s
    *("energy_in", "energy_out", ("lost", N_CAUSES)),  # since the start, J
    *("energy_start", "energy_stored"),  # J
    *("input_torque_mean", "output_torque_mean", "torque_ripple"),  # over the step, N m
    *("switches", "housing_engagements", "output_engagements"),  # counters since the start
    "evaluations",  # of the equations of motion since the start
    *("output_angle", "output_turns"),  # of the output shaft, rad and whole revolutions
    # The present or last communication step
    "length",  # s
    *("begin_q", "begin_omega2", "begin_theta1"),  # rad, rad/s, rad
    *("begin_input_turns", "begin_drive_turns"),  # revolutions
    ("step_beginning", BEGINNING),
    # Contacts (equations.states)
    *("housing_state", "output_state"),
    "slip_sign",  # sign of omega1 - omega2; 0 if the links stick
    "flow_sign",  # sign of the power through the mesh of the pinion shaft
    "tau6_signs",  # signs of the torques tau6 in the meshes 17-6, one bit each (1: negative)
    # End of the last internal step
    "mode_ended",  # 1 if a contact mode has ended
    "slip_reached_zero",  # 1 if the slip has become 0
    "event_pending",  # 1 if the communication step has stopped just before an event
    "mean_step",  # averaged: next internal step, s
    "torques_continue",  # 1 if the contact mode holds under the same torques
    "rates_cached",  # 1 if `now` is valid at this instant
    *PLAY,
    ("now", NOW),
)

# Column of the map of fidelity averaged, for one speed ratio. The slowness is V0 / V with V = |omega1| + V0
COLUMN = (
    ("torque", N_SLOWNESSES),  # mean torque over V^2, kg m^2
    ("link2", N_SLOWNESSES),  # mean omega2 over |omega1|
    ("lost", N_SLOWNESSES * N_LOSSES),  # power lost over |omega1| V^2, kg m^2
    "inertia",  # twice the mean energy over omega1^2, less J1, kg m^2
    *("ripple", "peak"),  # standard deviation and maximum of the output torque over omega1^2, kg m^2
)
# Map for one sign of omega1
SIDE = (
    "direction",  # sign of omega1
    "end",  # last speed ratio
    "locks",  # 1 if link 2 reaches the speed of link 1 there in free flight
    "v0",  # V0, the input speed at which friction and drag take the stall torque, rad/s; 0 without them
    ("slowness", N_SLOWNESSES),  # slownesses of the grid, ascending
    ("columns", COLUMN, N_RATIOS),
)
# Means of the steady motion at a speed and a ratio
STEADY = (
    "torque",  # N m
    "omega2",  # rad/s
    "inertia",  # kg m^2
    "slope",  # of the inertia over the ratio, kg m^2
    "resistance",  # power lost over |omega1|, N m
    ("lost", N_CAUSES),  # the same for each cause, N m
)
# Rates of the mean motion
MEAN = (
    *("omega1", "omega3"),  # rad/s^2
    *("theta1", "theta2", "theta3"),  # rad/s
    *("drive", "mesh", "output"),  # torques, N m
    ("lost", N_CAUSES),  # W
)

# One evaluation of the equations of motion
MACHINE = (
    *MOTION,
    *("applied1", "applied_q"),  # torques of gravity and windage on theta1 and q, N m
    ("lost", N_CAUSES),  # powers of the speed-dependent losses, W
    "journals",  # C, friction of the satellite bearings against q, N m
    "mesh_friction",  # S, friction of the meshes 17-6 against q, N m
    "flow_torque",  # torque tau of the mesh 2-16 times the sign of the slip, N m
    "flow_sign",  # sign of the power through the mesh of the pinion shaft
    "friction_reserve",  # friction that sticking links do not use, N m; negative if they begin to slip
    "tau6_signs",  # signs of the torques tau6 in the meshes 17-6, one bit each (1: negative)
    ("mesh_friction_by", MAX_SATELLITES),  # contribution of each satellite to `mesh_friction`, N m
    *PLAY,
    *NOW,
)

# Integrated quantities; the ideal module with a rigid output has the first 12
INTEGRATED = (
    "q",  # rad
    *("omega1", "omega2", "omega3"),  # rad/s
    *("drive", "housing", "output"),  # impulses of M1, Th and Tc, N m s
    "square",  # integral of Tc^2, N^2 m^2 s
    *("theta1", "turned3"),  # angles of link 1 and of the output shaft, rad
    *("work_in", ("lost", N_CAUSES)),  # J
    *("twist", "relative"),  # rad, rad/s
    *("wound_housing", "wound_output"),  # rad
)

CONSTANTS = (
    *("k", "s"),  # gear ratios
    "mass",  # of all imbalances, kg
    "planar",  # 1 for the planar layout
    *("phase_a", "phase_b"),  # phases of the angles A and B, rad
    *("radial", "radial_cos", "arm", "axial", "axial_cos"),  # lengths of the position of an imbalance, m
    *("pole_offset", "pole_arm", "spin_square"),  # in |r'|^2 (parameters.derive_bevel), m, m, m^2
    *("period", "period_low"),  # period of q as the sum of two doubles, rad
    "period_turns",  # revolutions of the pinion shaft in a period
    "harmonic",  # highest harmonic of q in the reduced inertia
    *("F_by_slip", "F_by_speed", "F_by_alpha1"),  # bounds of |F| over slip^2, omega1^2 and |alpha1|, kg m^2
    "gear_inertia",  # 1 if I and B have terms of the satellite gears that depend on q
    *("gear_i", "gear_b"),  # amplitudes of these terms of I and B, kg m^2
    *("J1", "J2", "J3", "J4", "J16"),  # kg m^2
    "by_torque",  # 1 if a torque drives link 1
    "elastic",  # 1 if the elastic shaft is integrated
    "rigid_shaft",  # 1 if the elastic shaft is so stiff that it is rigid
    *("b1", "bq", "b2", "b3"),  # viscous friction, N m s/rad
    "viscous",  # 1 if one of them is not 0
    "averaged",  # 1 for fidelity averaged
    "averaged_losses",  # 1 for fidelity averaged with losses or backlash
    "losses",  # 1 if the equations of motion with losses, drag, gravity or wind-up are necessary
    *("mesh_loss", "satellite_loss"),  # 1 - efficiency
    "weight",  # of all imbalances, N
    "backlash",  # 1 if a freewheel has an engagement angle
    "freewheel_angles",  # 1 if an angle of a freewheel is integrated
    *("turn_across", "turn_along"),  # rotation of a satellite per q: product with axis x over cos A, square
    ("machine", MACHINE),
    *(("steady", STEADY), ("mean", MEAN)),  # averaged: means and rates at an instant
    "map_ready",  # 1 if the map is valid, -1 if it has been overwritten, 0 before the first one
    "map_lock",  # maximum torque of lock-up over omega1^2, kg m^2
    "map_evaluations",  # evaluations of the equations of motion for the map
    *(("forward", SIDE), ("backward", SIDE)),
)

WORKSPACE = (
    "stops",  # 1 if the communication step stops before its first switching event
    "tolerance",  # relative, of the present step
    # The present internal step
    "pair",  # row of the Runge-Kutta pair (tableau)
    "prescribed",  # torque, N m, or acceleration, rad/s^2, of link 1
    "load",  # N m
    "step",  # length, s
    *("momentum", "energy", "potential"),  # at the beginning of the step, N m s, J, J
    ("rates", INTEGRATED, N_STAGES),  # at each stage
    *(("change", INTEGRATED), ("inside", INTEGRATED)),  # change over the step and over a part
    (
        "indicators",
        (("value", N_STAGES), ("rate", N_STAGES), ("dense", N_DENSE)),
        N_INDICATORS + MAX_SATELLITES,
    ),
    ("weights", N_STAGES),  # of the stages for a part of the step
    ("scale", INTEGRATED),  # scale of each error; 0 if the error does not count (events.error)
    # Periodic orbit
    "orbit_start",  # angle of the pinion shaft at the beginning of the period, rad
    "orbit_torque",  # input torque, N m
    "orbit_energy",  # mean kinetic energy, J
    ("column", COLUMN),  # of the map, at constant input speed
    # Mean motion (averaged.integrate)
    *(("means", MEAN, 2), ("mean_slopes", MEAN, 2)),  # rates at both stages, derivatives by omega1 and omega3
    *(("mean_stages", MEAN, 2), ("mean_change", MEAN)),
    "mean_length",  # of the step, s
    # State at the beginning of the call; a state to return to; the state of an orbit of the map
    *(("before", STATE), ("saved", STATE), ("orbit", STATE)),
)
