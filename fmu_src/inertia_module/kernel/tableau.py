"""Embedded explicit Runge-Kutta pairs, their dense output and a Gauss rule.

A pair is a record with the usual letters, which is checked when this module is imported:

    k_i = f(t + c_i h, y + h sum_j a_ij k_j)      y(t + h) = y + h sum_i b_i k_i      error = h sum_i e_i k_i

The last stage is at the end of the step: its row of A is b, and it is the first stage of the next step.
DOP853 has three more stages for its dense output of order 7.

The kernel reads WEIGHTS, one table with the rows of all pairs: row DOP853_ROW + i is row i of A of DOP853.
The first row of a pair identifies it (`w.pair`).

Sources: E. Hairer, S. P. Norsett, G. Wanner: Solving Ordinary Differential Equations I (1993), section II.5,
table 5.2 and code DOP853; J. R. Dormand, P. J. Prince (1980), J. Comput. Appl. Math. 6, 19.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field

from .records import Doubles

# Relative tolerance of the checks of a tableau
CHECK_RTOL = 1e-14


def check_sum(name: str, terms: Iterable[float], value: float) -> None:
    """Raise ValueError unless the terms add up to the value, up to round-off.

    Args:
        name: Condition that the sum belongs to.
        terms: Numbers to add.
        value: Expected sum.
    """
    numbers = list(terms)
    difference = sum(numbers) - value
    if abs(difference) > CHECK_RTOL * (1.0 + sum(map(abs, numbers))):
        raise ValueError(f"{name} must be {value} (got {value + difference})")


@dataclass(frozen=True, eq=False)
class Tableau:
    """Butcher tableau of an embedded explicit Runge-Kutta pair.

    Attributes:
        name: Name of the pair.
        order: Order of the result.
        last_stage: Number of the stage at the end of the step; row last_stage of A is b.
        A: Row i has the coefficients a_ij, j < i.
        C: Node c_i of each stage.
        E: Error weights by their order q: the error is 0 for rates that are polynomials of degree below q.
        D: Rows of the dense output.
    """

    name: str
    order: int
    last_stage: int
    A: tuple[tuple[float, ...], ...]
    C: tuple[float, ...]
    E: dict[int, tuple[float, ...]] = field(default_factory=dict)
    D: tuple[tuple[float, ...], ...] = ()

    def __post_init__(self) -> None:
        """Check row sums, quadrature conditions of b and E, and sums of D."""
        for i, row in enumerate(self.A):
            check_sum(f"{self.name}: sum of row {i} of A", row, self.C[i])
        b = self.A[self.last_stage]
        for power in range(self.order):
            terms = (weight * c**power for weight, c in zip(b, self.C, strict=False))
            check_sum(f"{self.name}: sum b c^{power}", terms, 1.0 / (power + 1))
        for order, weights in self.E.items():
            for power in range(order):
                terms = (weight * c**power for weight, c in zip(weights, self.C, strict=False))
                check_sum(f"{self.name}: sum of E{order} c^{power}", terms, 0.0)
        for n, row in enumerate(self.D):
            check_sum(f"{self.name}: sum of row {n} of D", row, 0.0)


# fmt: off
DOP853 = Tableau(
    name="DOP853",
    order=8,
    last_stage=12,
    C=(0.0, 0.05260015195876773, 0.0789002279381516, 0.1183503419072274, 0.2816496580927726,
       0.3333333333333333, 0.25, 0.3076923076923077, 0.6512820512820513, 0.6, 0.8571428571428571, 1.0, 1.0,
       0.1, 0.2, 0.7777777777777778),
    A=(
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
    ),
    E={
        5: (0.01312004499419488, 0.0, 0.0, 0.0, 0.0, -1.2251564463762044, -0.4957589496572502,
            1.6643771824549864, -0.35032884874997366, 0.3341791187130175, 0.08192320648511571,
            -0.022355307863886294),
        3: (-0.18980075407240762, 0.0, 0.0, 0.0, 0.0, 4.450312892752409, 1.8915178993145003,
            -5.801203960010585, -0.4226823213237919, -0.1521609496625161, 0.20136540080403034,
            0.02265179219836082),
    },
    D=(
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
    ),
)
DOPRI5 = Tableau(
    name="DOPRI5",
    order=5,
    last_stage=6,
    C=(0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0),
    A=(
        (),
        (1 / 5,),
        (3 / 40, 9 / 40),
        (44 / 45, -56 / 15, 32 / 9),
        (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
        (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
        (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
    ),
    E={4: (71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40)},
)
# fmt: on

# The flat tables of the kernel: nodes and rows of both pairs, then rows of errors and dense output
N_STAGES = len(DOP853.A)
DOP853_ROW, DOPRI5_ROW = 0, N_STAGES
DOP853_LAST_STAGE, DOPRI5_LAST_STAGE = DOP853.last_stage, DOPRI5.last_stage
DOP853_E5_ROW = DOPRI5_ROW + len(DOPRI5.A)
DOP853_E3_ROW, DOPRI5_E_ROW, DOP853_D_ROW = DOP853_E5_ROW + 1, DOP853_E5_ROW + 2, DOP853_E5_ROW + 3
NODES = (*DOP853.C, *DOPRI5.C)
ROWS = (*DOP853.A, *DOPRI5.A, DOP853.E[5], DOP853.E[3], DOPRI5.E[4], *DOP853.D)
# Stages of each pair in the order of their nodes, for extrema by parabolas through three neighbours
STAGES_BY_TIME = (0, 3, 5, 9, 10, 12, 0, 2, 3, 6)
N_DOP853_BY_TIME, N_DOPRI5_BY_TIME = 6, 4
# First stage after stage 0 with a weight in the errors and in the dense output of DOP853
FIRST_ERROR_STAGE = 5

# Rows one after the other, each N_STAGES long
WEIGHTS = tuple(weight for row in ROWS for weight in (*row, *[0.0] * (N_STAGES - len(row))))
# First stage after stage 0 with a non-zero weight, for each row
FIRST_NONZERO_STAGE = tuple(
    next((n for n, weight in enumerate(row) if n > 0 and weight != 0.0), 1) for row in ROWS
)

# Gauss-Legendre rule of five points on [0, 1], exact for polynomials of degree 9
N_GAUSS_NODES = 5
GAUSS_NODES = (
    *(0.04691007703066802, 0.23076534494715845, 0.5, 1.0 - 0.23076534494715845, 1.0 - 0.04691007703066802),
)
GAUSS_WEIGHTS = (
    *(0.11846344252809454, 0.23931433524968324, 0.28444444444444444),
    *(0.23931433524968324, 0.11846344252809454),
)
for power in range(2 * N_GAUSS_NODES):
    check_sum(
        f"Gauss rule: sum w x^{power}",
        (w * x**power for w, x in zip(GAUSS_WEIGHTS, GAUSS_NODES, strict=True)),
        1.0 / (power + 1),
    )


def stage_order_range(pair: int) -> tuple[int, int]:
    """Return the range of a pair in STAGES_BY_TIME.

    Args:
        pair: First row of the pair.

    Returns:
        Position of its first stage, number of its stages.
    """
    if pair == DOP853_ROW:
        return 0, N_DOP853_BY_TIME
    return N_DOP853_BY_TIME, N_DOPRI5_BY_TIME


def last_stage(pair: int) -> int:
    """Return the number of the stage at the end of the step.

    Args:
        pair: First row of the pair.
    """
    return DOP853_LAST_STAGE if pair == DOP853_ROW else DOPRI5_LAST_STAGE


def parabola_extremum(t0: float, t1: float, t2: float, y0: float, y1: float, y2: float, end: float) -> float:
    """Return the extremum of the parabola through three points, or y1 if it is not between them.

    Args:
        t0: Time of the first point; t0 < t1 < t2.
        t1: Time of the second point.
        t2: Time of the third point.
        y0: Value of the first point.
        y1: Value of the second point.
        y2: Value of the third point.
        end: Time after which an extremum does not count.
    """
    slope = (y1 - y0) / (t1 - t0)
    curve = ((y2 - y1) / (t2 - t1) - slope) / (t2 - t0)
    if curve == 0.0:
        return y1
    time = 0.5 * (t0 + t1 - slope / curve)
    if not (t0 < time < t2) or time > end:
        return y1
    return y0 + (time - t0) * (slope + curve * (time - t1))


def weighted_sum(row: int, count: int, values: Doubles) -> float:
    """Return the weighted sum of values at the stages.

    Args:
        row: Row of WEIGHTS.
        count: Number of stages to add.
        values: Value at each stage.
    """
    total = 0.0
    for n in range(count):
        total += WEIGHTS[N_STAGES * row + n] * values[n]
    return total


def fit_dense_output(h: float, rates: Doubles, dense: Doubles) -> None:
    """Write the coefficients of the dense output of DOP853 for one quantity.

    Args:
        h: Step, s.
        rates: Rate of the quantity at each of the N_STAGES stages, 1/s.
        dense: 7 coefficients, written.
    """
    change = h * weighted_sum(DOP853_LAST_STAGE, DOP853_LAST_STAGE, rates)
    dense[0] = change
    dense[1] = h * rates[0] - change
    dense[2] = 2.0 * change - h * (rates[0] + rates[DOP853_LAST_STAGE])
    for n in range(4):
        dense[3 + n] = h * weighted_sum(DOP853_D_ROW + n, N_STAGES, rates)


def dense_change(dense: Doubles, sigma: float) -> float:
    """Return the change of a quantity since the beginning of the step, by dense output of order 7.

    Args:
        dense: 7 coefficients (fit_dense_output).
        sigma: Fraction of the step, 0 to 1.
    """
    rest = 1.0 - sigma
    y = (dense[5] + sigma * dense[6]) * rest
    y = (dense[4] + y) * sigma
    y = (dense[3] + y) * rest
    y = (dense[2] + y) * sigma
    y = (dense[1] + y) * rest
    return (dense[0] + y) * sigma


def dense_rate(dense: Doubles, sigma: float) -> float:
    """Return the derivative of dense_change with respect to sigma.

    Args:
        dense: 7 coefficients (fit_dense_output).
        sigma: Fraction of the step, 0 to 1.
    """
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


def write_dense_weights(sigma: float, weights: Doubles) -> None:
    """Write the weights of the stages in the dense output: change = h sum_i weights_i k_i.

    Args:
        sigma: Fraction of the step, 0 to 1.
        weights: One weight for each of the N_STAGES stages, written.
    """
    rest = 1.0 - sigma
    whole = sigma * (1.0 - rest + 2.0 * sigma * rest)
    third = sigma * rest * sigma * rest
    fourth = sigma * third
    fifth = fourth * rest
    sixth = fifth * sigma
    for n in range(N_STAGES):
        weight = (
            whole * WEIGHTS[N_STAGES * DOP853_LAST_STAGE + n] + third * WEIGHTS[N_STAGES * DOP853_D_ROW + n]
        )
        weight += (
            fourth * WEIGHTS[N_STAGES * (DOP853_D_ROW + 1) + n]
            + fifth * WEIGHTS[N_STAGES * (DOP853_D_ROW + 2) + n]
        )
        weights[n] = weight + sixth * WEIGHTS[N_STAGES * (DOP853_D_ROW + 3) + n]
    weights[0] += sigma * rest * rest
    weights[DOP853_LAST_STAGE] -= sigma * sigma * rest
