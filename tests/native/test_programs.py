"""Test C programs with the shell: random calls, memory, threads, locales."""

import os
import shutil
import subprocess
from dataclasses import replace

import pytest

from .conftest import OF_FMI_3, SANITIZERS, Workshop, run

# A variable of the environment sets the number of calls per seed.
CALLS = int(os.environ.get("INERTIA_MODULE_ABUSE_CALLS", "200000"))
# Modes of a host by the version of FMI (see fmi2_by_3.c).
MODES = {2: ("",), 3: ("", "event", "early", "update")}
SEEDS = os.environ.get("INERTIA_MODULE_ABUSE_SEEDS", "1").split(",")
FILES = (
    *("abuse.c", "abuse_arguments.c", "abuse_life.c", "abuse_states.c", "abuse_values.c"),
    *("host.c", "snapshot.c"),
)
GAP = 4  # Value reference of the last variable before a gap.
MAX_BYTES = 131072  # Limit for an instance with a saved state.
N_LIVES = 420  # 3 · 4 · 5 · 7: all combinations of the periods of the actions


@pytest.fixture
def checked():
    """Return a function that runs a program under valgrind and returns its output."""
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        pytest.skip("valgrind is not installed")
    checker = [valgrind, "--quiet", "--error-exitcode=9", "--leak-check=full", "--show-leak-kinds=all"]
    return lambda *command: run([*checker, *command])


@pytest.fixture(scope="session")
def comma(tmp_path_factory):
    """Return the environment of a locale with decimal commas."""
    folder = tmp_path_factory.mktemp("locales")
    tool = shutil.which("localedef")
    command = [tool, "--no-archive", "-i", "de_DE", "-f", "UTF-8", str(folder / "comma")]
    if tool is None or subprocess.run(command, capture_output=True, check=False).returncode != 0:
        pytest.skip("no locale with a decimal comma can be made (Debian: locales)")
    return {"LOCPATH": str(folder), "LC_ALL": "comma"}


@pytest.mark.parametrize("seed", SEEDS)
def test_random_calls_pass_the_sanitizers_and_leave_no_files(workshop, seed):
    program = workshop.build("abuse", *FILES, flags=SANITIZERS)
    modes = MODES[workshop.fmu.fmi]
    calls = CALLS // len(modes)
    for mode in modes:
        printed = run([program, seed, calls], ASAN_OPTIONS="detect_leaks=1", FMI3=mode)
        assert printed.startswith(f"{calls} calls")


@pytest.mark.parametrize("identifier", OF_FMI_3)
@pytest.mark.parametrize("seed", SEEDS)
def test_random_calls_of_fmi_3_in_any_order_pass_the_sanitizers(workshops, identifier, seed):
    program = workshops(identifier).build("abuse3", "abuse3.c", "host.c", flags=SANITIZERS)
    assert "error" in run([program, seed, CALLS], ASAN_OPTIONS="detect_leaks=1")


def test_rare_rejections(workshop):
    run([workshop.build("rejections", "rejections.c", "host.c", "snapshot.c", flags=SANITIZERS)])


def test_unused_value_reference_is_a_harmless_error(representative_workshop, tmp_path):
    """A row after the time, which exists only in FMI 3.0, leaves unused value references."""
    model = representative_workshop.fmu.model

    def moved(variable):
        return replace(variable, reference=variable.reference + (variable.reference > GAP))

    variables = tuple(moved(variable) for variable in model.variables)
    changed = replace(model, variables=variables, time=moved(model.time))
    workshop = Workshop(representative_workshop.fmu._replace(model=changed), tmp_path)
    run([workshop.build("gap", "gap.c", "host.c", flags=SANITIZERS), GAP + 1])
    run([workshop.build("rejections", "rejections.c", "host.c", "snapshot.c", flags=SANITIZERS)])
    run([workshop.build("abuse", *FILES, flags=SANITIZERS), 1, CALLS // 10])


def test_forged_states_access_only_their_memory(representative_workshop):
    """A checksum stops no forgery. Indices and choices are checked when a state is deserialised."""
    run([representative_workshop.build("forged", "forged.c", "host.c", "snapshot.c", flags=SANITIZERS)])


def test_hundreds_of_life_cycles_leak_no_memory(representative_workshop, checked):
    program = representative_workshop.build("leaks", "leaks.c", "host.c", "snapshot.c", flags=("-g",))
    assert checked(program, N_LIVES) == f"{N_LIVES} instances lived\n"


@pytest.mark.parametrize("identifier", OF_FMI_3)
def test_random_calls_of_fmi_3_use_only_their_memory(workshops, identifier, checked):
    program = workshops(identifier).build("abuse3", "abuse3.c", "host.c", flags=("-g",))
    assert "events" in checked(program, 1, 20000)


def test_kernel_stays_within_its_arrays(representative_workshop, checked):
    checked(representative_workshop.build("bounds", "bounds.c", "host.c", flags=("-g",)))


def test_steps_and_values_allocate_no_memory_and_instances_are_small(workshop):
    program = workshop.build("memory", "memory.c", "host.c", "snapshot.c")
    of_instance, with_state = map(int, run([program]).split())
    assert 0 < of_instance < with_state < MAX_BYTES


def test_eight_threads_give_the_bits_of_a_single_thread(representative_workshop):
    files = ("threads.c", "host.c", "snapshot.c")
    program = representative_workshop.build("threads", *files, flags=("-O2",), libraries=("-lpthread",))
    assert run([program, 8, 250]) == "8 threads, 250 instances each: the bits of one thread\n"


def test_threads_share_no_memory(representative_workshop):
    flags = ("-fsanitize=thread", "-g")
    program = representative_workshop.build(
        "races", "threads.c", "host.c", "snapshot.c", flags=flags, libraries=("-lpthread",)
    )
    run([program, 8, 30], TSAN_OPTIONS="halt_on_error=1")


def test_messages_contain_the_same_numbers_in_every_locale(representative_workshop, comma):
    program = representative_workshop.build("locales", "locales.c", "host.c")
    tolerance, begin, speed = run([program], **comma).splitlines()
    variable = representative_workshop.fmu.model.variables[0]
    assert tolerance == "tolerance must be a positive number (got -1.5)"
    assert begin == "start time must be a finite number of seconds (got nan)"
    assert speed == f"{variable.name} must be {variable.allowed} (got 1234567.5)"
