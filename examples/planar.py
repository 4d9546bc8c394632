"""Simulate a planar module with three satellites; inputs from a table, the whole run in one call."""

from inertia_module import current_fmu, simulate

MECHANISM = {
    "layout": "planar",
    "sun_radius": "50 mm",
    "satellite_radius": "30 mm",
    "eccentricity": "20 mm",
    "imbalance_mass": "0.8 kg",  # each
    "satellites": 3,
    "link2_inertia": "0.003 kg.m2",
    "output_inertia": "0.4 kg.m2",
}

table = simulate(
    current_fmu(),
    inputs={"omega1": "120 rad/s", "load_torque": "8 N.m"},
    stop_time=1.0,  # s
    step=0.0005,
    outputs=("omega2", "omega_out", "output_torque_mean"),
    parameters=MECHANISM,
    tolerance=1e-9,
)
torque = table["output_torque_mean"][1:].mean()
print(f"output shaft {table['omega_out'][-1]:.6f} rad/s after 1 s, mean torque {torque:.3f} N.m")
