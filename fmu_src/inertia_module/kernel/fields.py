"""The records the module's kernel reads and writes, by the names of their fields.

p parameters, u inputs (with omega1_rate, its rate over the coming step, omega1_rate_given, and so on), y
outputs and locals: their fields are made from the table of variables (contract/models.py). First in p
stands what the map of fidelity averaged depends on. x is the state, d what is derived from the parameters, w
the workspace of one call. A field is a name (one double), a name with a length (an array of doubles), or a
name with a list of fields (a record within) and maybe a number (so many).
Every record has its doubles in one row besides, as `numbers`: so a state is copied whole.
"""

from .equations import losses

# stages of the explicit pair, with those for the inside of a step; its interpolants
STAGES = 16
DENSE = 7
# averaged: stages of its stiff step
SOLVED = 8
# their guards, and satellites at most (contract/variables.py), which have one each
GUARDS, SATELLITES = 6, 24
# causes of losses
CAUSES = len(losses.CAUSES)
# map of fidelity averaged: speed ratios, slownesses, causes of losses (averaged.torque_map)
RATIOS, SLOWNESSES, LOSSES = 21, 13, 4

# motion of links 1 and 2 at a moment, and how many moments of a step are kept (see loads)
MOMENT = ("q", "omega1", "omega2", "alpha1", "alpha2")
MOMENTS = 8

# motion of an instant, and what is kept of it from one step to the next: accelerations, torques, reduced
# inertia
MOTION = ("q", "theta1", "omega1", "omega2", "omega3", "twist", "relative", "wound_housing", "wound_output")
# play that is left until a freewheel which has overrun carries again
PLAY = ("play_housing", "play_output")
NOW = (
    *("alpha1", "alpha2", "alpha3", "rate_relative", "drive", "mesh", "output", "housing"),
    *("i", "b", "g"),
)
# of the communication step in hand, or the last one: impulses, angle of the output, energy lost, how many
# moments of it were seen, the largest |a|^2 of imbalance 0 before those kept, the largest torques and slips
SUMS = (
    *("input_impulse", "mesh_impulse", "output_impulse", "housing_impulse", "output_square", "turned3"),
    *("step_lost", "step_evaluations", "seen", "largest_square", "torque_peak"),
    *("housing_torque_peak", "housing_slip_peak", "output_slip_peak"),
)
OF_MOTION, OF_NOW, OF_SUMS = len(MOTION), len(NOW), len(SUMS)

STATE = (
    *MOTION,
    *SUMS,
    *("drive_turns", "input_turns"),
    "mode",
    *("alpha1", "held_input", "load_torque", "drive_torque", "step_size", "short_size"),
    *("energy_in", "energy_out", ("lost", CAUSES)),
    *("energy_start", "energy_stored", "input_torque_mean", "output_torque_mean"),
    "torque_ripple",
    *("switches", "housing_engagements", "output_engagements"),
    *("evaluations", "output_angle", "output_turns"),
    # the communication step in hand, or the last one: its length, the state it began with, moments of it
    *("length", "begin_q", "begin_omega2"),
    *("begin_theta1", "begin_input_turns", "begin_drive_turns", ("moments", MOMENT, MOMENTS)),
    # general: what freewheels and slip do
    *("housing_state", "output_state", "slip_sign", "flow_sign", "spin_signs"),
    # ... and how the last internal step has ended; whether a step has stopped at a switch yet to come
    *("ended", "slip_reached_zero", "switching"),
    # averaged: the next internal step, s
    "mean_step",
    # by events: whether the contact mode continues under the same torques, with what is prescribed; whether
    # the accelerations and torques of this instant are kept (without losses)
    *("torques_continue", "prescribed", "load_prescribed", "rates_cached"),
    *PLAY,
    ("now", NOW),
)

# averaged: the map has a column for each speed ratio, for each sign of omega1 (averaged.torque_map). In a
# column are, for each slowness, the mean torque over V^2, kg m^2, the mean of omega2 over |omega1|, and for
# each cause the power lost over |omega1| V^2, kg m^2. At infinite speed it has twice the mean energy over
# omega1^2 less J1, and RMS and peak of the output torque over omega1^2, kg m^2
COLUMN = (
    *(("torque", SLOWNESSES), ("link2", SLOWNESSES), ("lost", SLOWNESSES * LOSSES)),
    *("inertia", "ripple", "peak"),
)
# direction: sign of omega1; end: last ratio; locks: 1 if link 2 reaches link 1 there; slow: V0, rad/s
SIDE = ("direction", "end", "locks", "slow", ("columns", COLUMN, RATIOS))
# means of the steady motion at a speed and a ratio: torque, N m; omega2, rad/s; energy inertia, kg m^2, and
# its slope over the ratio; power lost over |omega1|, N m, in all and by cause
STEADY = ("torque", "omega2", "inertia", "slope", "resistance", ("lost", CAUSES))
# rates of the mean motion: two states; angles of link 1, link 2 and the output; torques at the input, the
# mesh and the output; powers lost, W
MEAN = (
    *("omega1", "omega3", "theta1", "theta2", "theta3", "drive", "mesh", "output"),
    ("lost", CAUSES),
)

# equations of motion: torques of weights and of losses that go by speeds, powers of these by cause; of the
# satellites journals and mesh, of links that stick together the torque at the drives that is needed and the
# rest
MACHINE = (
    *MOTION,
    *("weight1", "weight_q", ("lost", CAUSES), "journals", "spun", "torque", "flow_sign", "margin"),
    # signs of the loads of all satellites, as one number, and by these what each adds to spun
    *("spin_signs", ("spun_by", SATELLITES)),
    *PLAY,
    *NOW,
)

# what the equations of motion follow by events: speeds and angles; impulses of M1, Th and Tc, integral of
# Tc^2; angle of the output, work of M1 and losses by cause; angles by which freewheels turn back, into their
# play or their springs. An ideal module of rigid output has the first 12
FOLLOWED = (
    *("q", "omega1", "omega2", "omega3", "drive", "housing", "output", "square"),
    *("theta1", "turned3", "work_in", ("lost", CAUSES)),
    *("twist", "relative", "wound_housing", "wound_output"),
)

# d, behind all fields of p, of some of which derive makes something else
CONSTANTS = (
    *("k", "s", "mass", "planar", "phase_a", "phase_b"),
    *("radial", "radial_cos", "arm", "axial", "axial_cos", "pole_offset", "pole_arm", "spin"),
    *("period", "period_low", "period_turns", "harmonic", "F_by_slip", "F_by_speed", "F_by_alpha1"),
    # (F_by_...: bounds of |F|, the mesh torque, by the squares of slip and speed and by alpha1; then the
    # least inertia of a link over its largest)
    "lightest",
    # (J1 and J16 with what the turning satellite gears add at every angle, body_...: what varies, see bodies)
    *("bodies", "body_i", "body_b"),
    *("J1", "J2", "J3", "J4", "J16", "housing", "output", "by_torque", "elastic"),
    # whether the elastic shaft is so stiff that it is rigid
    "rigid_shaft",
    *("b1", "bq", "b2", "b3", "viscous"),
    # whether it is fidelity averaged, with losses
    *("averaged", "lossy"),
    # what only the general equations of motion know, and whether any of it is there (kernel.equations)
    *("losses", "mesh_loss", "satellite_loss", "weight"),
    # whether freewheels have play, and whether angles of theirs are followed: play, wind-up
    *("plays", "turning"),
    *("turn_across", "turn_along"),
    ("machine", MACHINE),
    # averaged: means and rates of an instant; the map, which is ready (1), absent (0) or lost (-1), the
    # largest torque of lock-up over omega1^2, kg m^2, and the right-hand-side evaluations of the map
    *(("steady", STEADY), ("mean", MEAN)),
    *("map_ready", "map_lock", "map_evaluations"),
    *(("forward", SIDE), ("backward", SIDE)),
)

# w, before two of the outputs that have rates: nothing in it outlives the call
WORKSPACE = (
    # whether a step ends at a switch; the tolerance that holds
    *("stops", "tolerance"),
    # the step in hand: row of its pair in the table of weights; torque or acceleration given at link 1, load,
    # length, angular momentum and kinetic energy at its beginning
    *("pair", "prescribed", "load", "step", "momentum", "energy", "potential"),
    # rates at the stages, changes over the step and over a part of it of all that is followed, and the guards
    *(("rates", FOLLOWED, STAGES), ("change", FOLLOWED), ("inside", FOLLOWED)),
    ("watched", (("value", STAGES), ("rate", STAGES), ("dense", DENSE)), GUARDS + SATELLITES),
    ("weights", STAGES),
    # by events: scale of the error of each integrated quantity, 0 if it does not count (events.error)
    ("scale", FOLLOWED),
    # periodic orbit: angle of the pinion shaft at its beginning, input torque, mean kinetic energy
    *("orbit_start", "orbit_torque", "orbit_energy"),
    # mean motion: rates at the beginning and at the second stage of a step, derivatives by omega1 and omega3,
    # stages, changes over the step
    *(("means", MEAN, 2), ("mean_slopes", MEAN, 2), ("mean_stages", MEAN, 2), ("mean_change", MEAN)),
    "mean_length",
    # state at the beginning of the call, of two short steps for rates, of a part of a step
    *(("before", STATE), ("kept", STATE), ("part", STATE)),
)
