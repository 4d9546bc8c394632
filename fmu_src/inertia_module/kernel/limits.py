"""Limits of the work of one communication step, beyond which it is refused or abandoned."""

LARGEST_SPEED = 1e6
LARGEST_TORQUE = 1e12
# a slower input counts as none: its square is no normal double
SMALLEST_SPEED = 1e-150
LARGEST_STEP = 1e6
# work one communication step may take before it is given up
MAX_EVALUATIONS = 5e7
# fixed steps one communication step may take
MAX_STEPS = 1e7
# contact switches per turn of the highest harmonic: a pulse has about four
SWITCHES_PER_PULSE = 64.0
SWITCHES_ALLOWED = 1000.0
# events in a row that leave the mode as it was
STALLS_ALLOWED = 100
