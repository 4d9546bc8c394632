"""Write examples/fit_rig.csv, a synthetic measurement of a test rig.

The speeds are computed by the independent reference for a module whose imbalance mass and link 2 are
heavier than in the scene. Normal noise is added.
Run: python -m benchmarks.fit_rig_data
"""

from pathlib import Path

import numpy as np

from inertia_module.fmi.results import write_columns
from verification.reference.cases import OMEGA2, OMEGA3
from verification.reference.motion import Reference

TRUE = {"imbalance_mass": 1.07, "link2_inertia": 0.0062, "output_inertia": 0.5}
OMEGA1, LOAD_TORQUE = 100.0, 10.0
# sampling times, s: every 2 ms, the first 0.7 ms after the start
TIMES = 0.7e-3 + 2e-3 * np.arange(249)
# standard deviations of the encoders on link 2 and on the output shaft, rad/s
NOISE = {"omega2": 0.5, "omega_out": 0.1}
SEED = 17
FILE = Path(__file__).parents[1] / "examples" / "fit_rig.csv"


def true_speeds(**parameters):
    """Return the speeds of link 2 and of the output shaft at TIMES, rad/s, by name.

    Args:
        parameters: Parameters that override TRUE.
    """
    motion, speeds = Reference(TRUE | parameters, OMEGA1, LOAD_TORQUE), []
    for time in TIMES:
        motion.advance(time)
        speeds.append(motion.state[[OMEGA2, OMEGA3]])
    return dict(zip(NOISE, np.array(speeds).T, strict=True))


def measured(true, seed):
    """Return the columns of a measurement with noise: time in ms, speeds in rpm.

    Args:
        true: Exact speeds, rad/s, by name.
        seed: Seed of the noise.
    """
    noise = np.random.default_rng(seed)
    columns = {name: values + noise.normal(0.0, NOISE[name], values.size) for name, values in true.items()}
    rpm = {name: np.round(values * 30.0 / np.pi, 2) for name, values in columns.items()}
    return {
        "time [ms]": np.round(1e3 * TIMES, 3),
        **{f"{name} [rpm]": values for name, values in rpm.items()},
    }


if __name__ == "__main__":
    print(write_columns(FILE, measured(true_speeds(), SEED)))
