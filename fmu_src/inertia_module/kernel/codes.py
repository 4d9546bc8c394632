"""Numbers of the kernel by name: contact modes, levels of fidelity, operations, statuses."""

# contact modes
HELD = 0
FREE = 1
DRIVING = 2
HELD_DRIVING = 3

# none of the guards (events.guards)
NONE = -1

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
STEP_PRECISELY = 5
# rates of the outputs in place of the outputs; u and x are left with no meaning
RATES = 6
# the sum of the warnings that hold; nothing is changed
WARN = 7
# parameters have changed between steps: derives d anew and forgets what x knows of the last step
TUNE = 8
# STEP_ONLY that ends early, just before the first switch of a freewheel within it; SWITCH carries that out,
# as the next step else does
STEP_TO_SWITCH = 9
SWITCH = 10

# warnings
PLANAR_OVERLAP = 1
BEVEL_OVERLAP = 2
PLANAR_OUTSIDE = 4
BEVEL_OUTSIDE = 8
GEAR_TOO_FLAT = 16
METHOD_DEPRECATED = 32

# status codes
OK = 0
SINGULAR = 3
BAD_START_HOUSING = 4
BAD_START_OUTPUT = 5
BAD_START_RIGID = 6
NO_RECTIFIER = 7
NO_INPUT_INERTIA = 8
PRESCRIBED = 9
NO_PLAY = 27
NO_WINDAGE = 26
JAMMED = 19
BAD_STEP = 12
BAD_HOLD = 13
TOO_MANY_SWITCHES = 20
TOO_MUCH_WORK = 21
STEP_TOO_SMALL = 22
NOT_FINITE = 23
NOT_BALANCED = 24
NOT_STEADY = 25
# ... of the first input and of its rate; those of the others follow
BAD_INPUT = 30
BAD_RATE = 40
