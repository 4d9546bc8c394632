"""The kernel in the page computes what the native FMU computes, and says what that says."""

import numpy as np
import pytest

from inertia_module.contract.variables import LOCAL, OUTPUT, with_causality
from inertia_module.harness.fmu import Fmu, FmuError
from tests.unit.scenes import DRIVEN, ELASTIC, SCENES

INPUTS = ("omega1", "load_torque", "drive_torque")
READ = [variable.name for variable in with_causality(OUTPUT, LOCAL)]
LOSSES = {
    **{"mesh_efficiency": 0.98, "satellite_mesh_efficiency": 0.98, "journal_friction": 2e-5, "gravity": 9.81},
    **{"housing_drag": 0.3, "output_drag": 0.3, "input_friction": 2e-3, "output_friction": 2e-3},
}
LEVELS = {
    "kinematic": {"fidelity": 0, "kinematic_ratio": 0.4},
    "averaged": {"fidelity": 1},
    "rigid": {"fidelity": 2},
    "elastic": ELASTIC,
    "fixed steps": {"fidelity": 2, "method": 1, "max_step": 1e-4},
    "losses": LOSSES,
}
# each level with a layout driven by speed and the other one driven by torque
CASES = {
    f"{level}, {layout}, {drive}": {**scenes[layout], **values}
    for n, (level, values) in enumerate(LEVELS.items())
    for drive, scenes, layout in (
        ("speed", SCENES, ("bevel", "planar")[n % 2]),
        ("torque", DRIVEN, ("planar", "bevel")[n % 2]),
    )
    if (level, drive) != ("kinematic", "torque")
}
STEP, STEPS = 1e-3, 200


def options(values):
    """What simulate takes, from parameters and inputs in one."""
    parameters = {name: float(value) for name, value in values.items() if name not in INPUTS}
    inputs = {name: values[name] for name in INPUTS if name in values}
    return {"parameters": parameters, "inputs": inputs, "step": STEP, "steps": STEPS, "outputs": READ}


def native(built, given):
    """The same run in the native FMU: rows of READ."""
    with Fmu(built / "InertiaModule.fmu", given["parameters"], given["inputs"]) as fmu:
        rows = [fmu.read(READ)]
        for _ in range(given["steps"]):
            fmu.advance(given["step"])
            rows.append(fmu.read(READ))
    return dict(zip(READ, np.array(rows).T, strict=True))


@pytest.mark.parametrize("case", CASES)
def test_simulate_is_the_native_fmu_in_every_output(still, built, case):
    given = options(CASES[case])
    expected, found = native(built, given), still.simulate(given)
    assert found["time"] == pytest.approx([n * STEP for n in range(STEPS + 1)], abs=0.0, rel=1e-15)
    off = {
        name: np.abs(np.array(found[name]) - values).max() / max(np.abs(values).max(), 1.0)
        for name, values in expected.items()
    }
    assert {name: error for name, error in off.items() if not error <= 1e-9} == {}


BAD = {
    "out of range": {"tolerance": 7.0, "a": -1.0},
    "no number": {"imbalance_mass": float("nan")},
    "no whole teeth": {"z2": 0},
    "together": {"link2_inertia": 0.0, "imbalance_mass": 1e-9},
    "a bad start": {"omega2_start": -3.25},
    "an input": {"omega1": 1e300},
    "an input that is tiny elsewhere": {"load_torque": -1.25e-7, "drive_torque": float("inf")},
}


def test_bad_value_gives_the_sentence_of_the_native_fmu(still, built):
    for case, values in BAD.items():
        given = options(values)
        with pytest.raises(FmuError) as refused:
            native(built, given)
        assert still.simulate(given) == str(refused.value), case


INTEGRATE = """request => new Promise(done => {
  let calls = 0;
  window.inertiaModule.integrate(request, run => {
    calls++;
    if (run.complete || run.refusal !== null) {
      const columns = Object.entries(run.columns).map(([name, array]) => [name, [...array]]);
      done({ ...run, columns: Object.fromEntries(columns), time: [...run.time], calls });
    }
  });
})"""
# up to speed and, by a jump, to another load
OVER_TIME = {
    "omega1": {"times": [0.0, 0.05, 0.2], "values": [0.0, 20.0, 120.0]},
    "load_torque": {"times": [0.0, 0.1, 0.1, 0.3], "values": [2.0, 2.0, 12.0, 8.0]},
}


def over_time(signal, time):
    """Value of a signal just after a time, and its rate until the next point."""
    times, values = signal["times"], signal["values"]
    at = np.searchsorted(times, time, side="right")
    if at in (0, len(times)):
        return values[0 if at == 0 else -1], 0.0
    rate = (values[at] - values[at - 1]) / (times[at] - times[at - 1])
    return values[at - 1] + rate * (time - times[at - 1]), rate


def test_inputs_over_time_are_straight_lines_as_the_fmu_takes_them(still, built):
    steps = 400  # beyond the last point
    found = still.simulate({**options({}), "inputs": OVER_TIME, "steps": steps})
    start = {name: over_time(signal, 0.0)[0] for name, signal in OVER_TIME.items()}
    with Fmu(built / "InertiaModule.fmu", {}, start) as fmu:
        rows = [fmu.read(READ)]
        for n in range(steps):
            now = {name: over_time(signal, n * STEP) for name, signal in OVER_TIME.items()}
            fmu.set(**{name: value for name, (value, _) in now.items()})
            fmu.set_rates(**{name: rate for name, (_, rate) in now.items()})
            fmu.advance(STEP)
            rows.append(fmu.read(READ))
    for name, values in zip(READ, np.array(rows).T, strict=True):
        assert found[name] == pytest.approx(values, rel=1e-9, abs=1e-9 * max(np.abs(values).max(), 1.0)), name


def test_integrate_is_simulate_in_slices_with_angles_whole(still):
    given = options(SCENES["planar"])
    request = {**given, "duration": 2.0}
    run = still.page.evaluate(INTEGRATE, request)
    at_once = still.simulate({**given, "steps": 2000})
    assert run["complete"]
    assert run["calls"] > 1
    assert run["time"] == at_once["time"]
    assert {name: run["columns"][name] for name in READ} == {name: at_once[name] for name in READ}
    turned = np.array(at_once["drive_angle"]) + 2.0 * np.pi * np.array(at_once["drive_turns"])
    assert run["columns"]["q"] == pytest.approx(turned, rel=1e-15)


def test_run_that_is_refused_on_its_way_keeps_what_it_has(still):
    given = options({"load_torque": 10.0})
    given["inputs"]["omega1"] = {"times": [0.0, 0.0105, 0.0105], "values": [100.0, 100.0, 1e300]}
    run = still.page.evaluate(INTEGRATE, {**given, "duration": 1.0})
    assert not run["complete"]
    assert len(run["time"]) == len(run["columns"]["omega2"]) == 12
    assert run["refusal"] == still.simulate(given)
    assert run["refusal"].startswith("omega1 must be between ")


def test_warnings_are_those_of_the_native_fmu(still, built):
    given = options({"layout": 1, "eccentricity": 0.05, "satellites": 12, "omega1": 10.0})
    run = still.page.evaluate(INTEGRATE, {**given, "duration": 0.01})
    with Fmu(built / "InertiaModule.fmu", given["parameters"], given["inputs"]) as fmu:
        assert run["warnings"] == fmu.warnings
    assert len(run["warnings"]) == 2


def test_thousand_instances_take_the_memory_of_one(still):
    """Instances are given back, also those that are refused."""
    used = """([good, bad]) => {
      const { simulate } = window.inertiaModule;
      for (let n = 0; n < 1000; n++) {
        simulate(good);
        try { simulate(bad); } catch { /* refused */ }
      }
      return simulate(good).omega_out.at(-1);
    }"""
    good = {**options({"omega1": 100.0}), "steps": 2, "outputs": ["omega_out"]}
    bad = {**good, "parameters": {"tolerance": 7.0}}
    assert still.page.evaluate(used, [good, bad]) == still.simulate(good)["omega_out"][-1]
