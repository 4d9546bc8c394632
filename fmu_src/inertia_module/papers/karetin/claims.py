"""Every claim in the text of Karetin (2020) and what was found of it."""

from __future__ import annotations

from ..report import FAILS, HOLDS, PARTLY, Claim
from . import findings_modes as modes
from . import findings_velocity as velocity

CLAIMS: list[Claim] = [
    Claim(
        "abstract, results",
        "The standard layout covers a broad range of modifications through a, b and c.",
        PARTLY,
        modes.layout,
    ),
    Claim(
        "abstract, methods",
        "The absolute motion of D is the superposition of three rotations, about QA, OQ and Ox.",
        HOLDS,
        velocity.superposition,
    ),
    Claim(
        "abstract",
        "V_QA = omega6 x AD lies in the base plane of the pitch cone of satellite z17.",
        PARTLY,
        velocity.base_plane,
    ),
    Claim(
        "abstract; before (13)",
        "V_OQ = omega16 x OH is parallel to the plane xOy.",
        PARTLY,
        velocity.drive_velocity_in_plane,
    ),
    Claim(
        "abstract",
        "V_Ox = omega1 x OP is parallel to the plane yOz.",
        HOLDS,
        velocity.central_velocity_in_plane,
    ),
    Claim(
        "abstract",
        "The functions are obtained for omega16 = omega2 (stop mode) and omega16 = omega2 = omega1 (dynamic "
        "mode).",
        FAILS,
        modes.stop_condition,
    ),
    Claim(
        "abstract",
        "Projections of V and a and their arms about O let the dynamic quantities be predicted at any time.",
        PARTLY,
        velocity.moments_from_arms,
    ),
    Claim(
        "before (1)",
        "Wheel 17 is fixed to the output link, satellite and drive turn in hinges of 'the output link 1'.",
        PARTLY,
        modes.carrier,
    ),
    Claim(
        "before (1)",
        "A freewheel blocks link 2 from turning back with respect to link 1.",
        PARTLY,
        modes.freewheel,
    ),
    Claim(
        "before (1)",
        "In the dynamic mode omega16 >= 0 for 0 < i < infinity.",
        PARTLY,
        modes.dynamic_range,
    ),
    Claim(
        "before (6)",
        "The angles (5) are continuous, so that differentiation gives the angular velocities.",
        PARTLY,
        modes.differentiable_angles,
    ),
    Claim(
        "before (6)",
        "omega_H, omega_P, omega_F are the angular velocities about Ox, Oy and Oz respectively.",
        FAILS,
        modes.axes_of_the_angles,
    ),
    Claim(
        "before (8)",
        "In the stop mode the applicate of A does not change with time.",
        HOLDS,
        modes.height_of_A,
    ),
    Claim(
        "before (2), before (17)",
        "In the stop mode (2) is the position in the fixed frame and (17) the absolute velocity.",
        PARTLY,
        modes.absolute_in_stop_mode,
    ),
    Claim(
        "before (19)",
        "The velocity vectors of the stop and the dynamic mode differ only in modulus.",
        FAILS,
        velocity.only_modulus,
    ),
    Claim(
        "before (19)",
        "The angle of the turn about Ox must account for the swing omega_P besides omega1.",
        FAILS,
        velocity.angle_of_turn,
    ),
    Claim(
        "before (19)",
        "In the turn about the central axis the abscissa of D does not change.",
        HOLDS,
        velocity.abscissa,
    ),
    Claim(
        "figure 3",
        "One turn of the satellite about the axis of the drive is one period.",
        PARTLY,
        modes.period_of_a_turn,
    ),
    Claim(
        "conclusion 1",
        "The kinematic quantities are described by functions continuous in time.",
        PARTLY,
        velocity.continuous_functions,
    ),
    Claim(
        "conclusion 2",
        "The initial offsets of D about the axes of satellite and drive cause asymmetry of the kinematic "
        "quantities within one period.",
        PARTLY,
        velocity.asymmetry_from_offsets,
    ),
    Claim(
        "conclusion 3",
        "D swings about Ox and Oy in the stop and in the dynamic mode.",
        PARTLY,
        velocity.swing_about_axes,
    ),
    Claim(
        "conclusion 3",
        "So the planes xOy and yOz are those in which to characterise velocities and accelerations.",
        FAILS,
        velocity.planes_of_the_swing,
    ),
]
