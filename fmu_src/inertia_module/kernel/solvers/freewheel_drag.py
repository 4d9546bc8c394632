"""Drag of the freewheels in a fixed step: impulses against their mean slips (docs/mechanics.md)."""


def find_drags(d, x, w, held, joined, h):
    """Impulses of drag on link 2 and the hub, N m s, by the mean speed u of link 2; load_hub was before.

    Housing: drag_load + drag_gain u against link 2. Output: over_load - over_gain u against the hub.
    Where the hub and link 2 stay together drag holds them with up to w.holding.
    """
    w.drag_load = w.drag_gain = w.over_load = w.over_gain = w.holding = 0.0
    if w.dragging == 0.0:
        return
    if d.housing != 0.0 and not held:
        w.drag_load = h * d.housing_drag
        w.drag_gain = h * d.housing_drag_viscous
    if joined:
        w.holding = h * d.output_drag if d.output != 0.0 else 0.0
        return
    w.over_gain = h * d.output_drag_viscous
    drag = h * d.output_drag
    braking = w.hub_load + w.hub_gain * x.omega3 + drag + w.over_gain * (x.omega3 - x.omega2)
    mean3 = x.omega3 - w.theta * braking / (d.J3 + w.theta * w.hub_gain)
    w.over_load = drag + w.over_gain * mean3


def take_drags(w, held, h):
    """Impulses of drag at the mean speed of link 2 that the step has come to."""
    mean2 = 0.0 if held else (w.angle1 - w.new_slip_angle) / h
    w.drag = w.drag_load + w.drag_gain * mean2
    w.overrun = w.over_load - w.over_gain * mean2


def lose_by_drag(w, held, h):
    """Energy that drag has taken, and whether a mean slip went against its drag (w.reversed)."""
    mean2 = 0.0 if held else (w.angle1 - w.new_slip_angle) / h
    housing = w.drag * mean2
    output = w.overrun * (w.mean3 - mean2)
    w.lost_freewheel = housing + output
    w.reversed = 1.0 if housing < 0.0 or output < 0.0 else 0.0
