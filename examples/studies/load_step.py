"""Steps of the load: how does the shaft react to a growing load, and at which load does it stop?

The module runs locked up at constant input speed: link 1, link 2 and the shaft turn together, and more than
the stall torque is transmitted without pulses. The load increases in steps. Above the lock-up torque the
satellites start to spin, and the speed falls until the mean torque equals the load. With a load above the
stall torque the shaft stops, held by the housing freewheel. When the load decreases, the shaft starts again.

Run: python examples/studies/load_step.py    (writes out/load_step/table.csv and plot.png)
"""

from pathlib import Path

import numpy as np
from launch import MECHANISM

from inertia_module import Result, current_fmu, simulate, torque_converter_chart
from inertia_module.fmi.results import write_figure
from inertia_module.plots.panels import smooth

OMEGA1 = 150.0  # rad/s
INERTIA = 0.5  # kg.m2
HOLD = 4.0  # s at each load
STEP = 2e-3  # s
# loads over the stall torque, in the middle over the lock-up torque
STALL_RATIOS_UP = (0.3, 0.8)
LOCK_UP_RATIOS = (0.5, 1.1)
STALL_RATIOS_DOWN = (0.8, 0.3)
SMOOTHING = 0.1  # s
OUTPUTS = ("omega_out", "output_torque_mean", "input_torque_mean")


def loads_of_study():
    """Return the loads, N·m, from the chart of the mechanism."""
    summary = torque_converter_chart({**MECHANISM, "layout": 1}).summary()  # planar
    stall, lock_up = (summary[name] * OMEGA1**2 for name in ("stall_torque", "lock_up_torque"))
    return np.array(
        [
            *(ratio * stall for ratio in STALL_RATIOS_UP),
            *(ratio * lock_up for ratio in LOCK_UP_RATIOS),
            *(ratio * stall for ratio in STALL_RATIOS_DOWN),
        ]
    )


def run(loads, fmu=None):
    """Run the load steps.

    Args:
        loads: Loads, N·m.
        fmu: FMU to use; None for the bundled FMU.
    """
    edges = HOLD * np.arange(len(loads) + 1)
    # the load changes within one communication step
    time = np.sort(np.concatenate([edges[:-1], edges[1:] - STEP]))
    inputs = {"time": time, "omega1": np.full(time.size, OMEGA1), "load_torque": np.repeat(loads, 2)}
    parameters = {**MECHANISM, "output_inertia": INERTIA}
    return simulate(
        fmu or current_fmu(),
        inputs,
        stop_time=float(edges[-1]),
        step=STEP,
        outputs=OUTPUTS,
        parameters=parameters,
    )


def study(fmu=None):
    """Run the study.

    Args:
        fmu: FMU to use; None for the bundled FMU.

    Returns:
        Rows (load, settled speed, minimum speed, input torque), and the result.
    """
    loads = loads_of_study()
    table = run(loads, fmu)
    rows = []
    for n, load in enumerate(loads):
        step = (table.time >= n * HOLD) & (table.time < (n + 1) * HOLD)
        last = step & (table.time >= (n + 0.75) * HOLD)
        speed = table["omega_out"][last].mean()
        torque = table["input_torque_mean"][last].mean()
        rows.append((load, speed, table["omega_out"][step].min(), torque))
    return rows, table


def main():
    """Run the study, print its table, and write table.csv and plot.png."""
    rows, table = study()
    print("load, N.m   settled, rad/s   / omega1    minimum, rad/s   mean input torque, N.m")
    for load, speed, lowest, torque in rows:
        print(f"{load:<11.1f} {speed:<16.2f} {speed / OMEGA1:<11.3f} {lowest:<15.2f} {torque:.2f}")
    # means over a tenth of a second, because pulses are not visible in a figure of half a minute
    torques = ("output_torque_mean", "input_torque_mean")
    columns = {"time": table.time, "load_torque": table["load_torque"]}
    columns |= {name: smooth(table.time, table[name], SMOOTHING) for name in torques} | {
        "omega_out": table["omega_out"]
    }
    units = {name: "rad/s" if name == "omega_out" else "N.m" for name in columns if name != "time"}
    folder = Path("out") / "load_step"
    print(table.to_csv(folder / "table.csv"))
    print(write_figure(folder / "plot.png", Result.from_columns(columns, units).plot()))


if __name__ == "__main__":
    main()
