"""Test fidelity averaged with losses: means against the pulses, energy balance, rejections.

The means describe the steady motion, even if link 2 never rests.
"""

import math
import random
import re
import tomllib
from itertools import product
from pathlib import Path

import pytest
from averaged_errors import REALISTIC, of_map, of_pulses
from scenes import FOUND, MECHANISMS, advanced, input_angle, mechanism, started

from inertia_module.common.errors import InertiaModuleError
from inertia_module.driveline import interface_inertia
from inertia_module.model import Module

PLANAR = MECHANISMS["planar"]
TABLES = tomllib.loads(Path(__file__).with_name("averaged_losses.toml").read_text(encoding="utf-8"))
ALONE, SLOW, CRAWLING = TABLES["alone"], TABLES["slow"], TABLES["crawling"]
HEAVY = mechanism(FOUND["heavy_link_2"])
# friction of link 2 and freewheels that scales with a speed
VISCOUS = ("link2_friction", "housing_drag_viscous", "output_drag_viscous")


def alone(name):
    """Return a machine with a single loss: the satellites of the planar layout have no wheel 17."""
    return (PLANAR if name != "satellite_mesh_efficiency" else {}) | {name: ALONE[name][0]}


# Shape and losses, input speed, ratio, tolerance.
STEADY = [
    *(
        (MECHANISMS[mechanism] | REALISTIC, omega1, ratio, bound)
        for mechanism in MECHANISMS
        for omega1, ratio, bound in (
            *((15.0, 0.1, 0.03), (15.0, 0.9, 0.03), (30.0, 0.5, 0.01)),
            *((200.0, 0.1, 0.01), (200.0, 0.9, 0.01), (-60.0, 0.5, 0.01)),
        )
    ),
    *((alone(name), 60.0, 0.5, 0.005) for name in ALONE),
]


@pytest.mark.parametrize("values, omega1, ratio, bound", STEADY)
def test_steady_means_agree_with_the_pulses(compiled, values, omega1, ratio, bound):
    means, pulses = (of(compiled, values, omega1, ratio) for of in (of_map, of_pulses))
    assert means[:2] == pytest.approx(pulses[:2], abs=bound * max(abs(pulses[0]), pulses[1]))
    assert means[2:] == pytest.approx(pulses[2:], abs=bound)


def averaged(kernel, *scenes, **values):
    return started(kernel, PLANAR, *scenes, {"fidelity": 1}, values)


def test_locked_to_link_1_friction_and_drag_alone_are_lost(compiled):
    module = averaged(compiled, REALISTIC, omega1=100.0, omega_out_start=100.0, load_torque=10.0)
    module.advance(0.5)
    assert module["omega_out"] == 100.0
    assert module["output_torque"] == pytest.approx(11.0, rel=1e-12)
    assert module["mesh_torque"] == pytest.approx(12.3, rel=2e-3)
    assert module["input_torque_mean"] == pytest.approx(13.3, rel=2e-3)
    assert module["housing_torque_mean"] == pytest.approx(-0.3, abs=0.02)
    assert module["housing_torque"] == pytest.approx(-0.3, abs=0.02)
    assert module["energy_lost_freewheel"] == pytest.approx(15.0, rel=2e-3)


@pytest.mark.parametrize("step", [0.01, 3.0])
@pytest.mark.parametrize("omega1", [0.0, 40.0])
def test_a_coasting_shaft_slows_by_friction_and_drag(compiled, step, omega1):
    slow = {"output_friction": 0.02, "output_drag": 0.3, "output_drag_viscous": 0.01}
    module = averaged(compiled, slow, omega1=omega1, omega_out_start=80.0)
    advanced(module, *[step] * round(3.0 / step))
    end = (0.01 * omega1 - 0.3) / 0.03
    left = (80.0 - end) * math.exp(-0.03 * 3.0 / PLANAR["output_inertia"]) + end
    assert module["omega_out"] == pytest.approx(left, rel=1e-5)
    gone = 0.5 * PLANAR["output_inertia"] * (80.0**2 - left**2)
    assert module["energy_lost"] - module["energy_in"] == pytest.approx(gone, rel=1e-4)
    assert omega1 or module["energy_in"] == pytest.approx(0.0, abs=1e-4 * gone)


def test_strong_output_friction_dissipates_the_energy_of_the_shaft(compiled):
    module = started(compiled, fidelity=1, omega_out_start=10.0, output_friction=90.0)
    had = module["energy_stored"]
    module.advance(0.02)
    assert module["omega_out"] < 0.3
    assert module["energy_lost_viscous"] == module["energy_lost"]
    assert module["energy_residual"] == pytest.approx(0.0, abs=1e-9 * had)


@pytest.mark.parametrize("change", [0.0, 0.5], ids=["constant", "ramps"])
def test_work_of_link_1_is_accurate_with_large_losses(compiled, change):
    tolerances = [1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7]
    values = {"mesh_efficiency": 0.9, "omega1": 100.0, "input_hold": 1}
    modules = [averaged(compiled, values, tolerance=tolerance) for tolerance in tolerances]
    for n in range(10):
        for module in modules:
            advanced(module, 0.02, omega1=100.0 + change * n)
    for module, tolerance in zip(modules, tolerances, strict=True):
        allowed = 20.0 * tolerance * module["energy_stored"]
        assert module["energy_in"] == pytest.approx(modules[0]["energy_in"], rel=1e-12, abs=allowed)
        assert module["rhs_evaluations"] < 500 or tolerance < 1e-9


@pytest.mark.parametrize("load", [-0.5, -2.0])
def test_drag_of_both_freewheels_holds_a_shaft_at_rest(compiled, load):
    module = advanced(averaged(compiled, output_drag=1.5, housing_drag=0.8, load_torque=load), 0.1)
    assert (module["omega_out"] == 0.0) == (load == -0.5)


def test_max_step_does_not_change_the_map(compiled):
    means = []
    # Another efficiency, so that each run computes its own map.
    for efficiency, longest in ((0.96, 1e-3), (0.96 + 1e-9, 0.0)):
        values = {"mesh_efficiency": efficiency, "max_step": longest}
        module = advanced(averaged(compiled, values, omega1=50.0, omega_out_start=20.0), 0.01)
        means.append([module["omega_out"], module["output_torque_mean"], module["energy_lost_mesh"]])
    assert means[1] == pytest.approx(means[0], rel=1e-5)


def test_journals_without_slip_lock_the_output_to_link_1(compiled):
    module = advanced(started(compiled, fidelity=1, omega1=50.0, journal_friction=10.0), 0.05)
    assert module["omega_out"] == 50.0
    assert module["energy_residual"] == pytest.approx(0.0, abs=1e-4 * module["energy_in"])


def under_torque(kernel, values, fidelity, speed, torque):
    """Return the module after 60 s at a constant output speed, and the mean speed of link 1."""
    held = {"drive": 1, "fidelity": fidelity, "output_inertia": 1e5, "tolerance": 1e-7}
    start = {"omega1": 130.0, "omega_out_start": speed, "drive_torque": torque}
    module = advanced(started(kernel, values, held, start), 30.0)
    angle = input_angle(module)
    return advanced(module, 60.0), (input_angle(module) - angle) / 60.0


# Shape and losses, output speeds of one map, torque of link 1, tolerance.
UNDER_TORQUE = [
    *(
        (MECHANISMS[mechanism] | REALISTIC | {"input_inertia": inertia}, (10.0, 50.0), torque, 0.01)
        for mechanism, torque in (("bevel", 12.0), ("planar", 20.0))
        for inertia in (0.13, 1.0)
    ),
    *((alone(name) | {"input_inertia": 0.5}, (20.0,), 15.0, 0.005) for name in ALONE),
    # Without losses; the inertia of link 1 is below and above the inertia of the parts that rotate with it.
    *(
        (shape | {"input_inertia": share * interface_inertia(shape).maximum}, (10.0, 50.0), torque, 0.02)
        for shape, torque in ((MECHANISMS["bevel"], 12.0), (PLANAR, 20.0))
        for share in (5.0, 20.0)
    ),
]


@pytest.mark.parametrize("values, speeds, torque, bound", UNDER_TORQUE)
def test_torque_driven_speeds_agree_with_the_pulses(compiled, values, speeds, torque, bound):
    for speed in speeds:
        (means, omega1), (pulses, speed1) = (under_torque(compiled, values, f, speed, torque) for f in (1, 2))
        assert omega1 == pytest.approx(speed1, rel=bound)
        assert means["output_torque_mean"] == pytest.approx(pulses["output_torque_mean"], rel=bound)
        passed, taken = means["output_torque_mean"] * speed, pulses["output_torque_mean"] * speed
        assert passed / (torque * omega1) == pytest.approx(taken / (torque * speed1), abs=bound)
        assert means["mesh_torque_mean"] == pytest.approx(pulses["mesh_torque_mean"], abs=bound * torque)


@pytest.mark.parametrize("drive", [{}, {"drive": 1, "input_inertia": 0.5, "drive_torque": 15.0}], ids=str)
@pytest.mark.parametrize("name", ALONE)
def test_each_loss_has_its_account(compiled, name, drive):
    module = started(compiled, alone(name), drive, fidelity=1, omega1=60.0, omega_out_start=30.0)
    module.advance(0.1)
    assert module[f"energy_lost_{ALONE[name][1]}"] == module["energy_lost"] > 0.0


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_torque_driven_long_steps_agree_with_short_steps_until_rest(compiled, mechanism):
    machine = {**MECHANISMS[mechanism], **REALISTIC, "drive": 1, "fidelity": 1, "input_inertia": 0.13}
    heavy = {"output_inertia": 1e4, "drive_torque": 12.0, "omega_out_start": 30.0}
    ends = []
    for step in (0.01, 1.0, 12.0):
        module = advanced(started(compiled, machine, heavy), *[step] * round(12.0 / step))
        assert module["energy_residual"] == pytest.approx(0.0, abs=1e-4 * module["energy_in"])
        ends.append([module["input_speed"], module["omega_out"], module["energy_lost"]])
    assert ends[1] == pytest.approx(ends[0], rel=1e-4)
    assert ends[2] == pytest.approx(ends[0], rel=1e-4)
    module = started(compiled, machine, omega1=100.0)
    stored = module["energy_stored"]
    advanced(module, *[5.0] * 20)
    assert abs(module["input_speed"]) + module["omega_out"] < 0.01
    assert module["energy_lost"] == pytest.approx(stored, rel=5e-4)


def test_map_follows_losses_that_change_between_steps(compiled):
    scene = {"omega_out_start": 40.0, "omega1": 100.0}
    tuned = averaged(compiled, scene)
    ideal = tuned["output_torque"]
    advanced(tuned, 0.01, journal_friction=2e-3)
    other = averaged(compiled, scene, journal_friction=2e-3)
    assert other["output_torque"] > 1.05 * ideal
    other.advance(0.01)
    assert tuned["output_torque_mean"] == other["output_torque_mean"]
    assert tuned["energy_lost_journal"] == other["energy_lost_journal"] > 0.0
    assert averaged(compiled, scene)["output_torque"] == ideal


def stall_torque(values, omega1):
    """Return the stall torque of the machine without losses, N m."""
    rubs = re.compile(".*(efficiency|friction|drag).*")
    lossless = {name: value for name, value in values.items() if not rubs.fullmatch(name)}
    return of_map("compiled", lossless, omega1, 0.0)[0]


def errors(values, omega1, ratio):
    """Return torque errors over the stall torque, and efficiency errors at torques above 1/50 of it."""
    means, pulses = of_map("compiled", values, omega1, ratio), of_pulses("compiled", values, omega1, ratio)
    stall = stall_torque(values, omega1)
    return (
        abs(means[0] - pulses[0]) / stall,
        abs(means[1] - pulses[1]) / stall,
        abs(means[2] - pulses[2]) if pulses[0] > 0.02 * stall else 0.0,
    )


@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("shape, losses, omega1, ratio", TABLES["never_rests"]["rows"])
def test_mean_equals_the_steady_motion(shape, losses, omega1, ratio):
    torque, taken, efficiency = errors({**{**MECHANISMS, "heavy": HEAVY}[shape], **losses}, omega1, ratio)
    assert max(torque, taken) < 0.02
    assert efficiency < 0.01


def drawn(draw, number):
    """Return a random mechanism with losses, an input speed and a ratio."""
    planar = number % 4 == 3
    if planar:
        radii = {"sun_radius": draw.uniform(0.03, 0.2), "satellite_radius": draw.uniform(0.02, 0.1)}
        shape = {"layout": 1, **radii}
        shape["eccentricity"] = size = draw.uniform(0.3, 0.95) * shape["satellite_radius"]
        reach = shape["sun_radius"] + shape["satellite_radius"]
    else:
        shape = {name: draw.randint(12, 45) for name in ("z2", "z16", "z17", "z6")}
        shape |= {name: draw.uniform(0.4, 1.6) for name in "abc"}
        shape |= {name: draw.uniform(0.0, 6.28) for name in ("epsilon", "gamma")}
        shape["shaft_angle"] = draw.choice((0.5 * math.pi, draw.uniform(0.8, 2.2)))
        shape["wheel_radius"] = size = reach = draw.uniform(0.04, 0.25)
    shape["satellites"] = draw.randint(1, 4)
    shape["imbalance_mass"] = math.exp(draw.uniform(-2.0, 1.0))
    inertia = shape["imbalance_mass"] * shape["satellites"] * size * reach
    shape["input_inertia"] = inertia
    shape["link2_inertia"] = inertia * math.exp(draw.uniform(-4.0, 2.5))
    shape["drive_inertia"] = inertia * draw.choice((0.0, math.exp(draw.uniform(-5.0, -1.0))))
    omega1 = math.exp(draw.uniform(math.log(5.0), math.log(300.0))) * draw.choice((1, 1, 1, 1, -1))
    torque = 0.1 * inertia * omega1 * omega1
    viscous = ("drive_friction", "link2_friction", "housing_drag_viscous", "output_drag_viscous")
    losses = [
        {"mesh_efficiency": draw.uniform(0.92, 0.995)},
        {"journal_friction": 0.03 * size * math.exp(draw.uniform(-3.0, 0.0))},
        {name: torque * math.exp(draw.uniform(-5.0, -1.0)) for name in ("housing_drag", "output_drag")},
        {name: torque / abs(omega1) * math.exp(draw.uniform(-5.0, -1.5)) for name in viscous},
        {} if planar else {"satellite_mesh_efficiency": draw.uniform(0.93, 0.995)},
    ]
    kind = number // 4 % 6
    chosen = losses if kind == 5 or not losses[kind] else [losses[kind]]
    for loss in chosen:
        shape |= loss
    return shape, omega1, draw.uniform(0.0, 0.95)


@pytest.mark.usefixtures("compiled")
def test_random_machines_with_losses_have_the_torque_and_efficiency_of_their_pulses():
    draw = random.Random(15)
    seen = 0
    off = {}
    while seen < 64:
        values, omega1, ratio = drawn(draw, seen)
        try:
            Module("plain").check(**values)
        except InertiaModuleError:
            continue  # The meshes jam.
        seen += 1
        torque, _, efficiency = errors(values, omega1, ratio)
        if torque > 0.02 or efficiency > 0.01:
            off[seen] = torque, efficiency, omega1, ratio, values
    assert off == {}


def errors_below_balance(values, omega1, ratio):
    """Return the errors of both torques over the ideal stall torque or the friction, whichever is larger."""
    means, pulses = of_map("compiled", values, omega1, ratio), of_pulses("compiled", values, omega1, ratio)
    module = Module("compiled").start(**values)
    viscous = sum(module[name] for name in VISCOUS) + module.derived.k**2 * module["drive_friction"]
    friction = module["housing_drag"] + module["output_drag"] + viscous * abs(omega1)
    scale = max(stall_torque(values, omega1), friction)
    return abs(means[0] - pulses[0]) / scale, abs(means[1] - pulses[1]) / scale


@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("values, omega1, ratio", TABLES["kinks"]["rows"])
def test_mean_equals_the_pulses_where_they_begin_to_move_link_2(values, omega1, ratio):
    assert max(errors_below_balance(values, omega1, ratio)) < 0.02


@pytest.mark.usefixtures("compiled")
def test_random_machines_below_the_speed_at_which_friction_takes_the_stall_torque():
    draw = random.Random(77)
    off = {}
    number = machines = 0
    while machines < 16:
        number += 1
        values, direction, _ = drawn(draw, number)
        try:
            module = Module("compiled").start(**values, fidelity=1)
        except InertiaModuleError:
            continue  # The meshes jam.
        side = module.derived.forward if direction > 0.0 else module.derived.backward
        machines += side.v0 > 0.0
        for _ in range(4 if side.v0 > 0.0 else 0):
            omega1 = math.copysign(side.v0 * math.exp(draw.uniform(-3.5, 0.0)), direction)
            ratio = draw.uniform(0.02, 0.98) * min(side.end, 1.0)
            if max(errors_below_balance(values, omega1, ratio)) > 0.02:
                off[number] = omega1, ratio, values
    assert off == {}


@pytest.mark.parametrize("mechanism", MECHANISMS)
@pytest.mark.parametrize("losses", SLOW)
def test_a_machine_too_slow_for_its_friction_brakes_as_its_pulses_do(compiled, mechanism, losses):
    values = {**MECHANISMS[mechanism], **SLOW[losses]}
    slow = Module(compiled).start(**values, fidelity=1).derived.forward.v0
    for share, ratio in product((1.5, 9.0, 100.0), (0.1, 0.9)):
        omega1 = slow / share
        (means, *_, turned), (pulses, *_) = (
            of(compiled, values, omega1, ratio) for of in (of_map, of_pulses)
        )
        stall = stall_torque(values, omega1)
        assert means == pytest.approx(pulses, rel=0.05, abs=0.4 * stall)
        assert means < 0.0 or pulses > -0.1 * stall
        assert 0.0 <= turned <= ratio * (1.0 + 1e-9)


@pytest.mark.parametrize("mechanism", MECHANISMS)
@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("losses", CRAWLING)
def test_slow_links_balance_friction_and_drag(compiled, mechanism, direction, losses):
    values = {**MECHANISMS[mechanism], **CRAWLING[losses]}
    omega1 = direction * Module(compiled).start(**values, fidelity=1).derived.forward.v0 / 99.0
    means, pulses = (of(compiled, values, omega1, 0.9) for of in (of_map, of_pulses))
    assert means[0] == pytest.approx(pulses[0], rel=0.02)
    assert means[3] == pytest.approx(pulses[3], abs=0.02)


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_a_shaft_at_rest_is_pulled_away_when_link_1_is_fast_enough(compiled, mechanism):
    values = {**MECHANISMS[mechanism], **SLOW["viscous"], "output_inertia": 1e5}
    module = Module(compiled).start(**values, fidelity=1, omega1=30.0, load_torque=0.0)
    load = module["output_torque"]
    module = Module(compiled).start(**values, fidelity=1, omega1=0.0, load_torque=load)
    module.set_rates(omega1=20.0)
    module.advance(1.4)
    assert module["omega_out"] == 0.0
    module.set(omega1=28.0)
    module.set_rates(omega1=20.0)
    module.advance(1.0)
    assert module["omega_out"] > 0.0
