"""The module's equations as a peer's user would write them, compiled by numba: generous to the peers.

The state is y = (q, omega2, omega3): rad and rad/s. Everything else is one record (see FIELDS): plain Python
takes it as it is, compiled functions in an array (see in_array).
"""

from __future__ import annotations

import functools
from typing import Any, NamedTuple

import numpy as np

from inertia_module.common.errors import Refused
from inertia_module.common.extras import library
from inertia_module.compiling.ir import data_type, jitted_kernel
from inertia_module.compiling.records import record_type
from inertia_module.kernel import codes
from inertia_module.kernel.fields import CONSTANTS
from inertia_module.memory.instances import Module

from ..reference.geometry import Array
from ..reference.trajectory import Case, Unavailable

# the kernel's constants, then rad/s, N.m, the mode, and the stiffness of the clutches, N.m.s/rad
FIELDS = (("d", CONSTANTS), "omega1", "load", "mode", "stiffness")

# guards of a contact mode: the speed of link 2 or the housing torque, the output freewheel
LINK2 = 0
OUTPUT = 1


# a mode beside the contact modes: a viscous clutch for each freewheel, Tc = c max(0, omega2 - omega3),
# Th = c max(0, -omega2), c their stiffness; without events
CLUTCHES = -1.0


class Equations(NamedTuple):
    """Compiled functions of (t, y, data), data in_array; rates and guards take a third array for the result.

    Attributes:
        rates: (t, y, rates, data), motion in the mode of the data.
        new_rates: (t, y, data), the same in a new array.
        guards: (t, y, guards, data), two numbers that are positive while the mode goes on.
        guard: (t, y, data, which), one of them.
    """

    rates: Any
    new_rates: Any
    guards: Any
    guard: Any


@functools.cache
def equations() -> Equations:
    """Compile the equations, once a process.

    Raises:
        NotInstalled: numba is not.
    """
    numba, kernel = library("numba", "peers"), jitted_kernel()
    jit = numba.njit(error_model="numpy")
    accelerations, held_torque = kernel["links"].accelerations, kernel["links"].held_torque
    held, free, driving, clutches = codes.HELD, codes.FREE, codes.DRIVING, CLUTCHES

    @jit  # type: ignore[untyped-decorator]
    def alpha2(y, data, carried, torque):  # type: ignore[no-untyped-def]
        return accelerations(data.d, y[0], data.omega1, y[1], 0.0, False, carried, 0.0, torque)[1]

    @jit  # type: ignore[untyped-decorator]
    def rates(t, y, result, array):  # type: ignore[no-untyped-def]
        data = array[0]
        result[0] = data.d.k * (data.omega1 - y[1])
        result[1] = 0.0
        result[2] = 0.0
        if data.mode == clutches:
            clutch = data.stiffness * max(0.0, y[1] - y[2])
            housing = data.stiffness * max(0.0, -y[1])
            result[1] = alpha2(y, data, 0.0, clutch - housing)
            result[2] = (clutch - data.load) / data.d.J3
        elif data.mode == driving:
            result[1] = alpha2(y, data, data.d.J3, data.load)
            result[2] = result[1]
        elif data.mode == held:
            result[2] = -data.load / data.d.J3
        elif data.mode == free:
            result[1] = alpha2(y, data, 0.0, 0.0)
            result[2] = -data.load / data.d.J3

    @jit  # type: ignore[untyped-decorator]
    def guard(t, y, array, which):  # type: ignore[no-untyped-def]
        data = array[0]
        if data.mode == clutches:
            return 1.0
        if data.mode in (free, driving):
            if which == LINK2:
                return y[1] if data.d.housing != 0.0 else 1.0
            if data.d.output == 0.0:
                return 1.0
            if data.mode == free:
                return y[2] - y[1]
            return data.load + data.d.J3 * alpha2(y, data, data.d.J3, data.load)
        if which == LINK2:
            carried = 0.0 if data.mode == held else data.load
            return carried - held_torque(data.d, y[0], data.omega1, 0.0)[0]
        return y[2] if data.mode == held and data.load > 0.0 else 1.0

    @jit  # type: ignore[untyped-decorator]
    def guards(t, y, result, data):  # type: ignore[no-untyped-def]
        result[0] = guard(t, y, data, LINK2)
        result[1] = guard(t, y, data, OUTPUT)

    @jit  # type: ignore[untyped-decorator]
    def new_rates(t, y, data):  # type: ignore[no-untyped-def]
        result = np.empty(3)
        rates(t, y, result, data)
        return result

    return Equations(rates, new_rates, guards, guard)


def data_of(case: Case, stiffness: float | None = None) -> Any:
    """What the equations need of a case, a record of FIELDS, its mode not chosen yet.

    Args:
        case: what is run. stiffness: of a clutch for each freewheel, N.m.s/rad, or None: by events.

    Raises:
        Unavailable: the module refuses the parameters, or the case is not of the rigid module; or clutches
            are to stand for freewheels and one is left out.
    """
    if case.parameter("fidelity") != codes.RIGID:
        raise Unavailable("the peers know the rigid module only: fidelity = 2")
    module = Module("plain")
    try:
        module.check(**case.parameters)
    except Refused as error:
        raise Unavailable(str(error)) from None
    d = module.derived
    if stiffness is not None and not (d.housing and d.output):
        raise Unavailable("viscous clutches stand for both freewheels: the case leaves one out")
    return record_type(FIELDS)(d=d, omega1=case.omega1, load=case.load_torque, stiffness=stiffness or 0.0)


def in_array(data: Any) -> Any:
    """The same memory for compiled functions: a NumPy array of one record."""
    return np.frombuffer(data, dtype=data_type(FIELDS))


def largest_step(case: Case, phase: float) -> float:
    """Time in which the fastest harmonic of the mechanism turns by a phase (rad), s.

    Solvers compare a guard's sign at the ends of a step only; while link 2 is held the motion is so
    smooth that their steps would jump over whole pulses.
    """
    data = data_of(case)
    rate = data.d.harmonic * data.d.k * abs(case.omega1)
    return float(phase / rate) if rate > 0.0 else np.inf


def start_of(case: Case) -> Array:
    """State at time 0, shape (3,): drive angle, speeds of link 2 and of the output shaft."""
    return np.array(
        [case.parameter(name) for name in ("drive_angle_start", "omega2_start", "omega_out_start")]
    )
