"""Print errors of fidelity averaged with losses, relative to steady pulses of the rigid module.

Run: python tests/unit/averaged_errors.py, for the table in accuracy.md.
"""

from scenes import MECHANISMS, PARTS

from inertia_module.analysis.steady_state import SteadyMachine
from inertia_module.model import Module

REALISTIC = PARTS["realistic"]


def of_pulses(_kernel, values, omega1, ratio):
    """Return output and input torque, N m, efficiency, and mean speed of link 2 over omega1."""
    return SteadyMachine(values).at(omega1, ratio)[:4]


def of_map(kernel, values, omega1, ratio):
    """Return the same numbers by fidelity averaged."""
    module = Module(kernel).start(
        **{**values, "fidelity": 1, "output_inertia": 1e5},
        omega1=omega1,
        omega_out_start=ratio * abs(omega1),
        load_torque=0.0,
    )
    module.advance(1e-3)
    friction = module["output_friction"] * module["omega_out"]
    efficiency = 1.0 - module["energy_lost"] / module["energy_in"]
    taken = module["input_torque_mean"] * (1.0 if omega1 > 0.0 else -1.0)
    return (
        module["output_torque_mean"] - friction,
        taken,
        max(efficiency, 0.0),
        module["omega2"] / abs(omega1),
    )


if __name__ == "__main__":
    print("| | ω1, rad/s | ratio | torque on the load, N·m | error, % | efficiency, % | error |")
    print("|---|---|---|---|---|---|---|")
    for mechanism, shape in MECHANISMS.items():
        for omega1 in (15.0, 30.0, 100.0, 300.0):
            for ratio in (0.1, 0.5, 0.9):
                case = "auto", {**shape, **REALISTIC}, omega1, ratio
                rigid, ours = of_pulses(*case), of_map(*case)
                share, gap = 100.0 * (ours[0] / rigid[0] - 1.0), 100.0 * (ours[2] - rigid[2])
                numbers = f"{rigid[0]:.3g} | {share:+.2f} | {100.0 * rigid[2]:.1f} | {gap:+.2f}"
                print(f"| {mechanism} | {omega1:g} | {ratio} | {numbers} |", flush=True)
