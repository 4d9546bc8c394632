"""The same source and tools give the same bytes, whoever builds it, where and when; others give others."""

import json
import os
import shutil
import subprocess
import sys

import pytest

from inertia_module.common.files import PACKAGE_FOLDER, cache_folder
from inertia_module.compiling import CompilationUnavailable
from inertia_module.compiling.ir import llvm_text, tool_versions
from inertia_module.compiling.targets import TARGETS
from inertia_module.contract.models import DRIVEN_SHAFT
from inertia_module.fmu.builder import FMUS, SHAFT_FMU, WEB_KERNEL, build
from inertia_module.fmu.native_fmu import guid

# objects are made anew: of the cache, only what the compiler brings along for each platform is used
LINK = """
import sys
from pathlib import Path

from inertia_module.compiling import linking as compiling
from inertia_module.fmu import linking
from inertia_module.compiling.targets import TARGETS
from inertia_module.contract.models import DRIVEN_SHAFT

compiling.object_file = compiling.compile_ir
for number, target in enumerate(TARGETS):
    library = linking.link(DRIVEN_SHAFT, "DrivenShaft", "{guid}", target, 2)
    Path(sys.argv[1], str(number)).write_bytes(library)
"""
LINK_FOR_BROWSERS = """
import sys

from inertia_module.compiling.linking import compile_ir
from inertia_module.fmu import web_kernel
from inertia_module.fmu.builder import WEB_KERNEL

web_kernel.object_file = compile_ir
sys.stdout.buffer.write(web_kernel.link(WEB_KERNEL.model))
"""
TRANSLATE = """
import sys
from inertia_module.compiling.ir import llvm_text
from inertia_module.contract.models import DRIVEN_SHAFT

sys.stdout.buffer.write(llvm_text(DRIVEN_SHAFT).encode())
"""
# a build after a change, whose compilers make nothing but a word
BUILD = """
import json
import lzma
import subprocess
import sys
from pathlib import Path

from inertia_module.common import files
from inertia_module.compiling import ir
from inertia_module.compiling import linking
from inertia_module.fmu import native_fmu
from inertia_module.fmu.builder import SHAFT_FMU
from inertia_module.compiling.targets import LINUX64

word, change = sys.argv[1:]
exec(change)


def translate(command, **_):
    Path(command[-1]).write_bytes(lzma.compress(word.encode()))
    return subprocess.CompletedProcess(command, 0)


files.cache_folder().mkdir(exist_ok=True)
subprocess.run = translate
linking.compile_ir = native_fmu.link = lambda *_: word.encode()
guid = native_fmu.guid(SHAFT_FMU)
print(json.dumps({
    "text": ir.llvm_text(SHAFT_FMU.model),
    "object": linking.object_file(SHAFT_FMU.model, LINUX64).decode(),
    "library": native_fmu.library(SHAFT_FMU, guid, LINUX64, lambda stage: None).decode(),
    "guid": guid,
}))
"""
ALL, COMPILED, LINKED = {"text", "object", "library"}, {"object", "library"}, {"library"}
# what is made anew after a change of a file of the package
FILES = {
    "kernel/inertia.py": ALL,
    "contract/records.py": ALL,
    "compiling/ir.py": ALL,
    "compiling/linking.py": COMPILED,
    "fmu/linking.py": LINKED,
    "fmu/native_fmu.py": LINKED,
    "compiling/targets.py": LINKED,
    "fmu/shell/values.c": LINKED,
    # the table of variables: by the fields that the records have of it, not by its words
    "contract/variables.py": set(),
}
OTHER_VERSION = """
import importlib.metadata as metadata
installed = metadata.version
metadata.version = lambda name: "99" if name == "{}" else installed(name)
"""
OTHER_FIELDS = """
first, *others = SHAFT_FMU.model.records
vars(SHAFT_FMU.model)["records"] = (first[::-1], *others)
"""
# what is made anew with another tool, and the code that makes it another
TOOLS = {
    "Python": (ALL, "import platform; platform.python_version = lambda: '3.99.0'"),
    "numba": (ALL, OTHER_VERSION.format("numba")),
    "llvmlite": (ALL, OTHER_VERSION.format("llvmlite")),
    "ziglang": (LINKED, OTHER_VERSION.format("ziglang")),
    "fields of records": (ALL, OTHER_FIELDS),
    "headers of FMI 2.0": (LINKED, "native_fmu.header_folder = lambda: files.PACKAGE_FOLDER"),
}


@pytest.fixture(scope="module", autouse=True)
def tools():
    """What it takes to compile."""
    try:
        tool_versions("ziglang")
        llvm_text(DRIVEN_SHAFT)
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


def test_second_build_leaves_the_same_files_but_for_the_date(built, tmp_path, monkeypatch):
    for path in build(tmp_path / "again").paths:
        assert path.read_bytes() == (built / path.name).read_bytes()
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1900000000")
    for path in build(tmp_path / "later", files=FMUS).paths:
        assert path.read_bytes() != (built / path.name).read_bytes()


def test_web_kernel_is_the_same_wherever_it_is_linked_and_tells_no_path(built, tmp_path):
    here = (built / WEB_KERNEL.file_name).read_bytes()
    assert elsewhere(tmp_path / "user", "-c", LINK_FOR_BROWSERS) == here
    assert here.startswith(b"\0asm")
    assert b"inertia_module_entry" in here
    assert (os.path.expanduser("~") + os.sep).encode() not in here


def test_library_is_the_same_wherever_it_is_linked_and_tells_no_path_and_no_user(tmp_path):
    here, other = tmp_path / "here", tmp_path / "other"
    for folder in (here, other):
        folder.mkdir()
    subprocess.run([sys.executable, "-c", LINK, str(here)], check=True)
    elsewhere(tmp_path / "user", "-c", LINK, str(other))
    user = os.path.expanduser("~") + os.sep
    for number, target in enumerate(TARGETS):
        library = (here / str(number)).read_bytes()
        assert (other / str(number)).read_bytes() == library, target.label
        for told in (str(tmp_path), str(PACKAGE_FOLDER), user, "somebody", "kernel.o", "tables.o"):
            assert told.encode() not in library, target.label


@pytest.mark.slow
def test_kernel_is_translated_to_the_same_text_wherever_its_source_lies(tmp_path):
    moved = tmp_path / "moved"
    shutil.copytree(PACKAGE_FOLDER, moved / PACKAGE_FOLDER.name, ignore=shutil.ignore_patterns("__pycache__"))
    own = {"INERTIA_MODULE_CACHE": str(tmp_path / "cache"), "PYTHONPATH": str(moved)}
    text = elsewhere(tmp_path / "user", "-c", TRANSLATE, **own)
    assert text == llvm_text(DRIVEN_SHAFT).encode()


def build_after(folder, cache, word, file="", change=""):
    """What a build leaves whose compilers make a word, after a change of a file or of a tool."""
    package = folder / PACKAGE_FOLDER.name
    shutil.copytree(PACKAGE_FOLDER, package, ignore=shutil.ignore_patterns("__pycache__"))
    if file:
        with open(package / file, "a") as stream:
            stream.write("/* changed */\n" if file.endswith(".c") else "# changed\n")
    own = {"INERTIA_MODULE_CACHE": str(cache), "PYTHONPATH": str(folder)}
    return json.loads(elsewhere(folder / "user", "-c", BUILD, word, change, **own))


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A cache with what this source and these tools gave, and what that was."""
    folder = tmp_path_factory.mktemp("kept")
    return folder / "cache", build_after(folder, folder / "cache", "old")


def made_anew(before, after):
    """What is new of two builds; the GUID is another if anything is."""
    anew = {what for what in after if after[what] == "new"}
    assert (after["guid"] != before["guid"]) == bool(anew)
    return anew


def test_same_source_and_tools_find_what_was_compiled_before_and_have_the_same_guid(kept, tmp_path):
    cache, before = kept
    assert made_anew(before, build_after(tmp_path, cache, "new")) == set()
    assert before["guid"] == guid(SHAFT_FMU)


@pytest.mark.parametrize("file", FILES)
def test_after_a_change_of_source_nothing_old_comes_back(kept, tmp_path, file):
    cache, before = kept
    assert made_anew(before, build_after(tmp_path, cache, "new", file=file)) == FILES[file]


@pytest.mark.parametrize("tool", TOOLS)
def test_with_another_tool_nothing_old_comes_back(kept, tmp_path, tool):
    cache, before = kept
    anew, change = TOOLS[tool]
    assert made_anew(before, build_after(tmp_path, cache, "new", change=change)) == anew
