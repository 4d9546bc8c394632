"""What campaigns of random motions have found: parameters, and segments of the inputs."""

BEVEL = {"satellites": 4, "z6": 80, "b": 0.8, "wheel_radius": 0.3, "shaft_angle": 1.0}
JOINED = {"housing_freewheel": 0, "output_freewheel": 0}
# of each segment: duration, omega1, load, slope, drive
FOUND = {
    "shaft swung by a load": (
        {"fidelity": 3, "output_inertia": 60.0, "driven_inertia": 1e-3, "tolerance": 5e-5},
        [(2.0, 0.0, 1.0)],
    ),
    "shaft swung by a load taken off": (
        {"fidelity": 3, "output_inertia": 8e-4, "shaft_stiffness": 6e3},
        [(2.0, 0.0, 0.2), (2.0, 0.0, 0.0)],
    ),
    "undamped shaft swung by a load": (
        {"fidelity": 3, "output_inertia": 4e-4, "shaft_damping": 0.0, "tolerance": 4e-9},
        [(0.012, 0.0, -1.0)],
    ),
    "shaft without pulses": (
        {"fidelity": 3, "imbalance_mass": 0.0, "shaft_stiffness": 8e5},
        [(0.02, -0.2, 0.05)],
    ),
    "jump of a swinging shaft": (
        {"fidelity": 3, **BEVEL, **JOINED, "shaft_stiffness": 14695000.0, "tolerance": 2e-9},
        [(0.0069986, 0.0, 0.0, -4.0), (0.011583, 0.10526, 0.00010081, 7.7782)],
    ),
    "prescribed ramp from rest": (
        {
            **{"fidelity": 0, "kinematic_ratio": -1.0, "tolerance": 3e-10},
            **{"layout": 1, "sun_radius": 0.09, "satellite_radius": 0.14, "eccentricity": 0.1},
        },
        [(0.3, 0.0, 0.0, -7.0)],
    ),
    "prescribed motion with losses in both meshes": (
        {"fidelity": 0, "mesh_efficiency": 0.5, "satellite_mesh_efficiency": 0.5},
        [(0.06, 50.0, 0.0), (0.1, 50.0, 0.0, -1000.0)],
    ),
    "averaged at a small tolerance": (
        {
            **{"fidelity": 1, "drive": 1, "input_inertia": 6e-4, "tolerance": 1e-10},
            **{"output_inertia": 20.0, "z17": 20, "b": 0.01, "wheel_radius": 0.05},
        },
        [(0.6, 0.0, -0.02, 0.0, 0.02)],
    ),
    "averaged light shaft behind a speed that falls": (
        {
            **{"fidelity": 1, "imbalance_mass": 74.145, "output_inertia": 0.00019208, "z2": 52, "z6": 76},
            **{"a": 0.0, "tolerance": 2.2619e-10, "omega_out_start": 0.56126, "omega2_start": 0.56126},
        },
        [(2.3563, 1.1293, 0.0010515, -0.21168)],
    ),
    "shaft that lets go for a short while": (
        {
            **{
                "fidelity": 3,
                "satellites": 5,
                "imbalance_mass": 60.0,
                "z2": 55,
                "z16": 50,
                "z6": 24,
                "b": 0.0,
            },
            **{"wheel_radius": 0.3, "shaft_angle": 0.49922, "tolerance": 2.9007e-5, "output_inertia": 0.008},
            **{"driven_inertia": 0.15285, "driven_friction": 0.043433},
        },
        [(0.27721, -8.4662, 0.0), (0.28511, -8.4662, 0.0), (0.38831, -8.4662, 52.954, 9.3276)],
    ),
    "heavy driven mass": (
        {
            **{"fidelity": 3, "imbalance_mass": 0.02, "output_inertia": 1e-3, "shaft_angle": 2.0},
            **{"driven_inertia": 40.0, "shaft_stiffness": 800.0},
        },
        [(0.2, 16.0, 0.0)],
    ),
    "freewheel that lets go between two looks of the reference": (
        {
            **{"layout": 1, "satellites": 4, "imbalance_mass": 0.038069, "drive_inertia": 3.3967e-5},
            **{"link2_inertia": 0.001287, "output_inertia": 71.056, "sun_radius": 0.011307, "drive": 1},
            **{"satellite_radius": 0.062511, "eccentricity": 0.027151, "input_inertia": 0.00086077},
            **{"tolerance": 2.2333e-10, "housing_freewheel": 0},
        },
        [
            (0.87259, 24.382, 0.0032364, 0.0, -0.34774),
            (0.045, 12.763, 0.0, 0.0, 0.14585),
            (0.82627, 12.763, -0.092459),
            (0.77985, 12.763, 0.069973),
        ],
    ),
    "rounding alone, in fixed steps": ({"imbalance_mass": 0.0, "method": 1}, [(8e-5, 0.0, 0.0, -3e5)]),
}
