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

STAGES = 16  # stages of a Runge-Kutta pair, with those for its dense output
DENSE = 7  # coefficients of a dense output
GUARDS = 6  # event indicators of freewheels and slip
SATELLITES = 24  # maximum number of satellites; each has an event indicator
CAUSES = len(losses.CAUSES)  # causes of losses
# Map of fidelity averaged (averaged.torque_map): speed ratios, slownesses, causes of losses
RATIOS, SLOWNESSES, LOSSES = 21, 15, 4

# Beginning of an internal step, for the peak of the bearing force (loads)
MOMENT = (
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
    "relative",  # omega3 - omega4, rad/s
    *("wound_housing", "wound_output"),  # wind-up of the freewheels, rad
)
# Rest of the engagement angle of each freewheel, rad
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
    *("input_jump", "output_jump"),  # impulses of M1 and Tc at a jump at its beginning, N m s
    "output_square",  # integral of Tc^2, N^2 m^2 s
    "turned3",  # angle of the output, rad
    "step_lost",  # energy lost, J
    "step_evaluations",  # evaluations of the equations of motion
    "largest_square",  # maximum of |a|^2 of imbalance 0 before the last internal step, m^2/s^4
    *("last_step", "last_turn"),  # length, s, and change of q, rad, of this step; 0 if it is included
    *("torque_peak", "housing_torque_peak"),  # N m
    *("housing_slip_peak", "output_slip_peak"),  # rad/s
)
OF_MOTION, OF_NOW, OF_SUMS = len(MOTION), len(NOW), len(SUMS)

STATE = (
    *MOTION,
    *SUMS,
    *("drive_turns", "input_turns"),  # whole revolutions taken off the angles
    "mode",  # contact mode (codes)
    "alpha1",  # slope of a prescribed omega1, or the acceleration of a driven link 1, rad/s^2
    "held_input",  # input speed of the last step, for its extrapolation, rad/s
    *("load_torque", "drive_torque"),  # means over the step, N m
    *("step_size", "short_size"),  # next step of the pairs 8(5,3) and 5(4), s
    *("energy_in", "energy_out", ("lost", CAUSES)),  # since the start, J
    *("energy_start", "energy_stored"),  # J
    *("input_torque_mean", "output_torque_mean", "torque_ripple"),  # over the step, N m
    *("switches", "housing_engagements", "output_engagements"),  # numbers since the start
    "evaluations",  # of the equations of motion since the start
    *("output_angle", "output_turns"),  # rad, revolutions
    # The present or last communication step
    "length",  # s
    *("begin_q", "begin_omega2", "begin_theta1"),  # rad, rad/s, rad
    *("begin_input_turns", "begin_drive_turns"),  # revolutions
    ("last_begin", MOMENT),
    # Contacts (equations.states)
    *("housing_state", "output_state"),
    "slip_sign",  # sign of omega1 - omega2; 0 if the links stick
    "flow_sign",  # sign of the power through the mesh of the pinion shaft
    "spin_signs",  # signs of the torques at the satellites, one bit each
    # End of the last internal step
    "ended",  # 1 if a contact mode has ended
    "slip_reached_zero",  # 1 if the slip has become 0
    "switching",  # 1 if the communication step stopped just before an event
    "mean_step",  # averaged: next internal step, s
    "torques_continue",  # 1 if the contact mode holds under the same torques
    "rates_cached",  # 1 if `now` holds at this instant
    *PLAY,
    ("now", NOW),
)

# Column of the map of fidelity averaged, for one speed ratio; V is the speed of the slowness
COLUMN = (
    ("torque", SLOWNESSES),  # mean torque over V^2, kg m^2
    ("link2", SLOWNESSES),  # mean omega2 over |omega1|
    ("lost", SLOWNESSES * LOSSES),  # power lost over |omega1| V^2, kg m^2
    "inertia",  # twice the mean energy over omega1^2, less J1, kg m^2
    *("ripple", "peak"),  # standard deviation and maximum of the output torque over omega1^2, kg m^2
)
# Map for one sign of omega1
SIDE = (
    "direction",  # sign of omega1
    "end",  # last speed ratio
    "locks",  # 1 if link 2 reaches link 1 there
    "slow",  # V0, at which friction takes the stall torque, rad/s
    ("slowness", SLOWNESSES),  # slownesses of the grid, rising
    ("columns", COLUMN, RATIOS),
)
# Means of the steady motion at a speed and a ratio
STEADY = (
    "torque",  # N m
    "omega2",  # rad/s
    "inertia",  # kg m^2
    "slope",  # of the inertia over the ratio, kg m^2
    "resistance",  # power lost over |omega1|, N m
    ("lost", CAUSES),  # the same for each cause, N m
)
# Rates of the mean motion
MEAN = (
    *("omega1", "omega3"),  # rad/s^2
    *("theta1", "theta2", "theta3"),  # rad/s
    *("drive", "mesh", "output"),  # torques, N m
    ("lost", CAUSES),  # W
)

# One evaluation of the equations of motion
MACHINE = (
    *MOTION,
    *("weight1", "weight_q"),  # torques of gravity and of speed-dependent losses on theta1 and q, N m
    ("lost", CAUSES),  # powers of the speed-dependent losses, W
    "journals",  # friction of the satellite journals, N m
    "spun",  # friction of journals and satellite meshes that resists the slip, N m
    "torque",  # that links sticking together need at the pinion shafts, N m
    "flow_sign",  # sign of the power through the mesh of the pinion shaft
    "margin",  # of stiction, N m
    "spin_signs",  # signs of the torques at the satellites, one bit each
    ("spun_by", SATELLITES),  # contribution of each satellite to `spun`, N m
    *PLAY,
    *NOW,
)

# Integrated quantities; the ideal module with a rigid output has the first 12
FOLLOWED = (
    "q",  # rad
    *("omega1", "omega2", "omega3"),  # rad/s
    *("drive", "housing", "output"),  # impulses of M1, Th and Tc, N m s
    "square",  # integral of Tc^2, N^2 m^2 s
    *("theta1", "turned3"),  # rad
    *("work_in", ("lost", CAUSES)),  # J
    *("twist", "relative"),  # rad, rad/s
    *("wound_housing", "wound_output"),  # rad
)

CONSTANTS = (
    *("k", "s"),  # gear ratios
    "mass",  # of all imbalances, kg
    "planar",  # 1 for the planar layout
    *("phase_a", "phase_b"),  # phases of the angles A and B, rad
    *("radial", "radial_cos", "arm", "axial", "axial_cos"),  # lengths of the position of an imbalance, m
    *("pole_offset", "pole_arm", "spin"),  # lengths of |r'|, m, and a square, m^2
    *("period", "period_low"),  # of q, in two doubles, rad
    "period_turns",  # revolutions of the pinion shaft in a period
    "harmonic",  # highest harmonic of q in the reduced inertia
    *("F_by_slip", "F_by_speed", "F_by_alpha1"),  # bounds of |F| over slip^2, omega1^2 and |alpha1|, kg m^2
    "bodies",  # 1 if the satellite gears have an inertia that depends on q
    *("body_i", "body_b"),  # their parts of I and B, kg m^2
    *("J1", "J2", "J3", "J4", "J16"),  # kg m^2
    *("housing", "output"),  # 1 if the freewheel is present
    "by_torque",  # 1 if a torque drives link 1
    "elastic",  # 1 if the elastic shaft is integrated
    "rigid_shaft",  # 1 if the elastic shaft is so stiff that it is rigid
    *("b1", "bq", "b2", "b3"),  # viscous friction, N m s/rad
    "viscous",  # 1 if one of them is not 0
    "averaged",  # 1 for fidelity averaged
    "lossy",  # 1 for fidelity averaged with losses
    "losses",  # 1 if the general equations of motion are necessary
    *("mesh_loss", "satellite_loss"),  # 1 - efficiency
    "weight",  # of all imbalances, N
    "plays",  # 1 if a freewheel has an engagement angle
    "turning",  # 1 if an angle of a freewheel is integrated
    *("turn_across", "turn_along"),  # rotation of a satellite per q: product with axis x over cos A, square
    ("machine", MACHINE),
    *(("steady", STEADY), ("mean", MEAN)),  # averaged: means and rates at an instant
    "map_ready",  # 1 if the map is there, -1 if it was lost, otherwise 0
    "map_lock",  # maximum torque of lock-up over omega1^2, kg m^2
    "map_evaluations",  # evaluations of the equations of motion for the map
    *(("forward", SIDE), ("backward", SIDE)),
)

WORKSPACE = (
    "stops",  # 1 if the communication step ends at an event
    "tolerance",  # relative, of the present step
    # The present internal step
    "pair",  # row of the Runge-Kutta pair (tableau)
    "prescribed",  # torque, N m, or acceleration, rad/s^2, of link 1
    "load",  # N m
    "step",  # length, s
    *("momentum", "energy", "potential"),  # at its beginning, N m s, J, J
    ("rates", FOLLOWED, STAGES),  # at each stage
    *(("change", FOLLOWED), ("inside", FOLLOWED)),  # over the step and over a part of it
    ("watched", (("value", STAGES), ("rate", STAGES), ("dense", DENSE)), GUARDS + SATELLITES),
    ("weights", STAGES),  # of the stages for a part of the step
    ("scale", FOLLOWED),  # scale of each error; 0 if the error does not count (events.error)
    # Periodic orbit
    "orbit_start",  # angle of the pinion shaft at its beginning, rad
    "orbit_torque",  # input torque, N m
    "orbit_energy",  # mean kinetic energy, J
    ("column", COLUMN),  # of the map, at constant input speed
    # Mean motion (averaged.integrate)
    *(("means", MEAN, 2), ("mean_slopes", MEAN, 2)),  # rates at both stages, derivatives by omega1 and omega3
    *(("mean_stages", MEAN, 2), ("mean_change", MEAN)),
    "mean_length",  # of the step, s
    # States at the beginning of the call, of two steps for differences, and of a part of a step
    *(("before", STATE), ("kept", STATE), ("part", STATE)),
)
