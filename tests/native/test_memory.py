"""Memory: nothing is lost, nothing is asked for while stepping, and an instance is small."""

import shutil

import pytest

from .conftest import OF_FMI_3, run

MOST_BYTES = 327680  # of an instance with a saved state: most of it the averaged map with losses
LIVES = 1000


def test_a_thousand_lives_leak_nothing(workshop):
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        pytest.skip("valgrind is not installed")
    program = workshop.build("leaks", "leaks.c", "host.c", "snapshot.c", flags=("-g",))
    checker = [valgrind, "--quiet", "--error-exitcode=9", "--leak-check=full", "--show-leak-kinds=all"]
    assert run([*checker, program, LIVES]) == f"{LIVES} instances lived\n"


@pytest.mark.parametrize("identifier", OF_FMI_3)
def test_random_calls_of_fmi_3_use_no_memory_that_is_not_theirs(workshops, identifier):
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        pytest.skip("valgrind is not installed")
    program = workshops(identifier).build("abuse3", "abuse3.c", "host.c", flags=("-g",))
    checker = [valgrind, "--quiet", "--error-exitcode=9", "--leak-check=full", "--show-leak-kinds=all"]
    assert "events" in run([*checker, program, 1, 20 * LIVES])


def test_the_kernel_keeps_within_its_arrays(workshop):
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        pytest.skip("valgrind is not installed")
    program = workshop.build("bounds", "bounds.c", "host.c", flags=("-g",))
    run([valgrind, "--quiet", "--error-exitcode=9", program])


def test_steps_and_values_ask_for_no_memory_and_an_instance_is_small(workshop):
    program = workshop.build("memory", "memory.c", "host.c", "snapshot.c")
    of_instance, with_state = map(int, run([program]).split())
    assert 0 < of_instance < with_state < MOST_BYTES
