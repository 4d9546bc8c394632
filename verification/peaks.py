"""Error of satellite_force_peak in long communication steps.

The reference is the maximum satellite_force in communication steps of 25 μs.
Run: python -m verification.peaks
"""

import numpy as np
from numpy.typing import NDArray

from inertia_module.model import Module

STOP_TIME, FINE_STEP, FINE_TOLERANCE = 1.0, 25e-6, 1e-9
STEPS = (1e-3, 1e-2, 0.1, 1.0)
TOLERANCES = (1e-6, 1e-3)
PLANAR = {"sun_radius": 0.05, "satellite_radius": 0.03, "eccentricity": 0.02, "imbalance_mass": 0.8}
PLANAR |= {"satellites": 3, "link2_inertia": 0.003, "output_inertia": 0.4}
LAYOUTS: tuple[dict[str, float | str], ...] = (
    {"omega1": 100.0, "load_torque": 10.0},
    {"layout": "planar", **PLANAR, "omega1": 120.0, "load_torque": 8.0},
)
VARIANTS: dict[str, dict[str, float | str]] = {
    "ideal": {},
    "losses": {"mesh_efficiency": 0.98, "link2_friction": 0.01, "output_friction": 0.01, "output_drag": 0.1},
    "elastic shaft": {
        "fidelity": "elastic",
        "shaft_stiffness": 400.0,
        "shaft_damping": 0.05,
        "output_inertia": 0.02,
    },
    "engagement angle 0.02 rad": {"housing_engagement_angle": 0.02, "output_engagement_angle": 0.02},
    "driven by a torque": {"drive": 1, "drive_torque": 20.0, "input_inertia": 1.0},
    "satellite inertia 0.001 kg·m²": {"satellite_inertia": 1e-3},
    "no housing freewheel": {"housing_freewheel": 0},
}

Array = NDArray[np.float64]
Values = dict[str, float | str]


def run(values: Values, step: float, name: str, tolerance: float) -> Array:
    """Run the module and return an output after each communication step, shape (steps,).

    Args:
        values: Parameters and inputs.
        step: Communication step, s.
        name: Name of the output.
        tolerance: Relative tolerance.
    """
    module, rows = Module().start(**values, tolerance=tolerance), []
    for _ in range(round(STOP_TIME / step)):
        module.advance(step)
        rows.append(module[name])
    return np.array(rows)


def deviation(values: Values, step: float, tolerance: float, force: Array) -> float:
    """Return the maximum relative deviation of a peak below the maximum force in its step.

    Args:
        values: Parameters and inputs.
        step: Communication step, s.
        tolerance: Relative tolerance.
        force: satellite_force in steps of FINE_STEP, N, shape (fine steps,).
    """
    max_force = force.reshape(round(STOP_TIME / step), -1).max(axis=1)
    return float((1.0 - run(values, step, "satellite_force_peak", tolerance) / max_force).max())


def main() -> None:
    """Print a table of the maximum deviations over both layouts."""
    print(f"| machine | tolerance | {' | '.join(f'{1e3 * step:g} ms' for step in STEPS)} |")
    print(f"|---|---|{'---|' * len(STEPS)}")
    for variant, changes in VARIANTS.items():
        cases = [layout | changes for layout in LAYOUTS]
        forces = [run(values, FINE_STEP, "satellite_force", FINE_TOLERANCE) for values in cases]
        for tolerance in TOLERANCES:
            pairs = list(zip(cases, forces, strict=True))
            deviations = [
                max(deviation(case, step, tolerance, force) for case, force in pairs) for step in STEPS
            ]
            cells = " | ".join(f"{max(100.0 * value, 0.0):.1f} %" for value in deviations)
            print(f"| {variant} | {tolerance:g} | {cells} |", flush=True)


if __name__ == "__main__":
    main()
