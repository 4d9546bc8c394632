"""Ideal freewheels as complementarity conditions on impulses (docs/mechanics.md).

0 <= omega2 _|_ Ph >= 0  (housing)        0 <= omega3 - omega2 _|_ Pc >= 0  (output)
"""

from .codes import DRIVING, FREE, HELD, HELD_DRIVING


def settle(d, inertia2, free2, inertia3, free3):
    """Solve the complementarity problem on impulses, from the velocities without them.

    Returns:
        (omega2, omega3, Pc, contact mode) at the end of the step.
    """
    # ties as in select_mode: link 2 stays held, and a shaft that nothing pulls away touches it
    held = d.housing != 0.0 and free2 <= 0.0
    if d.output != 0.0:
        if held and free3 > 0.0:
            return 0.0, free3, 0.0, HELD
        if not held and free2 <= free3:
            return free2, free3, 0.0, FREE
    together = (inertia2 * free2 + inertia3 * free3) / (inertia2 + inertia3)
    if d.housing == 0.0 or together > 0.0:
        return together, together, inertia3 * (together - free3), DRIVING
    return 0.0, 0.0, -inertia3 * free3, HELD_DRIVING
