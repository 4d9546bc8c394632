"""Overrun and coasting: how does the shaft move when the engine becomes slower than the shaft?

The output freewheel transmits no torque backwards, so there is no engine braking. The shaft coasts against
its load while the input slows down. When the input accelerates again, it must overtake the shaft before
torque is transmitted. Without the output freewheel, link 2 and the shaft are one body, and the shaft drives
the mechanism.

Run: python examples/studies/overrun.py    (writes out/overrun/table.csv and plot.png)
"""

from pathlib import Path

import numpy as np
from launch import MECHANISM

from inertia_module import Result, current_fmu, simulate
from inertia_module.fmi.results import write_figure

INERTIA = 2.0  # kg.m2
LOAD = 5.0  # N.m
# input speed: full, a quarter, full
TIMES = (0.0, 4.0, 4.5, 7.0, 8.0, 12.0)  # s
SPEEDS = (200.0, 200.0, 50.0, 50.0, 200.0, 200.0)  # rad/s
STEP = 2e-3  # s
OUTPUTS = ("omega_out", "omega2", "output_torque_mean", "input_torque_mean", "energy_in", "energy_out")


def run(output_freewheel=True, fmu=None):
    """Run with or without the output freewheel.

    Args:
        output_freewheel: True to include the output freewheel.
        fmu: FMU to use; None for the bundled FMU.
    """
    parameters = {**MECHANISM, "output_inertia": INERTIA, "output_freewheel": output_freewheel}
    parameters["input_hold"] = "linear"
    inputs = {"time": TIMES, "omega1": SPEEDS, "load_torque": np.full(len(TIMES), LOAD)}
    return simulate(
        fmu or current_fmu(), inputs, stop_time=TIMES[-1], step=STEP, outputs=OUTPUTS, parameters=parameters
    )


def phases(table):
    """Return deceleration while coasting, load over inertia, rad/s², and the delay of the torque, s.

    Args:
        table: Result of run.
    """
    coasting = (table.time > TIMES[2]) & (table.time < TIMES[3])
    speed = table["omega_out"][coasting]
    deceleration = (speed[0] - speed[-1]) / np.ptp(table.time[coasting])
    accelerating = table.time >= TIMES[3]
    has_torque = accelerating & (table["output_torque_mean"] > LOAD)
    torque_start = table.time[np.flatnonzero(has_torque)[0]] if has_torque.any() else np.nan
    return deceleration, LOAD / INERTIA, torque_start - TIMES[3]


def study(fmu=None):
    """Run with (True) and without (False) the output freewheel; return the results by this value.

    Args:
        fmu: FMU to use; None for the bundled FMU.
    """
    return {freewheel: run(freewheel, fmu) for freewheel in (True, False)}


def main():
    """Run the study, print its table, and write table.csv and plot.png."""
    tables = study()
    deceleration, free_deceleration, delay = phases(tables[True])
    print(f"deceleration while overrunning: {deceleration:.4f} rad/s2")
    print(f"load over inertia: {free_deceleration:.4f} rad/s2")
    print(f"torque transmitted again {delay:.3f} s after the input starts to accelerate")
    for freewheel, table in tables.items():
        slow = (table.time > TIMES[2]) & (table.time < TIMES[3])
        work = table["energy_in"][slow][-1] - table["energy_in"][slow][0]
        with_or_without = "with" if freewheel else "without"
        lowest = table["omega_out"][slow].min()
        print(
            f"{with_or_without} output freewheel: input work while slow {work:9.1f} J,"
            f" lowest speed {lowest:7.2f} rad/s"
        )
    columns = {"time": tables[True].time, "omega1": tables[True]["omega1"]}
    columns |= {
        f"omega_out_{'free' if key else 'rigid'}": table["omega_out"] for key, table in tables.items()
    }
    columns["output_torque_mean"] = tables[True]["output_torque_mean"]
    units = {name: "N.m" if "torque" in name else "rad/s" for name in columns if name != "time"}
    result = Result.from_columns(columns, units)
    folder = Path("out") / "overrun"
    print(result.to_csv(folder / "table.csv"))
    print(write_figure(folder / "plot.png", result.plot()))


if __name__ == "__main__":
    main()
