"""The peer: scene R1 as a user would write it with SciPy, LSODA and freewheels made of viscous clutches."""

import numpy as np
from scipy.integrate import solve_ivp

from inertia_module.kernel import derive, dynamics, inertia, slots
from inertia_module.variables import default_parameters


def compiled_right_side():
    """Right-hand side of (q, omega2, omega3), compiled by numba: generous to the peer."""
    import numba

    jit = numba.njit(error_model="numpy")
    reduced = jit(inertia.reduced_inertia)
    free = jit(dynamics.free_torque)
    k_slot, j2_slot, j3_slot = slots.D_K, slots.D_J2, slots.D_J3

    @jit
    def right_side(t, y, d, omega1, load, stiffness):
        q, omega2, omega3 = y
        _, i1, _, b, _, g, g1, _ = reduced(d, q)
        k = d[k_slot]
        clutch = stiffness * max(0.0, omega2 - omega3)
        housing = stiffness * max(0.0, -omega2)
        torque = free(d, omega1, 0.0, k * (omega1 - omega2), i1, b, g, g1)
        alpha2 = (torque - clutch + housing) / (d[j2_slot] + k * k * g)
        return np.array([k * (omega1 - omega2), alpha2, (clutch - load) / d[j3_slot]])

    return right_side


def simulate(right_side, stiffness, tolerance, stop_time=1.0, omega1=100.0, load=10.0):
    """Speed omega3 at stop_time, rad/s, and the right-hand sides it took."""
    d = [0.0] * slots.D_SIZE
    derive.derive(default_parameters(), d)
    done = solve_ivp(
        right_side,
        (0.0, stop_time),
        [0.0, 0.0, 0.0],
        method="LSODA",
        rtol=tolerance,
        atol=tolerance,
        args=(np.array(d), omega1, load, stiffness),
    )
    return float(done.y[2, -1]), int(done.nfev)
