"""The averaged module as a system of python-control, and the tools of the control examples."""

import averaged_module
import control as ct
import numpy as np
import pytest
from averaged_errors import REALISTIC
from frequency_response import fit_sine
from rejected import REJECTED
from scenes import MECHANISMS, started
from speed_control_margins import Margins, measured_margins, predicted_margins

from inertia_module.model import Module

PLANAR = {"layout": 1, "sun_radius": 0.1, "satellite_radius": 0.06, "eccentricity": 0.04}
PLANAR |= {"imbalance_mass": 0.3, "satellites": 3, "link2_inertia": 0.01, "output_inertia": 4.78}
LOSSY = MECHANISMS["planar"] | REALISTIC
NAMES = ("omega_out", "omega2", "input_torque", "mesh_torque", "output_torque", "housing_torque")


@pytest.mark.parametrize("omega1, load, speed", [(100, 10, 5), (100, 3, 60), (-80, 4, 2), (60, 3, 90)])
@pytest.mark.parametrize("mechanism", [{}, LOSSY], ids=["ideal", "losses"])
def test_outputs_and_acceleration_equal_the_module(compiled, mechanism, omega1, load, speed):
    module = started(compiled, mechanism, fidelity=1, omega_out_start=speed, omega1=omega1, load_torque=load)
    system = averaged_module.averaged_system(mechanism, outputs=NAMES, kernel=compiled)
    assert system.output(0.0, [speed], [omega1, load]) == pytest.approx([module[name] for name in NAMES])
    resistance = load + module["output_friction"] * speed
    rate = (module["output_torque"] - resistance) / module["output_inertia"]
    assert system.dynamics(0.0, [speed], [omega1, load]) == pytest.approx([rate])


def test_acceleration_of_the_input_adds_to_the_input_torque_as_in_the_module(compiled):
    module = Module(compiled).start(fidelity=1, omega_out_start=20.0, omega1=100.0, load_torque=10.0)
    module.set_rates(omega1=50.0)
    module.advance(1e-9)
    system = averaged_module.averaged_system(
        inputs=("omega1", "load_torque", "omega1_rate"), outputs=("input_torque",), kernel=compiled
    )
    accelerated = system.output(0.0, [20.0], [100.0, 10.0, 50.0])
    assert accelerated == pytest.approx([module["input_torque"]], rel=1e-6)
    assert accelerated != pytest.approx(system.output(0.0, [20.0], [100.0, 10.0, 0.0]), rel=1e-2)


def test_load_above_the_stall_torque_has_no_operating_point(compiled):
    system = averaged_module.averaged_system(kernel=compiled)
    for speed in (0.0, -1e-12):
        assert system.dynamics(0.0, [speed], [100.0, 1000.0])[0] == 0.0
    with pytest.raises(ValueError, match=r"load_torque must be between .* N.m .* .got 1000000"):
        averaged_module.operating_point(system, 100.0, 1e6)


@pytest.mark.parametrize("parameters, omega1, load", [({}, 100.0, 10.0), (PLANAR, 200.0, 100.0)])
def test_transient_inertias_depend_only_on_the_speed_ratio(compiled, parameters, omega1, load):
    system = averaged_module.averaged_system(parameters, outputs=("omega_out",), kernel=compiled)
    speed = averaged_module.operating_point(system, omega1, load, 0.3 * omega1)
    inertia = averaged_module.transient_inertia(parameters, omega1, speed, compiled)
    assert inertia == pytest.approx(
        averaged_module.transient_inertia(parameters, 2.0 * omega1, 2.0 * speed, compiled), rel=1e-6
    )
    # Order of magnitude of the moving inertias, small compared with the output inertia.
    assert 0.0 < inertia.input < 0.02
    assert 0.0 < inertia.output < 0.02


def test_transient_inertia_adds_to_the_output_inertia(compiled):
    added = averaged_module.TransientInertia(0.0, 0.5)
    plain = averaged_module.averaged_system(kernel=compiled)
    heavier = averaged_module.averaged_system(kernel=compiled, transient=added)
    at = 0.0, [10.0], [100.0, 10.0]
    assert heavier.dynamics(*at) == pytest.approx(0.5 * plain.dynamics(*at))


@pytest.mark.parametrize("arguments, message", REJECTED["averaged_systems"])
def test_invalid_arguments_of_the_averaged_system_are_errors(compiled, arguments, message):
    with pytest.raises(ValueError, match=message):
        averaged_module.averaged_system(**arguments, kernel=compiled)


def test_transient_inertia_requires_an_output_speed_below_the_input_speed(compiled):
    with pytest.raises(ValueError, match=r"must be above 0 and below omega1 = 100 rad/s .got 120"):
        averaged_module.transient_inertia({}, 100.0, 120.0, compiled)


def test_sine_is_fitted_to_a_signal_with_pulses_and_drift():
    time = np.arange(20000) * 1e-3
    pulses = np.abs(np.sin(2.0 * np.pi * 17.3 * time)) * 50.0
    values = 0.3 * np.sin(2.0 * np.pi * time + 0.5) + 2.0 + 0.1 * time + pulses
    (sine,), _ = fit_sine(time, values[:, None], 1.0)
    assert abs(sine) == pytest.approx(0.3, rel=1e-3)
    assert np.angle(sine) == pytest.approx(0.5, abs=1e-3)


class Pulsing:
    """Integrator whose output has slowly growing pulses."""

    speed, omega1, steps = 0.0, 0.0, 0

    def set(self, **values):
        self.omega1 = values["omega1"]

    def advance(self, step):
        self.speed += step * self.omega1
        self.steps += 1

    def read(self, names):
        return (self.speed + 1e-3 * (1.0 + 1e-3 * self.steps) * (-1.0) ** self.steps,)

    def get_state(self):
        return self.speed, self.steps

    def set_state(self, state):
        self.speed, self.steps = state


def test_predicted_and_measured_margins_of_an_integrator_with_pulses():
    """The loop g / (z (z - 1)) is unstable above g = 1; the hold adds a delay of half a step."""
    expected = predicted_margins(ct.tf([0.1], [1.0, -1.0, 0.0], 1.0))
    assert expected.gain == pytest.approx(10.0, rel=1e-2)
    crossover = 2.0 * np.arcsin(0.05)
    assert expected.crossover == pytest.approx(crossover, rel=1e-3)
    assert expected.phase == pytest.approx(90.0 - np.degrees(1.5 * crossover), abs=0.1)
    # The surrounding system has a delay of one step.
    around = ct.ss([[0.0]], [[-0.1]], [[1.0]], [[0.0]], 1.0, inputs="omega_out", outputs="omega1")
    point, limits = {"omega_out": 0.0, "omega1": 0.0}, (-1e9, 1e9)
    measured = measured_margins(Pulsing(), around, point, [1.0], expected, limits)
    assert measured.gain == pytest.approx(expected.gain, rel=0.05)
    assert measured.delay == pytest.approx(expected.delay, rel=0.03)
    too_low = Margins(0.4 * expected.gain, expected.delay, expected.crossover)
    with pytest.raises(ValueError, match=r"the loop must be unstable at "):
        measured_margins(Pulsing(), around, point, [1.0], too_low, limits)


def test_operating_points_are_listed_with_their_stability(compiled):
    """The shaft leaves an operating point at which the torque increases with the speed."""
    omega1 = 100.0
    system = averaged_module.averaged_system({}, outputs=("output_torque",))
    low, high = averaged_module.carried_range(system, omega1)
    points = {
        load: averaged_module.operating_points(system, omega1, load)
        for load in np.linspace(low, high, 23)[1:-1]
    }
    assert {point.is_stable for balances in points.values() for point in balances} == {True, False}
    for load, balances in points.items():
        assert balances
        for point in balances:
            rates = [
                system.dynamics(0.0, [point.omega_out * (1.0 + shift)], [omega1, load])[0]
                for shift in (-1e-6, 1e-6)
            ]
            assert bool(rates[0] > 0.0 > rates[1]) == point.is_stable
        stable = [point.omega_out for point in balances if point.is_stable]
        if len(stable) == 1:
            assert averaged_module.operating_point(system, omega1, load) == stable[0]
        else:
            words = r"guess must be close to one of the operating points .*rad/s .(un)?stable"
            with pytest.raises(ValueError, match=words):
                averaged_module.operating_point(system, omega1, load)
        for point in balances:
            assert averaged_module.operating_point(system, omega1, load, point.omega_out) == point.omega_out


@pytest.mark.parametrize("share", [1.01, -0.5])
def test_load_out_of_range_is_an_error_with_the_range(compiled, share):
    system = averaged_module.averaged_system({}, outputs=("output_torque",))
    low, high = averaged_module.carried_range(system, 100.0)
    words = f"load_torque must be between {low:.4g} and {high:.4g} N.m at omega1 = 100 rad/s"
    with pytest.raises(ValueError, match=words):
        averaged_module.operating_point(system, 100.0, share * high)
