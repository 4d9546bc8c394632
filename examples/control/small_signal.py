"""Compare the linearised averaged module with the rigid FMU for small signals.

For each mechanism and operating point, a small sine of up to a tenth of the pulse frequency is added to
omega1 and to the load torque of the rigid FMU. The response is compared with the averaged module, with and
without its transient inertia. Prints the maximum deviations of gain and phase of the output speed and the
mean torques.
"""

import argparse
from pathlib import Path

import numpy as np
from averaged_module import TransientInertia, averaged_response, averaged_system, transient_inertia
from frequency_response import measured_response

from inertia_module import current_fmu

BEVEL = {"output_inertia": 0.5}
PLANAR = {"layout": 1, "sun_radius": 0.1, "satellite_radius": 0.06, "eccentricity": 0.04}
PLANAR |= {"imbalance_mass": 0.3, "satellites": 3, "link2_inertia": 0.01}
# title, parameters, omega1 and omega_out in rad/s, approximate pulse rate in Hz
CASES = (
    ("bevel R1, ratio 0.27", BEVEL, 100.0, 26.8, 29.6),
    ("bevel R1, ratio 0.27, 10 J3", BEVEL | {"output_inertia": 5.0}, 100.0, 26.8, 29.0),
    ("bevel R1, ratio 0.60", BEVEL, 100.0, 60.0, 11.0),
    ("planar car, ratio 0.05", PLANAR | {"output_inertia": 4.78}, 200.0, 10.0, 50.0),
    ("planar car, ratio 0.30", PLANAR | {"output_inertia": 4.78}, 200.0, 60.0, 44.0),
    ("planar car, ratio 0.50", PLANAR | {"output_inertia": 4.78}, 200.0, 100.0, 37.0),
    ("planar, light output, ratio 0.30", PLANAR | {"output_inertia": 0.5}, 200.0, 60.0, 44.0),
    ("planar, lighter output, ratio 0.30", PLANAR | {"output_inertia": 0.05}, 200.0, 60.0, 44.0),
)
OUTPUTS = ("omega_out", "output_torque_mean", "input_torque_mean")
# frequencies over the pulse rate
PULSE_RATE_SHARES = np.array([0.01, 0.03, 0.1])
# amplitude of an input over its mean
AMPLITUDES = {"omega1": 0.005, "load_torque": 0.1}
STEP = 1e-3  # s


def compare(fmu_path, case):
    """Print the deviations of one case."""
    title, parameters, omega1, omega_out, rate = case
    system = averaged_system(parameters, outputs=("output_torque",))
    load = float(system.output(0.0, [omega_out], [omega1, 0.0])[0])
    transient = transient_inertia(parameters, omega1, omega_out)
    print(
        f"{title}: load {load:.3g} N.m, transient inertia {transient.input:.4f}, {transient.output:.4f} kg.m2"
    )
    for excited, share in AMPLITUDES.items():
        point = {
            "omega1": omega1,
            "load_torque": load,
            "excited": excited,
            "frequencies": PULSE_RATE_SHARES * rate,
        }
        measured = measured_response(
            fmu_path, {**parameters, "omega_out_start": omega_out}, **point, outputs=OUTPUTS,
            amplitude=share * {"omega1": omega1, "load_torque": load}[excited],
            step=STEP, settling=8.0, record=20.0,
        )  # fmt: skip
        for model, inertia in (
            ("plain", TransientInertia(0.0, 0.0)),
            ("with transient", transient),
        ):
            linear = averaged_response(
                parameters, **point, outputs=OUTPUTS, guess=omega_out, transient=inertia
            )
            gain, phase = measured.deviation_from(linear)
            deviations = "   ".join(
                f"{100.0 * np.abs(gain[n]).max():5.1f} % {np.abs(phase[n]).max():5.1f} deg"
                for n in range(len(OUTPUTS))
            )
            print(f"  {excited:12s} {model:15s} {deviations}")
    print(
        f"  pulses at {measured.pulse_rate:.1f} Hz, omega_out {measured.mean[0]:.2f} of {omega_out:g} rad/s"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Small-signal response of averaged module and rigid FMU.")
    parser.add_argument("--fmu", type=Path, default=current_fmu())
    arguments = parser.parse_args()
    print("largest deviation at 0.01, 0.03 and 0.1 of the pulse rate: " + ", ".join(OUTPUTS))
    for case in CASES:
        compare(arguments.fmu, case)
