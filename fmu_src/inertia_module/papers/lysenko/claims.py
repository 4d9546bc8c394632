"""Every claim in the text of the paper with the verdict on it."""

from __future__ import annotations

from ..report import FAILS, HOLDS, PARTLY, Claim
from . import findings_forces, findings_motion

CLAIMS = (
    Claim("text on the figure", "The imbalance (l = r) moves on an epicycloid.", HOLDS, findings_forces.cusp),
    Claim(
        "text on (1)",
        "The modulus b sets the shape of the epicycloid and the ratio of the angles and speeds of wheel and"
        " carrier.",
        HOLDS,
        findings_forces.modulus,
    ),
    Claim(
        "text on (1)",
        "The epicycloid is cyclic, and the modulus sets the frequency of cycles.",
        HOLDS,
        findings_forces.cycles,
    ),
    Claim("note on (2)", "φ = bα.", FAILS, findings_forces.note),
    Claim(
        "text on (3)–(5)",
        "The inertia forces on the imbalance are F1, F2 and Fk as given.",
        PARTLY,
        findings_forces.forces,
    ),
    Claim("text on (5)–(8)", "V as given is the speed of the imbalance.", PARTLY, findings_forces.speed),
    Claim(
        "abstract, text on (15), (16), conclusion",
        "The dependences of torques and power on speed, dimensions and mass are found and serve engineering"
        " calculations of drive power and vibration.",
        FAILS,
        findings_forces.moments,
    ),
    Claim(
        "text on (16)",
        "(15) and (16) serve to set up the differential equations of motion.",
        FAILS,
        findings_forces.equations_of_motion,
    ),
    Claim(
        "text on (18)",
        "The inertia forces change cyclically: in some zones they resist the drive, in others they"
        " unload it.",
        HOLDS,
        findings_forces.zones,
    ),
    Claim(
        "text on (19)",
        "Angular momentum is conserved (Jω = const), hence the speeds cannot be constant.",
        FAILS,
        findings_motion.angular_momentum,
    ),
    Claim(
        "text on (20)",
        "J changes between the limits (20) as ρ runs from R + r − l to R + r + l.",
        PARTLY,
        findings_motion.limits,
    ),
    Claim(
        "text on (21)",
        "The speed is highest where J is smallest and lowest where J is largest.",
        HOLDS,
        findings_motion.places,
    ),
    Claim("text on (21)", "Highest and lowest speed are as J_max to J_min.", FAILS, findings_motion.ratio),
    Claim(
        "text on (21)",
        "In every cycle the speed changes impulsively from highest to lowest and back.",
        PARTLY,
        findings_motion.impulse,
    ),
    Claim(
        "text on (24)",
        "The kinetic energy grows from T1 to T2 in the ratio J_max/J_min.",
        FAILS,
        findings_motion.energy,
    ),
    Claim(
        "text on (24)",
        "This growth takes an impulsive drive that overcomes the centrifugal forces on the way in.",
        FAILS,
        findings_motion.impulsive_drive,
    ),
    Claim(
        "conclusion",
        "The mechanism has the property of changing its kinetic energy cyclically.",
        PARTLY,
        findings_motion.cyclic_energy,
    ),
    Claim(
        "abstract, introduction, conclusion",
        "The energy of the centrifugal forces of inertia can be converted: an alternative source of energy.",
        FAILS,
        findings_motion.no_gain,
    ),
)
