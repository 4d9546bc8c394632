"""Whatever a host does, in whatever order: the freewheels hold, the energy audit closes."""

import math

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule
from scenes import started
from test_motions import assert_freewheels_hold

SPEEDS = st.one_of(st.sampled_from([0.0, 100.0, -100.0]), st.floats(-200.0, 200.0, allow_subnormal=False))
LOADS = st.one_of(st.sampled_from([0.0, 10.0, 1000.0]), st.floats(-50.0, 50.0))
FACTORS = st.one_of(st.just(1.0), st.floats(0.2, 2.0))
ANGLES = st.one_of(st.just(0.0), st.floats(-7.0, 7.0))
MECHANISMS = st.fixed_dictionaries(
    {
        "layout": st.sampled_from([0, 0, 1]),
        "satellites": st.integers(1, 4),
        "modules": st.integers(1, 3),
        "z17": st.integers(15, 60),
        "shaft_angle": st.floats(0.5, 2.5),
        "a": FACTORS,
        "b": FACTORS,
        "c": FACTORS,
        "epsilon": ANGLES,
        "gamma": ANGLES,
        "imbalance_mass": st.floats(0.1, 2.0),
        "drive_inertia": st.one_of(st.just(0.0), st.floats(1e-5, 1e-2)),
        "satellite_inertia": st.one_of(st.just(0.0), st.floats(1e-5, 1e-2)),
        "satellite_transverse_inertia": st.one_of(st.just(0.0), st.floats(1e-5, 1e-2)),
        "input_inertia": st.sampled_from([0.0, 0.1]),
        "link2_inertia": st.floats(1e-3, 0.1),
        "output_inertia": st.floats(1e-2, 10.0),
        "housing_freewheel": st.sampled_from([True, True, False]),
        "output_freewheel": st.sampled_from([True, True, False]),
        "drive_angle_start": ANGLES,
        "omega1": SPEEDS,
        "load_torque": LOADS,
        "tolerance": st.floats(-12.0, -4.0).map(lambda exponent: 10.0**exponent),
    }
)


class AnyHost(RuleBasedStateMachine):
    """Jumps, ramps, loads and steps in any order."""

    @initialize(mechanism=MECHANISMS)
    def start(self, mechanism):
        self.module = started("auto", mechanism)
        self.turnover = self.module["energy_stored"]
        self.fastest = abs(mechanism["omega1"])
        self.last = dict.fromkeys(("contact_switches", "rhs_evaluations"), 0.0)
        self.saved = None

    def advance(self, step):
        self.module.advance(step)
        values = self.module.snapshot()
        names = ("omega1", "omega2", "omega_out")
        self.fastest = max(self.fastest, *(abs(values[name]) for name in names))
        energies = ("energy_in", "energy_out", "energy_stored")
        self.turnover = max(self.turnover, *(abs(values[name]) for name in energies))

    @rule(omega1=SPEEDS, load=LOADS, exponent=st.floats(-9.0, -1.0))
    def jump(self, omega1, load, exponent):
        self.module.set(omega1=omega1, load_torque=load)
        self.advance(10.0**exponent)

    @rule(load=LOADS, exponent=st.floats(-9.0, -1.0))
    def change_load(self, load, exponent):
        self.module.set(load_torque=load)
        self.advance(10.0**exponent)

    @rule(exponent=st.floats(-9.0, -1.0), times=st.integers(1, 5))
    def go_on(self, exponent, times):
        for _ in range(times):
            self.advance(10.0**exponent)

    @rule(part=st.floats(-1e-9, 1e-9))
    def tremble(self, part):
        self.module.set(omega1=self.module["omega1"] * (1.0 + part))
        self.advance(1e-4)

    @rule()
    def save(self):
        self.saved = self.module.save(), dict(self.last)

    @precondition(lambda self: self.saved is not None)
    @rule()
    def go_back(self):
        saved, self.last = self.saved
        self.last = dict(self.last)
        self.module.restore(saved)

    @invariant()
    def every_value_is_finite(self):
        assert all(math.isfinite(value) for value in self.module.snapshot().values())

    @invariant()
    def freewheels_hold_and_only_push(self):
        torques = ("input_torque", "mesh_torque", "load_torque")
        tiny = 1e-9 * max(abs(self.module[name]) for name in torques) + 1e-11 * self.turnover + 1e-20
        assert_freewheels_hold(self.module, tiny)

    @invariant()
    def energy_audit_closes(self):
        module = self.module
        heaviest = max(self.turnover, module["output_inertia"] * self.fastest**2)
        assert abs(module["energy_residual"]) <= (300.0 * module["tolerance"] + 1e-12) * heaviest + 1e-20
        assert module["energy_lost"] == 0.0

    @invariant()
    def counters_only_grow(self):
        for name, value in self.last.items():
            assert self.module[name] >= value
            self.last[name] = self.module[name]


TestAnyHost = AnyHost.TestCase
TestAnyHost.settings = settings(stateful_step_count=12)
