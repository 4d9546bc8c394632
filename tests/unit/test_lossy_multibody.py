"""The equations of the machine with losses against inverse dynamics of the multibody engine."""

import numpy as np
import pytest
from scenes import LAYOUTS, parameters

pytest.importorskip("mujoco")
from multibody import Multibody

from studies.reference.cases import A1, A2, A3, CLOSED, OMEGA1, OPEN, SUMS, THETA1, Machine, Q

OUTPUT_INERTIA, LINK2_INERTIA, INPUT_INERTIA = 0.03, 0.006, 0.02
FRICTION = {"input_friction": 0.3, "drive_friction": 0.2, "link2_friction": 0.1}
DRAG = {"housing_drag": 4.0, "housing_drag_viscous": 0.05}


def rubbed(multibody):
    """The same with dampers at the hinges, the drives' evenly, and dry friction at link 2."""
    p, model = multibody.p, multibody.model
    names = [model.joint(n).name.split()[0] for n in range(model.njnt)]
    drives = names.count("drive")
    damping = {"drive": p["drive_friction"] / drives, "satellite": 0.0}
    link2 = p["link2_friction"] + p["housing_drag_viscous"]
    links = iter((p["input_friction"], link2))
    model.dof_damping[:] = [damping[name] if name in damping else next(links) for name in names]
    last = names.index("link", 1)
    model.dof_frictionloss[last] = p["housing_drag"]
    # as stiff as that, it slides whatever the acceleration
    model.dof_solref[last] = -1.0, -1e9
    return multibody


@pytest.fixture(params=LAYOUTS)
def layout(request):
    return LAYOUTS[request.param]


@pytest.mark.parametrize("satellites, modules", [(1, 1), (2, 1), (3, 2)])
def test_links_accelerate_as_inverse_dynamics_says(layout, satellites, modules):
    p = parameters(
        **layout, satellites=satellites, modules=modules, imbalance_mass=0.8, gravity=9.81, drive=1
    )
    p |= {"drive_inertia": 0.004, "satellite_inertia": 5e-4, "satellite_transverse_inertia": 4e-4}
    p |= {"input_inertia": INPUT_INERTIA, "link2_inertia": LINK2_INERTIA, "output_inertia": OUTPUT_INERTIA}
    multibody = rubbed(Multibody(p | FRICTION | DRAG))
    multibody.model.opt.gravity[:] = 0.0, 0.0, -9.81
    machine, y = Machine(multibody.p), np.zeros(SUMS)
    for state in np.random.default_rng(7).uniform(-1.0, 1.0, (20, 6)):
        q, theta1, omega1, alpha1, omega2, alpha2 = state * [10.0, 10.0, 100.0, 3000.0, 100.0, 3000.0]
        omega2 = abs(omega2)  # the freewheel to the housing overruns
        m1, m2 = multibody.prescribe(q, theta1, omega1, alpha1, omega2, alpha2)
        # what is left of the mesh torque, friction taken off, turns link 2 and the shaft behind it
        machine.torque, machine.load = m1, m2 - (LINK2_INERTIA + OUTPUT_INERTIA) * alpha2
        y[Q], y[THETA1], y[OMEGA1 : OMEGA1 + 4] = q, theta1, (omega1, omega2, omega2, omega2)
        found = machine.forces(y, (OPEN, CLOSED, 1, 1, *[1] * satellites)).x
        assert found[[A1, A2, A3]] == pytest.approx([alpha1, alpha2, alpha2], rel=1e-8, abs=3e-5)
