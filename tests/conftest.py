import importlib.util
import os

import pytest
from hypothesis import settings

# the same examples each run; `pytest --hypothesis-profile=search` looks for new ones
settings.register_profile("same", max_examples=40, deadline=None, derandomize=True, database=None)
settings.register_profile("few", settings.get_profile("same"), max_examples=8)
settings.register_profile("search", max_examples=400, deadline=None)
settings.load_profile("same")
# tests/planted_changes.py asks for that: nothing is translated
ONLY_PLAIN = os.environ.get("INERTIA_MODULE_KERNEL") == "plain"


@pytest.fixture(scope="session", params=["plain", "compiled"])
def kernel(request):
    """Both kernels in turn."""
    if request.param == "plain":
        return "plain"
    if ONLY_PLAIN:
        pytest.skip("the plain kernel alone was asked for")
    return request.getfixturevalue("compiled")


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
    """Folder with all FMUs."""
    from inertia_module.fmu.builder import build

    folder = tmp_path_factory.mktemp("build")
    assert not build(folder).skipped
    return folder


def pytest_configure(config):
    """Compile the kernels once, before the workers start: each of them would do it for itself."""
    if ONLY_PLAIN or importlib.util.find_spec("numba") is None or hasattr(config, "workerinput"):
        return
    from inertia_module.compiling import load as compiled

    for name in ("module", "driven_shaft"):
        compiled.load(name)
