"""The stiff step of the equations of motion: Rosenbrock's pair, where it is taken and what it leaves out."""

import numpy as np
import pytest
from scenes import ELASTIC, SCENES, advanced, started

from inertia_module.contract.records import record_type
from inertia_module.kernel import fields
from inertia_module.kernel.events import advance, rosenbrock, stages
from inertia_module.kernel.tableau import LONG

MOTION = ("q", "omega2", "omega3", "twist", "relative", "drive", "work_in", "square")


def stiff_step(scene, h, part):
    """Changes over this part of a stiff step h from a moment at which link 2 drives the shaft."""
    module = advanced(started("plain", scene, ELASTIC, tolerance=1e-9), 0.005)
    d, x = module.derived, module.state
    w = record_type(fields.workspace(fields.FOLLOWED))()
    w.prescribed = x.drive_torque if d.by_torque else x.alpha1
    w.load = x.load_torque
    assert x.output_state == 1.0
    advance.begin_step(d, x, w)
    rosenbrock.differentiate(d, x, w)
    rosenbrock.make_stiff_step(d, x, w, h)
    rosenbrock.set_part(d, x, w, part)
    return np.array([getattr(w.change, name) for name in MOTION])


def exact_step(scene, h):
    """The same by the explicit pair, in sixteen steps."""
    module = advanced(started("plain", scene, ELASTIC, tolerance=1e-9), 0.005)
    d, x = module.derived, module.state
    w = record_type(fields.workspace(fields.FOLLOWED))()
    w.prescribed = x.drive_torque if d.by_torque else x.alpha1
    w.load = x.load_torque
    total = np.zeros(len(MOTION))
    for _ in range(16):
        x.rates_cached = 0.0
        advance.begin_step(d, x, w)
        stages.make_step(d, x, w, LONG, h / 16)
        total += [getattr(w.change, name) for name in MOTION]
        for name in ("q", "theta1", "omega1", "omega2", "omega3", "twist", "relative"):
            setattr(x, name, getattr(x, name) + getattr(w.change, name))
    return total


@pytest.mark.parametrize("part, order", [(1.0, 5), (0.4, 4)], ids=["end", "inside"])
@pytest.mark.parametrize("scene", SCENES)
def test_a_stiff_step_is_of_its_order_in_all_that_is_followed(scene, part, order):
    lengths = [1e-3, 5e-4]
    errors = [abs(stiff_step(SCENES[scene], h, part) - exact_step(SCENES[scene], part * h)) for h in lengths]
    scale = abs(exact_step(SCENES[scene], lengths[0])) + 1e-12
    assert np.all(errors[0] < 1e-3 * scale)
    # of what errs at all, halving the step leaves no more than 2^-(order + 1), or nearly
    counted = errors[0] > 1e-9 * scale
    assert counted.any()
    assert np.median(np.log2(errors[0][counted] / errors[1][counted])) > order + 0.5
