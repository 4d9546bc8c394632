"""Test batch: arrays of parameters and inputs are broadcast to runs with the bits of a single module."""

import numpy as np
import pytest
from rejected import assert_rejected

from inertia_module import Module, batch
from inertia_module.common.errors import InertiaModuleError

MASSES, LOADS = [[0.5], [1.0], [-1.0]], ["8 N.m", "0.012 kN.m"]
OUTPUTS = ("omega_out", "output_torque_mean", "contact_mode")


@pytest.mark.parametrize("step", [None, 0.03])
def test_rows_agree_with_single_modules(compiled, step):
    result = batch({"imbalance_mass": MASSES, "load_torque": LOADS, "layout": "planar"}, 0.1, OUTPUTS, step)
    for n, (mass,) in enumerate(MASSES[:2]):
        for k, load in enumerate((8.0, 12.0)):
            module = Module(compiled).start(imbalance_mass=mass, load_torque=load, layout=1)
            for length in (0.1,) if step is None else np.diff([0.0, 0.03, 0.06, 0.09, 0.1]):
                module.advance(float(length))
            assert tuple(result[name][n, k] for name in OUTPUTS) == module.read(OUTPUTS)
    assert np.isnan(result["omega_out"][2]).all()
    assert not result["refused"][:2].any()
    assert [text.startswith("imbalance_mass must be between") for text in result["refused"][2]] == [
        True,
        True,
    ]


def test_scalars_are_a_single_run(compiled):
    assert batch({"omega1": 50.0}, 0.01)["omega_out"].shape == ()
    with pytest.raises(InertiaModuleError, match="unknown batch output '"):
        batch({}, 0.01)["omega2"]


# arguments that are wrong for all runs, and the sentence
WRONG = [
    ({"values": {"omega7": 1.0}}, "unknown parameter or input 'omega7'"),
    ({"values": {"omega_out": 1.0}}, "unknown parameter or input 'omega_out'"),
    ({"values": ["omega1"]}, r"values must be numbers, strings or arrays by name .got \['omega1'\].$"),
    ({"values": {"omega1": [1.0, 2.0, 3.0], "load_torque": [[1.0], [2.0]], "a": [1.0, 1.0]}},
     r"values must have shapes that broadcast together: omega1 \(3,\), load_torque \(2, 1\), a \(2,\)$"),
    ({"values": {"omega1": [[1.0, 2.0], [3.0]]}}, "omega1 must be an array with rows of equal length"),
    ({"values": {"omega1": "3 kg"}}, "omega1 must be .* .got '3 kg'.: incompatible unit 'kg'"),
    ({"values": {"omega1": ["3 kg", "4 kg"]}}, "omega1 must be .* .got '3 kg'.: incompatible unit 'kg'"),
    ({"values": {"omega1": None}}, "omega1 must be .* .got None."),
    ({"values": {"layout": ["conic"]}}, "layout must be 0 .bevel. or 1 .planar. .got 'conic'"),
    ({"outputs": "omega_in"}, "unknown variable of InertiaModule 'omega_in'"),
    ({"outputs": 3}, "names must be a string or a list of strings .got 3.$"),
    ({"stop_time": "1 s"}, "stop_time must be a positive number of seconds .got '1 s'.$"),
    ({"step": -1.0}, "step must be a positive number of seconds .got -1.0.$"),
    ({"step": 1e-12}, "step must be at least 1e-10 s, for at most 100,000,000 steps .got 1e-12.$"),
    ({"workers": 0}, "workers must be a whole number of at least 1 .got 0.$"),
    ({"workers": 1.5}, "workers must be a whole number of at least 1 .got 1.5.$"),
]  # fmt: skip


@pytest.mark.parametrize("arguments, words", WRONG)
def test_invalid_argument_of_all_runs_is_an_error(arguments, words):
    assert_rejected(words, batch, **{"values": {"omega1": 50.0}, "stop_time": 0.01, **arguments})


def test_invalid_values_of_some_runs_give_nan(compiled):
    result = batch({"omega1": ["3 kg", "30 rad/s", "nan"], "imbalance_mass": [1.0, 1.0, 1.0]}, 0.01)
    assert np.isnan(result["omega_out"]).tolist() == [True, False, True]
    sentence = "omega1 must be between -100000 and 100000 rad/s (got '3 kg'): incompatible unit 'kg'; "
    assert result["refused"][0].startswith(sentence)
    assert np.isnan(batch({"omega1": [np.nan, -1e9]}, 0.01)["omega_out"]).all()
    assert batch({"omega1": []}, 0.01)["omega_out"].shape == (0,)


def test_step_longer_than_the_run_is_cut_to_it(compiled):
    whole = batch({"omega1": 50.0}, 0.01)["omega_out"]
    assert batch({"omega1": 50.0}, 0.01, step=1e9)["omega_out"] == whole
