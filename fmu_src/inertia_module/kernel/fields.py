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
# ... of the stiff step, and how many quantities it solves for
SOLVED, MOVING = 8, 9
# their guards, and the satellites that may have one each (equations.satellites.MANY)
GUARDS, SATELLITES = 6, 50
# causes of losses
CAUSES = len(losses.CAUSES)
# knots of the averaged map at most, for one sign of omega1
KNOTS = 64

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

# a ..._low is what the field before it lost to rounding (compensated sums), so that a billion tiny
# communication steps add up to the same motion as one long step
STATE = (
    *MOTION,
    *SUMS,
    *("q_low", "drive_turns", "theta1_low", "input_turns"),
    *("omega1_low", "omega2_low", "omega3_low", "mode"),
    *("alpha1", "held_input", "load_torque", "drive_torque", "step_size", "short_size"),
    # ... rigid output: the size in each contact mode when it was left, the mode of step_size; averaged: sizes
    # of gentle steps in each leg
    *(("sizes", 4), "sized_mode"),
    *("energy_in", "energy_in_low", "energy_out", "energy_out_low"),
    *(("lost", CAUSES), ("lost_low", CAUSES)),
    *("energy_start", "energy_stored", "input_torque_mean", "output_torque_mean"),
    "torque_ripple",
    *("switches", "housing_engagements", "output_engagements"),
    *("evaluations", "output_angle", "output_angle_low", "output_turns"),
    # the communication step in hand, or the last one: its length, the state it began with, moments of it
    *("length", "begin_q", "begin_omega2"),
    *("begin_theta1", "begin_input_turns", "begin_drive_turns", ("moments", MOMENT, MOMENTS)),
    # elastic output: of twist, and of omega3 - omega4, which would cancel if omega4 were kept instead
    *("twist_low", "relative_low"),
    # general: what freewheels and slip do
    *("housing_state", "output_state", "slip_sign", "flow_sign", "spin_signs"),
    # ... and how the last internal step has ended; whether a step has stopped at a switch yet to come
    *("ended", "slip_reached_zero", "switching"),
    # averaged: the knot of the map last used; the speed that its torques go with, if that is not omega1
    *("map_knot", "map_speed"),
    # by events: whether the contact mode continues under the same torques, with what is prescribed; whether
    # the accelerations and torques of this instant are kept (without losses)
    *("torques_continue", "prescribed", "load_prescribed", "rates_cached"),
    *PLAY,
    ("now", NOW),
)

# averaged: a knot of the map over the speed ratio: curves of mean torque, mean speed of link 2, the mean
# energy or, under its torque, speed of link 1, ripple and peak (see averaged.table); while the map is built
# the error of the interval that follows, the torque of link 1, and how the motion begins. Torques, speeds of
# link 2 and powers lost by cause stand there for so many motions: the ideal one and with losses those of
# averaged.table
MOTIONS = 9
CURVES = 2 * MOTIONS + 3
KNOT = (
    *("ratio", ("value", CURVES), ("slope", CURVES), "error"),
    *("drive", "begin_energy", "begin_omega2", ("lost", MOTIONS * CAUSES)),
)
# one side of the map for each sign of omega1: where the torque ends, whether lock-up is reached there; where
# a period begins and the largest momentum of link 2 at rest; with losses the speed at which friction takes
# the stall torque
SIDE = ("direction", "count", "end", "locks", "start", "thrown", "slow", ("knots", KNOT, KNOTS))

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
    *("b1", "bq", "b2", "b3", "viscous"),
    # whether it is fidelity averaged, with losses
    *("averaged", "lossy"),
    # what only the general equations of motion know, and whether any of it is there (kernel.equations)
    *("losses", "mesh_loss", "satellite_loss", "weight"),
    # whether freewheels have play, and whether angles of theirs are followed: play, wind-up
    *("plays", "turning"),
    *("turn_across", "turn_along"),
    ("machine", MACHINE),
    # averaged: rates of an instant (see averaged.rates); the map
    ("mean", FOLLOWED),
    *("map_ready", "map_lock", "map_inertia", "map_evaluations"),
    *(("forward", SIDE), ("backward", SIDE)),
)

# w, before a copy of d for the mechanism of a map, and two of the outputs that have rates: nothing in it
# outlives the call
WORKSPACE = (
    # whether a step ends at a switch; the tolerance that holds
    *("stops", "tolerance"),
    # the step in hand: row of its pair in the table of weights; torque or acceleration given at link 1, load,
    # length, angular momentum and kinetic energy at its beginning
    *("pair", "prescribed", "load", "step", "momentum", "energy"),
    # averaged: speed that counts as zero beside those at the beginning of the communication step
    "at_rest",
    # rates at the stages, changes over the step and over a part of it of all that is followed, and the guards
    *(("rates", FOLLOWED, STAGES), ("change", FOLLOWED), ("inside", FOLLOWED)),
    ("watched", (("value", STAGES), ("rate", STAGES), ("dense", DENSE)), GUARDS + SATELLITES),
    ("weights", STAGES),
    # the stiff step: changes at its stages, derivatives of all rates, what moves in it, linear equations
    *(("stages", FOLLOWED, SOLVED), ("slopes", FOLLOWED, MOVING), ("moves", MOVING), "moving"),
    *(("matrix", MOVING * MOVING), ("pivots", MOVING), ("right_side", MOVING)),
    # steady motion of a map: torque of link 1; at the beginning energy, over that of v = 1, and omega2
    *("drive", "begin_energy", "begin_omega2", ("knot", KNOT)),
    # ... and sums over it
    *("sum_time", "sum_torque", "sum_square", "sum_energy"),
    *("sum_gain", "sum_omega1", "sum_omega2", "sum_peak"),
    ("sum_lost", CAUSES),
    # state at the beginning of the call, of two short steps for rates, of a part of a step
    *(("before", STATE), ("kept", STATE), ("part", STATE)),
)
