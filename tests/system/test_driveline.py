"""Loads, controllers and the closed loop, compared with exact solutions, balances and the module."""

import math
from collections import Counter

import control
import numpy as np
import pytest

from inertia_module import driveline
from inertia_module.common.examples import example
from inertia_module.driveline import cycles
from inertia_module.driveline.connection import law_of
from inertia_module.driveline.cycles import ELEMENTARY_URBAN_CYCLE as CYCLE
from inertia_module.model import Module, Plant
from inertia_module.scene import load_scene

KMH = 1.0 / 3.6


class Shaft(Plant):
    """Shaft that a torque accelerates, exact for a torque that is constant in each step."""

    def __init__(self, inertia, speed=0.0, drive=0.0, prevents_reverse=False):
        self.inertia, self.speed, self.drive = inertia, speed, drive
        self.prevents_reverse = prevents_reverse
        self.load_torque = 0.0

    def set(self, **values):
        self.load_torque = values.get("load_torque", self.load_torque)

    def advance(self, step):
        self.speed += step * (self.drive - self.load_torque) / self.inertia
        if self.prevents_reverse:
            self.speed = max(self.speed, 0.0)

    def read(self, names):
        return tuple({"omega_out": self.speed}[name] for name in names)


def spin(plant, load, stop_time, *others):
    surroundings = driveline.connect([load.system, *others])
    return driveline.ClosedLoop(plant, surroundings, ["omega_out"]).run(stop_time)


def no_brake(step):
    return driveline.source("brake_force", 0.0, step)


# --- shaft load ---


def test_viscous_friction_decelerates_a_coasting_shaft_exponentially(compiled):
    """The error is of first order in the step."""
    driveline.shaft_load(0.1, 0.5, viscous_friction=12.0).check_step(0.8)  # A lighter shaft is rejected below
    friction, hub, driven = 0.4, 0.1, 0.9
    errors = []
    for step in (0.02, 0.01):
        load = driveline.shaft_load(step, driven, friction)
        inertia = hub + load.rigid_inertia
        plant = Module(compiled).start(omega1=0.0, omega_out_start=50.0, output_inertia=inertia)
        table = spin(plant, load, 2.0)
        exact = 50.0 * np.exp(-friction / inertia * table.time)
        errors.append(np.abs(table["omega_out"] - exact).max())
    assert errors[0] < 0.1
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.05)


def test_elastic_load_oscillates_exactly_at_constant_shaft_speed():
    inertia, stiffness = 0.5, 200.0
    natural = math.sqrt(stiffness / inertia)
    load = driveline.shaft_load(0.03, inertia, coupling=driveline.Coupling(stiffness, 0.0))
    assert load.rigid_inertia == 0.0
    table = spin(Shaft(1e30, speed=10.0), load, 3.0)
    np.testing.assert_allclose(
        table["load_speed"], 10.0 * (1.0 - np.cos(natural * table.time)), rtol=0, atol=1e-9
    )
    np.testing.assert_allclose(
        table["load_torque"], 10.0 * stiffness / natural * np.sin(natural * table.time), rtol=0, atol=1e-8
    )


@pytest.mark.parametrize(
    ("stiffness", "damping", "stable"),
    [(500.0, 0.0, True), (500.0, 5.0, True), (500.0, 2000.0, False), (60000.0, 0.0, False)],
)
def test_step_is_rejected_exactly_if_the_oscillation_grows(stiffness, damping, stable):
    load = driveline.shaft_load(0.005, 0.5, coupling=driveline.Coupling(stiffness, damping))
    table = spin(Shaft(0.5, speed=1.0), load, 1.0)
    assert bool(np.abs(table["omega_out"]).max() < 3.0) == stable
    if stable:
        load.check_step(0.5)
        if damping == 0.0:  # The amplitude stays constant over many periods
            table = spin(Shaft(0.5, speed=10.0), load, 20.0)
            difference = np.abs(table["omega_out"] - table["load_speed"])
            assert difference[-400:].max() == pytest.approx(difference[:400].max(), rel=0.01)
    else:
        with pytest.raises(ValueError, match=r"the step must be shorter with .* \(got 0.005 s\)\. A softer "):
            load.check_step(0.5)


def test_elastic_load_with_friction_settles_at_its_torque():
    load = driveline.shaft_load(0.01, 0.2, 0.3, torque=2.0, coupling=driveline.Coupling(50.0, 2.0))
    table = spin(Shaft(1e30, speed=10.0), load, 20.0)
    assert table["load_speed"][-1] == pytest.approx(10.0, rel=1e-9)
    assert table["load_torque"][-1] == pytest.approx(0.3 * 10.0 + 2.0, rel=1e-9)


def test_torque_source_follows_its_table():
    load = driveline.Load(driveline.source("load_torque", driveline.Table([0.0, 1.0], [0.0, 8.0]), 0.1))
    table = spin(Shaft(1.0), load, 2.0)
    np.testing.assert_allclose(table["load_torque"], np.minimum(8.0 * table.time, 8.0))


# --- vehicle ---


def vehicle(step, **values):
    defaults = {"mass": 1000.0, "wheel_radius": 0.3, "final_drive": 3.0}
    return driveline.vehicle_load(step, **{**defaults, **values})


@pytest.mark.parametrize("prevents_reverse", [True, False])
@pytest.mark.parametrize("brake", [0.0, 3000.0])
def test_vehicle_stops_and_stays_at_rest(prevents_reverse, brake):
    step, ratio = 0.01, 0.1
    load = vehicle(step, rolling_resistance=0.02, prevents_reverse=prevents_reverse)
    plant = Shaft(load.rigid_inertia, speed=5.0 / ratio, prevents_reverse=prevents_reverse)
    table = spin(plant, load, 30.0, driveline.source("brake_force", brake, step))
    deceleration = 0.02 * 9.80665 + brake / 1000.0
    exact = np.maximum(5.0 - deceleration * table.time, 0.0)
    np.testing.assert_allclose(table["vehicle_speed"], exact, atol=deceleration * step + 1e-9)
    assert table["vehicle_speed"].min() >= -1e-12
    assert table["distance"][-1] == pytest.approx(5.0**2 / (2.0 * deceleration), rel=0.02)


def test_elastic_vehicle_stops_and_stays_at_rest():
    step = 0.01
    load = vehicle(step, rolling_resistance=0.02, coupling=driveline.Coupling(2000.0, 10.0))
    table = spin(Shaft(0.2, speed=0.0, drive=0.0), load, 5.0, no_brake(step))
    assert np.abs(table["vehicle_speed"]).max() == 0.0
    # Accelerate against the friction, then remove the torque.
    plant = Shaft(0.2, drive=60.0)
    loop = driveline.ClosedLoop(plant, driveline.connect([load.system, no_brake(step)]), ["omega_out"])

    def release(fraction):
        if fraction >= 500 / 4000:
            plant.drive = 0.0

    speeds = loop.run(40.0, release)["vehicle_speed"]
    expected = (60.0 / 0.1 - 0.02 * 1000.0 * 9.80665) / (1000.0 + 0.2 / 0.1**2) * 5.0
    assert speeds[500] == pytest.approx(expected, rel=0.02)
    assert abs(speeds[-1]) < 1e-9
    assert min(speeds) > -1e-3


@pytest.mark.parametrize("slope, brake", [(0.1, 2000.0), (-0.1, 2000.0), (-0.1, 0.0)])
def test_brake_holds_the_vehicle_on_a_hill(compiled, slope, brake):
    """Without the brake the vehicle rolls down. The load torque on a shaft at rest is not negative."""
    load = vehicle(0.01, slope=slope)
    plant = Module(compiled).start(output_inertia=load.rigid_inertia, omega1=0.0)
    table = spin(plant, load, 2.0, driveline.source("brake_force", brake, 0.01))
    angle = math.atan(0.1)
    pull = 0.0 if brake else 9.80665 * (math.sin(angle) - 0.01 * math.cos(angle))
    assert table["vehicle_speed"][-1] == pytest.approx(2.0 * pull, rel=1e-6)
    if brake:
        assert np.all(table["omega_out"] == 0.0)
        assert table["load_torque"].min() >= 0.0


@pytest.mark.parametrize("start", [0.0, 50.0])
def test_distance_is_the_integral_of_the_speed_by_the_trapezoidal_rule(start):
    load = vehicle(0.1, start_speed=start)
    table = spin(Shaft(load.rigid_inertia, speed=start, drive=60.0), load, 5.0, no_brake(0.1))
    speed = table["vehicle_speed"]
    assert speed[-1] > speed[0] + 1.0
    exact = np.append(0.0, np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(table.time)))
    np.testing.assert_allclose(table["distance"], exact, atol=1e-12)


def test_slope_over_distance_and_terminal_speed():
    """A hill after 50 m accelerates the vehicle until drag and rolling resistance balance the slope."""
    step = 0.05
    slope = driveline.Table([0.0, 50.0, 51.0], [0.0, 0.0, -0.1])
    load = vehicle(step, slope=slope, drag_area=2.0, rolling_resistance=0.01)
    table = spin(Shaft(load.rigid_inertia, speed=100.0, prevents_reverse=True), load, 300.0, no_brake(step))
    angle = math.atan(0.1)
    pull = 1000.0 * 9.80665 * (math.sin(angle) - 0.01 * math.cos(angle))
    assert table["vehicle_speed"][-1] == pytest.approx(math.sqrt(pull / (0.5 * 1.2 * 2.0)), rel=1e-6)
    assert table["slope_torque"][0] == 0.0


@pytest.mark.parametrize("speed", [30.0, -30.0])
def test_drag_opposes_the_motion_in_both_directions(speed):
    load = vehicle(0.05, drag_area=2.0, prevents_reverse=False)
    outputs = load.system.output(0.0, [0.0], [speed, 0.0])
    torque = outputs[load.system.output_labels.index("drag_torque")]
    drag = 0.5 * 1.2 * 2.0 * (0.1 * speed) ** 2
    assert torque == pytest.approx(math.copysign(0.1 * drag, speed), rel=1e-12)


@pytest.mark.parametrize("slope", [0.1, -0.1])
@pytest.mark.parametrize("brake, share", [(2000.0, 0.0), (0.0, 1.0)])
def test_friction_of_a_vehicle_at_rest_balances_the_slope_up_to_its_capacity(slope, brake, share):
    """A vehicle that can reverse rests with the brake and rolls down without it."""
    load = vehicle(0.05, slope=slope, prevents_reverse=False)
    outputs = load.system.output(0.0, [0.0], [0.0, brake])
    angle = math.atan(slope)
    pull = 1000.0 * 9.80665 * (math.sin(angle) - math.copysign(0.01 * math.cos(angle), slope))
    assert outputs[0] == pytest.approx(0.1 * share * pull, rel=1e-12, abs=1e-9)


# --- controllers ---


def pi(**values):
    defaults = {
        "step": 0.01,
        "proportional_gain": 2.0,
        "integral_gain": 4.0,
        "limits": (0.0, 5.0),
        "command": "torque",
    }
    return driveline.pi_speed_controller(**{**defaults, **values})


def follow(controller, reference, stop_time=20.0):
    """Return speed and command of an inertia of 1 kg.m2 with friction that the controller drives."""
    step = controller.dt
    plant = control.sample_system(control.ss([[-0.5]], [[1.0]], [[1.0]], [[0.0]]), step)
    speed, integral, speeds, commands = 0.0, np.zeros(1), [], []
    for n in range(round(stop_time / step)):
        u = np.array([reference(n * step), speed])
        command = float(controller.output(n * step, integral, u)[0])
        integral = controller.dynamics(n * step, integral, u)
        speed = float(plant.A[0, 0] * speed + plant.B[0, 0] * command)
        speeds.append(speed)
        commands.append(command)
    return np.array(speeds), np.array(commands)


def test_pi_controller_without_limits_is_linear():
    """The command is the gain times the error plus the integral gain times the sum of errors."""
    controller = pi(limits=(-1e9, 1e9), feedforward=0.5)
    integral = np.zeros(1)
    errors = np.sin(np.arange(50))
    for n, error in enumerate(errors):
        u = np.array([1.0, 1.0 - error])
        expected = 0.5 + 2.0 * error + 4.0 * 0.01 * errors[:n].sum()
        assert controller.output(0.0, integral, u)[0] == pytest.approx(expected, abs=1e-12)
        integral = controller.dynamics(0.0, integral, u)


def test_anti_windup_ends_saturation_without_delay():
    """The reference is out of range for 20 s, then within range."""
    speeds, commands = follow(pi(), lambda time: 50.0 if time < 20.0 else 4.0, 40.0)
    assert speeds[1999] == pytest.approx(10.0, rel=1e-3)
    assert commands[2000] == 0.0
    below = np.flatnonzero(speeds[2000:] < 4.0)[0] * 0.01
    assert below == pytest.approx(2.0 * math.log(10.0 / 4.0), abs=0.05)  # The shaft coasts
    assert speeds[2000:].min() > 3.0
    assert speeds[-1] == pytest.approx(4.0, rel=1e-6)
    assert 0.0 <= commands.min() < commands.max() <= 5.0


def test_integral_of_a_controller_faster_than_its_step_stays_at_the_limit():
    """With a small proportional gain the integral does not oscillate in saturation."""
    controller, integral = pi(proportional_gain=1e-3, integral_gain=10.0), np.zeros(1)
    for _ in range(200):
        integral = controller.dynamics(0.0, integral, np.array([100.0, 0.0]))
    assert 5.0 < integral[0] <= 5.0 + 0.01 * 10.0 * 100.0


def test_driver_brakes_only_above_the_margin():
    brake = driveline.driver_brake(0.01, gain=1000.0, maximum=500.0, margin=0.2)
    forces = [brake.output(0.0, [], [10.0, speed])[0] for speed in (9.0, 10.2, 10.5, 12.0)]
    np.testing.assert_allclose(forces, [0.0, 0.0, 300.0, 500.0], atol=1e-9)


# --- the loop ---


def run_to(stop_time):
    load = driveline.source("load_torque", 1.0, 0.1)
    return driveline.ClosedLoop(Shaft(1.0), driveline.connect([load])).run(stop_time)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: pi(proportional_gain=-1.0), r"proportional_gain must be finite and at least 0 \(got -1\)$"),
        (lambda: pi(integral_gain=math.nan), r"integral_gain must be finite and at least 0 \(got nan\)$"),
        (lambda: pi(limits=(5.0, 5.0)), r"limits must be a minimum below a maximum \(got 5 and 5\)$"),
        (
            lambda: driveline.shaft_load(0.1, 0.5, viscous_friction=12.0).check_step(0.1),
            r"the step must be at most inertia / friction = 0.05 s with viscous_friction = 12 .*got 0.1 s\)$",
        ),
        (
            lambda: driveline.connect(
                [driveline.source("load_torque", torque, 0.1) for torque in (1.0, 2.0)]
            ),
            r"load_torque must be the output of one system only \(got .* and .*\)$",
        ),
        (
            lambda: driveline.ClosedLoop(Shaft(1.0), driveline.connect([no_brake(0.1)])),
            "no output drives an input of the FMU .omega1, load_torque, drive_torque.; outputs: brake_force",
        ),
        (
            lambda: run_to(0.25),
            r"stop_time must be a positive multiple of the communication step 0.1 s \(got 0.25 s\)$",
        ),
        (
            lambda: run_to(-1.0),
            r"stop_time must be a positive multiple of the communication step 0.1 s \(got -1 s\)$",
        ),
        (
            lambda: driveline.Table([0.0, 1.0], [1.0]),
            r"^a table must have one value for each point, and at least one \(got 2 points and 1 values\)$",
        ),
        (
            lambda: driveline.Table([1.0, 0.0], [1.0, 2.0]),
            r"^points of a table must be increasing, or equal for a step \(got 0 after 1\)$",
        ),
        (lambda: driveline.Table([0.0], [math.nan]), r"^numbers of a table must be finite \(got nan\)$"),
    ],
)
def test_invalid_values_are_errors(make, sentence):
    with pytest.raises(ValueError, match=sentence):
        make()


STEP = 0.01
ROAD = driveline.Table([0.0, 2.0, 5.0], [0.02, 0.1, -0.1])
COUPLING = driveline.Coupling(2000.0, 10.0)
ENGINE_MAP = driveline.EngineMap((0.0, 100.0, 300.0), (20.0, 36.0, 32.0), (6.0, 8.0, 14.0))
# Each system of the package, and the range of each of its inputs
SYSTEMS = {
    "source": (lambda: driveline.source("load_torque", driveline.Table([0.0, 0.7], [1.0, 8.0]), STEP), ()),
    "rigid shaft": (lambda: driveline.shaft_load(STEP, 0.5, 0.3, torque=2.0).system, [(-20.0, 90.0)]),
    "elastic shaft": (
        lambda: driveline.shaft_load(STEP, 0.5, 0.3, torque=2.0, coupling=COUPLING).system,
        [(-20.0, 90.0)],
    ),
    "vehicle": (
        lambda: vehicle(STEP, slope=ROAD, drag_area=0.6, start_speed=3.0).system,
        [(0.0, 90.0), (-50.0, 4000.0)],
    ),
    "vehicle in both directions": (
        lambda: vehicle(STEP, slope=ROAD, drag_area=0.6, prevents_reverse=False).system,
        [(-20.0, 90.0), (-50.0, 4000.0)],
    ),
    "elastic vehicle": (
        lambda: vehicle(STEP, slope=ROAD, drag_area=0.6, coupling=COUPLING).system,
        [(-20.0, 90.0), (-50.0, 4000.0)],
    ),
    "PI controller": (lambda: pi(feedforward=0.3), [(0.0, 90.0), (0.0, 90.0)]),
    "brake": (lambda: driveline.driver_brake(STEP, 1000.0, 500.0, margin=0.2), [(0.0, 20.0), (0.0, 20.0)]),
    "engine": (
        lambda: driveline.governed_engine(
            STEP, ENGINE_MAP, idle=80.0, top_speed=250.0, proportional_gain=3.0, integral_gain=12.0
        ),
        [(0.0, 1.0), (-10.0, 300.0)],
    ),
}


def assert_same_bits(system, ranges, steps=200):
    """Compare the evaluation in a run with the simulation of the system by python-control.

    Args:
        system: The system.
        ranges: Minimum and maximum of each input.
        steps: Number of steps.
    """
    random, time = np.random.default_rng(3), STEP * np.arange(steps)
    inputs = np.array([random.uniform(*limits, steps) for limits in ranges]).reshape(len(ranges), steps)
    expected = control.input_output_response(system, time, inputs, np.zeros(system.nstates), squeeze=False)
    law, state = law_of(system), [0.0] * system.nstates
    for n in range(steps):
        if system.nstates:
            np.testing.assert_array_equal(state, expected.states[:, n])
        outputs, state = law(time[n], state, inputs[:, n].tolist())
        np.testing.assert_array_equal(outputs, expected.outputs[:, n])


@pytest.mark.parametrize("name", SYSTEMS)
def test_each_law_has_the_same_bits_as_the_system_of_python_control(name):
    make, ranges = SYSTEMS[name]
    system = make()
    assert isinstance(system, control.NonlinearIOSystem)
    assert_same_bits(system, ranges)
    connected = driveline.connect([system])
    assert isinstance(connected, control.InterconnectedSystem)
    assert_same_bits(connected, ranges)


def driver(measured="vehicle_speed"):
    """Return reference, controller and brake of a driver."""
    return [
        driveline.source("reference", driveline.Table([0.0, 0.5, 1.0], [0.0, 8.0, 2.0]), STEP),
        pi(measured=measured, command="omega1", limits=(0.0, 400.0), proportional_gain=50.0),
        driveline.driver_brake(STEP, gain=8000.0, maximum=6000.0, margin=0.14),
    ]


@pytest.mark.parametrize("mix", ["own", "filter", "nonlinear", "nested"])
def test_connected_system_has_the_same_bits_as_in_python_control(mix):
    car = vehicle(STEP, slope=ROAD, drag_area=0.6).system
    names = {"inputs": ["vehicle_speed"], "outputs": ["measured_speed"]}
    lag = control.tf([0.2], [1.0, -0.8], STEP, name="lag", **names)
    sensor = control.nlsys(None, lambda t, x, u, _: [round(u[0], 1)], dt=True, name="resolution", **names)
    systems = {
        "own": [car, *driver()],
        "filter": [car, lag, *driver("measured_speed")],
        "nonlinear": [sensor, *driver("measured_speed"), car],
        "nested": [driveline.connect([car, lag]), *driver("measured_speed")],
    }
    connected = driveline.connect(systems[mix])
    assert connected.input_labels == ["omega_out"]
    assert_same_bits(connected, [(0.0, 90.0)])


def test_connection_with_gains_and_sums_has_the_same_bits_as_in_python_control():
    brake = driveline.driver_brake(STEP, gain=1000.0, maximum=500.0)
    car = vehicle(STEP).system
    connected = control.interconnect(
        [car, brake],
        connections=[
            ["vehicle_load.brake_force", "-driver_brake.brake_force"],
            ["driver_brake.vehicle_speed", "vehicle_load.vehicle_speed", "-vehicle_load.load_speed"],
        ],
        inplist=["vehicle_load.omega_out", "driver_brake.reference"],
        outlist=["vehicle_load.load_torque", "vehicle_load.brake_force"],
        name="sums",
        check_unused=False,
    )
    assert_same_bits(connected, [(0.0, 90.0), (-3.0, 3.0)])


def test_connected_system_of_a_scene_can_be_linearised_and_its_response_plotted():
    scene = load_scene(example("urban"))
    surroundings = scene.surroundings
    assert isinstance(surroundings, control.InterconnectedSystem)
    # The reference is 0 at the start, so omega1 decreases with the speed of the car.
    speed, command = 10.0, surroundings.output_labels.index("omega1")
    linear = control.linearize(surroundings, [0.0, 500.0], [speed])
    metres_per_radian = 0.29 / 4.0
    assert linear.dt == scene.run.communication_step
    assert linear.D[command, 0] == pytest.approx(-500.0 * metres_per_radian, rel=1e-6)
    time = scene.run.communication_step * np.arange(100)
    response = control.input_output_response(surroundings, time, np.full(100, speed))
    assert response.plot() is not None


def test_own_system_is_deprecated_as_a_conversion_and_sources_alone_need_no_system():
    load = driveline.shaft_load(STEP, 0.5).system
    with pytest.deprecated_call(match=r"to_control\(\) is deprecated"):
        assert load.to_control() is load
    signals = {"omega1": 100.0, "load_torque": driveline.Table([0.0, 1.0], [0.0, 8.0])}
    parts = [driveline.Sources({name: signal}, STEP) for name, signal in signals.items()]
    sources = driveline.connect(parts)
    assert isinstance(sources, driveline.Sources)
    assert sources.signals == signals
    assert_same_bits(sources.system(), ())


def test_algebraic_loop_and_different_steps_are_errors():
    ring = [
        driveline.DiscreteSystem(a, 0.1, [b], [a], lambda _, __, u: ([u[0] + 1.0], ()))
        for a, b in ("xy", "yx")
    ]
    with pytest.raises(ValueError, match=r"^algebraic loop among x, y$"):
        driveline.initial_inputs(driveline.connect(ring))
    slow = driveline.source("b", 1.0, 0.2)
    for step, text in ((0.1, "0.1 s"), (1.0, "1 s"), (0, "continuous time")):
        system = control.tf([1.0], [1.0, 0.5], step, name="a", inputs=["b"], outputs=["c"])
        with pytest.raises(
            ValueError, match=rf"^steps of the systems must be equal \(got a {text}, b_source 0"
        ):
            driveline.connect([system, slow])


def test_initial_inputs_equal_the_first_row():
    load = driveline.shaft_load(0.1, 1.0, 0.5, torque=2.0)
    surroundings = driveline.connect([load.system, driveline.source("omega1", 7.0, 0.1)])
    assert driveline.initial_inputs(surroundings, {"omega_out": 4.0}) == {"load_torque": 4.0, "omega1": 7.0}


def test_progress_and_units():
    fractions = []
    load = vehicle(0.1)
    surroundings = driveline.connect([load.system, no_brake(0.1)])
    table = driveline.ClosedLoop(Shaft(1.0), surroundings, ["omega_out"]).run(5.0, fractions.append)
    assert fractions[0] == 0.0
    assert fractions[-1] == 1.0
    assert {"vehicle_speed": "m/s", "load_torque": "N.m", "omega_out": "rad/s"}.items() <= table.units.items()


# --- the elementary urban cycle ---


def test_urban_cycle_has_the_published_sums():
    """The regulation publishes seconds by kind of operation, duration, distance and mean speed."""
    seconds, before = Counter(), 0.0
    for duration, speed in zip(np.diff(CYCLE.time), CYCLE.speed[1:], strict=True):
        constant = "gear-changing" if duration == 2.0 else "steady speed" if speed else "idling"
        falling = "deceleration" if speed else "clutch disengaged"
        seconds[constant if speed == before else falling if speed < before else "acceleration"] += duration
        before = speed
    published = {"idling": 60.0, "acceleration": 36.0, "gear-changing": 8.0, "steady speed": 57.0}
    assert seconds == published | {"deceleration": 25.0, "clutch disengaged": 9.0}
    assert CYCLE.duration == 195.0
    distance = np.trapezoid(CYCLE.speed, CYCLE.time)
    assert distance == pytest.approx(1013.0, rel=0.01)
    assert round(distance / CYCLE.duration / KMH) == 19
    rates = np.diff(CYCLE.speed) / np.diff(CYCLE.time)
    assert rates.max() == pytest.approx(1.04, abs=0.005)
    assert rates.min() > -1.0


def test_tolerance_band_equals_the_extremes_of_samples():
    times = np.linspace(0.0, 195.0, 1951)
    lower, upper = CYCLE.tolerance_band(times)
    for n in range(0, times.size, 7):
        window = CYCLE.speed_at(np.linspace(times[n] - 1.0, times[n] + 1.0, 2001))
        assert upper[n] == pytest.approx(window.max() + 2.0 * KMH, abs=1e-3)
        assert lower[n] == pytest.approx(max(window.min() - 2.0 * KMH, 0.0), abs=1e-3)
    assert cycles.CYCLES[CYCLE.name] is CYCLE
    peak = cycles.Cycle("peak", np.array([0.0, 5.0, 10.0]), np.array([0.0, 10.0, 0.0]))
    assert peak.tolerance_band(np.array([4.5]))[1] == pytest.approx(10.0 + 2.0 * KMH)


def test_car_follows_the_cycle_with_balanced_momentum_and_energy():
    scene = load_scene(example("urban"))
    parameters = {**scene.parameters(), "tolerance": 1e-8}
    outputs = ["omega_out", "output_torque_mean", "energy_in", "energy_out", "energy_residual"]
    plant = Module("compiled").start(**parameters)
    table = driveline.ClosedLoop(plant, driveline.connect(list(scene.systems())), outputs).run(CYCLE.duration)
    lower, upper = CYCLE.tolerance_band(table.time)
    speed = table["vehicle_speed"]
    assert np.mean((speed < lower) | (speed > upper)) < 0.02
    assert np.sqrt(np.mean((speed - table["reference"]) ** 2)) < 0.6 * KMH
    assert table["omega1"].max() <= 400.0
    assert speed[-1] == 0.0
    # J d(omega) = (mean torque - load) dt while the car moves
    momentum = parameters["output_inertia"] * np.diff(table["omega_out"])
    torque = table["output_torque_mean"][1:] - table["load_torque"][:-1]
    moving = table["omega_out"][1:] > 0.0
    assert moving.mean() > 0.5
    np.testing.assert_allclose(momentum[moving], 0.01 * torque[moving], atol=1e-7)
    # The car ends at rest, so drag, rolling resistance, slope and brake absorb the output energy.
    mean_speed = 0.5 * (table["omega_out"][1:] + table["omega_out"][:-1])
    parts = [
        float(np.sum(table[f"{name}_torque"][:-1] * mean_speed * 0.01))
        for name in ("drag", "rolling", "slope", "brake")
    ]
    assert sum(parts) == pytest.approx(table["energy_out"][-1], rel=1e-4)
    assert parts[1] == pytest.approx(0.01 * 900.0 * 9.80665 * table["distance"][-1], rel=1e-3)
    assert abs(table["energy_residual"][-1]) < 1e-7 * table["energy_in"][-1]
