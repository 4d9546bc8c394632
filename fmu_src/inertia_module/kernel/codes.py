"""Enumerations of the kernel: contact modes, fidelities, methods, operations, warnings, status codes."""

# Contact modes: state of the housing freewheel and of the output freewheel
HELD = 0  # Link 2 locked to the housing
FREE = 1  # Both freewheels overrun
DRIVING = 2  # Link 2 drives the output
HELD_DRIVING = 3  # Both freewheels are locked

NO_EVENT = -1  # No event indicator has crossed zero (events.guards)

# Fidelities
KINEMATIC = 0
AVERAGED = 1
RIGID = 2
ELASTIC = 3
# Methods
EVENT = 0
TIMESTEPPING = 1

# Values of the parameter drive: the quantity that is prescribed at link 1
DRIVE_SPEED = 0
DRIVE_TORQUE = 1

# Operations of the entry of a kernel (entry.call)
START = 0  # End of the initialisation
STEP = 1  # One communication step with all outputs
CHECK = 2  # The checks of START only; writes only d, with the map of averaged if it has been overwritten
STEP_ONLY = 3  # STEP without the late outputs, which can take longer than the step
OUTPUTS = 4  # The late outputs after STEP_ONLY
STEP_FOR_DIFFERENCING = 5  # STEP at a tight tolerance, for differences of its results
OUTPUT_DERIVATIVES = 6  # Time derivatives of the outputs, in y; u and x are invalid afterwards
WARN = 7  # Returns the sum of the warnings; writes nothing
UPDATE_PARAMETERS = 8  # After a change of tunable parameters between steps
STEP_UNTIL_EVENT = 9  # STEP_ONLY that ends before the first freewheel switching event
HANDLE_EVENT = 10  # The event at which STEP_UNTIL_EVENT has ended (the next step does the same)
# START in the periodic orbit of the rigid module with its output held at omega_out_start. The argument h is
# the angle of the pinion shaft in a period, rad
START_STEADY = 11

# Warnings: powers of 2, so that a sum can contain several
PLANAR_OVERLAP = 1
BEVEL_OVERLAP = 2
PLANAR_OUTSIDE = 4
BEVEL_OUTSIDE = 8
GEAR_TOO_FLAT = 16
METHOD_DEPRECATED = 32

# Status codes; interface/messages.py has a message for each
OK = 0
# Parameters
SINGULAR = 3
BAD_START_HOUSING = 4
BAD_START_OUTPUT = 5
BAD_START_RIGID = 6
FREEWHEELS_REQUIRED = 7
INPUT_INERTIA_TOO_SMALL = 8
TORQUE_DRIVE_UNSUPPORTED = 9
BACKLASH_UNSUPPORTED = 27
WINDAGE_UNSUPPORTED = 26
SOFT_FREEWHEEL = 28
SELF_LOCKING = 19
# Steps
BAD_STEP = 12
BAD_HOLD = 13
TOO_MUCH_WORK = 21
STEP_TOO_SMALL = 22
NOT_FINITE = 23
NOT_BALANCED = 24
LIGHT_INPUT = 18
NO_CYCLIC_STEADY_STATE = 25
# Inputs: the first input and the first rate; add the number of the input
BAD_INPUT = 30
BAD_RATE = 40
