"""A jump of the input speed is an impulse, shared out by the 2 x 2 complementarity problem."""

from itertools import product

import numpy as np
import pytest
from geometry import direct_sums, ratio
from hypothesis import given
from hypothesis import strategies as st
from scenes import advanced, parameters, started

MOMENT = 1e-13  # s: too short for anything but the jump
SPEEDS = st.floats(-200.0, 200.0)


def brute_force(p, q, jump, omega2, omega3):
    """(omega2, omega3, Pc) after the jump: of the four ways in contact the one that is consistent."""
    k = ratio(p)
    _, _, b, _, g, _ = direct_sums(p, q)
    inertia, shaft = p["link2_inertia"] + k * k * g, p["output_inertia"]
    push = k * (b + k * g) * jump
    tiny = 1e-9 * (abs(omega2) + abs(omega3) + abs(jump))
    for housing, output in product([False, True], repeat=2):
        if (housing and not p["housing_freewheel"]) or (not output and not p["output_freewheel"]):
            continue
        # unknowns: end speeds, Pc, Ph
        matrix = np.array([[inertia, 0, 1, -1], [0, shaft, -1, 0], [0, 0, 0, 0], [0, 0, 0, 0]], float)
        matrix[2] = [-1, 1, 0, 0] if output else [0, 0, 1, 0]
        matrix[3] = [1, 0, 0, 0] if housing else [0, 0, 0, 1]
        known = [inertia * omega2 + push, shaft * omega3, 0.0, 0.0]
        end2, end3, clutch, block = np.linalg.solve(matrix, known)
        holds = not p["housing_freewheel"] or (end2 >= -tiny and block >= -tiny * inertia)
        drives = not p["output_freewheel"] or (end3 - end2 >= -tiny and clutch >= -tiny * shaft)
        if holds and drives:
            return end2, end3, clutch
    raise AssertionError("a P-matrix always has a solution")


@pytest.mark.parametrize("output", [True, False], ids=["output freewheel", "rigid with the shaft"])
@pytest.mark.parametrize("housing", [True, False], ids=["housing freewheel", "no housing freewheel"])
@given(
    omega1=SPEEDS,
    target=SPEEDS,
    omega2=st.one_of(st.just(0.0), SPEEDS),
    slip=st.one_of(st.just(0.0), st.floats(0.0, 50.0)),
    q=st.floats(-10.0, 10.0),
    inertia=st.sampled_from([0.0, 0.003]),
)
def test_speeds_and_impulses_after_a_jump_solve_the_complementarity_problem(
    compiled, scene, housing, output, omega1, target, omega2, slip, q, inertia
):
    omega2 = abs(omega2) if housing else omega2
    p = parameters(
        **{name: value for name, value in scene.items() if name not in ("omega1", "load_torque")},
        housing_freewheel=housing,
        output_freewheel=output,
        drive_inertia=inertia,
        input_inertia=0.01,
        omega2_start=omega2,
        omega_out_start=omega2 + (slip if output else 0.0),
        drive_angle_start=q,
    )
    module = started(compiled, p, omega1=omega1, load_torque=scene["load_torque"])
    omega2, omega3, stored = module["omega2"], module["omega_out"], module["energy_stored"]
    end2, end3, clutch = brute_force(p, q, target - omega1, omega2, omega3)
    advanced(module, MOMENT, omega1=target)

    near = {"rel": 1e-7, "abs": 1e-6}
    assert module["omega2"] == pytest.approx(end2, **near)
    assert module["omega_out"] == pytest.approx(end3, **near)
    assert module["output_torque_mean"] * MOMENT == pytest.approx(clutch, **near)
    i, _, b, _, g, _ = direct_sums(p, q)
    k, change = ratio(p), target - omega1
    slipped = k * (change - (end2 - omega2))
    driven = (p["input_inertia"] + i) * change + b * slipped + k * (b * change + g * slipped)
    assert module["input_torque_mean"] * MOMENT == pytest.approx(driven, **near)

    # a speed is zero within rounding of the fastest one
    fastest = max(abs(omega1), abs(target), abs(omega2), abs(omega3))
    turnover = stored + abs(module["energy_in"]) + p["output_inertia"] * fastest**2
    assert abs(module["energy_residual"]) <= 1e-12 * turnover + 1e-20
    assert module["energy_lost"] == 0.0


@given(jump=st.floats(1.0, 100.0), parts=st.integers(2, 50))
def test_jump_in_parts_ends_as_the_whole_jump(compiled, scene, jump, parts):
    one = advanced(started(compiled, scene), 0.0043)
    many = advanced(started(compiled, scene), 0.0043)
    target = one["omega1"] + jump
    advanced(one, MOMENT, omega1=target)
    for part in range(1, parts + 1):
        advanced(many, MOMENT, omega1=target - jump * (1.0 - part / parts))
    assert many["omega2"] == pytest.approx(one["omega2"], rel=1e-6, abs=1e-6)
    assert many["omega_out"] == pytest.approx(one["omega_out"], rel=1e-6, abs=1e-6)
