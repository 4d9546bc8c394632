"""Balances of momentum and energy of an internal step."""

from ..equations.losses import MESH, SHAFT, VISCOUS
from ..equations.satellites import gravity_potential
from ..equations.states import ENGAGED_COMPLIANT, LOCKED
from ..fields import N_CAUSES
from ..layout import imbalance_position
from ..links import energy_of_links, momentum_of_links
from ..records import Constants, Integrated, State, Workspace

MAX_ENERGY_MADE = 4.0  # Over the tolerance times the energies that change in a step
ENERGY_ROUNDING = 1e-13  # Relative round-off of energies


def balance(d: Constants, x: State, w: Workspace) -> None:
    """Write impulses and work of the present step by balances of momentum and energy, for the ideal module.

    M1 - Tc + Th is the rate of the angular momentum. While link 2 is held, the work of M1 is kinetic energy.
    On a ramp of the input speed the impulses are integrated instead.

    Args:
        d: Constants; ``d.machine`` holds the reduced inertia at the end of the step.
        x: State at the beginning of the step.
        w: Workspace with the changes over the step, which are updated.
    """
    change = w.change
    if d.elastic == 0.0 and x.output_state == LOCKED:
        change.output = d.J3 * change.omega3 + w.load * w.step + d.b3 * change.turned3
    m = d.machine
    omega1, omega2 = x.omega1 + change.omega1, x.omega2 + change.omega2
    passed = momentum_of_links(d, m.i, m.b, omega1, omega2) - w.momentum + change.output
    passed += d.b1 * change.theta1 + d.b2 * (change.theta1 - change.q / d.k)
    if d.by_torque != 0.0:
        change.housing = passed - w.prescribed * w.step
    elif w.prescribed == 0.0:
        change.drive = passed
        if x.housing_state == LOCKED:
            lost = (d.b1 + d.k * d.k * d.bq) * change.theta1
            gained = energy_of_links(d, m.i, m.b, m.g, omega1, omega2) - w.energy
            change.drive = gained / x.omega1 + lost if x.omega1 != 0.0 else 0.0
        change.housing = passed - change.drive
        change.work_in = x.omega1 * change.drive


def work_of_balancer(d: Constants, x: State, change: Integrated) -> float:
    """Return the work of the balancer at the speed of the hub in the present step, J."""
    return d.balancer * d.J4 * (x.omega3 + 0.5 * change.omega3) * change.omega3


def energy_lost(d: Constants, x: State, change: Integrated) -> float:
    """Return the energy lost in the present step by all causes, J."""
    lost = 0.0
    if d.viscous != 0.0:
        lost += change.lost[VISCOUS]
    if d.elastic != 0.0:
        lost += change.lost[SHAFT]
    if d.elastic + d.rigid_shaft != 0.0:
        lost -= work_of_balancer(d, x, change)
    if d.losses != 0.0:
        for cause in range(MESH, N_CAUSES):
            lost += change.lost[cause]
    return lost


def energy_made(d: Constants, x: State, w: Workspace) -> float:
    """Return the energy error of the present step over the allowed one.

    The error estimate of a step that is far too long can be zero by chance. The energy balance does not
    depend on it. The scale contains only energies that change: neither link 1 at a prescribed speed nor an
    output that overruns. In maps of fidelity averaged the inertia of the output has no physical meaning, and
    the result is 0.

    Args:
        d: Constants; ``d.machine`` holds the end of the step.
        x: State at the beginning of the step.
        w: Workspace with the energies at the beginning and the changes over the step.
    """
    if d.averaged != 0.0:
        return 0.0
    m, change = d.machine, w.change
    omega1, omega2, omega3 = x.omega1 + change.omega1, x.omega2 + change.omega2, x.omega3 + change.omega3
    links = energy_of_links(d, m.i, m.b, m.g, omega1, omega2)
    output = 0.5 * d.J3 * change.omega3 * (x.omega3 + omega3)
    moved = abs(output)
    if d.rigid_shaft != 0.0:
        output += work_of_balancer(d, x, change)
    if d.elastic != 0.0:
        before, after = x.omega3 - x.relative, omega3 - x.relative - change.relative
        output += 0.5 * d.J4 * (after - before) * (after + before)
        output += 0.5 * d.shaft_stiffness * change.twist * (2.0 * x.twist + change.twist)
        moved += 0.5 * d.shaft_stiffness * x.twist * x.twist
    springs = 0.0
    if x.housing_state == ENGAGED_COMPLIANT:
        wound = change.wound_housing * (2.0 * x.wound_housing + change.wound_housing)
        springs += 0.5 * d.housing_stiffness * wound
    if x.output_state == ENGAGED_COMPLIANT:
        wound = change.wound_output * (2.0 * x.wound_output + change.wound_output)
        springs += 0.5 * d.freewheel_stiffness * wound
    work_in = change.work_in if d.by_torque == 0.0 else w.prescribed * change.theta1
    work_out = w.load * change.turned3
    weights = lifted = 0.0
    if d.weight != 0.0:
        lifted = d.weight * (abs(d.radial) + abs(d.axial) + d.arm)
        weights, _, _ = gravity_potential(
            d, imbalance_position(d, x.q + change.q, 0.0), x.theta1 + change.theta1
        )
        weights -= w.potential
    lost = energy_lost(d, x, change)
    made = (links - w.energy) + output + springs + weights + lost + work_out - work_in
    link1 = 0.5 * d.J1 * (x.omega1 * x.omega1 + omega1 * omega1) if d.by_torque == 0.0 else 0.0
    moved += abs(links + w.energy - link1) + abs(work_in) + abs(work_out) + abs(lost) + abs(springs)
    fixed = link1 + d.J3 * (x.omega3 * x.omega3 + omega3 * omega3)
    allowed = MAX_ENERGY_MADE * w.tolerance * moved + ENERGY_ROUNDING * (moved + fixed + lifted)
    return abs(made) / allowed if allowed > 0.0 else 0.0
