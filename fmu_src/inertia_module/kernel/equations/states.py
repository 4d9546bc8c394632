"""States of the two freewheels and of the slip of links 1 and 2, and what they allow."""

from ..codes import DRIVING, FREE, HELD, HELD_DRIVING

# whether there are losses by load, drag, weights or wind-up: a constant where functions are compiled with
# it, so that the ideal machine has no trace of them
IDEAL, LOSSY = 0, 1

# of a freewheel: overrunning; locked, rigid; locked, winding up
OPEN = 0.0
LOCKED = 1.0
WOUND = 2.0
# ... turning back through its play: it has overrun, and carries nothing until the play is used up
CLOSING = -1.0
# fidelity kinematic: the output keeps link 2 at its prescribed ratio to link 1, and no freewheel takes part
GEARED = 3.0


def is_open(state):
    """Tell whether a freewheel carries nothing in this state."""
    return state <= OPEN


def contact_mode(x):
    """The contact mode by what the freewheels do."""
    if not is_open(x.housing_state):
        return HELD if is_open(x.output_state) else HELD_DRIVING
    return FREE if is_open(x.output_state) else DRIVING


def holds(mode):
    """Tell whether the housing freewheel is engaged in this contact mode."""
    return mode == HELD or mode == HELD_DRIVING


def drives(mode):
    """Tell whether the output freewheel is engaged in this contact mode."""
    return mode == DRIVING or mode == HELD_DRIVING


def count_switch(x, before, mode, housing, output):
    """Count a switch to another contact mode, if it is one, and the freewheels that engage in it.

    Args:
        x: state.
        before: contact mode before.
        mode: contact mode now.
        housing: True if the housing freewheel carries once it is closed.
        output: likewise of the output freewheel.
    """
    x.switches += 1.0 if mode != before else 0.0
    x.housing_engagements += 1.0 if housing and holds(mode) and not holds(before) else 0.0
    x.output_engagements += 1.0 if output and drives(mode) and not drives(before) else 0.0


def carries(state, drag, angle, torque):
    """Return True if a freewheel that closes with its contact mode carries then.

    One with an engagement angle carries when its play is used up (events.advance.engage), and its drag alone
    may hold it.
    """
    return angle == 0.0 and not (state == LOCKED and drag > 0.0 and torque <= 0.0)


def is_wound(x):
    """Tell whether a freewheel is locked by its spring."""
    return x.housing_state == WOUND or x.output_state == WOUND


def is_rough(d):
    """Tell whether something resists the slip of links 1 and 2 at any speed, so that they can stick."""
    return d.mesh_loss + d.satellite_loss + d.journal_friction > 0.0


def may_be_housing(d, x):
    """Tell whether the housing freewheel may be in its state with these speeds."""
    if d.housing == 0.0:
        return x.housing_state == OPEN
    if x.play_housing > 0.0:
        return may_be_in_play(x.omega2, d.housing_drag, x.housing_state)
    return may_be(x.omega2, d.housing_stiffness, x.wound_housing, x.housing_state)


def may_be_output(d, x):
    """Tell whether the output freewheel may be in its state; without one link 2 is locked to the output."""
    if d.output == 0.0:
        return x.output_state == LOCKED
    if x.play_output > 0.0:
        return may_be_in_play(x.omega3 - x.omega2, d.output_drag, x.output_state)
    return may_be(x.omega3 - x.omega2, d.freewheel_stiffness, x.wound_output, x.output_state)


def may_be_in_play(speed, drag, state):
    """Tell whether a freewheel with play left may be in this state: locked it is by its drag alone."""
    if state == LOCKED:
        return speed == 0.0 and drag > 0.0
    return speed >= 0.0 if state == OPEN else speed <= 0.0


def may_be(speed, stiffness, wound, state):
    """Tell whether a freewheel of this speed and wind-up, without play, may be in this state."""
    if stiffness != 0.0 and (wound != 0.0 or speed < 0.0):
        return state == WOUND
    if state == OPEN:
        return True
    if speed > 0.0:
        return False
    return (stiffness != 0.0) == (state == WOUND)


def may_slip(d, x):
    """Tell whether the slip may have its sign, 0 for links that stick together."""
    if not is_rough(d):
        return x.slip_sign > 0.0
    slip = x.omega1 - x.omega2
    return slip == 0.0 or x.slip_sign * slip > 0.0


def are_allowed(d, x):
    """Tell whether freewheels and slip may be in their states with these speeds and wind-up."""
    return may_be_housing(d, x) and may_be_output(d, x) and may_slip(d, x)
