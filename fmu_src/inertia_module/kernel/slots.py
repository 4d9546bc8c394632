"""Where each number lives in the arrays the kernel reads and writes.

p parameters, u inputs, x state, y outputs and locals, d constants derived from p, w workspace.
:mod:`inertia_module.variables` gives p, u and y their names, units and ranges.
"""

# p: parameters, in the order of the table of variables
P_LAYOUT = 0
P_Z2 = 1
P_Z16 = 2
P_Z17 = 3
P_Z6 = 4
P_SHAFT_ANGLE = 5
P_WHEEL_RADIUS = 6
P_A = 7
P_B = 8
P_C = 9
P_EPSILON = 10
P_GAMMA = 11
P_SUN_RADIUS = 12
P_SATELLITE_RADIUS = 13
P_ECCENTRICITY = 14
P_IMBALANCE_MASS = 15
P_MODULES = 16
P_SATELLITES = 17
P_J16 = 18
P_J1 = 19
P_J2 = 20
P_J3 = 21
P_J4 = 22
P_SHAFT_STIFFNESS = 23
P_SHAFT_DAMPING = 24
P_DRIVEN_FRICTION = 25
P_BALANCER = 26
P_HOUSING_FREEWHEEL = 27
P_OUTPUT_FREEWHEEL = 28
P_FIDELITY = 29
P_METHOD = 30
P_DRIVE = 31
P_INPUT_HOLD = 32
P_TOLERANCE = 33
P_MAX_STEP = 34
P_KINEMATIC_RATIO = 35
P_OMEGA2_START = 36
P_OMEGA_OUT_START = 37
P_DRIVE_ANGLE_START = 38
P_SIZE = 39

# u: inputs, their rates over the coming step, and whether each rate is given
U_OMEGA1 = 0
U_LOAD_TORQUE = 1
U_DRIVE_TORQUE = 2
U_OMEGA1_RATE = 3
U_LOAD_TORQUE_RATE = 4
U_DRIVE_TORQUE_RATE = 5
U_OMEGA1_RATE_GIVEN = 6
U_LOAD_TORQUE_RATE_GIVEN = 7
U_DRIVE_TORQUE_RATE_GIVEN = 8
U_SIZE = 9

# y: outputs, then locals, in the order of the table of variables
Y_OMEGA2 = 0
Y_OMEGA_OUT = 1
Y_INPUT_TORQUE = 2
Y_MESH_TORQUE = 3
Y_OUTPUT_TORQUE = 4
Y_HOUSING_TORQUE = 5
Y_INPUT_TORQUE_MEAN = 6
Y_OUTPUT_TORQUE_MEAN = 7
Y_ACCELERATION = 8
Y_ACCELERATION_X = 9
Y_ACCELERATION_Y = 10
Y_ACCELERATION_Z = 11
Y_INPUT_SPEED = 12
Y_DRIVE_ANGLE = 13
Y_DRIVE_TURNS = 14
Y_INPUT_ANGLE = 15
Y_INPUT_TURNS = 16
Y_CONTACT_MODE = 17
Y_OMEGA_HUB = 18
Y_SHAFT_TWIST = 19
Y_POSITION_X = 20
Y_POSITION_Y = 21
Y_POSITION_Z = 22
Y_VELOCITY_X = 23
Y_VELOCITY_Y = 24
Y_VELOCITY_Z = 25
Y_ENERGY_IN = 26
Y_ENERGY_OUT = 27
Y_ENERGY_STORED = 28
Y_ENERGY_LOST = 29
Y_ENERGY_RESIDUAL = 30
Y_TORQUE_RIPPLE = 31
Y_TORQUE_PEAK = 32
Y_CONTACT_SWITCHES = 33
Y_RHS_EVALUATIONS = 34
Y_SIZE = 35

# x: state. A ..._LOW slot is what the slot before it lost to rounding (compensated sums), so that
# a billion tiny communication steps add up to the same motion as one long step.
X_Q = 0
X_Q_LOW = 1
X_DRIVE_TURNS = 2
X_THETA1 = 3
X_THETA1_LOW = 4
X_INPUT_TURNS = 5
X_OMEGA2 = 6
X_OMEGA2_LOW = 7
X_OMEGA3 = 8
X_OMEGA3_LOW = 9
X_MODE = 10
X_OMEGA1 = 11
X_OMEGA1_LOW = 12
X_ALPHA1 = 13
X_HELD_INPUT = 14
X_HELD_STEP = 15
X_LOAD_TORQUE = 16
X_DRIVE_TORQUE = 17
X_STEP_SIZE = 18
X_ENERGY_IN = 19
X_ENERGY_IN_LOW = 20
X_ENERGY_OUT = 21
X_ENERGY_OUT_LOW = 22
X_ENERGY_START = 23
X_INPUT_TORQUE_MEAN = 24
X_OUTPUT_TORQUE_MEAN = 25
X_TORQUE_RIPPLE = 26
X_SWITCHES = 27
X_EVALUATIONS = 28
# sums over the communication step in hand
X_INPUT_IMPULSE = 29
X_OUTPUT_IMPULSE = 30
X_OUTPUT_SQUARE = 31
X_STEP_SWITCHES = 32
X_STEP_EVALUATIONS = 33
X_TORQUE_PEAK = 34
# elastic output: twist, and omega3 - omega4, which would cancel if omega4 were kept instead
X_TWIST = 35
X_TWIST_LOW = 36
X_RELATIVE = 37
X_RELATIVE_LOW = 38
X_ENERGY_LOST = 39
X_ENERGY_LOST_LOW = 40
# averaged: the row of the map last used
X_MAP_ROW = 41
X_SIZE = 42

# d: constants derived from the parameters
D_K = 0
D_S = 1
D_MASS = 2
D_PLANAR = 3
D_SINGLE = 4
D_PAIRED = 5
D_PHASE_A = 6
D_PHASE_B = 7
D_RADIAL = 8
D_RADIAL_COS = 9
D_ARM = 10
D_AXIAL = 11
D_AXIAL_COS = 12
D_POLE_OFFSET = 13
D_POLE_ARM = 14
D_SPIN = 15
D_PERIOD = 16
D_PERIOD_LOW = 17
D_PERIOD_TURNS = 18
D_HARMONIC = 19
D_G_SLOPE = 20
D_I_SLOPE = 21
D_ALPHA_SLOPE = 22
D_J1 = 23
D_J2 = 24
D_J3 = 25
D_J16 = 26
D_HOUSING = 27
D_OUTPUT = 28
D_TOLERANCE = 29
D_MAX_STEP = 30
D_J4 = 31
D_STIFFNESS = 32
D_DAMPING = 33
D_FRICTION = 34
D_BALANCER = 35
# square of the slowest shaft whose own motion is followed, over that of the pulses
D_FOLLOWED = 36
# collocation of the elastic output: A, A A and the Lagrange polynomials, 5 x 5 each
D_RADAU = 37
D_RADAU_SQUARE = 62
D_LAGRANGE = 87
# averaged: the map of mean torque, its key, and sums while it is built (see average_map)
D_AVERAGED = 112
D_MAP_KEY = D_AVERAGED
D_SUM_TIME = D_MAP_KEY + 24
D_SUM_TORQUE = D_SUM_TIME + 1
D_SUM_SQUARE = D_SUM_TIME + 2
D_SUM_ENERGY = D_SUM_TIME + 3
D_SUM_ANGLE = D_SUM_TIME + 4
D_SUM_PEAK = D_SUM_TIME + 5
D_MAP_EVALUATIONS = D_SUM_TIME + 6
# lock-up: largest torque over omega1^2
D_MAP_LOCK = D_SUM_TIME + 7
# one header a sign of omega1: knots, speed ratio where the torque ends, whether lock-up is reached
D_MAP_FORWARD = D_SUM_TIME + 8
D_MAP_BACKWARD = D_MAP_FORWARD + 8
D_MAP_KNOTS = D_MAP_BACKWARD + 8
# one row a knot
MAP_ROWS = 64
MAP_ROW = 16
D_SIZE = D_MAP_KNOTS + 2 * MAP_ROWS * MAP_ROW

# w: workspace of one call (nothing in it outlives the call)
# stage blocks of the integrator: stages 1, 6 to 12, the end of the step, stages 14 to 16
W_RATE_Q = 0
W_RATE_OMEGA2 = 12
W_MOMENTUM = 24
W_DENSE_Q = 36
W_DENSE_OMEGA2 = 43
W_DENSE_OTHER = 50
# the step in hand
W_OMEGA1 = 57
W_ALPHA1 = 58
W_LOAD = 59
W_STEP = 60
W_SHAFT_INERTIA = 61
W_SHAFT_TORQUE = 62
# inertia at the beginning of a fixed step, omega1 given or the torque (in place of the stages)
W_KEPT_I = 0
W_KEPT_I1 = 1
W_KEPT_B = 2
W_KEPT_G = 3
W_KEPT_TOTAL = 0
W_KEPT_SHARE = 1
W_KEPT_ROOT = 2
W_KEPT_BEND = 3
W_SLOPE = 4
W_IMPULSE = 5
W_SUM = 6
W_RELATIVE_GAIN = 7
W_TWIST_GAIN = 8
W_LAG = 9
# which step is in hand: of a pulse 0, of the elastic output 1, the same with given torque -1 and 2
W_COLLOCATED = 63
# the step in hand of the elastic output: matrices of the shaft, 5 x 5 each
W_INVERSE = 64
W_GAIN = 89
W_SHAFT = 114
W_JACOBIAN = 139
# and numbers at its five stages
W_RATE2 = 164
W_RATE3 = 169
W_RATE_RELATIVE = 174
W_STAGE_Q = 179
W_STAGE_OMEGA2 = 184
W_STAGE_OMEGA3 = 189
W_STAGE_RELATIVE = 194
W_STAGE_SHAFT_TORQUE = 199
W_STAGE_CLUTCH = 204
W_RIGHT_SIDE = 209
W_SHAFT_RIGHT_SIDE = 214
# polynomials of omega2, omega3 and the torque that a guard looks at
W_POLYNOMIAL_2 = 219
W_POLYNOMIAL_3 = 225
W_POLYNOMIAL_TORQUE = 231
# torque-driven: link 1 in the blocks of the integrator, and all twelve stages while they are made
W_RATE_OMEGA1 = 236
W_DENSE_OMEGA1 = 248
W_DRIVE_TORQUE = 255
W_ALL_Q = 256
W_ALL_OMEGA1 = 268
W_ALL_OMEGA2 = 280
# rates and speeds of link 1 at the five stages of the elastic output
W_RATE1 = 292
W_STAGE_OMEGA1 = 297
W_STAGE_RELEASE = 302
# equations of both links, 5 x 5 each: of the first by the rates of omega2 with its right side (5 x 6), of the
# second by those of omega1 and of omega2, and the update of the rates of omega1
W_LINK_COLUMNS = 307
W_LINK_LOWER = 337
W_LINK_CORNER = 362
W_LINK_UPDATE = 387
W_STATE = 392
# state and outputs at the beginning and after the first of the two short steps that rates are found from
W_KEPT_STATE = W_STATE + X_SIZE
W_OUTPUTS_0 = W_KEPT_STATE + X_SIZE
W_OUTPUTS_1 = W_OUTPUTS_0 + Y_SIZE
# state at the beginning of a part of a step, averaged and with given torque
W_PART_STATE = W_OUTPUTS_1 + Y_SIZE
W_SIZE = W_PART_STATE + X_SIZE

# contact modes
HELD = 0
FREE = 1
DRIVING = 2
HELD_DRIVING = 3

# values of W_COLLOCATED
PULSE = 0.0
COLLOCATED = 1.0
DRIVEN_PULSE = -1.0
DRIVEN_COLLOCATED = 2.0

# guards of a contact mode: of the speed of link 2 or its release, and of the output freewheel
NONE = -1
LINK2 = 0
OUTPUT = 1

# fidelities and methods
KINEMATIC = 0
AVERAGED = 1
RIGID = 2
ELASTIC = 3
EVENT = 0
TIMESTEPPING = 1

# what drives link 1
DRIVE_SPEED = 0
DRIVE_TORQUE = 1

# operations of the entry of a kernel
START = 0
STEP = 1
# only the checks of START: changes nothing but d
CHECK = 2
# STEP without the late outputs, which cost more than a step of fidelity averaged; OUTPUTS fills them in,
# where a shell is asked for one of them
STEP_ONLY = 3
OUTPUTS = 4
# STEP with little noise in its results, for differences of them
STEP_SMOOTHLY = 5
# rates of the outputs in place of the outputs; u and x are left with no meaning
RATES = 6

# status codes
OK = 0
SINGULAR = 3
BAD_START_HOUSING = 4
BAD_START_OUTPUT = 5
BAD_START_RIGID = 6
NO_RECTIFIER = 7
NO_INPUT_INERTIA = 8
PRESCRIBED = 9
BAD_OMEGA1 = 10
BAD_LOAD_TORQUE = 11
BAD_STEP = 12
BAD_OMEGA1_RATE = 13
BAD_LOAD_TORQUE_RATE = 14
BAD_DRIVE_TORQUE = 15
BAD_DRIVE_TORQUE_RATE = 16
TOO_MANY_SWITCHES = 20
TOO_MUCH_WORK = 21
STEP_TOO_SMALL = 22
NOT_FINITE = 23
