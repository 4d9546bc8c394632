"""Bad input never gets in: refused with a message, no crash, nothing lost (DESIGN section 6)."""

import math

import pytest

from inertia_module.instance import DriveError, Fmu
from inertia_module.variables import PARAMETER, with_causality

REALS = [v for v in with_causality(PARAMETER) if v.kind == "Real"]
WHOLES = [v for v in with_causality(PARAMETER) if v.kind in ("Integer", "Enumeration")]
OUT_OF_RANGE = [
    *((v.name, math.nan) for v in REALS),
    *((v.name, math.inf) for v in REALS),
    *((v.name, v.minimum - 1.0) for v in REALS),
    *((v.name, v.maximum * 2.0 + 1.0) for v in REALS),
    *((v.name, v.minimum - 1) for v in WHOLES),
    *((v.name, v.maximum + 1) for v in WHOLES),
]
TOGETHER = {
    "singular bevel": ({"link2_inertia": 0.0}, ("link2_inertia", "drive_inertia", "a =")),
    "singular bevel, a = b": ({"link2_inertia": 0.0, "a": 0.7, "b": 0.7}, ("link2_inertia", "a = 0.7")),
    "no mass": ({"link2_inertia": 0.0, "imbalance_mass": 0.0}, ("imbalance_mass",)),
    "singular planar": ({"layout": 1, "link2_inertia": 0.0, "eccentricity": 0.0}, ("eccentricity",)),
    "backwards": ({"omega2_start": -1.0}, ("omega2_start", ">= 0")),
    "ahead": ({"omega2_start": 2.0, "omega_out_start": 1.0}, ("omega_out_start >= omega2_start",)),
    "apart": ({"output_freewheel": False, "omega_out_start": 1.0}, ("omega_out_start = omega2_start",)),
    "torque on link 1 without inertia": ({"drive": 1}, ("input_inertia = 0", "drive = 1")),
    "torque and prescribed motion": (
        {"drive": 1, "fidelity": 0, "input_inertia": 1.0},
        ("fidelity = 0", "drive = 1"),
    ),
    "averaged without rectifier": (
        {"fidelity": 1, "housing_freewheel": False},
        ("averaged", "housing_freewheel = 0"),
    ),
}


@pytest.mark.parametrize("name, value", OUT_OF_RANGE)
def test_parameter_out_of_range_is_named_with_what_is_allowed(fmu_path, name, value):
    with pytest.raises(DriveError) as caught:
        Fmu(fmu_path, {name: value}) if not isinstance(value, int) else Fmu(fmu_path, {name: int(value)})
    message = str(caught.value)
    assert name in message
    assert f"{value:.16g}" in message
    assert "allowed is" in message


@pytest.mark.parametrize("case", TOGETHER)
def test_parameters_that_do_not_go_together_are_refused(fmu_path, case):
    parameters, words = TOGETHER[case]
    with pytest.raises(DriveError) as caught:
        Fmu(fmu_path, parameters)
    assert all(word in str(caught.value) for word in words)
    assert "allowed is" in str(caught.value)


def test_refused_parameters_make_every_step_refused_until_reset(instance):
    assert "imbalance_mass = -1 is refused" in instance.refusal(lambda: instance.start(imbalance_mass=-1.0))
    for _ in range(2):
        assert "doStep is refused" in instance.refusal(lambda: instance.try_step(0.01))
    instance.fmu.reset()
    instance.start(omega1=100.0)
    assert not instance.is_discarded(0.01)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, math.nan, 1.0])
def test_bad_tolerance_of_the_experiment_is_refused(fmu_path, tolerance):
    with pytest.raises(DriveError, match=r"tolerance = .* allowed is"):
        Fmu(fmu_path, tolerance=tolerance)


BAD_INPUTS = [
    ({"omega1": math.nan}, 0.01, "omega1 = nan"),
    ({"omega1": -math.inf}, 0.01, "omega1 = -inf"),
    ({"omega1": 1e9}, 0.01, "omega1 = 1000000000"),
    ({"load_torque": math.nan}, 0.01, "load_torque = nan"),
    ({"load_torque": 1e13}, 0.01, "load_torque = "),
    ({"drive_torque": math.nan}, 0.01, "drive_torque = nan"),
    ({"drive_torque": -1e13}, 0.01, "drive_torque = -"),
    ({}, 0.0, "communication step = 0 s"),
    ({}, -0.01, "communication step = -0.01 s"),
    ({}, math.nan, "communication step = nan s"),
    ({}, math.inf, "communication step = inf s"),
    ({}, 1e9, "communication step = 1000000000 s"),
]


@pytest.mark.parametrize("drive", [0, 1])
@pytest.mark.parametrize("inputs, h, words", BAD_INPUTS)
def test_bad_input_or_step_is_discarded_and_nothing_is_lost(instances, inputs, h, words, drive, capfd):
    good = {"omega1": 100.0, "load_torque": 10.0, "drive_torque": 20.0}
    driven = {"drive": drive, "input_inertia": 0.2}
    instance = instances().start(**good, **driven)
    undisturbed = instances().start(**good, **driven)
    instance.step(0.1)
    undisturbed.step(0.1)
    before = instance.all_values()
    instance.set(**inputs)
    assert instance.is_discarded(h)
    instance.set(**good)
    assert instance.all_values() == before
    instance.step(0.1)
    undisturbed.step(0.1)
    assert instance.all_values() == undisturbed.all_values()
    out = capfd.readouterr().out
    assert words in out
    assert "allowed is" in out


def test_bad_input_at_the_end_of_initialisation_is_refused(fmu_path):
    with pytest.raises(DriveError, match=r"omega1 = nan is refused: allowed is from"):
        Fmu(fmu_path, inputs={"omega1": math.nan})


def test_work_without_end_is_an_error_and_no_hang(instance):
    instance.start(omega1=1e6, load_torque=0.0, output_freewheel=False, housing_freewheel=False)
    instance.step(1e-4)
    before = instance.all_values()
    assert instance.is_discarded(1e5)
    assert instance.all_values() == before
    assert not instance.is_discarded(1e-4)


def test_steps_out_of_order_are_refused(instance):
    def refused():
        return "doStep is refused: the instance is" in instance.refusal(lambda: instance.try_step(0.01))

    assert refused()
    instance.fmu.setupExperiment()
    assert refused()
    instance.fmu.enterInitializationMode()
    assert refused()
    instance.fmu.exitInitializationMode()
    assert not instance.is_discarded(0.01)
    instance.fmu.terminate()
    assert refused()


def test_end_of_initialisation_without_its_beginning_is_refused(instance):
    message = instance.refusal(instance.fmu.exitInitializationMode)
    assert "exitInitializationMode is refused: the instance is instantiated" in message
    assert "doStep is refused" in instance.refusal(lambda: instance.try_step(0.01))


def test_parameters_cannot_change_after_initialisation(instance):
    instance.start(omega1=100.0)
    message = instance.refusal(lambda: instance.set(link2_inertia=3.0))
    assert "link2_inertia is refused: parameters are fixed" in message
    assert instance.get("link2_inertia") == 0.005
    assert not instance.is_discarded(0.01)


def test_outputs_cannot_be_set(instance):
    instance.start(omega1=100.0)
    instance.step(0.1)
    value = instance.get("omega_out")
    assert "omega_out is refused" in instance.refusal(lambda: instance.set(omega_out=77.0))
    assert instance.get("omega_out") == value


def test_unknown_references_and_wrong_types_are_refused(instance):
    instance.start(omega1=100.0)
    z2 = instance.references["z2"]
    calls = (
        lambda: instance.fmu.getReal([9999]),
        lambda: instance.fmu.getReal([z2]),
        lambda: instance.fmu.getInteger([instance.references["omega1"]]),
        lambda: instance.fmu.setReal([9999], [1.0]),
        lambda: instance.fmu.setReal([z2], [1.0]),
    )
    for call in calls:
        assert "value reference" in instance.refusal(call)
    assert not instance.is_discarded(0.01)


def test_percent_signs_in_messages_survive(fmu_path):
    with pytest.raises(DriveError, match="no such variable"):
        Fmu(fmu_path, {"100%s%n": 1.0})
