"""Design a speed controller on the averaged module; verify it on the rigid and elastic FMUs.

A car of 900 kg climbs through a planar module. A motor with a lag of 0.15 s sets omega1; a sensor with a lag
of 0.05 s measures the speed. The averaged module is linearised at the operating point on the hill. A PI
controller is tuned for a phase margin, and a state feedback with integral action by LQR. Both then run on the
full FMUs. There the gain and the delay increase until the loop becomes unstable, which measures the predicted
margins.

Writes responses.csv and speed_control.png to out/speed_control/.
"""

import argparse
import math
import warnings
from pathlib import Path

import control as ct
import numpy as np
from averaged_module import averaged_system, operating_point, transient_inertia
from frequency_response import measured_response
from speed_control_margins import measured_margins, predicted_margins
from speed_control_report import figure_of, report, step_numbers

from inertia_module import Fmu, Result, control, current_fmu, driveline
from inertia_module.fmi.results import write_figure

STEP = 0.01  # s, of communication and control
MOTOR_LAG, SENSOR_LAG = 0.15, 0.05  # s
SIGNALS = ["omega_out", "measured", "omega1"]
LIMITS = (0.0, 400.0)  # rad/s
KICK = 0.5  # initial disturbance of the first state around the FMU
OMEGA1, HILL = 200.0, 100.0  # operating point, rad/s and N.m (a slope of 15 % at 17 km/h)
MECHANISM = {"layout": 1, "sun_radius": 0.1, "satellite_radius": 0.06, "eccentricity": 0.04}
MECHANISM |= {"imbalance_mass": 0.3, "satellites": 3, "link2_inertia": 0.01}
CAR = 900.0 * (0.29 / 4.0) ** 2  # kg.m2 at the output shaft: wheels of 0.29 m behind a final drive of 4
REFERENCE_STEP, HILL_STEP = 3.0, 20.0  # rad/s and N.m
HUB = 0.5  # kg.m2 of gearbox and propeller shaft
SHAFT = {"driven_inertia": CAR, "shaft_stiffness": 800.0, "shaft_damping": 2.0}
PLANTS = {
    "averaged": {**MECHANISM, "fidelity": 1, "output_inertia": HUB + CAR},
    "rigid": {**MECHANISM, "fidelity": 2, "output_inertia": HUB + CAR},
    "elastic": {**MECHANISM, "fidelity": 3, "output_inertia": HUB, **SHAFT},
}


def lag(time, source, output, name):
    """Make a first-order lag, exact for an input that is constant in each step; its state is its output."""
    decay = math.exp(-STEP / time)
    return ct.ss([[decay]], [[1.0 - decay]], [[1.0]], [[0.0]], STEP, inputs=source, outputs=output, name=name)


def sampled_plant(continuous):
    """Sample a plant (zero-order hold) and name its signals."""
    sampled = ct.sample_system(continuous, STEP, "zoh")
    return ct.ss(sampled, inputs=["omega1", "load_torque"], outputs=["omega_out"], name="module")


def linear_plant(kind, operating):
    """Linearise and sample the averaged module: inputs omega1 and load_torque, output omega_out."""
    inertia = PLANTS[kind]["output_inertia"]
    averaged = averaged_system({**MECHANISM, "output_inertia": inertia}, outputs=("omega_out",))
    module = ct.linearize(averaged, [operating], [OMEGA1, HILL])
    if kind == "elastic":
        c, d, car = SHAFT["shaft_stiffness"], SHAFT["shaft_damping"], CAR
        (a, (b1, b2)) = module.A[0, 0], module.B[0]
        # states: hub, car, twist; the shaft torque acts on the hub like load_torque
        shaft = np.array([d, -d, c])
        rows = [np.array([a, 0.0, 0.0]) + b2 * shaft, shaft / car, [1.0, -1.0, 0.0]]
        module = ct.ss(rows, [[b1, 0.0], [0.0, -1.0 / car], [0.0, 0.0]], [[0.0, 1.0, 0.0]], [[0.0, 0.0]])
    return sampled_plant(module)


def tune_pi(plant, crossover, phase_margin):
    """Return proportional and integral gain for a crossover, rad/s, and a phase margin, degrees."""
    z = np.exp(1j * crossover * STEP)
    response = complex(plant(z))
    # forward Euler integral, as in driveline.pi_speed_controller: Kp + Ki h / (z - 1)
    controller = np.exp(1j * math.radians(phase_margin - 180.0)) / response
    integral = controller.imag / (STEP / (z - 1.0)).imag
    return controller.real - integral * (STEP / (z - 1.0)).real, integral


def pi_controller(gains):
    """Make sensor and PI controller for deviations, from omega_out to command."""
    proportional, integral = gains
    controller = ct.ss(
        [[1.0]], [[-STEP * integral]], [[1.0]], [[-proportional]],
        STEP, inputs="measured", outputs="command", name="controller",
    )  # fmt: skip
    return [lag(SENSOR_LAG, "omega_out", "measured", "sensor"), controller]


def feedback_controller(gains):
    """Make sensor and state feedback for deviations, from omega_out and omega1 to command."""
    speed_gain, motor_gain, sum_gain = gains
    controller = ct.ss(
        [[1.0]], [[1.0, 0.0]], [[-sum_gain]], [[-speed_gain, -motor_gain]],
        STEP, inputs=["measured", "omega1"], outputs="command", name="controller",
    )  # fmt: skip
    return [lag(SENSOR_LAG, "omega_out", "measured", "sensor"), controller]


def surrounding(controller):
    """Connect sensor, controller and motor to one linear system from omega_out to omega1."""
    motor = lag(MOTOR_LAG, "command", "omega1", "motor")
    return ct.interconnect([*controller, motor], inputs="omega_out", outputs="omega1")


def open_loop(controller, plant):
    """Return the open loop, cut between module and sensor."""
    return -ct.series(surrounding(controller), plant["omega_out", "omega1"])


def plant_with_transient(operating):
    """Linearise and sample the rigid plant with its transient inertia, which adds a lead in omega1."""
    parameters = PLANTS["rigid"]
    averaged = averaged_system(
        parameters,
        inputs=("omega1", "load_torque", "omega1_rate"),
        outputs=("omega_out",),
        transient=transient_inertia(parameters, OMEGA1, operating),
    )
    module = ct.linearize(averaged, [operating], [OMEGA1, HILL, 0.0])
    pole, (gain, load, lead) = module.A[0, 0], module.B[0]
    # The new state omega_out - lead * omega1 replaces the rate in the inputs.
    proper = ct.ss([[pole]], [[gain + pole * lead, load]], [[1.0]], [[lead, 0.0]])
    return sampled_plant(proper)


def start_values(kind, operating):
    """Return the parameters of the FMU at the operating point, with an untwisted elastic shaft."""
    return {**PLANTS[kind], "omega_out_start": operating}


def simulate(fmu_path, kind, operating, controllers, signals):
    """Simulate the closed loop with control.input_output_response and return the rows SIGNALS.

    Args:
        fmu_path: Path of the FMU.
        kind: Kind of plant, a key of PLANTS.
        operating: Output speed at the operating point, rad/s.
        controllers: Discrete-time systems around motor and module, and their states at the operating point.
        signals: reference and load_torque, shape (2, n).
    """
    start = {"omega1": OMEGA1, "load_torque": HILL}
    with control.fmu_system(
        fmu_path, start_values(kind, operating), step=STEP, start=start, tolerance=1e-6, name="module",
        outputs=["omega_out"], state="whole" if kind == "elastic" else "motion",
    ) as plant:  # fmt: skip
        systems, states = controllers
        motor = lag(MOTOR_LAG, "command", "omega1", "motor")
        loop = ct.interconnect(
            [*systems, motor, plant.system],
            inputs=["reference", "load_torque"],
            outputs=SIGNALS,
        )
        initial = np.concatenate([*states, [OMEGA1], plant.start])
        time = STEP * np.arange(signals.shape[1])
        return ct.input_output_response(loop, time, signals, initial).outputs


def limited_pi(gains, operating):
    """Make sensor and PI controller with limits; return them with their states at the operating point."""
    sensor = lag(SENSOR_LAG, "omega_out", "measured", "sensor")
    proportional, integral = gains
    pi = driveline.pi_speed_controller(
        STEP, proportional, integral, LIMITS, measured="measured", command="command"
    )
    return [sensor, pi], [[operating], [OMEGA1]]


def limited_feedback(gains, operating):
    """Make sensor and state feedback with limits; return them with their states at the operating point."""
    speed_gain, motor_gain, sum_gain = gains

    def output(_, x, u, __):
        command = OMEGA1 - speed_gain * (u[1] - operating) - motor_gain * (u[2] - OMEGA1) - sum_gain * x[0]
        return [min(max(command, LIMITS[0]), LIMITS[1])]

    def update(_, x, u, __):
        return [x[0] + u[1] - u[0]]

    inputs = ["reference", "measured", "omega1"]
    feedback = ct.nlsys(
        update, output, inputs=inputs, outputs="command", states=1, dt=STEP, name="controller"
    )
    sensor = lag(SENSOR_LAG, "omega_out", "measured", "sensor")
    return [sensor, feedback], [[operating], [0.0]]


def design(operating):
    """Design both controllers on the linearised averaged module and return their gains."""
    plant = linear_plant("averaged", operating)
    motor = lag(MOTOR_LAG, "command", "omega1", "motor")
    sensor = lag(SENSOR_LAG, "omega_out", "measured", "sensor")
    pi_gains = tune_pi(sensor * plant["omega_out", "omega1"] * motor, crossover=2.0, phase_margin=60.0)
    both = ct.interconnect([plant, motor], inputs=["command", "load_torque"], outputs="omega_out")
    state_weight = np.diag([1.0, 0.0, (2.0 * STEP) ** 2])  # omega_out, omega1, sum of the error
    states = ct.ss(both.A, both.B[:, :1], np.eye(2), np.zeros((2, 1)), STEP)
    gains, _, _ = ct.dlqr(states, state_weight, [[0.02]], integral_action=np.array([[1.0, 0.0]]))
    return pi_gains, tuple(gains[0])


def controllers_of(operating):
    """Return both controllers for deviations with their gains, by name."""
    pi_gains, feedback_gains = design(operating)
    return {
        "PI": (pi_controller(pi_gains), pi_gains),
        "state feedback": (feedback_controller(feedback_gains), feedback_gains),
    }


def margins(fmu_path, operating, controllers):
    """Return rows (controller, plant, predicted margins, measured margins)."""
    rows = []
    point = {"omega1": OMEGA1, "omega_out": operating}
    for name, (controller, _) in controllers.items():
        around = surrounding(controller)
        kick = [KICK] + [0.0] * (around.nstates - 1)
        for kind in PLANTS:
            predicted = predicted_margins(open_loop(controller, linear_plant(kind, operating)))
            start = {"omega1": OMEGA1, "load_torque": HILL}
            with Fmu(fmu_path, start_values(kind, operating), start, tolerance=1e-6) as fmu:
                measured = measured_margins(fmu, around, point, kick, predicted, LIMITS)
            rows.append((name, kind, predicted, measured))
    return rows


def responses(fmu_path, operating, gains):
    """Simulate a reference step and a later load step with both controllers on all plants."""
    time = STEP * np.arange(round(14.0 / STEP))
    reference = np.where(time < 1.0, operating, operating + REFERENCE_STEP)
    hill = np.where(time < 7.0, HILL, HILL + HILL_STEP)
    signals = np.stack([reference, hill])
    columns = {"time": time, "reference": reference, "load_torque": hill}
    for name, limited in (("PI", limited_pi), ("state feedback", limited_feedback)):
        for kind in PLANTS:
            run = simulate(fmu_path, kind, operating, limited(gains[name], operating), signals)
            for signal, values in zip(SIGNALS, run, strict=True):
                columns[f"{signal} {name} {kind}"] = values
    units = {name: "N.m" if name == "load_torque" else "rad/s" for name in columns if name != "time"}
    return Result.from_columns(columns, units)


def measured_loop(fmu_path, operating, controller, frequencies):
    """Return the open loop with the measured response of the rigid FMU."""
    measured = measured_response(
        fmu_path, start_values("rigid", operating), omega1=OMEGA1, load_torque=HILL, excited="omega1",
        amplitude=0.005 * OMEGA1, frequencies=frequencies, outputs=["omega_out"], step=1e-3, settling=8.0,
        record=10.0,
    )  # fmt: skip
    s = 2j * math.pi * frequencies
    # response of the zero-order hold of omega1
    hold = (1.0 - np.exp(-s * STEP)) / (s * STEP)
    around = surrounding(controller)(np.exp(s * STEP))
    return -around * hold * measured.response[0], measured.pulse_rate


def compare_loops(fmu_path, operating, controller):
    """Print deviations of the measured loop; return curves of the Bode plot and the pulse rate, Hz."""
    fine, coarse = np.geomspace(0.03, 10.0, 300), np.array([0.1, 0.3, 1.0, 2.0, 4.0])
    loop, pulse_rate = measured_loop(fmu_path, operating, controller, coarse)
    curves = [("measured on the rigid FMU", (coarse, loop), "o")]
    for kind, style in (("rigid", "-"), ("elastic", "--")):
        predicted = open_loop(controller, linear_plant(kind, operating))
        response = predicted(np.exp(2j * math.pi * fine * STEP))
        curves.append((f"averaged module, {kind} output", (fine, response), style))
    predicted = open_loop(controller, linear_plant("rigid", operating))
    print(f"\nrigid FMU against averaged module, linearised (pulses at {pulse_rate:.1f} Hz):")
    for frequency, value in zip(coarse, loop / predicted(np.exp(2j * math.pi * coarse * STEP)), strict=True):
        phase = np.degrees(np.angle(value))
        print(f"  {frequency:4.1f} Hz: gain {abs(value) - 1.0:+.2%}, phase {phase:+.2f} degrees")
    return curves, pulse_rate


def main(fmu_path, folder):
    """Run the study and write its table and figure into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    averaged = averaged_system(PLANTS["rigid"], outputs=("omega_out",))
    operating = operating_point(averaged, OMEGA1, HILL, guess=60.0)
    linear = ct.linearize(averaged, [operating], [OMEGA1, HILL])
    controllers = controllers_of(operating)
    print(f"operating point: omega_out {operating:.3f} rad/s, pole {linear.A[0, 0]:.4f} /s,")
    print(f"  gain from omega1 {linear.B[0, 0]:.4f} /s, from the load {linear.B[0, 1]:.4f} /(kg.m2)")
    for name, (_, gains) in controllers.items():
        print(f"gains of {name}: {', '.join(f'{gain:.4g}' for gain in gains)}")
    report(margins(fmu_path, operating, controllers))
    exact = plant_with_transient(operating)
    for name, (controller, _) in controllers.items():
        predicted = predicted_margins(open_loop(controller, exact))
        print(
            f"{name} with transient inertia: gain {predicted.gain:.2f}, phase {predicted.phase:.1f} degrees"
        )
    table = responses(fmu_path, operating, {name: gains for name, (_, gains) in controllers.items()})
    step_numbers(table, PLANTS)
    curves, pulse_rate = compare_loops(fmu_path, operating, controllers["PI"][0])
    table.to_csv(folder / "responses.csv")
    write_figure(folder / "speed_control.png", figure_of(table, PLANTS, curves, pulse_rate))
    print(f"\nresponses.csv and speed_control.png are in {folder}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Speed control, designed on the averaged module.")
    parser.add_argument("--fmu", type=Path, default=current_fmu())
    parser.add_argument("-o", "--output", type=Path, default=Path("out/speed_control"))
    arguments = parser.parse_args()
    warnings.filterwarnings("ignore", message="Unused (in|out)put", module="control")
    main(arguments.fmu, arguments.output)
