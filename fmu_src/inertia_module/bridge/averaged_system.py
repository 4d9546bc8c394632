"""Averaged module as a continuous system of python-control, on the map the kernel itself has found.

    J3 omega_out' = omega1^2 F(omega_out / |omega1|) - load_torque

State omega_out. Every torque is that of fidelity averaged at this instant, computed by the kernel's own
functions. Two things a differential equation cannot say. At lock-up (omega_out = omega1) the FMU holds the
two together; here the torque drops to zero above ratio 1, and a solver would chatter there: it is for ratios
below. And at constant inputs no torque has a part in omega1': give `omega1_rate` as a third input for it.

omega1 is an input here. What a torque makes of it is one more equation around this system, with its input
torque; of a module driven by torque there is the FMU itself (fmu_system).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import control as ct
import numpy as np

from ..common.errors import did_you_mean
from ..contract.variables import BY_NAME
from ..harness.fmu import as_names
from ..kernel import codes
from ..kernel.averaged import balance as average_balance
from ..kernel.averaged import legs as average_legs
from ..kernel.averaged import outputs as average_outputs
from ..kernel.averaged import rates as average_rates
from ..kernel.averaged import run as average
from ..memory import Module

INPUTS = ("omega1", "load_torque")
INPUT_RATE = "omega1_rate"
OUTPUTS = (
    "omega_out",
    "omega2",
    "input_torque",
    "mesh_torque",
    "output_torque",
    "housing_torque",
    "torque_ripple",
    "torque_peak",
)


class TransientInertia(NamedTuple):
    """Inertias by which accelerations add to the mean output torque: + input * omega1' - output * omega_out'.

    Attributes:
        input, output: kg m2, at one speed ratio; transient_inertia finds them.
    """

    input: float
    output: float


QUASI_STEADY = TransientInertia(0.0, 0.0)


def averaged_system(
    parameters: Mapping[str, float | str] | None = None,
    *,
    inputs: str | Sequence[str] = INPUTS,
    outputs: str | Sequence[str] = ("omega_out", "input_torque", "output_torque"),
    transient: TransientInertia = QUASI_STEADY,
    name: str = "averaged",
    kernel: str = "auto",
) -> Any:
    """Make a continuous-time NonlinearIOSystem of the averaged module.

    Args:
        parameters: of the module by name, as in Module.set; fidelity is averaged whatever they say.
        inputs: omega1, rad/s, load_torque, N.m, and if wanted omega1_rate, rad/s2 (else 0); all that are
            wanted.
        outputs: of omega_out, omega2, rad/s, input_torque, mesh_torque, output_torque, housing_torque,
            torque_ripple (RMS), torque_peak, N.m.
        transient: what accelerations add to the mean torque while it is driven; nothing in fidelity averaged.
        name: of the system. kernel: as in Module.

    Returns:
        control.NonlinearIOSystem with the state omega_out, rad/s.

    Raises:
        Refused: the parameters cannot be, or there is no mean torque (a freewheel is missing).
        ValueError: an unknown input or output, omega1 or load_torque missing, or drive = torque.
    """
    if BY_NAME["drive"].number((parameters or {}).get("drive", codes.DRIVE_SPEED)) != codes.DRIVE_SPEED:
        raise ValueError("drive must be 0 (speed), is 1 (torque): omega1 is an input of the averaged system")
    inputs, outputs = as_names(inputs), as_names(outputs)
    known = (*INPUTS, INPUT_RATE)
    for kind, names, allowed in (("input", inputs, known), ("output", outputs, OUTPUTS)):
        for wanted in names:
            if wanted not in allowed:
                raise ValueError(f"{kind} {wanted} must be of this system {did_you_mean(wanted, allowed)}")
    if not set(INPUTS) <= set(inputs):
        raise ValueError(f"inputs must contain {' and '.join(INPUTS)}, are {', '.join(inputs)}")
    module = Module(kernel).start(**{**(parameters or {}), "fidelity": float(codes.AVERAGED)})
    d = module.derived
    places = [list(inputs).index(wanted) if wanted in inputs else -1 for wanted in known]

    def motion(omega_out: float, u: Any) -> tuple[Any, Any, float, float, float]:
        """State, side of the map, omega1', rad/s2, mean output torque, N.m, omega_out', rad/s2."""
        omega1, load, rate = (float(u[place]) if place >= 0 else 0.0 for place in places)
        x = type(module.state)()
        x.omega1, x.alpha1 = omega1, rate
        # the shaft does not turn backwards: what a solver leaves below 0 is rest
        x.omega3, x.load_torque = max(omega_out, 0.0), load
        side = average_rates.side_at(d, omega1, rate)  # type: ignore[no-untyped-call]
        leg = average_legs.choose_leg(d, side, x, omega1, rate)  # type: ignore[no-untyped-call]
        torque, acceleration, _, _ = average.torque_at(d, side, x, leg, omega1, rate)  # type: ignore[no-untyped-call]
        if leg == average_legs.SLIPPING and transient != QUASI_STEADY:
            carried = load + d.b3 * x.omega3
            driving = torque - carried + transient.input * rate
            acceleration = driving / (d.J3 + transient.output)
            torque = carried + d.J3 * acceleration
        return x, side, rate, torque, acceleration

    def update(_: float, state: Any, u: Any, __: Any) -> Any:
        return np.array([motion(float(state[0]), u)[-1]])

    def output(_: float, state: Any, u: Any, __: Any) -> Any:
        omega_out, y = float(state[0]), type(module.outputs)()
        x, side, rate, torque, acceleration = motion(omega_out, u)
        omega1 = x.omega1
        average.end_step(d, x, average_legs.RESTING, -1.0, omega1)  # type: ignore[no-untyped-call]
        average_outputs.write_averaged(d, x, y)  # type: ignore[no-untyped-call]
        values = {name: getattr(y, name) for name in OUTPUTS}
        mesh = average_balance.mesh_share(d, side, x, omega1, torque)  # type: ignore[no-untyped-call]
        taken = average_balance.mean_input_torque(d, side, x, omega1, rate, acceleration, torque)  # type: ignore[no-untyped-call]
        values |= {"omega_out": omega_out, "omega2": x.omega2, "input_torque": taken}
        housing = torque + d.b2 * x.omega2 - mesh
        values |= {"output_torque": torque, "mesh_torque": mesh, "housing_torque": housing}
        return np.array([values[wanted] for wanted in outputs])

    return ct.nlsys(
        update, output, inputs=list(inputs), outputs=list(outputs), states=["omega_out"], name=name, dt=0
    )
