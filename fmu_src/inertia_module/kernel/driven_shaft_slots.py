"""Where each number of DrivenShaft lives in its arrays; the status codes are those of :mod:`.slots`.

:mod:`inertia_module.driven_shaft_variables` gives p, u and y their names, units and ranges.
"""

# p: parameters, in the order of the table of variables
P_DRIVEN_INERTIA = 0
P_STIFFNESS = 1
P_DAMPING = 2
P_FRICTION = 3
P_BALANCER = 4
P_INPUT_HOLD = 5
P_OMEGA_OUT_START = 6
P_TWIST_START = 7
P_SIZE = 8

# u: inputs, their rates over the coming step, and whether each rate is given
U_HUB_SPEED = 0
U_LOAD_TORQUE = 1
U_HUB_SPEED_RATE = 2
U_LOAD_TORQUE_RATE = 3
U_HUB_SPEED_RATE_GIVEN = 4
U_LOAD_TORQUE_RATE_GIVEN = 5
U_SIZE = 6

# y: outputs, then locals, in the order of the table of variables
Y_SHAFT_TORQUE = 0
Y_SHAFT_TORQUE_MEAN = 1
Y_OMEGA_OUT = 2
Y_ACCELERATION = 3
Y_TWIST = 4
Y_ENERGY_IN = 5
Y_ENERGY_OUT = 6
Y_ENERGY_STORED = 7
Y_ENERGY_LOST = 8
Y_ENERGY_RESIDUAL = 9
Y_SIZE = 10

# x: state. A ..._LOW slot is what the slot before it lost to rounding (compensated sums).
X_TWIST = 0
X_TWIST_LOW = 1
X_OMEGA4 = 2
X_OMEGA4_LOW = 3
X_HUB_SPEED = 4
X_HUB_SPEED_LOW = 5
X_HUB_SLOPE = 6
X_HELD_INPUT = 7
X_HELD_STEP = 8
X_LOAD_TORQUE = 9
X_ACCELERATION = 10
X_SHAFT_TORQUE_MEAN = 11
X_ENERGY_IN = 12
X_ENERGY_IN_LOW = 13
X_ENERGY_OUT = 14
X_ENERGY_OUT_LOW = 15
X_ENERGY_LOST = 16
X_ENERGY_LOST_LOW = 17
X_ENERGY_START = 18
X_SIZE = 19

# d: constants derived from the parameters, all per inertia: the characteristic equation is
# lambda^2 + D_RATE lambda + D_SQUARE = 0; what D_SWING, D_SLOW, D_FAST are tells propagator.characteristic
D_RATE = 0
D_SQUARE = 1
D_SWING = 2
D_SLOW = 3
D_FAST = 4
# the communication step last taken, the answers to it and at the nodes within it (kept_responses)
D_STEP = 5
D_RESPONSES = 6
D_NODES = 13
D_SIZE = D_NODES + 48

# w: workspace of one call: the motion over the step in hand. From impulse, its rate slope and its integrals
# one, two ... of propagator.responses, both speeds are
#     slip = W_SLIP slope + W_SLIP_PULL impulse + W_SLIP_RAMP one
#     omega4 = W_OMEGA4 + W_SPEED_RATE impulse + W_SPEED_PULL one + W_SPEED_RAMP two
#            = W_OMEGA4 slope + W_FRESH_RATE impulse + W_FRESH_PULL one + W_SPEED_RAMP two
# and the twist follows as the integral of the slip, or anew from the twist at the beginning:
#     twist = (twist) step + W_SLIP impulse + W_TWIST_PUSH one + W_SLIP_RAMP two
W_SLIP = 0
W_SLIP_PULL = 1
W_SLIP_RAMP = 2
W_OMEGA4 = 3
W_SPEED_RATE = 4
W_SPEED_PULL = 5
W_SPEED_RAMP = 6
W_FRESH_RATE = 7
W_FRESH_PULL = 8
W_TWIST_PUSH = 9
W_STATE = 10
W_SIZE = W_STATE + X_SIZE

# status codes of its own
BAD_HUB_SPEED = 30
BAD_HUB_SPEED_RATE = 31
