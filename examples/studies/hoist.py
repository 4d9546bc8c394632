"""Hoist: a load that pulls backwards, with and without the housing freewheel.

The weight of a hanging load pulls the drum backwards all the time. The module lifts it with its pulses.
Between pulses, and while the input stands still, the housing freewheel holds the load. The module cannot
lower it; this needs a brake on a second path. Without the housing freewheel nothing holds the load.

Run: python examples/studies/hoist.py    (writes out/hoist/table.csv and plot.png)
"""

from pathlib import Path

import numpy as np
from launch import MECHANISM, stall_torque

from inertia_module import Result, current_fmu, simulate
from inertia_module.fmi.results import write_figure

LIFT = 0.01  # m per radian of the shaft: drum of 0.2 m radius behind a gear ratio of 20
INERTIA = 0.2  # kg.m2, drum and load
GRAVITY = 9.80665  # m/s2
OMEGA1 = 150.0  # rad/s
# the input runs, stops and runs again
TIMES = (0.0, 3.0, 3.2, 7.0, 7.2, 10.0)  # s
SPEEDS = (OMEGA1, OMEGA1, 0.0, 0.0, OMEGA1, OMEGA1)
STEP = 2e-3  # s
LOAD_RATIOS = (0.2, 0.5, 0.8, 1.2)  # load torque over stall torque
OUTPUTS = ("omega_out", "output_torque_mean", "housing_torque", "energy_in", "energy_out")


def run(weight_torque, housing_freewheel=True, fmu=None, stop=TIMES[-1]):
    """Run with a load, and add the height of the load to the result.

    Args:
        weight_torque: Load torque, N·m.
        housing_freewheel: True to include the housing freewheel.
        fmu: FMU to use; None for the bundled FMU.
        stop: Duration, s.
    """
    parameters = {**MECHANISM, "output_inertia": INERTIA, "housing_freewheel": housing_freewheel}
    parameters["input_hold"] = "linear"
    inputs = {"time": TIMES, "omega1": SPEEDS, "load_torque": np.full(len(TIMES), weight_torque)}
    table = simulate(
        fmu or current_fmu(), inputs, stop_time=stop, step=STEP, outputs=OUTPUTS, parameters=parameters
    )
    # height = work on the load / weight
    height = table["energy_out"] * LIFT / weight_torque
    columns = {name: table[name] for name in table.names} | {"height": height}
    return Result.from_columns(columns, {**table.units, "height": "m"})


def study(fmu=None):
    """Run all loads.

    Args:
        fmu: FMU to use; None for the bundled FMU.

    Returns:
        Rows (load, mass, lifted height, dropped height, lifting speed), and the results by this ratio.
    """
    torque = stall_torque(OMEGA1, fmu)
    rows, tables = [], {}
    for ratio in LOAD_RATIOS:
        load = ratio * torque
        table = tables[ratio] = run(load, True, fmu)
        standing = table.time < TIMES[3]
        lifted, end_height = np.interp((TIMES[1], TIMES[3]), table.time, table["height"])
        late = (table.time > 1.0) & (table.time < TIMES[1])
        speed = np.ptp(table["height"][late]) / np.ptp(table.time[late])
        rows.append(
            (load, load / LIFT / GRAVITY, lifted, table["height"][standing].max() - end_height, speed)
        )
    return rows, tables


def main():
    """Run the study, print its table, and write table.csv and plot.png."""
    rows, tables = study()
    print("load, N.m   mass, kg   lifted in 3 s, m   dropped at rest, m       lifting, m/s")
    for load, mass, lifted, dropped, speed in rows:
        print(f"{load:<11.1f} {mass:<10.1f} {lifted:<18.3f} {dropped:<24.2e} {speed:.3f}")
    load = LOAD_RATIOS[1] * rows[0][0] / LOAD_RATIOS[0]
    falling = run(load, False, stop=1.0)
    print(f"without the housing freewheel, {load:.1f} N.m: {falling['height'][-1]:.2f} m after 1 s")
    columns = {"time": tables[LOAD_RATIOS[0]].time, "omega1": tables[LOAD_RATIOS[0]]["omega1"]}
    columns |= {f"height_{ratio:g}": table["height"] for ratio, table in tables.items()}
    units = {name: "rad/s" if name == "omega1" else "m" for name in columns if name != "time"}
    result = Result.from_columns(columns, units)
    folder = Path("out") / "hoist"
    print(result.to_csv(folder / "table.csv"))
    print(write_figure(folder / "plot.png", result.plot()))


if __name__ == "__main__":
    main()
