"""Coefficients of Dormand and Prince's pair 5(4): Hairer, Norsett and Wanner, section II.5, table 5.2.

Half the stages of the pair 8(5,3): for communication steps that are short beside the pulses. sum_6 is the
result,
stage 6 the end of the step; fourth weighs the error of order 4.
"""

from .dormand_prince import weighted_sum

END = 6
NODES = (0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0)
sum_1 = weighted_sum((1 / 5,))
sum_2 = weighted_sum((3 / 40, 9 / 40))
sum_3 = weighted_sum((44 / 45, -56 / 15, 32 / 9))
sum_4 = weighted_sum((19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729))
sum_5 = weighted_sum((9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656))
sum_6 = weighted_sum((35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84))
fourth = weighted_sum((71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40))
