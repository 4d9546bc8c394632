"""Couple the inertia module and an elastic shaft as two FMUs at the communication points.

The rigid module drives the hub (its output shaft, J3). DrivenShaft is the shaft downstream with the driven
mass. Speed and torque are exchanged:

    omega_out of the module          ->  hub_speed of the shaft
    shaft_torque_mean of the shaft   ->  load_torque of the module

Most hosts step both in parallel (Jacobi scheme); the error is proportional to the step. With the
instantaneous torque, the module stepped first and the derivatives of both, the error is proportional to the
square of the step: see docs/how_to/coupling.md. Run `inertia-module build` first. The last line is the
monolithic elastic module.
"""

from pathlib import Path

from inertia_module import Fmu

BUILD = Path("build")  # of `inertia-module build`
MODULE = {"output_inertia": 0.02, "fidelity": "rigid"}
SHAFT = {"driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
SPEED = 100.0  # rad/s
LOAD = 10.0  # N.m
MONOLITHIC = 3.908460340, 16.766411224  # speeds of hub and driven mass, rad/s


def advance(module, shaft, step):
    """Advance both in parallel by a communication step, with the mean torque of the last step.

    Args:
        module: FMU of the module.
        shaft: FMU of the driven shaft.
        step: Communication step, s.
    """
    speed, torque = module["omega_out"], shaft["shaft_torque_mean"]
    module.set(load_torque=torque)
    shaft.set(hub_speed=speed)
    module.advance(step)
    shaft.advance(step)


def advance_with_derivatives(module, shaft, step):
    """Advance the module, then the shaft, by a communication step, with derivatives of torque and speed.

    Args:
        module: FMU of the module.
        shaft: FMU of the driven shaft.
        step: Communication step, s.
    """
    speed = module["omega_out"]
    module.set(load_torque=shaft["shaft_torque"])
    module.set_rates(load_torque=shaft.rates("shaft_torque")[0])
    module.advance(step)
    shaft.set(hub_speed=speed)
    shaft.set_rates(hub_speed=(module["omega_out"] - speed) / step)
    shaft.advance(step)


def simulate(advance, step, stop=1.0, folder=BUILD):
    """Return the final speeds of hub and driven mass, rad/s.

    Args:
        advance: Function that advances both FMUs by a step.
        step: Communication step, s.
        stop: Duration, s.
        folder: Folder with the FMUs.
    """
    with (
        Fmu(folder / "InertiaModule.fmu", MODULE, {"omega1": SPEED}, tolerance=1e-9) as module,
        Fmu(folder / "DrivenShaft.fmu", SHAFT, {"load_torque": LOAD}) as shaft,
    ):
        for _ in range(round(stop / step)):
            advance(module, shaft, step)
        return module["omega_out"], shaft["omega_out"]


if __name__ == "__main__":
    print("             Jacobi                     with derivatives")
    print("step, s      hub, rad/s  driven mass    hub, rad/s  driven mass")
    for step in (1e-3, 1e-4, 1e-5):
        speeds = *simulate(advance, step), *simulate(advance_with_derivatives, step)
        print("{:<10g} {:12.6f} {:12.6f}  {:12.6f} {:12.6f}".format(step, *speeds))
    print("monolithic {:12.6f} {:12.6f}".format(*MONOLITHIC))
