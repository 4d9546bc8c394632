"""R1: a bevel inertia module at 100 rad/s brings its output shaft up to speed against 10 N.m."""

import numpy as np

from inertia_module import Fmu, Result

STEP = 0.0005  # s
STEPS = 2000
NAMES = ("omega2", "omega_out", "output_torque", "imbalance_acceleration")

rows = []
with Fmu(inputs={"omega1": "100 rad/s", "load_torque": "10 N.m"}, tolerance=1e-9) as fmu:
    for n in range(STEPS + 1):
        rows.append((n * STEP, *fmu.read(NAMES)))
        if n < STEPS:
            fmu.advance(STEP)
    residual = fmu["energy_residual"]

columns = dict(zip(("time", *NAMES), np.array(rows).T, strict=True))
table = Result.from_columns(columns, {name: fmu.units[name] for name in NAMES})
print(f"output shaft {table['omega_out'][-1]:.6f} rad/s after 1 s, energy residual {residual:.1e} J")
print(f"greatest acceleration of the imbalance {table['imbalance_acceleration'].max():.0f} m/s2")
