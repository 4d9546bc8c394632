"""Embedded Runge-Kutta pairs as tables: Dormand and Prince 8(5,3), for short steps 5(4), 3(2) of Bogacki.

Sources: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section II.5, DOP853 and
table 5.2; Bogacki and Shampine (1989), Appl. Math. Lett. 2, 321. Row n of a pair weighs the rates of the
stages before stage n; its last stage is the end of the step, so that this row is the result. Pair 8(5,3) has
three stages more, for the inside of the step, and four rows for the interpolant's coefficients, of order 7.
"""

STAGES = 16
# last stages of both pairs; row of stage 0 of each, rows of their errors and of the interpolant
END, SHORT_END = 12, 6
LONG, SHORT = 0, 16
# nodes of the parts at which the inside of a stiff step is looked at (events.rosenbrock), and how many
THIRDS, PARTS = 23, 3
FIFTH, THIRD, FOURTH, DENSE = 23, 24, 25, 26
# stages of LONG, SHORT and THIRDS at rising nodes, through three of which in a row extrema are interpolated
IN_ORDER = (0, 3, 5, 9, 10, 12, 0, 2, 3, 6, 0, 1, 2, 3)
LONG_ORDER, SHORT_ORDER, THIRDS_ORDER, END_ORDER = 0, 6, 10, 14
# the stage after stage 0 that errors of the long pair begin with
LATE = 5
# the pair of order 3 of gentle steps: its rows, last stage, and row of errors
GENTLE, GENTLE_END, GENTLE_ERROR = 30, 3, 34
# the five-point Gauss rule on [0, 1], for what is known at any instant
GAUSS = 5
GAUSS_NODES = (
    *(0.04691007703066802, 0.23076534494715845, 0.5, 1.0 - 0.23076534494715845, 1.0 - 0.04691007703066802),
)
GAUSS_WEIGHTS = (
    *(0.11846344252809454, 0.23931433524968324, 0.28444444444444444),
    *(0.23931433524968324, 0.11846344252809454),
)

# fmt: off
NODES = (
    0.0, 0.05260015195876773, 0.0789002279381516, 0.1183503419072274, 0.2816496580927726,
    0.3333333333333333, 0.25, 0.3076923076923077, 0.6512820512820513, 0.6, 0.8571428571428571, 1.0, 1.0,
    0.1, 0.2, 0.7777777777777778,
    0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0,
    0.0, 1 / 3, 2 / 3, 1.0,
)
ROWS = (
    (),
    (0.05260015195876773,),
    (0.0197250569845379, 0.0591751709536137),
    (0.02958758547680685, 0.0, 0.08876275643042054),
    (0.2413651341592667, 0.0, -0.8845494793282861, 0.924834003261792),
    (0.037037037037037035, 0.0, 0.0, 0.17082860872947386, 0.12546768756682242),
    (0.037109375, 0.0, 0.0, 0.17025221101954405, 0.06021653898045596, -0.017578125),
    (0.03709200011850479, 0.0, 0.0, 0.17038392571223998, 0.10726203044637328, -0.015319437748624402,
     0.008273789163814023),
    (0.6241109587160757, 0.0, 0.0, -3.3608926294469414, -0.868219346841726, 27.59209969944671,
     20.154067550477894, -43.48988418106996),
    (0.47766253643826434, 0.0, 0.0, -2.4881146199716677, -0.590290826836843, 21.230051448181193,
     15.279233632882423, -33.28821096898486, -0.020331201708508627),
    (-0.9371424300859873, 0.0, 0.0, 5.186372428844064, 1.0914373489967295, -8.149787010746927,
     -18.52006565999696, 22.739487099350505, 2.4936055526796523, -3.0467644718982196),
    (2.273310147516538, 0.0, 0.0, -10.53449546673725, -2.0008720582248625, -17.9589318631188,
     27.94888452941996, -2.8589982771350235, -8.87285693353063, 12.360567175794303, 0.6433927460157636),
    (0.054293734116568765, 0.0, 0.0, 0.0, 0.0, 4.450312892752409, 1.8915178993145003, -5.801203960010585,
     0.3111643669578199, -0.1521609496625161, 0.20136540080403034, 0.04471061572777259),
    (0.056167502283047954, 0.0, 0.0, 0.0, 0.0, 0.0, 0.25350021021662483, -0.2462390374708025,
     -0.12419142326381637, 0.15329179827876568, 0.00820105229563469, 0.007567897660545699, -0.008298),
    (0.03183464816350214, 0.0, 0.0, 0.0, 0.0, 0.028300909672366776, 0.053541988307438566,
     -0.05492374857139099, 0.0, 0.0, -0.00010834732869724932, 0.0003825710908356584,
     -0.00034046500868740456, 0.1413124436746325),
    (-0.42889630158379194, 0.0, 0.0, 0.0, 0.0, -4.697621415361164, 7.683421196062599, 4.06898981839711,
     0.3567271874552811, 0.0, 0.0, 0.0, -0.0013990241651590145, 2.9475147891527724, -9.15095847217987),
    (),
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
    (0.01312004499419488, 0.0, 0.0, 0.0, 0.0, -1.2251564463762044, -0.4957589496572502, 1.6643771824549864,
     -0.35032884874997366, 0.3341791187130175, 0.08192320648511571, -0.022355307863886294),
    (-0.18980075407240762, 0.0, 0.0, 0.0, 0.0, 4.450312892752409, 1.8915178993145003, -5.801203960010585,
     -0.4226823213237919, -0.1521609496625161, 0.20136540080403034, 0.02265179219836082),
    (71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40),
    (-8.428938276109013, 0.0, 0.0, 0.0, 0.0, 0.5667149535193777, -3.0689499459498917, 2.38466765651207,
     2.117034582445028, -0.871391583777973, 2.2404374302607883, 0.6315787787694688, -0.08899033645133331,
     18.148505520854727, -9.194632392478356, -4.436036387594894),
    (10.427508642579134, 0.0, 0.0, 0.0, 0.0, 242.28349177525817, 165.20045171727028, -374.5467547226902,
     -22.113666853125306, 7.733432668472264, -30.674084731089398, -9.332130526430229, 15.697238121770845,
     -31.139403219565178, -9.35292435884448, 35.81684148639408),
    (19.985053242002433, 0.0, 0.0, 0.0, 0.0, -387.0373087493518, -189.17813819516758, 527.8081592054236,
     -11.57390253995963, 6.8812326946963, -1.0006050966910838, 0.7777137798053443, -2.778205752353508,
     -60.19669523126412, 84.32040550667716, 11.99229113618279),
    (-25.69393346270375, 0.0, 0.0, 0.0, 0.0, -154.18974869023643, -231.5293791760455, 357.6391179106141,
     93.40532418362432, -37.45832313645163, 104.0996495089623, 29.8402934266605, -43.53345659001114,
     96.32455395918828, -39.17726167561544, -149.72683625798564),
    (),
    (1 / 2,),
    (0.0, 3 / 4),
    (2 / 9, 1 / 3, 4 / 9),
    (-5 / 72, 1 / 12, 1 / 9, -1 / 8),
)
# fmt: on
# all rows one after the other, each as long as there are stages; the stage each weighs first after stage 0
WEIGHTS = tuple(weight for row in ROWS for weight in (*row, *[0.0] * (STAGES - len(row))))
AFTER = tuple(next((n for n, weight in enumerate(row) if n > 0 and weight != 0.0), 1) for row in ROWS)


def order_of_stages(pair):
    """Return where the stages of a pair begin in IN_ORDER, and how many there are."""
    if pair == LONG:
        return LONG_ORDER, SHORT_ORDER - LONG_ORDER
    if pair == SHORT:
        return SHORT_ORDER, THIRDS_ORDER - SHORT_ORDER
    return THIRDS_ORDER, END_ORDER - THIRDS_ORDER


def extremum(t0, t1, t2, y0, y1, y2, end):
    """Return the extremum of the parabola through three points, or y1.

    Args:
        t0: time of the first point; t0 < t1 < t2.
        t1: of the second point.
        t2: of the third point.
        y0: value of the first point.
        y1: of the second point.
        y2: of the third point.
        end: time after which an extremum does not count.
    """
    slope = (y1 - y0) / (t1 - t0)
    curve = ((y2 - y1) / (t2 - t1) - slope) / (t2 - t0)
    if curve == 0.0:
        return y1
    time = 0.5 * (t0 + t1 - slope / curve)
    if not (t0 < time < t2) or time > end:
        return y1
    return y0 + (time - t0) * (slope + curve * (time - t1))


def last_stage(pair):
    """Number of the last stage of a pair; of a stiff step, of its parts."""
    if pair == LONG:
        return END
    return SHORT_END if pair == SHORT else PARTS


def weighed(row, count, values):
    """Sum of so many values at the stages with the weights of a row."""
    total = 0.0
    for n in range(count):
        total += WEIGHTS[STAGES * row + n] * values[n]
    return total


def fit(h, rates, dense):
    """Coefficients of the interpolant of a quantity with these rates at all stages, into dense."""
    change = h * weighed(END, END, rates)
    dense[0] = change
    dense[1] = h * rates[0] - change
    dense[2] = 2.0 * change - h * (rates[0] + rates[END])
    for n in range(4):
        dense[3 + n] = h * weighed(DENSE + n, STAGES, rates)


def dense_change(dense, sigma):
    """Change since the beginning of the step at the fraction sigma of it (order 7)."""
    rest = 1.0 - sigma
    y = (dense[5] + sigma * dense[6]) * rest
    y = (dense[4] + y) * sigma
    y = (dense[3] + y) * rest
    y = (dense[2] + y) * sigma
    y = (dense[1] + y) * rest
    return (dense[0] + y) * sigma


def dense_rate(dense, sigma):
    """Derivative of dense_change in sigma."""
    rest = 1.0 - sigma
    y = dense[5] + sigma * dense[6]
    slope = dense[6] * rest - y
    y = dense[4] + y * rest
    slope = slope * sigma + y
    y = dense[3] + y * sigma
    slope = slope * rest - y
    y = dense[2] + y * rest
    slope = slope * sigma + y
    y = dense[1] + y * sigma
    slope = slope * rest - y
    return slope * sigma + dense[0] + y * rest


def write_inside_weights(sigma, weights):
    """Write the weights of the rates at the stages in dense_change at the fraction sigma into weights."""
    rest = 1.0 - sigma
    whole = sigma * (1.0 - rest + 2.0 * sigma * rest)
    third = sigma * rest * sigma * rest
    fourth = sigma * third
    fifth = fourth * rest
    sixth = fifth * sigma
    for n in range(STAGES):
        weight = whole * WEIGHTS[STAGES * END + n] + third * WEIGHTS[STAGES * DENSE + n]
        weight += fourth * WEIGHTS[STAGES * (DENSE + 1) + n] + fifth * WEIGHTS[STAGES * (DENSE + 2) + n]
        weights[n] = weight + sixth * WEIGHTS[STAGES * (DENSE + 3) + n]
    weights[0] += sigma * rest * rest
    weights[END] -= sigma * sigma * rest
