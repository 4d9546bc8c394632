"""Test that Python and native FMU return the same for each call of FMI 2.0 in each phase."""

import ctypes
import math
from ctypes import byref, c_double, c_int, c_size_t, c_uint32, c_void_p

import pytest
from fmpy.fmi2 import fmi2OK

from inertia_module.interface.models import INERTIA_MODULE

from .conftest import R1

NATIVE, PYTHON = "InertiaModule", "InertiaModulePy"
INSTANTIATED, INITIALIZING, UNFIT, IN_ERROR, STEPPING, TERMINATED = PHASES = (
    *("instantiated", "initializing", "initializing, unfit", "in error", "stepping", "terminated"),
)
TYPES = {"Real": c_double, "Integer": c_int, "Boolean": c_int, "String": ctypes.c_char_p}
# Value references without a variable.
UNKNOWN = (INERTIA_MODULE.time.reference, 1000000, 2**32 - 1)


class Caller:
    """Calls the library of an instance like a C host, without the checks of FMPy."""

    def __init__(self, instance):
        self.instance, self.library = instance, instance.fmu.dll
        self.component = c_void_p(instance.fmu.component)
        self.state, self.freed = c_void_p(), c_void_p()

    def call(self, name, *arguments):
        function = self.library[f"fmi2{name}"]
        function.restype = c_int
        return function(self.component, *arguments)

    def bring_to(self, phase):
        """Bring the instance into a phase."""
        assert self.set("Real", **R1) == fmi2OK
        if phase == INSTANTIATED:
            return
        assert self.set_up() == self.call("EnterInitializationMode") == fmi2OK
        if phase in (UNFIT, IN_ERROR):
            assert self.set("Real", imbalance_mass=-1.0) == fmi2OK
        if phase not in (INITIALIZING, UNFIT):
            self.call("ExitInitializationMode")
        if phase in (STEPPING, TERMINATED):
            assert self.step(0.0, 0.1) == fmi2OK
        if phase == TERMINATED:
            assert self.call("Terminate") == fmi2OK

    def set_up(self, tolerance=None, begin=0.0, end=None):
        defined = tolerance is not None, end is not None
        return self.call(
            "SetupExperiment",
            *(c_int(defined[0]), c_double(tolerance or 0.0), c_double(begin)),
            *(c_int(defined[1]), c_double(end or 0.0)),
        )

    def step(self, time, length):
        return self.call("DoStep", c_double(time), c_double(length), c_int(1))

    def set(self, kind, **values):
        references = [self.instance.references[name] for name in values]
        return self.set_by(kind, references, list(values.values()))

    def set_by(self, kind, references, values):
        number = len(references)
        return self.call(
            f"Set{kind}",
            *((c_uint32 * number)(*references), c_size_t(number), (TYPES[kind] * number)(*values)),
        )

    def get(self, kind, *names):
        return self.get_by(kind, *(self.instance.references[name] for name in names))

    def get_by(self, kind, *references):
        number = len(references)
        values = (TYPES[kind] * number)()
        status = self.call(f"Get{kind}", (c_uint32 * number)(*references), c_size_t(number), values)
        return status, (list(values) if status == fmi2OK else None)

    def save(self, state):
        return self.call("GetFMUstate", byref(state))

    def free(self, state):
        return self.call("FreeFMUstate", byref(state))

    def size(self, state):
        size = c_size_t()
        return self.call("SerializedFMUstateSize", state, byref(size)), size.value

    def with_state(self, action):
        """Return the result of an action with a state of this instance and its serialised bytes."""
        state = c_void_p()
        assert self.save(state) == fmi2OK
        _, size = self.size(state)
        content = (ctypes.c_char * size)()
        assert self.call("SerializeFMUstate", state, content, c_size_t(size)) == fmi2OK
        return action(state, content, size)

    def after_free(self, action):
        """Return the result of an action with a freed state."""
        state = c_void_p()
        assert self.save(state) == fmi2OK
        freed = c_void_p(state.value)
        assert self.free(state) == fmi2OK
        return action(freed)

    def values(self):
        """Return the values of all variables by kind, or the status of the read call."""
        by_kind = {}
        for name, kind in self.instance.calls.items():
            by_kind.setdefault("Integer" if kind == "Enumeration" else kind, []).append(name)
        return [self.get(kind, *names) for kind, names in by_kind.items()]


def with_foreign(caller, action):
    """Return the result of an action with a pointer that is no state of this instance."""
    buffer = ctypes.create_string_buffer(4096)  # No state gets the address of the buffer.
    return action(c_void_p(ctypes.addressof(buffer)))


SMALL, LARGE = -1, 1000
CALLS = {
    # --- the life of an instance ---
    **{
        f"setupExperiment {arguments}": lambda c, arguments=arguments: c.set_up(*arguments)
        for arguments in (
            *((), (1e-5, 0.0, 1.0), (0.0,), (-1.0,), (math.nan,), (math.inf,), (None, math.nan)),
            *((None, math.inf), (None, -math.inf), (None, 1.0, 0.5), (None, 0.0, math.nan), (None, 2.0, 2.0)),
            (1.0,),  # This tolerance exceeds the maximum of the module.
        )
    },
    **{
        name: lambda c, name=name: c.call(name)
        for name in ("EnterInitializationMode", "ExitInitializationMode", "Terminate", "Reset")
    },
    "reset, then all again": lambda c: (c.call("Reset"), c.bring_to(STEPPING)),
    "the tolerance wins": lambda c: (
        *(c.set_up(1e-4), c.call("EnterInitializationMode"), c.get("Real", "tolerance")),
        *(c.set("Real", tolerance=1e-7), c.get("Real", "tolerance"), c.call("ExitInitializationMode")),
        c.get("Real", "tolerance"),
    ),
    # --- steps ---
    **{
        f"doStep {time} {length}": lambda c, time=time, length=length: c.step(time, length)
        for time, length in (
            *((0.1, 0.1), (0.1, 0.0), (0.1, -0.1), (0.1, math.nan), (0.1, math.inf), (0.1, 1e9)),
            *((math.nan, 0.1), (math.inf, 0.1), (-math.inf, 0.1)),
        )
    },
    "doStep past the stop time": lambda c: (
        *(c.set_up(None, 0.0, 0.3), c.call("EnterInitializationMode"), c.call("ExitInitializationMode")),
        *(c.step(0.0, 0.2), c.step(0.2, 0.2), c.step(math.inf, 0.1), c.step(math.nan, 0.1), c.step(0.2, 0.1)),
    ),
    "CancelStep": lambda c: c.call("CancelStep"),
    **{
        f"{call} {kind}": lambda c, call=call, kind=kind: c.call(call, c_int(kind), byref(c_double()))
        for call in ("GetStatus", "GetRealStatus", "GetIntegerStatus", "GetBooleanStatus", "GetStringStatus")
        for kind in (0, 1, 2, 3, 9)
    },
    "GetRealStatus NULL": lambda c: c.call("GetRealStatus", c_int(2), None),
    "GetBooleanStatus NULL": lambda c: c.call("GetBooleanStatus", c_int(3), None),
    # --- values ---
    **{
        f"reading {kind} {names}": lambda c, kind=kind, names=names: c.get(kind, *names)
        for kind, names in (
            *(("Real", ("omega_out",)), ("Real", ("drive_angle",)), ("Real", ("input_torque",))),
            *(("Real", ("omega1",)), ("Real", ("imbalance_mass", "tolerance"))),
            *(("Real", ("omega1", "omega_out")), ("Real", ("omega_out", "omega1"))),
            *(("Integer", ("z2",)), ("Integer", ("contact_mode",)), ("Integer", ("fidelity",))),
            *(("Boolean", ("output_freewheel",)), ("Boolean", ("z2",)), ("Integer", ("omega1",))),
            *(("Real", ("contact_mode",)), ("Real", ("omega1", "z2")), ("String", ("omega1",)), ("Real", ())),
        )
    },
    **{
        f"reading {kind} {reference}": lambda c, kind=kind, reference=reference: c.get_by(kind, reference)
        for kind in TYPES
        for reference in UNKNOWN
    },
    "reading all": lambda c: c.values(),
    "reading twice": lambda c: (c.get("Real", "omega_out"), c.get("Real", "omega_out")),
    **{
        f"{call}{kind} NULL {number}": lambda c, name=call + kind, number=number: c.call(
            name, None, c_size_t(number), None
        )
        for call in ("Get", "Set")
        for kind in TYPES
        for number in (0, 1)
    },
    **{
        f"setting {kind} {values}": lambda c, kind=kind, values=values: (
            *(c.set(kind, **values), c.get(kind, *values), c.values()),
        )
        for kind, values in (
            *(("Real", {"omega1": 50.0}), ("Real", {"load_torque": math.nan}), ("Real", {"omega1": 1e99})),
            *(("Real", {"balancer": 2.0}), ("Real", {"balancer": 11.0}), ("Real", {"balancer": math.nan})),
            *(
                ("Real", {"link2_inertia": 0.01}),
                ("Real", {"link2_inertia": -1.0}),
                ("Real", {"omega2": 1.0}),
            ),
            *(("Real", {"omega1": 5.0, "omega2": 1.0}), ("Real", {"omega1": 5.0, "balancer": 99.0})),
            *(("Real", {"tolerance": 1e-5}), ("Real", {"z2": 20.0}), ("Real", {})),
            *(("Integer", {"z2": 21}), ("Integer", {"z2": 0}), ("Integer", {"fidelity": 7})),
            *(("Integer", {"contact_mode": 1}), ("Integer", {"omega1": 1})),
            *(("Boolean", {"output_freewheel": 0}), ("Boolean", {"output_freewheel": 2})),
            *(("Boolean", {"output_freewheel": -1}), ("Boolean", {"z2": 1})),
            ("String", {"omega1": "Jürgen".encode("latin-1")}),
        )
    },
    **{
        f"setting {kind} {reference}": lambda c, kind=kind, reference=reference: c.set_by(
            kind, [reference], [b"" if kind == "String" else 1]
        )
        for kind in TYPES
        for reference in UNKNOWN
    },
    "setting, and a step of it": lambda c: (
        *(c.set("Real", omega1=80.0, balancer=0.5), c.step(0.1, 0.1), c.values()),
    ),
    "setting a value that no step accepts, and a step": lambda c: (
        *(c.set("Real", omega1=math.inf), c.step(0.1, 0.1), c.values()),
        *(c.set("Real", omega1=90.0), c.step(0.1, 0.1), c.values()),
    ),
    # --- states ---
    "saving": lambda c: c.save(c_void_p()),
    "saving NULL": lambda c: c.call("GetFMUstate", None),
    "saving over a state": lambda c: c.with_state(lambda state, *_: c.save(state)),
    "saving over a foreign pointer": lambda c: with_foreign(c, c.save),
    "saving over a freed state": lambda c: c.after_free(c.save),
    "restoring": lambda c: c.with_state(
        lambda state, *_: (c.step(0.1, 0.1), c.call("SetFMUstate", state), c.values())
    ),
    "restoring NULL": lambda c: c.call("SetFMUstate", None),
    "restoring a foreign pointer": lambda c: with_foreign(c, lambda state: c.call("SetFMUstate", state)),
    "restoring a freed state": lambda c: c.after_free(lambda state: c.call("SetFMUstate", state)),
    "restoring after a reset": lambda c: c.with_state(
        lambda state, *_: (c.call("Reset"), c.call("SetFMUstate", state), c.values(), c.step(0.1, 0.1))
    ),
    "freeing": lambda c: c.with_state(lambda state, *_: (c.free(state), state.value, c.free(state))),
    "freeing NULL": lambda c: c.call("FreeFMUstate", None),
    "freeing a foreign pointer": lambda c: with_foreign(c, c.free),
    "freeing a freed state": lambda c: c.after_free(c.free),
    "size of NULL": lambda c: c.call("SerializedFMUstateSize", None, byref(c_size_t())),
    "size into NULL": lambda c: c.with_state(lambda state, *_: c.call("SerializedFMUstateSize", state, None)),
    "size of a foreign pointer": lambda c: with_foreign(c, c.size),
    "size of a freed state": lambda c: c.after_free(c.size),
    **{
        f"serializing into {more:+} bytes": lambda c, more=more: c.with_state(
            lambda state, content, size: c.call(
                "SerializeFMUstate", state, (ctypes.c_char * (size + LARGE))(), c_size_t(size + more)
            )
        )
        for more in (0, SMALL, LARGE)
    },
    "serializing NULL": lambda c: c.call("SerializeFMUstate", None, (ctypes.c_char * 9)(), c_size_t(9)),
    "serializing into NULL": lambda c: c.with_state(
        lambda state, _, size: c.call("SerializeFMUstate", state, None, c_size_t(size))
    ),
    "deserializing": lambda c: c.with_state(
        lambda _, content, size: c.call("DeSerializeFMUstate", content, c_size_t(size), byref(c_void_p()))
    ),
    "deserializing over a state": lambda c: c.with_state(
        lambda state, content, size: (
            *(c.call("DeSerializeFMUstate", content, c_size_t(size), byref(state)), c.step(0.1, 0.1)),
            *(c.call("SetFMUstate", state), c.values(), c.free(state)),
        )
    ),
    "deserializing over a foreign pointer": lambda c: with_foreign(
        c,
        lambda foreign: c.with_state(
            lambda _, content, size: c.call("DeSerializeFMUstate", content, c_size_t(size), byref(foreign))
        ),
    ),
    "deserializing NULL": lambda c: c.call("DeSerializeFMUstate", None, c_size_t(9), byref(c_void_p())),
    "deserializing into NULL": lambda c: c.with_state(
        lambda _, content, size: c.call("DeSerializeFMUstate", content, c_size_t(size), None)
    ),
    # --- the log ---
    **{
        f"setDebugLogging {names}": lambda c, names=names: c.call(
            "SetDebugLogging", c_int(1), c_size_t(len(names)), (ctypes.c_char_p * len(names))(*names)
        )
        for names in ((), (b"logAll",), (b"logStatusError", b"logStatusDiscard"), (b"gossip",), (None,))
    },
    "setDebugLogging NULL": lambda c: c.call("SetDebugLogging", c_int(1), c_size_t(1), None),
}


@pytest.mark.parametrize("phase", PHASES)
def test_each_call_has_the_same_status_and_effect_in_both_fmus(instances_of, phase):
    different = {}
    for name, action in CALLS.items():
        answers = []
        for identifier in (NATIVE, PYTHON):
            caller = Caller(instances_of(identifier))
            caller.bring_to(phase)
            answers.append((action(caller), caller.values(), caller.step(0.1, 0.1), caller.values()))
        # NaN equals NaN in text.
        if repr(answers[0]) != repr(answers[1]):
            different[name] = [repr(answer)[:200] for answer in answers]
    assert different == {}
