import importlib.util
import os
from pathlib import Path

import pytest
from hypothesis import settings

# Each run has the same examples; `pytest --hypothesis-profile=search` searches new ones.
settings.register_profile("same", max_examples=40, deadline=None, derandomize=True, database=None)
settings.register_profile("few", settings.get_profile("same"), max_examples=8)
settings.register_profile("search", max_examples=400, deadline=None)
settings.load_profile("same")
# Names of slow tests and cases; only `make test-long` runs them.
LONG = frozenset(Path(__file__).with_name("long.txt").read_text(encoding="utf-8").splitlines())
# Slow files: other hosts, valgrind, sanitizers, Wine and QEMU, every page of the site.
LONG_FILES = ("tests/native/", "tests/system/test_hosts.py", "tests/system/test_site.py")
# With this option nothing is translated.
ONLY_PLAIN = os.environ.get("INERTIA_MODULE_KERNEL") == "plain"


@pytest.fixture(scope="session")
def compiled():
    """Return the compiled kernel, for tests that are too slow with the plain kernel."""
    if ONLY_PLAIN:
        return "plain"
    if importlib.util.find_spec("ziglang") is None:
        pytest.skip("ziglang is not installed")
    return "compiled"


@pytest.fixture(scope="session")
def built(tmp_path_factory):
    """Return a folder with all FMUs; the native ones only for this platform, which takes half the time."""
    from inertia_module.fmu.builder import build
    from tests.ready import HERE

    folder = tmp_path_factory.mktemp("build")
    assert not build(folder, targets=HERE).skipped
    return folder


@pytest.fixture(scope="session")
def fmu(built):
    """Return the FMU of the module."""
    return built / "InertiaModule.fmu"


@pytest.fixture(scope="session")
def built_for_all(tmp_path_factory):
    """Return a folder with all FMUs for every platform; tests that use it are slow."""
    from inertia_module.fmu.builder import build

    folder = tmp_path_factory.mktemp("build_for_all")
    assert not build(folder).skipped
    return folder


def pytest_collection_modifyitems(items):
    """Mark long tests as slow."""
    for item in items:
        is_long = {getattr(item, "originalname", item.name), item.name} & LONG
        if is_long or "built_for_all" in item.fixturenames or item.nodeid.startswith(LONG_FILES):
            item.add_marker(pytest.mark.slow)
