"""The balance of energies of a communication step, looked at before the step is answered.

What the input has put in goes out, is lost or is stored. Whatever has gone wrong in a step that nobody has
thought of, energy from nowhere, a freewheel that let go too late, shows here.
"""

from .codes import EVENT, NOT_BALANCED, OK, RIGID

# share of the energies of the step and of the speeds that may be missing: so many tolerances, but neither
# rounding nor a tenth
TOLERANCES = 1e3
LEAST = 1e-6
MOST = 0.1
# J: less than that is rounding of any machine that moves
NOTHING = 1e-30


def is_audited(p):
    """Tell whether steps are: fixed ones make no energy and may lose it, averaged ones look at themselves."""
    return p.fidelity >= RIGID and p.method == EVENT


def change(after, after_low, before, before_low):
    """Change of a compensated sum."""
    return (after - before) + (after_low - before_low)


def audit(d, x, before, stored, tolerance):
    """Tell whether the energies of the step balance: OK or NOT_BALANCED.

    Args:
        x, before: state after and before the step; x.energy_stored is set. stored: energy stored after it, J.
        tolerance: that the step was made with.
    """
    put_in = change(x.energy_in, x.energy_in_low, before.energy_in, before.energy_in_low)
    put_out = change(x.energy_out, x.energy_out_low, before.energy_out, before.energy_out_low)
    lost = x.step_lost
    missing = put_in - put_out - lost - (stored - before.energy_stored)
    energies = abs(put_in) + abs(put_out) + abs(lost) + abs(stored) + abs(before.energy_stored)
    x.energy_stored = stored
    fastest = max(abs(x.omega1), abs(before.omega1))
    share = max(LEAST, min(TOLERANCES * tolerance, MOST))
    slow = share * fastest  # speeds that may be missing: of a slow swing all that there is
    allowed = share * energies + (d.J1 + d.J2 + d.J3 + d.J4) * slow * slow
    return OK if abs(missing) <= allowed + NOTHING else NOT_BALANCED
