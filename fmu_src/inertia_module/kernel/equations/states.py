"""Contact states: two freewheels and the slip of links 1 and 2, and the motions that admit each state."""

from ..codes import DRIVING, FREE, HELD, HELD_DRIVING
from ..records import Constants, State

# Compile-time argument ``lossy``: equations without or with losses, drag, gravity and wind-up
IDEAL, LOSSY = 0, 1

# States of a freewheel
OVERRUNNING = 0.0
LOCKED = 1.0  # Rigid
ENGAGED_COMPLIANT = 2.0  # Through its spring
IN_BACKLASH = -1.0  # Rotates backward through its engagement angle and transmits no torque
RATIO_PRESCRIBED = 3.0  # Fidelity kinematic: link 2 follows the prescribed ratio, without freewheels


def is_open(state: float) -> bool:
    """Return True if a freewheel in this state transmits no torque except its drag."""
    return state <= OVERRUNNING


def contact_mode(x: State) -> int:
    """Return the contact mode (codes.HELD to HELD_DRIVING) of the freewheel states in ``x``."""
    if not is_open(x.housing_state):
        return HELD if is_open(x.output_state) else HELD_DRIVING
    return FREE if is_open(x.output_state) else DRIVING


def is_engagement(before: float, state: float, drag: float, engagement_angle: float, torque: float) -> bool:
    """Return True if an open freewheel transmits torque as soon as it changes to ``state``.

    A freewheel with an engagement angle transmits torque only at the end of this angle
    (events.advance.engage). A freewheel that is held by its drag alone transmits no torque.

    Args:
        before: State of the freewheel before.
        state: New state.
        drag: Torque of its drag, N m.
        engagement_angle: rad.
        torque: Torque of the freewheel, N m.
    """
    if engagement_angle > 0.0 or is_open(state) or not is_open(before):
        return False
    return not (state == LOCKED and drag > 0.0 and torque <= 0.0)


def has_engaged_spring(x: State) -> bool:
    """Return True if a freewheel is engaged through its spring."""
    return x.housing_state == ENGAGED_COMPLIANT or x.output_state == ENGAGED_COMPLIANT


def has_friction(d: Constants) -> bool:
    """Return True if friction opposes the slip of links 1 and 2 at any speed, so that they can stick."""
    return d.mesh_loss + d.satellite_loss + d.journal_friction > 0.0


def is_housing_admissible(d: Constants, x: State) -> bool:
    """Return True if the speeds admit the state of the housing freewheel."""
    if d.housing_freewheel == 0.0:
        return x.housing_state == OVERRUNNING
    if x.play_housing > 0.0:
        return is_admissible_in_backlash(x.omega2, d.housing_drag, x.housing_state)
    return is_admissible(x.omega2, d.housing_stiffness, x.wound_housing, x.housing_state)


def is_output_admissible(d: Constants, x: State) -> bool:
    """Return True if the speeds admit the state of the output freewheel.

    Without an output freewheel link 2 is locked to the output.
    """
    if d.output_freewheel == 0.0:
        return x.output_state == LOCKED
    if x.play_output > 0.0:
        return is_admissible_in_backlash(x.omega3 - x.omega2, d.output_drag, x.output_state)
    return is_admissible(x.omega3 - x.omega2, d.freewheel_stiffness, x.wound_output, x.output_state)


def is_admissible_in_backlash(speed: float, drag: float, state: float) -> bool:
    """Return True if a freewheel inside its engagement angle may be in ``state``; only its drag can lock it.

    Args:
        speed: Overrunning speed, rad/s.
        drag: Torque of its drag, N m.
        state: State of the freewheel.
    """
    if state == LOCKED:
        return speed == 0.0 and drag > 0.0
    return speed >= 0.0 if state == OVERRUNNING else speed <= 0.0


def is_admissible(speed: float, stiffness: float, wind_up: float, state: float) -> bool:
    """Return True if a freewheel at the end of its engagement angle may be in ``state``.

    Args:
        speed: Overrunning speed, rad/s.
        stiffness: Of its spring, N m/rad; 0 if it is rigid.
        wind_up: Deflection of its spring, rad.
        state: State of the freewheel.
    """
    if stiffness != 0.0 and (wind_up != 0.0 or speed < 0.0):
        return state == ENGAGED_COMPLIANT
    if state == OVERRUNNING:
        return True
    if speed > 0.0:
        return False
    return (stiffness != 0.0) == (state == ENGAGED_COMPLIANT)


def is_slip_admissible(d: Constants, x: State) -> bool:
    """Return True if the speeds admit the sign of the slip; the sign is 0 for links that stick together."""
    if not has_friction(d):
        return x.slip_sign > 0.0
    slip = x.omega1 - x.omega2
    return slip == 0.0 or x.slip_sign * slip > 0.0


def is_mode_admissible(d: Constants, x: State) -> bool:
    """Return True if speeds, wind-up and backlash admit the states of both freewheels and of the slip."""
    return is_housing_admissible(d, x) and is_output_admissible(d, x) and is_slip_admissible(d, x)
