"""Test the Python FMU in folders of any name, and in hosts in which pythonfmu alone crashes."""

import ctypes
import math
import os
from functools import partial
from operator import attrgetter
from pathlib import Path

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2CallbackLoggerTYPE, fmi2Discard, fmi2Error, fmi2OK

from inertia_module.fmi.instance import Fmu
from inertia_module.fmi.loading import Log, callbacks_of
from inertia_module.fmu import builder, python_fmu
from inertia_module.fmu.slave import HEADER_SIZE
from inertia_module.model import INVALID_STATE, Module
from tests.system.programs import process

from .conftest import R1

FLAVOURS = ("InertiaModulePy",)
FOLDERS = ["Jürgen Müller 日本 #3", "a%41b 100%25 100% off", "ends in %"]
# pythonfmu 0.7 writes to freed memory at the exit of the process: skip this exit.
DRIVE = """
import os, sys
for name in {blocked!r}:
    sys.modules[name] = None
from inertia_module.common.errors import FmuError
from inertia_module.fmi.instance import Fmu
try:
    fmu = Fmu({path!r}, inputs={{"omega1": 100.0, "load_torque": 10.0}}, tolerance=1e-9)
    fmu.advance(0.1)
    print(fmu.messages[0])
    print(fmu["omega_out"].hex(), flush=True)
except FmuError as error:
    print(error, flush=True)
os._exit(0)
"""


def drive(path, blocked=(), **environment):
    """Run the FMU in a process that lacks some modules; return the printed lines and fail after a crash."""
    code = DRIVE.format(path=str(path), blocked=list(blocked))
    return process("-c", code, **environment).stdout.splitlines()


def test_runs_its_compiled_kernel_or_plain_python(fmu_path, tmp_path):
    """Without a compiler, in a folder of any name, the results have the same bits."""
    cache = tmp_path / "cache"
    expected = drive(fmu_path, ("ziglang",), INERTIA_MODULE_CACHE=str(cache))
    assert expected[0] == "the kernel is compiled"
    assert [folder.name for folder in cache.iterdir()] == ["unpacked"]
    plain = drive(fmu_path, INERTIA_MODULE_KERNEL="plain")
    assert plain == ["the kernel is plain Python, as requested", expected[1]]
    assert float.fromhex(expected[1]) > 0.0
    for name in FOLDERS:
        (tmp_path / name).mkdir()
        assert drive(fmu_path, INERTIA_MODULE_CACHE=str(tmp_path / name)) == expected, name


def test_unknown_kernel_and_unreadable_folder_are_rejected(fmu_path, tmp_path):
    (message,) = drive(fmu_path, INERTIA_MODULE_KERNEL="fast")
    assert "kernel must be auto, compiled or plain (got 'fast')" in message
    (tmp_path / "50%20off").mkdir()
    (message,) = drive(fmu_path, INERTIA_MODULE_CACHE=str(tmp_path / "50%20off"))
    assert "the resource location must be the URI of this FMU's resources" in message
    assert "50%2520off" in message


def test_a_state_is_saved_when_the_folder_of_an_earlier_instance_is_gone(fmu_path):
    program = (
        "import sys\nfrom inertia_module.fmi.instance import Fmu\n"
        "for _ in range(2):\n"
        "    with Fmu(sys.argv[1], {}, {'omega1': 100.0}) as fmu:\n"
        "        fmu.advance(0.01)\n"
        "        kept = fmu.save() if _ else b''\n"
        "print(len(kept) > 1000)\n"
    )
    assert process("-c", program, fmu_path).stdout == "True\n"


def test_two_builds_run_in_a_process(monkeypatch, tmp_path, fmu_path):
    files = python_fmu.bundled_files()
    source = files["interface/variables.py"].decode()
    assert '"inertia J2 of link 2", 0.005' in source
    files["interface/variables.py"] = source.replace("0.005", "0.0075", 1).encode()
    monkeypatch.setattr(python_fmu, "bundled_files", lambda: files)
    path = tmp_path / "InertiaModulePy.fmu"
    path.write_bytes(builder.content_of(builder.PYTHON_FMU))
    with Fmu(fmu_path, inputs=R1) as first, Fmu(path, inputs=R1) as second:
        for each in (first, second):
            each.advance(0.1)
        assert (first["link2_inertia"], second["link2_inertia"]) == (0.005, 0.0075)
        assert first["omega_out"] != second["omega_out"]


def instantiated(description, folder, location, name=b"host", guid=None, logger=None):
    """Return an FMU with an instance or without one (component is None), and the log of the host."""
    fmu = FMU2Slave(
        guid=guid or description.guid,
        unzipDirectory=str(folder),
        modelIdentifier=description.modelName,
        instanceName="host",
    )
    log = Log()
    fmu.callbacks = callbacks_of(log)
    if logger is not None:
        fmu.callbacks.logger = logger
    arguments = (name, 1, fmu.guid.encode(), location, ctypes.byref(fmu.callbacks), 0, 1)
    fmu.component = fmu.fmi2Instantiate(*arguments)
    return fmu, log


@pytest.fixture
def location(unpacked):
    """Return the URI of the resources."""
    return (unpacked / "resources").as_uri().encode()


def messages_at(location, description, folder):
    """Return the message to a host that gives this location of the resources; None without an error."""
    fmu, log = instantiated(description, folder, location)
    if fmu.component:
        fmu.fmi2FreeInstance(fmu.component)
        return None
    (message,) = log.messages
    return message


@pytest.fixture(params=["plain", "Jürgen 100%"])
def moved(request, unpacked, tmp_path):
    """Return the FMU unpacked, reached through a link from a folder of another name."""
    link = tmp_path / request.param
    link.symlink_to(unpacked, target_is_directory=True)
    return link


@pytest.mark.parametrize(
    "form",
    [
        lambda folder: folder.as_uri(),
        lambda folder: folder.as_uri().replace("file://", "file:"),
        lambda folder: folder.as_uri().replace("file://", "file://localhost"),
        lambda folder: folder.as_uri().replace("file://", "FILE://LocalHost"),
        lambda folder: folder.as_uri().replace("file://", "FILE:"),
        lambda folder: folder.as_uri().replace("file", "File"),
        lambda folder: f"{folder.as_uri()}/",
        lambda folder: f"file://{folder}",
        lambda folder: "file://" + "".join(f"%{byte:02x}" if byte != 47 else "/" for byte in bytes(folder)),
        str,
    ],
    ids=[
        *("uri", "no authority", "localhost", "LocalHost", "FILE, no authority", "File", "slash at the end"),
        *("not encoded", "all encoded", "path"),
    ],
)
def test_resource_location_is_accepted_in_all_forms(description, moved, form):
    assert messages_at(form(moved / "resources").encode(), description, moved) is None


@pytest.mark.parametrize(
    "location",
    [
        *(None, b"", b"file:///no/such/folder", b"http://example.org/%zz", b"%", b"file:" * 2000),
        *(b"f", b"FILE", b"file:", b"file://", b"file:///%FC", b"files:///tmp"),
    ],
)
def test_invalid_resource_location_is_rejected(description, unpacked, location):
    message = messages_at(location, description, unpacked)
    assert message.startswith("the resource location must be the URI of")


# Latin-1, a lone surrogate, a text longer than a file name, formats of printf.
NAMES = {
    "Latin-1": b"J\xfcrgen",
    "no text": b"\xff\xfe\xed\xa0\x80",
    "long": b"x" * 100_000,
    "format": b"%s%n%d",
}


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES)
def test_instance_name_in_any_encoding_is_part_of_messages(description, unpacked, location, name):
    names = []
    logger = fmi2CallbackLoggerTYPE(lambda environment, instance, *message: names.append(instance))
    fmu, _ = instantiated(description, unpacked, location, name, logger=logger)
    fmu.enterInitializationMode()
    with pytest.raises(FMICallException):
        fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    fmu.doStep(0.0, 0.1)
    fmu.fmi2FreeInstance(fmu.component)
    # The kernel and the call out of order each write a message.
    assert names == 2 * [name]


def test_an_fmu_of_another_build_is_not_instantiated(description, unpacked, location):
    fmu, log = instantiated(description, unpacked, location, guid="{of-another-build}")
    assert fmu.component is None
    assert log.messages == ["the GUID must match modelDescription.xml: import the FMU again"]


def test_log_contains_the_enabled_categories(fmu_path):
    with Fmu(fmu_path, inputs={"omega1": 100.0}) as fmu:
        assert fmu.messages == ["the kernel is compiled"]
        fmu.set_logging(False, "logStatusDiscard")
        fmu.messages.clear()
        fmu.set(omega1=float("nan"))
        with pytest.raises(Exception, match=f"status {fmi2Discard}"):
            fmu.advance(0.1)
        assert fmu.messages == []


# Numbers of the kernel's records that are an index or a choice.
CHOICES = [
    *(("parameters", "fidelity"), ("parameters", "layout"), ("parameters", "method")),
    ("state", "mode"),
]


def test_a_forged_number_of_a_state_is_no_index_and_no_choice(instance):
    instance.start(omega1=100.0, fidelity=1, load_torque=10.0)
    memory = Module()
    for record, name in CHOICES:
        instance.step(0.1)
        before, good = instance.all_values(), instance.saved()
        for value in (-1.0, 0.5, 65.0, 1e9, -1e9, 1e300, math.nan, math.inf):
            memory.restore(good[HEADER_SIZE:])
            setattr(attrgetter(record)(memory), name, value)
            forged = good[:HEADER_SIZE] + memory.save()
            message = instance.rejection(lambda state=forged: instance.restore(state))
            assert "must be saved by this build (it is damaged" in message, f"{name} = {value}"
            assert instance.all_values() == before, f"{name} = {value}"
        assert not instance.is_discarded(0.1), name


def test_forged_or_early_state_is_rejected_without_effect(instances):
    fresh, running = instances(), instances().start(omega1=100.0)
    for state, byte, value, words in (
        *((running.saved(), *forged, INVALID_STATE) for forged in ((0, 5), (0, 255), (17, 200), (20, 255))),
        (fresh.saved(), 0, 2, "must be saved after the start"),  # a forged flag: initialised
    ):
        changed = bytes([*state[:byte], value, *state[byte + 1 :]])
        assert running.rejection(partial(running.restore, changed)).endswith(words)
        assert not running.is_discarded(0.1)


def test_restored_state_of_initialization_mode_is_evaluated_again(instance):
    instance.fmu.setupExperiment()
    instance.set(omega1=50.0)
    instance.fmu.enterInitializationMode()
    early = instance.fmu.getFMUstate()
    instance.set(omega1=80.0)
    assert instance.get("input_speed") == 80.0
    instance.fmu.setFMUstate(early)
    assert instance.get("input_speed") == 50.0


def memory_in_use():
    """Return the memory in use of this process, bytes."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


has_statm = pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="there is no /proc")


@has_statm
def test_saving_and_deserialising_over_a_state_takes_no_more_memory(instance):
    """A state has 100 kB: 2,000 leaked states would take 200 MB."""
    instance.start(omega1=100.0)
    library, component = instance.fmu.dll, ctypes.c_void_p(instance.fmu.component)
    state, size = ctypes.c_void_p(), ctypes.c_size_t()
    assert library.fmi2GetFMUstate(component, ctypes.byref(state)) == fmi2OK
    assert library.fmi2SerializedFMUstateSize(component, state, ctypes.byref(size)) == fmi2OK
    content, first = (ctypes.c_char * size.value)(), state.value
    before = memory_in_use()
    for _ in range(1000):
        assert library.fmi2GetFMUstate(component, ctypes.byref(state)) == fmi2OK
        assert library.fmi2SerializeFMUstate(component, state, content, size) == fmi2OK
        assert library.fmi2DeSerializeFMUstate(component, content, size, ctypes.byref(state)) == fmi2OK
        assert library.fmi2SetFMUstate(component, state) == fmi2OK
    assert memory_in_use() - before < 20e6
    assert state.value == first


@has_statm
def test_states_are_freed_with_their_instance(description, unpacked, location):
    before = memory_in_use()
    for _ in range(20):
        fmu, _ = instantiated(description, unpacked, location)
        for _ in range(100):
            fmu.getFMUstate()
        fmu.fmi2FreeInstance(fmu.component)
    assert memory_in_use() - before < 20e6


def test_a_state_of_another_instance_is_an_error(instances):
    first, second = (instances().start(omega1=100.0) for _ in range(2))
    state = second.fmu.getFMUstate()
    words = "a state must be saved by this instance and not yet freed"
    uses = (first.fmu.setFMUstate, first.fmu.serializeFMUstate, first.fmu.freeFMUstate)
    assert [first.rejection(partial(use, state)) for use in uses] == 3 * [words]
    second.fmu.setFMUstate(state)


def test_state_is_freed_only_once(instance):
    instance.start(omega1=100.0)
    instance.step(0.1)
    library, component = instance.fmu.dll, instance.fmu.component
    state = ctypes.c_void_p()
    for _ in range(100):
        assert library.fmi2GetFMUstate(ctypes.c_void_p(component), ctypes.byref(state)) == fmi2OK
        assert state.value
        for _ in range(3):
            assert library.fmi2FreeFMUstate(ctypes.c_void_p(component), ctypes.byref(state)) == fmi2OK
            assert state.value is None
    assert library.fmi2FreeFMUstate(ctypes.c_void_p(component), None) == fmi2OK
    assert not instance.is_discarded(0.1)


KINDS = ("Real", "Integer", "Boolean")


@pytest.mark.parametrize("call", [f"{call}{kind}" for call in ("Get", "Set") for kind in KINDS])
def test_null_pointers_are_rejected_and_the_instance_continues(instance, call):
    instance.start(omega1=100.0)
    instance.step(0.1)
    before = instance.all_values()
    function, component = instance.fmu.dll[f"fmi2{call}"], ctypes.c_void_p(instance.fmu.component)
    assert function(component, None, ctypes.c_size_t(1), None) == fmi2Error
    assert instance.log.errors == [f"fmi2{call} requires arguments that are not NULL"]
    assert instance.all_values() == before
    assert not instance.is_discarded(0.1)
    assert function(component, None, ctypes.c_size_t(0), None) == fmi2OK
