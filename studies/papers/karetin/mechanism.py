"""Geometry and steady motions of Karetin's standard layout, and the cases on which he is judged.

Teeth, shaft angle and a, b, c give the lengths of figure 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple


@dataclass(frozen=True)
class Geometry:
    """One inertia module in the standard layout.

    Names, ranges and defaults (scene R1) are those of the parameters of the FMU.

    Attributes:
        z2, z16, z17, z6: teeth. shaft_angle: angle Sigma = phi + psi between the axes QA and OQ, rad, the
            paper's chi as well. wheel_radius: pitch radius O_r Pi of wheel 17, m.
        a, b, c: AD, QA and OQ over their lengths in the pitch cones (KPi, QK, O_r Q).
        epsilon, gamma: offsets of the imbalance about QA and OQ at the time 0, rad.
        s: turns of the satellite 6 on the drive per turn of the drive 16, z17/z6.
        k: turns of the drive in link 1 per turn of link 1 against link 2, z2/z16.
        phi, psi: half angles of the pitch cones of the satellite and of wheel 17, rad.
        L: length of the generatrix Q Pi, U1 of equation (2), m.
        AD, QA, OQ: arm of the imbalance, offset of its plane on the satellite's axis, place of Q, m.
            QA is negative where phi > pi/2 (internal satellite), OQ where psi > pi/2.
        across, height: of A from OQ and above the plane z = 0, m: QA sin(Sigma), OQ - QA cos(Sigma).
        turns_in_period: turns of the drive after which drive and satellite are as they were.
    """

    z2: int = 20
    z16: int = 20
    z17: int = 34
    z6: int = 20
    shaft_angle: float = math.pi / 2
    wheel_radius: float = 0.08
    a: float = 1.0
    b: float = 1.0
    c: float = 1.0
    epsilon: float = 0.0
    gamma: float = 0.0

    s = cached_property(lambda g: g.z17 / g.z6)
    k = cached_property(lambda g: g.z2 / g.z16)
    _sine = cached_property(lambda g: math.sin(g.shaft_angle))
    # s + cos and 1 + s cos without the cancellation near Sigma = pi, where both can vanish
    _half = cached_property(lambda g: 2.0 * math.cos(0.5 * g.shaft_angle) ** 2)
    _along_satellite = cached_property(lambda g: (g.z17 - g.z6) / g.z6 + g._half)
    _along_drive = cached_property(lambda g: (g.z6 - g.z17) / g.z6 + g.s * g._half)
    # rolling without slip: s = sin psi / sin phi, so the cones follow from s and Sigma
    _scale = cached_property(lambda g: g.wheel_radius / (g.s * g._sine))
    phi = cached_property(lambda g: math.atan2(g._sine, g._along_satellite))
    psi = cached_property(lambda g: math.atan2(g.s * g._sine, g._along_drive))
    L = cached_property(lambda g: g._scale * math.hypot(g.s * g._sine, g._along_drive))
    AD = cached_property(lambda g: g.a * g.wheel_radius / g.s)
    QA = cached_property(lambda g: g.b * g._scale * g._along_satellite)
    OQ = cached_property(lambda g: g.c * g._scale * g._along_drive)
    across = cached_property(lambda g: g.b * g.wheel_radius * g._along_satellite / g.s)
    # with b = c the huge OQ and QA cos(Sigma) of a small Sigma cancel: written out
    height = cached_property(
        lambda g: (g.c - g.b) * g._scale * g._along_drive + g.b * g.wheel_radius * g._sine / g.s
    )
    turns_in_period = cached_property(lambda g: g.z6 // math.gcd(int(g.z17), int(g.z6)))


class Motion(NamedTuple):
    """Steady speeds of the links.

    Attributes:
        omega1: of link 1, rad/s. omega2: of link 2, rad/s.
        carrier: speed about Ox of the frame that carries the axis OQ, rad/s. In the mechanism that is
            link 1. The paper's stop mode has OQ at rest on Oz: its motion is the one seen from link 1.
    """

    omega1: float
    omega2: float
    carrier: float


def stop_mode(omega1: float) -> Motion:
    """The paper's stop mode: i = infinity, omega2 = 0, OQ at rest on Oz; omega1 against link 2, rad/s."""
    return Motion(omega1, 0.0, 0.0)


def dynamic_mode(omega1: float, transmission: float) -> Motion:
    """The dynamic mode, in which link 1 turns with omega1, rad/s, and carries OQ.

    Args:
        omega1: speed of link 1, rad/s.
        transmission: i = omega1/omega2, not 0; math.inf with link 2 held.
    """
    return Motion(omega1, omega1 / transmission, omega1)


def period(geometry: Geometry, motion: Motion) -> float:
    """Time after which drive and satellite stand in link 1 as before, s; the drive must turn."""
    drive = geometry.k * (motion.omega1 - motion.omega2)
    return float(2.0 * math.pi * geometry.turns_in_period / abs(drive))


# the paper gives no numbers; the scene R1: pole of the cones, no offsets
STANDARD = Geometry()
# s is whole, as the paper has it, for whom one turn of the drive is one period: its figures are drawn so
PAPER = Geometry(z17=40, z6=20)
# nothing vanishes or cancels, and D changes sides of every plane: the equations are judged on this one
GENERAL = Geometry(shaft_angle=math.radians(80.0), a=0.9, b=1.1, c=0.7, epsilon=0.4, gamma=0.3)
STOP = stop_mode(100.0)
# the link 1 closes with drive and satellite after ten turns of the drive, twenty of its own
DYNAMIC = dynamic_mode(100.0, 2.0)
