"""Batch: arrays of parameters and inputs broadcast to runs, each with the bits of a module by itself."""

import numpy as np
import pytest
from refused import assert_refused

from inertia_module import Module, batch
from inertia_module.common.errors import Refused

MASSES, LOADS = [[0.5], [1.0], [-1.0]], ["8 N.m", "0.012 kN.m"]
OUTPUTS = ("omega_out", "output_torque_mean", "contact_mode")


@pytest.mark.parametrize("step", [None, 0.03])
def test_rows_are_those_of_modules_by_themselves(compiled, step):
    found = batch({"imbalance_mass": MASSES, "load_torque": LOADS, "layout": "planar"}, 0.1, OUTPUTS, step)
    for n, (mass,) in enumerate(MASSES[:2]):
        for k, load in enumerate((8.0, 12.0)):
            module = Module(compiled).start(imbalance_mass=mass, load_torque=load, layout=1)
            for length in (0.1,) if step is None else np.diff([0.0, 0.03, 0.06, 0.09, 0.1]):
                module.advance(float(length))
            assert tuple(found[name][n, k] for name in OUTPUTS) == module.read(OUTPUTS)
    assert np.isnan(found["omega_out"][2]).all()
    assert not found["refused"][:2].any()
    assert [text.startswith("imbalance_mass must be between") for text in found["refused"][2]] == [True, True]


def test_numbers_alone_are_one_run_and_unknown_names_are_refused(compiled):
    assert batch({"omega1": 50.0}, 0.01)["omega_out"].shape == ()
    for given in ({"values": {"omega7": 1.0}}, {"values": {}, "outputs": "omega_in"}):
        assert_refused("must be a variable of InertiaModule", batch, **given)
    with pytest.raises(Refused, match="an output of the batch"):
        batch({}, 0.01)["omega2"]
