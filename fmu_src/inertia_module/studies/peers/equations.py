"""The module's equations as a peer's user would write them, compiled by numba: generous to the peers.

The state is y = (q, omega2, omega3): rad and rad/s. Everything else goes in one array of doubles,
the cheapest thing to hand to a compiled function: the kernel's derived constants, then omega1, the
load torque and the contact mode or the stiffness of the clutches.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...kernel import slots
from ...kernel.derive import derive
from ...kernel_ir import jitted_kernel
from ...model import INERTIA_MODULE
from ...variables import BY_NAME, default_parameters
from ..trajectory import Array, Case, Unavailable
from .extras import library

OMEGA1 = slots.D_SIZE
LOAD = slots.D_SIZE + 1
MODE = slots.D_SIZE + 2
STIFFNESS = slots.D_SIZE + 3
SIZE = slots.D_SIZE + 4

# guards of a contact mode: the speed of link 2 or the housing torque, the output freewheel
LINK2 = 0
OUTPUT = 1


@dataclass(frozen=True)
class Equations:
    """Compiled functions of (t, y, data); those with a third array write their result there.

    Attributes:
        contact_rates: (t, y, rates, data), motion in the contact mode data[MODE].
        contact_guards: (t, y, guards, data), two numbers that are positive while the mode goes on.
        clutch_rates: (t, y, rates, data), motion with a viscous clutch for each freewheel:
            Tc = c max(0, omega2 - omega3), Th = c max(0, -omega2), c = data[STIFFNESS].
        new_contact_rates, new_clutch_rates: (t, y, data), the same in a new array.
        guard: (t, y, data, which), one guard.
        select_mode: the kernel's choice of the contact mode.
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
    motion = kernel["dynamics"].motion
    held_torque = kernel["dynamics"].held_torque
    k_slot, j3_slot = slots.D_K, slots.D_J3
    housing_slot, output_slot = slots.D_HOUSING, slots.D_OUTPUT
    held, free, driving = slots.HELD, slots.FREE, slots.DRIVING

    @jit  # type: ignore[untyped-decorator]
    def contact_rates(t, y, rates, data):  # type: ignore[no-untyped-def]
        mode, omega1, load = data[MODE], data[OMEGA1], data[LOAD]
        rates[0] = data[k_slot] * (omega1 - y[1])
        rates[1] = 0.0
        rates[2] = 0.0
        if mode == held:
            rates[2] = -load / data[j3_slot]
        elif mode == free:
            rates[1] = motion(data, y[0], omega1, 0.0, y[1], 0.0, 0.0)[0]
            rates[2] = -load / data[j3_slot]
        elif mode == driving:
            rates[1] = motion(data, y[0], omega1, 0.0, y[1], data[j3_slot], load)[0]
            rates[2] = rates[1]

    @jit  # type: ignore[untyped-decorator]
    def guard(t, y, data, which):  # type: ignore[no-untyped-def]
        mode, omega1, load = data[MODE], data[OMEGA1], data[LOAD]
        if mode in (free, driving):
            if which == LINK2:
                return y[1] if data[housing_slot] != 0.0 else 1.0
            if data[output_slot] == 0.0:
                return 1.0
            if mode == free:
                return y[2] - y[1]
            return motion(data, y[0], omega1, 0.0, y[1], data[j3_slot], load)[2]
        if which == LINK2:
            carried = 0.0 if mode == held else load
            return carried - held_torque(data, y[0], omega1, 0.0)[0]
        return y[2] if mode == held and load > 0.0 else 1.0

    @jit  # type: ignore[untyped-decorator]
    def contact_guards(t, y, guards, data):  # type: ignore[no-untyped-def]
        guards[0] = guard(t, y, data, LINK2)
        guards[1] = guard(t, y, data, OUTPUT)

    @jit  # type: ignore[untyped-decorator]
    def clutch_rates(t, y, rates, data):  # type: ignore[no-untyped-def]
        omega1, stiffness = data[OMEGA1], data[STIFFNESS]
        clutch = stiffness * max(0.0, y[1] - y[2])
        housing = stiffness * max(0.0, -y[1])
        rates[0] = data[k_slot] * (omega1 - y[1])
        rates[1] = motion(data, y[0], omega1, 0.0, y[1], 0.0, clutch - housing)[0]
        rates[2] = (clutch - data[LOAD]) / data[j3_slot]

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
        contact_rates,
        contact_guards,
        clutch_rates,
        new_contact_rates,
        new_clutch_rates,
        guard,
        kernel["contact"].select_mode,
    )


def data_of(case: Case) -> Array:
    """What the equations need of a case, shape (SIZE,); contact mode and stiffness are yet to be set.

    Raises:
        Unavailable: the module refuses the parameters, or the case is not of the rigid module.
    """
    parameters = default_parameters()
    for name, value in case.parameters.items():
        parameters[BY_NAME[name].slot] = float(value)
    data = [0.0] * SIZE
    if parameters[slots.P_FIDELITY] != slots.RIGID:
        raise Unavailable("the peers know the rigid module only: fidelity = 2")
    status = derive(parameters, data)  # type: ignore[no-untyped-call]
    if status != slots.OK:
        inputs = [case.omega1, case.load_torque, 0.0, 0.0, 0.0, 0.0]
        raise Unavailable(INERTIA_MODULE.explain(status, parameters, inputs, 0.0))
    data[OMEGA1] = case.omega1
    data[LOAD] = case.load_torque
    return np.array(data)


def largest_step(case: Case, phase: float) -> float:
    """Time in which the fastest harmonic of the mechanism turns by a phase (rad), s.

    Solvers compare a guard's sign at the ends of a step only; while link 2 is held the motion is so
    smooth that their steps would jump over whole pulses.
    """
    data = data_of(case)
    rate = data[slots.D_HARMONIC] * data[slots.D_K] * abs(case.omega1)
    return float(phase / rate) if rate > 0.0 else np.inf


def start_of(case: Case) -> Array:
    """State at time 0, shape (3,): drive angle, speeds of link 2 and of the output shaft."""
    return np.array(
        [case.parameter(name) for name in ("drive_angle_start", "omega2_start", "omega_out_start")]
    )
