"""The hub over a fixed step, with drag and the elastic shaft: the midpoint rule (docs/mechanics.md)."""

from ..accumulate import add, add_loss, turn_against
from ..codes import SHAFT, VISCOUS
from ..impulse import push_driven_mass
from ..links import inertia_of_link2

# what a torque of the shaft may change of the speed it acts on in a step that resolves it
RESOLVED = 4.0


def load_hub(d, x, w, held, joined, h):
    """Find the impulses on hub and link 2 by mean speeds, N m s.

    Load, friction or shaft on the hub: hub_load + hub_gain u, u its mean speed. Drag of the housing freewheel
    on link 2: drag_load + drag_gain u, of the output freewheel on the hub: over_load - over_gain u, u that of
    link 2. Where both stay together drag holds them with up to w.holding.
    """
    w.hub_load = w.load * h
    w.hub_gain = d.b3 * h
    w.stiff = 0.0
    # one that friction stops within the step does not turn back
    w.theta = 0.5 if w.hub_gain < 2.0 * d.J3 else 1.0
    if d.elastic != 0.0:
        load_shaft(d, x, w, joined, h)
    w.drag_load = w.drag_gain = w.over_load = w.over_gain = w.holding = 0.0
    acting = h * w.dragging
    if acting == 0.0:
        return
    if not held:
        w.drag_load = acting * d.housing_drag
        w.drag_gain = acting * d.housing_drag_viscous
    if joined:
        w.holding = acting * d.output_drag
        return
    w.over_gain = acting * d.output_drag_viscous
    drag = acting * d.output_drag
    braking = w.hub_load + w.hub_gain * x.omega3 + drag + w.over_gain * (x.omega3 - x.omega2)
    mean3 = x.omega3 - w.theta * braking / (d.J3 + w.theta * w.hub_gain)
    w.over_load = drag + w.over_gain * mean3


def load_shaft(d, x, w, joined, h):
    """Find the impulse of an elastic shaft on the hub; behind it is relative_load + relative_gain u, rad/s.

    Where the step does not resolve the shaft its torque is that of the twist at the end. A light hub that
    turns freely then ends at its mean speed (w.theta), but where not even link 2 with the hub is heavy enough
    it meets the driven mass (w.stiff).
    """
    damping = d.damping + d.stiffness * h
    pull = damping * h
    together = d.J3 + inertia_of_link2(d, x.i, x.b, x.g)
    if pull * (together + d.J4) > RESOLVED * together * d.J4:
        w.stiff = 1.0
    elif not joined and pull * (d.J3 + d.J4) > RESOLVED * d.J3 * d.J4:
        w.theta = 1.0
    else:
        damping -= 0.5 * d.stiffness * h
    free = 2.0 * d.J4 * (1.0 - d.balancer)
    share = 1.0 / (2.0 * d.J4 + h * (d.friction + damping))
    spring = h * d.stiffness * x.twist
    w.relative_gain = share * (free + h * d.friction)
    w.relative_load = share * (2.0 * d.J4 * x.relative - free * x.omega3 + w.hub_load - spring)
    w.hub_load = spring + h * damping * w.relative_load
    w.hub_gain += h * damping * w.relative_gain


def drive_mass(d, x, w, h):
    """The driven mass over the step, behind a hub whose speed changes evenly (to w.seen3) about its mean."""
    w.mean_relative = w.relative_load + w.relative_gain * w.mean3
    w.seen3 = 2.0 * w.mean3 - x.omega3
    w.omega4 = w.seen3 - 2.0 * w.mean_relative + x.relative
    if d.friction * h > RESOLVED * d.J4:
        mean4 = abs(w.mean3 - w.mean_relative)
        w.omega4 = max(-mean4, min(mean4, w.omega4))


def turn_shaft(d, x, w, end3, h):
    """The hub to its end speed, with twist, driven mass and works of the shaft behind it."""
    mean4 = w.mean3
    if d.viscous != 0.0:
        lost = w.friction_work + h * d.b3 * w.mean3 * w.mean3
        add_loss(x, VISCOUS, lost)
    if d.elastic != 0.0:
        mean4 -= w.mean_relative
        lost = h * (d.damping * w.mean_relative * w.mean_relative + d.friction * mean4 * mean4)
        lost -= d.balancer * d.J4 * (w.seen3 - x.omega3) * mean4
        add_loss(x, SHAFT, lost)
        x.twist, x.twist_low = add(x.twist, x.twist_low, h * w.mean_relative)
        x.omega3 = w.seen3
        x.relative = w.seen3 - w.omega4
        x.relative_low = 0.0
        push_driven_mass(d, x, w.end3 - w.seen3, False)
        x.omega3 = w.end3
        if w.stiff != 0.0:
            x.relative = 0.0
            x.relative_low = 0.0
        push_driven_mass(d, x, end3 - w.end3, w.stiff != 0.0)
    turn_against(x, w.load, h * mean4)
    x.omega3 = end3
