"""Launch from standstill: how large is the stall torque, and how soon does the shaft reach its speed?

A planar module with constant input speed starts a flywheel against a constant load. The stall torque is the
mean torque on a locked output shaft; without gravity it is proportional to the square of the input speed. The
script prints the times to 50 % and 90 % of the input speed, rigid (with pulses) and averaged (without).

Run: python examples/studies/launch.py    (writes out/launch/table.csv and plot.png)
"""

from pathlib import Path

import numpy as np

from inertia_module import Result, current_fmu, simulate
from inertia_module.fmi.results import write_figure

MECHANISM = {"layout": "planar", "sun_radius": 0.1, "satellite_radius": 0.06, "eccentricity": 0.04}
MECHANISM |= {"imbalance_mass": 0.3, "satellites": 3, "link2_inertia": 0.01}
FLYWHEEL = 2.0  # kg.m2
LOAD = 20.0  # N.m
SPEEDS = (100.0, 150.0, 200.0)  # rad/s
STEP = 2e-3  # s
STOP = 6.0  # s
OUTPUTS = ("omega_out", "output_torque_mean", "input_torque_mean")


def stall_torque(omega1, fmu=None):
    """Return the mean torque on a locked output shaft over one second, N·m.

    Args:
        omega1: Input speed, rad/s.
        fmu: FMU to use; None for the bundled FMU.
    """
    parameters = {**MECHANISM, "output_inertia": 1e5}
    inputs = {"omega1": omega1, "load_torque": 0.0}
    table = simulate(
        fmu or current_fmu(), inputs, stop_time=1.0, step=1.0, outputs=OUTPUTS, parameters=parameters
    )
    return table["output_torque_mean"][-1]


def launch(omega1, fidelity, fmu=None):
    """Run a launch.

    Args:
        omega1: Input speed, rad/s.
        fidelity: Name of the fidelity.
        fmu: FMU to use; None for the bundled FMU.
    """
    parameters = {**MECHANISM, "output_inertia": FLYWHEEL, "fidelity": fidelity}
    inputs = {"omega1": omega1, "load_torque": LOAD}
    return simulate(
        fmu or current_fmu(), inputs, stop_time=STOP, step=STEP, outputs=OUTPUTS, parameters=parameters
    )


def time_to(table, speed):
    """Return the time at which the shaft reaches a speed, s; infinite if it does not.

    Args:
        table: Result of a launch.
        speed: Output speed, rad/s.
    """
    rows = np.flatnonzero(table["omega_out"] >= speed)
    return table.time[rows[0]] if rows.size else np.inf


def study(fmu=None):
    """Run all launches.

    Args:
        fmu: FMU to use; None for the bundled FMU.

    Returns:
        Rows (omega1, stall torque, times to 50 % and 90 % rigid and averaged), and the results by speed and
        fidelity.
    """
    rows, launches = [], {}
    for omega1 in SPEEDS:
        times = []
        for fidelity in ("rigid", "averaged"):
            table = launches[omega1, fidelity] = launch(omega1, fidelity, fmu)
            times += [time_to(table, 0.5 * omega1), time_to(table, 0.9 * omega1)]
        rows.append((omega1, stall_torque(omega1, fmu), *times))
    return rows, launches


def main():
    """Run the study, print its table, and write table.csv and plot.png."""
    rows, launches = study()
    print("omega1   stall torque   / omega1^2      rigid: 50 %    90 %   averaged: 50 %    90 %")
    print("rad/s    N.m            N.m.s2/rad2            s       s                s       s")
    for omega1, torque, *times in rows:
        rigid_50, rigid_90, averaged_50, averaged_90 = times
        print(
            f"{omega1:<8g} {torque:<14.1f} {torque / omega1**2:<15.5f} {rigid_50:11.3f} {rigid_90:7.3f}"
            f" {averaged_50:16.3f} {averaged_90:7.3f}"
        )
    columns = {"time": launches[SPEEDS[0], "rigid"].time}
    for (omega1, fidelity), table in launches.items():
        columns[f"{fidelity}_{omega1:g}"] = table["omega_out"]
    result = Result.from_columns(columns, {name: "rad/s" for name in columns if name != "time"})
    folder = Path("out") / "launch"
    print(result.to_csv(folder / "table.csv"))
    print(write_figure(folder / "plot.png", result.plot()))


if __name__ == "__main__":
    main()
