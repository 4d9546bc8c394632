"""A planar module with three satellites; inputs from a table, the whole run in one call."""

from pathlib import Path

from inertia_module.harness.simulate import drive

FMU = Path(__file__).parent.parent / "build" / "InertiaModule.fmu"
MECHANISM = {
    "layout": "planar",
    "sun_radius": 0.05,  # m
    "satellite_radius": 0.03,
    "eccentricity": 0.02,
    "imbalance_mass": 0.8,  # kg, each
    "satellites": 3,
    "link2_inertia": 0.003,  # kg.m2
    "output_inertia": 0.4,
}

table = drive(
    FMU,
    inputs={"omega1": 120.0, "load_torque": 8.0},
    stop_time=1.0,
    step=0.0005,
    outputs=("omega2", "omega_out", "output_torque_mean"),
    parameters=MECHANISM,
    tolerance=1e-9,
)
torque = table["output_torque_mean"][1:].mean()
print(f"output shaft {table['omega_out'][-1]:.6f} rad/s after 1 s, mean torque {torque:.3f} N.m")
