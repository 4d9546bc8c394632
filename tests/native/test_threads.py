"""Instances know nothing of each other: in threads they compute what they do alone."""

from inertia_module.compiling.targets import LINUX64

from .conftest import run


def test_eight_threads_give_the_bits_of_one(workshop):
    program = workshop.build_for(
        LINUX64, "threads", "threads.c", "host.c", "snapshot.c", flags=("-O2", "-lpthread")
    )
    assert run([program, 8, 250]) == "8 threads, 250 instances each: the bits of one thread\n"


def test_no_thread_touches_what_another_uses(workshop):
    flags = ("-fsanitize=thread", "-g")
    program = workshop.build(
        "races", "threads.c", "host.c", "snapshot.c", flags=flags, libraries=("-lpthread",)
    )
    run([program, 8, 30], TSAN_OPTIONS="halt_on_error=1")
