"""The same source gives the same bytes, whoever builds it, where and when."""

import os
import shutil
import subprocess
import sys

import pytest

from inertia_module.entries import DRIVEN_SHAFT, CompilationUnavailable
from inertia_module.files import cache_folder
from inertia_module.fmu.builder import FMUS, build
from inertia_module.fmu.linking import compiler
from inertia_module.fmu.python_fmu import PACKAGE_FOLDER
from inertia_module.fmu.targets import TARGETS
from inertia_module.kernel_ir import kernel_ir

# objects are made anew: of the cache, only what the compiler brings along for each platform is used
LINK = """
import sys
from pathlib import Path

from inertia_module.entries import ENTRIES
from inertia_module.fmu import linking
from inertia_module.fmu.targets import TARGETS
from inertia_module.kernel_ir import kernel_ir
from inertia_module.machine_code import compile_ir
from inertia_module.model import DRIVEN_SHAFT

linking.object_file = lambda name, machine, label: compile_ir(kernel_ir(name), ENTRIES[name], machine)
library = linking.link(DRIVEN_SHAFT, "DrivenShaft", "{guid}", TARGETS[int(sys.argv[1])])
Path(sys.argv[2]).write_bytes(library)
"""
TRANSLATE = """
import sys
from inertia_module.kernel_ir import kernel_ir

sys.stdout.buffer.write(kernel_ir(sys.argv[1]).encode())
"""


@pytest.fixture(scope="module", autouse=True)
def tools():
    """What it takes to compile."""
    try:
        compiler()
        kernel_ir(DRIVEN_SHAFT)
    except CompilationUnavailable as reason:
        pytest.skip(str(reason))


def elsewhere(folder, *arguments, **environment):
    """Run Python as another user would, in a folder and a time zone of theirs; what it prints."""
    home, temporary = folder / "home of somebody else", folder / "t"
    home.mkdir(parents=True)
    temporary.mkdir()
    other = {"HOME": str(home), "USERPROFILE": str(home), "USER": "somebody", "LOGNAME": "somebody"}
    other |= {"TMPDIR": str(temporary), "TZ": "Asia/Tokyo", "LANG": "tr_TR.UTF-8", "PYTHONHASHSEED": "7"}
    other |= {"INERTIA_MODULE_CACHE": str(cache_folder().absolute()), "NUMBA_OPT": "1"}
    other |= {"PYTHONPATH": str(PACKAGE_FOLDER.parent)}
    done = subprocess.run(
        [sys.executable, *arguments],
        env=os.environ | other | environment,
        cwd=home,
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr.decode(errors="replace")
    return done.stdout


@pytest.fixture(scope="module")
def built_twice(built, tmp_path_factory):
    """Folders of two builds, here and elsewhere."""
    other = tmp_path_factory.mktemp("elsewhere")
    elsewhere(other / "user", "-m", "inertia_module", "build", "-o", str(other))
    return built, other


@pytest.mark.parametrize("fmu", FMUS, ids=lambda fmu: fmu.identifier)
def test_fmu_is_the_same_file_wherever_it_is_built(fmu, built_twice):
    here, other = ((folder / fmu.file_name).read_bytes() for folder in built_twice)
    assert here == other


def test_second_build_leaves_the_same_files(built, tmp_path):
    for path in build(tmp_path).paths:
        assert path.read_bytes() == (built / path.name).read_bytes()


@pytest.mark.parametrize("number", range(len(TARGETS)), ids=[target.label for target in TARGETS])
def test_library_is_the_same_wherever_it_is_linked_and_tells_no_path_and_no_user(number, tmp_path):
    here, other = tmp_path / "here", tmp_path / "other"
    subprocess.run([sys.executable, "-c", LINK, str(number), str(here)], check=True)
    elsewhere(tmp_path / "user", "-c", LINK, str(number), str(other))
    library = here.read_bytes()
    assert other.read_bytes() == library
    for word in (
        str(tmp_path),
        str(PACKAGE_FOLDER),
        os.path.expanduser("~") + os.sep,
        "somebody",
        "kernel.o",
        "tables.o",
    ):
        assert word.encode() not in library


@pytest.mark.slow
def test_kernel_is_translated_to_the_same_text_wherever_its_source_lies(tmp_path):
    moved = tmp_path / "moved"
    shutil.copytree(PACKAGE_FOLDER, moved / PACKAGE_FOLDER.name, ignore=shutil.ignore_patterns("__pycache__"))
    texts = {kernel_ir(DRIVEN_SHAFT).encode()}
    for user, source in (("one", PACKAGE_FOLDER.parent), ("other", moved)):
        own = {"INERTIA_MODULE_CACHE": str(tmp_path / user / "cache"), "PYTHONPATH": str(source)}
        texts.add(elsewhere(tmp_path / user, "-c", TRANSLATE, DRIVEN_SHAFT, **own))
    assert len(texts) == 1
