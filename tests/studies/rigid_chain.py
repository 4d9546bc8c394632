"""The bevel mechanism as a chain of rotation matrices in extended precision, differentiated by differences.

Nothing is shared with the code under test: the cones follow from the line on which they roll, derivatives
from positions alone.
"""

from mpmath import mp, mpf

DIGITS = 50
STEP = mpf(10) ** -15  # of time, s: differences are right to 1e-20 at 1e5 rad/s


def turn(axis, angle):
    """Rotation matrix about a coordinate axis (0, 1, 2)."""
    c, s = mp.cos(angle), mp.sin(angle)
    u, v = (axis + 1) % 3, (axis + 2) % 3
    matrix = [[mpf(row == column) for column in range(3)] for row in range(3)]
    matrix[u][u], matrix[u][v], matrix[v][u], matrix[v][v] = c, -s, s, c
    return matrix


def apply(matrix, vector):
    return [sum(row[n] * vector[n] for n in range(3)) for row in matrix]


def dot(one, two):
    return sum(u * v for u, v in zip(one, two, strict=True))


def length(vector):
    return mp.sqrt(dot(vector, vector))


def cross(one, two):
    return [one[n - 2] * two[n - 1] - one[n - 1] * two[n - 2] for n in range(3)]


class Chain:
    """Link 1 about Ox, drive about its z axis, satellite about an axis inclined by Sigma, imbalance on it."""

    def __init__(self, p, omega1, omega2, carrier):
        with mp.workdps(DIGITS):
            self.s = mpf(p["z17"]) / p["z6"]
            self.rate = mpf(p["z2"]) / p["z16"] * (mpf(omega1) - mpf(omega2))
            self.carrier = mpf(carrier)
            self.epsilon, self.gamma = mpf(p["epsilon"]), mpf(p["gamma"])
            self.tilt = turn(1, -mpf(p["shaft_angle"]))
            drive_axis = [mpf(0), mpf(0), mpf(1)]
            satellite_axis = apply(self.tilt, drive_axis)
            # points of the satellite are at rest in link 1 on the line of the sum of both spins
            line = [u + self.s * v for u, v in zip(drive_axis, satellite_axis, strict=True)]
            line = [u / length(line) for u in line]
            cone = p["wheel_radius"] / length(cross(line, drive_axis))
            self.place = [
                -p["a"] * cone * length(cross(line, satellite_axis)),
                mpf(0),
                -p["b"] * cone * dot(line, satellite_axis),
            ]
            self.height = p["c"] * cone * dot(line, drive_axis)

    def position(self, t):
        q = self.rate * t
        r = apply(turn(2, self.s * q + self.epsilon), self.place)
        r = apply(turn(2, q + self.gamma), apply(self.tilt, r))
        r[2] += self.height
        return apply(turn(0, self.carrier * t), r)

    def motion(self, t):
        """(position, velocity, acceleration) at a time, velocity and acceleration by central differences."""
        with mp.workdps(DIGITS):
            t = mpf(float(t))
            before, now, after = (self.position(t + n * STEP) for n in (-1, 0, 1))
            velocity = [(v - u) / (2 * STEP) for u, v in zip(before, after, strict=True)]
            acceleration = [(u - 2 * w + v) / STEP**2 for u, w, v in zip(before, now, after, strict=True)]
            return now, velocity, acceleration


def relative_error(values, exact):
    """|values - exact| / |exact|, of vectors."""
    with mp.workdps(DIGITS):
        difference = [mpf(float(u)) - v for u, v in zip(values, exact, strict=True)]
        return float(length(difference) / length(exact))
