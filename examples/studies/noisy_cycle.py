"""Urban cycle with noise: how well does the car follow the cycle with a noisy speed sensor and gusts?

The car of examples/urban.toml runs without noise, with noise on the measured speed (a wheel sensor), and with
gusts on the load. The controller uses the noisy speed; the printed error is the error of the true speed. The
noise is the same in every run: seeded random numbers, constant for 50 ms, gusts smoothed over one second.

Run: python examples/studies/noisy_cycle.py    (writes out/noisy_cycle/table.csv and plot.png)
"""

from pathlib import Path

import control as ct
import numpy as np
from launch import MECHANISM

from inertia_module import Fmu, Result, driveline
from inertia_module.driveline.cycles import ELEMENTARY_URBAN_CYCLE as CYCLE
from inertia_module.fmi.results import write_figure

STEP = 0.01  # s
SEED = 2026
HOLD = 0.05  # s, time for which a random number is constant
SENSOR = 0.05  # m/s, standard deviation
GUST = 6.0  # N.m on the output shaft, standard deviation
CASES = {
    "undisturbed": (0.0, 0.0),
    "noisy sensor": (SENSOR, 0.0),
    "gusts": (0.0, GUST),
    "both": (SENSOR, GUST),
}


def noise(deviation, smooth, rng):
    """Make noise over the cycle: random numbers that are constant for HOLD, optionally smoothed.

    Args:
        deviation: Standard deviation.
        smooth: Time over which the numbers are smoothed, s; 0 for no smoothing.
        rng: Random generator.

    Returns:
        Noise over time as a driveline.Table.
    """
    time = np.arange(0.0, CYCLE.duration + HOLD, HOLD)
    values = rng.normal(0.0, 1.0, time.size)
    if smooth:
        width = round(smooth / HOLD)
        values = np.convolve(values, np.ones(width) / np.sqrt(width), mode="same")
    return driveline.Table(time, deviation * values)


def disturbances(sensor, gust):
    """Return a system that adds noise to the measured speed, and a table of the torque of gusts.

    Args:
        sensor: Standard deviation of the measured speed, m/s.
        gust: Standard deviation of the torque, N·m.
    """
    rng = np.random.default_rng(SEED)
    wheel, wind = noise(sensor, 0.0, rng), noise(gust, 1.0, rng)
    measured = ct.nlsys(
        None,
        lambda t, x, u, params: [u[0] + wheel(t)],
        inputs=["vehicle_speed"],
        outputs=["measured_speed"],
        dt=STEP,
        name="sensor",
    )
    return measured, wind


def run(sensor, gust, fmu=None):
    """Run the cycle and return its result.

    Args:
        sensor: Standard deviation of the measured speed, m/s.
        gust: Standard deviation of the torque of gusts, N·m.
        fmu: FMU to use; None for the bundled FMU.
    """
    measured, wind = disturbances(sensor, gust)
    car = driveline.vehicle_load(STEP, mass=900.0, wheel_radius=0.29, final_drive=4.0, drag_area=0.65)
    torque = ct.nlsys(
        None,
        lambda t, x, u, params: [u[0] + wind(t) * min(1.0, u[1])],
        inputs=["car_torque", "vehicle_speed"],
        outputs=["load_torque"],
        dt=STEP,
        name="wind",
    )
    labels = ["car_torque" if label == "load_torque" else label for label in car.system.output_labels]
    car.system.set_outputs(labels)
    controller = driveline.pi_speed_controller(
        STEP,
        proportional_gain=500.0,
        integral_gain=100.0,
        limits=(0.0, 400.0),
        feedforward=13.8,
        measured="measured_speed",
    )
    surroundings = driveline.connect(
        [
            driveline.source("reference", driveline.Table(CYCLE.time, CYCLE.speed), STEP),
            measured,
            controller,
            driveline.driver_brake(STEP, gain=8000.0, maximum=6000.0, margin=0.14),
            car.system,
            torque,
        ]
    )
    parameters = {**MECHANISM, "input_hold": "linear", "output_inertia": 0.05 + car.rigid_inertia}
    with Fmu(fmu, parameters, driveline.initial_inputs(surroundings), tolerance=1e-6) as instance:
        loop = driveline.ClosedLoop(instance, surroundings, outputs=("energy_in", "energy_residual"))
        return loop.run(CYCLE.duration)


def metrics(table):
    """Return the numbers of the printed table for one run.

    Args:
        table: Result of run.

    Returns:
        RMS speed error, km/h; fraction of the time outside the tolerance; input work, kJ; magnitude of the
        energy residual over the input work.
    """
    lower, upper = CYCLE.tolerance_band(table.time)
    speed = table["vehicle_speed"]
    outside = np.mean((speed < lower) | (speed > upper))
    error = 3.6 * np.sqrt(np.mean((speed - table["reference"]) ** 2))
    work = table["energy_in"][-1]
    return error, outside, work / 1e3, abs(table["energy_residual"][-1]) / work


def study(fmu=None):
    """Run all cases; return the results by name.

    Args:
        fmu: FMU to use; None for the bundled FMU.
    """
    return {name: run(*deviations, fmu) for name, deviations in CASES.items()}


def main():
    """Run the study, print its table, and write table.csv and plot.png."""
    tables = study()
    print("case           error, km/h rms   out of tolerance   input work, kJ   energy residual")
    for name, table in tables.items():
        error, outside, work, residual = metrics(table)
        print(f"{name:<14} {error:<17.3f} {outside:<18.2%} {work:<16.1f} {residual:.1e}")
    columns = {"time": tables["both"].time, "reference": tables["both"]["reference"]}
    columns |= {name.replace(" ", "_"): table["vehicle_speed"] for name, table in tables.items()}
    columns |= {
        f"omega1_{name.replace(' ', '_')}": tables[name]["omega1"] for name in ("undisturbed", "both")
    }
    units = {name: "rad/s" if name.startswith("omega1") else "m/s" for name in columns if name != "time"}
    result = Result.from_columns(columns, units)
    folder = Path("out") / "noisy_cycle"
    print(result.to_csv(folder / "table.csv"))
    print(write_figure(folder / "plot.png", result.plot()))


if __name__ == "__main__":
    main()
