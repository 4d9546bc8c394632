"""Hosts that call in any order with anything: the shell survives them, and refuses without a trace."""

import os

import pytest

from .conftest import OF_FMI_3, SANITIZERS, run

# a million calls a seed where the environment asks for them, else what a test has the time for
CALLS = int(os.environ.get("INERTIA_MODULE_ABUSE_CALLS", "200000"))
# how a host drives an FMU, by the version of FMI (see fmi2_by_3.c)
MODES = {2: ("",), 3: ("", "event", "early", "update")}
SEEDS = os.environ.get("INERTIA_MODULE_ABUSE_SEEDS", "1").split(",")
FILES = (
    *("abuse.c", "abuse_arguments.c", "abuse_life.c", "abuse_states.c", "abuse_values.c"),
    *("host.c", "snapshot.c"),
)


@pytest.mark.parametrize("seed", SEEDS)
def test_random_calls_are_survived_under_sanitizers_and_leave_no_trace(workshop, seed):
    program = workshop.build("abuse", *FILES, flags=SANITIZERS)
    modes = MODES[workshop.fmu.fmi]
    calls = CALLS // len(modes)
    for mode in modes:
        printed = run([program, seed, calls], ASAN_OPTIONS="detect_leaks=1", FMI3=mode)
        assert printed.startswith(f"{calls} calls")


@pytest.mark.parametrize("identifier", OF_FMI_3)
@pytest.mark.parametrize("seed", SEEDS)
def test_random_calls_of_fmi_3_in_any_order_are_survived(workshops, identifier, seed):
    program = workshops(identifier).build("abuse3", "abuse3.c", "host.c", flags=SANITIZERS)
    assert "error" in run([program, seed, CALLS], ASAN_OPTIONS="detect_leaks=1")


def test_refusals_that_random_calls_seldom_meet(workshop):
    run([workshop.build("refusals", "refusals.c", "host.c", "snapshot.c", flags=SANITIZERS)])


def test_forged_states_reach_no_memory_beyond_their_own(workshop):
    """A sum of bytes keeps nobody out: what is an index or a choice is checked when a state is read in."""
    run([workshop.build("forged", "forged.c", "host.c", "snapshot.c", flags=SANITIZERS)])
