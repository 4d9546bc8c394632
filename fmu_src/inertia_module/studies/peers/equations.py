"""The module's equations as a peer's user would write them, compiled by numba: generous to the peers.

The state is y = (q, omega2, omega3): rad and rad/s. Everything else is one record (see FIELDS): plain Python
takes it as it is, compiled functions in an array (see in_array).
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...common.errors import Refused
from ...compiling.ir import data_type, jitted_kernel
from ...compiling.records import record_type
from ...kernel import codes
from ...kernel.contact import TORQUE_ROUNDING
from ...kernel.fields import CONSTANTS
from ...memory.instances import Module
from ..trajectory import Array, Case, Unavailable
from .extras import library

# the kernel's constants, then rad/s, N.m, the contact mode, and the stiffness of the clutches, N.m.s/rad
FIELDS = (("d", CONSTANTS), "omega1", "load", "mode", "stiffness")

# guards of a contact mode: the speed of link 2 or the housing torque, the output freewheel
LINK2 = 0
OUTPUT = 1


@dataclass(frozen=True)
class Equations:
    """Compiled functions of (t, y, data), data in_array; those with a third array write their result there.

    Attributes:
        contact_rates: (t, y, rates, data), motion in the contact mode of the data.
        contact_guards: (t, y, guards, data), two numbers that are positive while the mode goes on.
        clutch_rates: (t, y, rates, data), motion with a viscous clutch for each freewheel:
            Tc = c max(0, omega2 - omega3), Th = c max(0, -omega2), c their stiffness.
        new_contact_rates, new_clutch_rates: (t, y, data), the same in a new array.
        guard: (t, y, data, which), one guard.
        select_mode: (y, data), the kernel's choice of the contact mode.
    """

    contact_rates: Any
    contact_guards: Any
    clutch_rates: Any
    new_contact_rates: Any
    new_clutch_rates: Any
    guard: Any
    select_mode: Any


@functools.cache
def equations() -> Equations:
    """Compile the equations, once a process.

    Raises:
        Unavailable: numba is not installed.
    """
    numba, kernel = library("numba"), jitted_kernel()
    jit = numba.njit(error_model="numpy")
    accelerations, held_torque = kernel["links"].accelerations, kernel["links"].held_torque
    kernel_mode = kernel["contact"].select_mode
    held, free, driving = codes.HELD, codes.FREE, codes.DRIVING

    @jit  # type: ignore[untyped-decorator]
    def alpha2(y, data, carried, torque):  # type: ignore[no-untyped-def]
        return accelerations(data.d, y[0], data.omega1, y[1], 0.0, False, carried, torque)[1]

    @jit  # type: ignore[untyped-decorator]
    def contact_rates(t, y, rates, array):  # type: ignore[no-untyped-def]
        data = array[0]
        rates[0] = data.d.k * (data.omega1 - y[1])
        rates[1] = 0.0
        rates[2] = 0.0
        if data.mode == held:
            rates[2] = -data.load / data.d.J3
        elif data.mode == free:
            rates[1] = alpha2(y, data, 0.0, 0.0)
            rates[2] = -data.load / data.d.J3
        elif data.mode == driving:
            rates[1] = alpha2(y, data, data.d.J3, data.load)
            rates[2] = rates[1]

    @jit  # type: ignore[untyped-decorator]
    def guard(t, y, array, which):  # type: ignore[no-untyped-def]
        data = array[0]
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
    def contact_guards(t, y, guards, data):  # type: ignore[no-untyped-def]
        guards[0] = guard(t, y, data, LINK2)
        guards[1] = guard(t, y, data, OUTPUT)

    @jit  # type: ignore[untyped-decorator]
    def clutch_rates(t, y, rates, array):  # type: ignore[no-untyped-def]
        data = array[0]
        clutch = data.stiffness * max(0.0, y[1] - y[2])
        housing = data.stiffness * max(0.0, -y[1])
        rates[0] = data.d.k * (data.omega1 - y[1])
        rates[1] = alpha2(y, data, 0.0, clutch - housing)
        rates[2] = (clutch - data.load) / data.d.J3

    @jit  # type: ignore[untyped-decorator]
    def select_mode(y, array):  # type: ignore[no-untyped-def]
        data = array[0]
        return kernel_mode(data.d, y[0], data.omega1, y[1], y[2], 0.0, data.load, 0.0, TORQUE_ROUNDING)

    @jit  # type: ignore[untyped-decorator]
    def new_contact_rates(t, y, data):  # type: ignore[no-untyped-def]
        rates = np.empty(3)
        contact_rates(t, y, rates, data)
        return rates

    @jit  # type: ignore[untyped-decorator]
    def new_clutch_rates(t, y, data):  # type: ignore[no-untyped-def]
        rates = np.empty(3)
        clutch_rates(t, y, rates, data)
        return rates

    return Equations(
        contact_rates, contact_guards, clutch_rates, new_contact_rates, new_clutch_rates, guard, select_mode
    )


def data_of(case: Case) -> Any:
    """What the equations need of a case, a record of FIELDS; contact mode and stiffness are yet to be set.

    Raises:
        Unavailable: the module refuses the parameters, or the case is not of the rigid module.
    """
    if case.parameter("fidelity") != codes.RIGID:
        raise Unavailable("the peers know the rigid module only: fidelity = 2")
    module = Module("plain")
    try:
        module.check(**case.parameters)
    except Refused as error:
        raise Unavailable(str(error)) from None
    return record_type(FIELDS)(d=module.derived, omega1=case.omega1, load=case.load_torque)


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
