"""A car of 900 kg follows the elementary urban cycle through a planar module, closed loop."""

import numpy as np

from inertia_module import Fmu, driveline
from inertia_module.driveline.cycles import ELEMENTARY_URBAN_CYCLE as CYCLE

STEP = 0.01  # s
MECHANISM = {
    "layout": "planar",
    "sun_radius": "100 mm",
    "satellite_radius": "60 mm",
    "eccentricity": "40 mm",
    "imbalance_mass": "0.3 kg",
    "satellites": 3,
    "link2_inertia": "0.01 kg.m2",
    "input_hold": "linear",
}

car = driveline.vehicle_load(STEP, mass=900.0, wheel_radius=0.29, final_drive=4.0, drag_area=0.65)
surroundings = driveline.connect(
    [
        driveline.source("reference", driveline.Table(CYCLE.time, CYCLE.speed), STEP),
        driveline.pi_speed_controller(
            STEP,
            proportional_gain=500.0,  # rad/m
            integral_gain=100.0,  # rad/m/s
            limits=(0.0, 400.0),  # rad/s
            feedforward=13.8,  # rad/m
            measured="vehicle_speed",
        ),
        driveline.driver_brake(STEP, gain=8000.0, maximum=6000.0, margin=0.14),
        car.system,
    ]
)
parameters = {**MECHANISM, "output_inertia": 0.05 + car.rigid_inertia}
with Fmu(parameters=parameters, inputs=driveline.initial_inputs(surroundings), tolerance=1e-7) as fmu:
    loop = driveline.ClosedLoop(fmu, surroundings, outputs=("omega_out", "output_torque_mean"))
    table = loop.run(CYCLE.duration)

lower, upper = CYCLE.tolerance_band(table.time)
speed = table["vehicle_speed"]
outside = np.mean((speed < lower) | (speed > upper))
error = 3.6 * np.sqrt(np.mean((speed - table["reference"]) ** 2))
print(f"{table['distance'][-1]:.0f} m, speed error {error:.2f} km/h rms, out of tolerance {outside:.2%}")
