import importlib.util
import os

import pytest
from hypothesis import settings

# the same examples each run; `pytest --hypothesis-profile=search` looks for new ones
settings.register_profile("same", max_examples=40, deadline=None, derandomize=True, database=None)
settings.register_profile("few", settings.get_profile("same"), max_examples=8)
settings.register_profile("search", max_examples=400, deadline=None)
settings.load_profile("same")
# what takes long, by name of the test or of one case of it: left to `make test-long`
LONG = frozenset(
    {
        "test_axe_finds_no_serious_fault",
        "test_a_point_that_ends_its_workers_is_refused_alone_and_nobody_elsewhere_can_reach_them",
        "test_coupling_tends_to_the_one_piece_reference[bevel-5.0-0.0001]",
        "test_imbalance_is_drawn_where_the_kernel_has_it",
        "test_intervals_are_as_wide_as_the_values_scatter",
        "test_kernel_alone_is_linked_for_every_platform",
        "test_level_has_the_losses_that_the_page_tells[averaged]",
        "test_first_picture_and_frames_are_quick",
        "test_fmusim_finds_the_results_that_an_fmu_carries_along",
        "test_margins_of_the_speed_control_are_those_of_the_full_model",
        "test_noise_on_sensor_and_load_leaves_the_car_within_the_tolerances_of_the_cycle",
        "test_nothing_hangs_over_in_any_font_and_the_theme_can_be_switched",
        "test_random_machines_with_losses_have_the_torque_and_efficiency_of_their_pulses",
        "test_run_is_played_as_it_was_recorded",
        "test_tutorial_shows_pictures_and_tables",
        "test_what_is_carried_along_is_what_the_reference_gives_today",
        "test_what_the_data_tell_together_alone_is_warned_of",
        "test_what_was_found_stays_mended[True-1-1064]",
        "test_what_was_found_stays_mended[True-1-1300]",
        "test_what_was_found_stays_mended[True-1-487]",
        "test_work_without_end_is_an_error_and_no_hang",
    }
)
# whole files: other hosts, valgrind, sanitizers, Wine and QEMU, every page of the site
LONG_FILES = ("tests/native/", "tests/system/test_hosts.py", "tests/system/test_site.py")
# tests/planted_changes.py asks for that: nothing is translated
ONLY_PLAIN = os.environ.get("INERTIA_MODULE_KERNEL") == "plain"


@pytest.fixture(scope="session")
def compiled():
    """The fast kernel, for what would take the plain one too long."""
    if ONLY_PLAIN:
        return "plain"
    if importlib.util.find_spec("numba") is None:
        pytest.skip("numba is not installed")
    return "compiled"


@pytest.fixture(scope="session")
def built(tmp_path_factory):
    """Folder with all FMUs, the native ones for this platform alone: that takes half the time."""
    from inertia_module.fmu.builder import build
    from tests.ready import HERE

    folder = tmp_path_factory.mktemp("build")
    assert not build(folder, targets=HERE).skipped
    return folder


@pytest.fixture(scope="session")
def fmu(built):
    """The FMU of the module."""
    return built / "InertiaModule.fmu"


@pytest.fixture(scope="session")
def built_for_all(tmp_path_factory):
    """Folder with all FMUs for every platform: a test that asks for it is slow."""
    from inertia_module.fmu.builder import build

    folder = tmp_path_factory.mktemp("build_for_all")
    assert not build(folder).skipped
    return folder


def pytest_collection_modifyitems(items):
    """Mark what is long as slow."""
    for item in items:
        is_long = {getattr(item, "originalname", item.name), item.name} & LONG
        if is_long or "built_for_all" in item.fixturenames or item.nodeid.startswith(LONG_FILES):
            item.add_marker(pytest.mark.slow)


def pytest_configure(config):
    """Compile the kernels once, before the workers start: each of them would do it for itself."""
    if ONLY_PLAIN or importlib.util.find_spec("numba") is None or hasattr(config, "workerinput"):
        return
    from inertia_module.compiling.load import load
    from inertia_module.contract.models import MODELS

    for model in MODELS.values():
        load(model)
