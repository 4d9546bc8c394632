"""The same source and tools give the same bytes, whoever builds it, where and when; others give others."""

import json
import os
import shutil
import subprocess
import sys

import pytest

from inertia_module.common.files import PACKAGE_FOLDER, cache_folder
from inertia_module.compiling import CompilationUnavailable
from inertia_module.compiling.ir import llvm_text
from inertia_module.compiling.linking import compiler
from inertia_module.contract.models import DRIVEN_SHAFT
from inertia_module.fmu.builder import FMUS, SHAFT_FMU, WEB_KERNEL, build
from inertia_module.fmu.native_fmu import guid

from .test_archive import content_of

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
OTHER_VERSION = """
import importlib.metadata as metadata
installed = metadata.version
metadata.version = lambda name: "99" if name == "{}" else installed(name)
"""
OTHER_FIELDS = """
first, *others = SHAFT_FMU.model.records
vars(SHAFT_FMU.model)["records"] = (first[::-1], *others)
"""
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
# and with another tool, and the code that makes it another
TOOLS = {
    "Python": (ALL, "import platform; platform.python_version = lambda: '3.99.0'"),
    "numba": (ALL, OTHER_VERSION.format("numba")),
    "llvmlite": (ALL, OTHER_VERSION.format("llvmlite")),
    "ziglang": (LINKED, OTHER_VERSION.format("ziglang")),
    "fields of records": (ALL, OTHER_FIELDS),
    "headers of FMI 2.0": (LINKED, "native_fmu.header_folder = lambda: files.PACKAGE_FOLDER"),
    "the same": (set(), ""),
}


@pytest.fixture(scope="module", autouse=True)
def tools():
    """What it takes to compile."""
    try:
        compiler()
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


def test_files_are_the_same_whoever_builds_them_wherever_and_tell_no_path_and_no_user(built, tmp_path):
    moved, cache, other = (tmp_path / name for name in ("moved", "cache", "other"))
    shutil.copytree(PACKAGE_FOLDER, moved / PACKAGE_FOLDER.name, ignore=shutil.ignore_patterns("__pycache__"))
    cache.mkdir()
    # all is made anew but for what takes half a minute: the tools, and the kernel of the module translated
    for path in (cache_folder() / "zig", *cache_folder().glob("InertiaModule-*.ll.xz")):
        (cache / path.name).symlink_to(path)
    own = {"INERTIA_MODULE_CACHE": str(cache), "PYTHONPATH": str(moved)}
    elsewhere(tmp_path / "user", "-m", "inertia_module", "build", "-o", str(other), **own)
    user = os.path.expanduser("~") + os.sep
    for file in (*FMUS, WEB_KERNEL):
        path = built / file.file_name
        assert (other / file.file_name).read_bytes() == path.read_bytes(), file.file_name
        libraries = content_of(path) if path.suffix == ".fmu" else {path.name: path.read_bytes()}
        for name in [name for name in libraries if not name.endswith((".py", ".txt", ".html"))]:
            for told in (str(tmp_path), str(PACKAGE_FOLDER), user, "somebody", "kernel.o", "tables.o"):
                assert told.encode() not in libraries[name], name


def test_second_build_leaves_the_same_files_but_for_the_date(built, tmp_path, monkeypatch):
    for path in build(tmp_path / "again").paths:
        assert path.read_bytes() == (built / path.name).read_bytes()
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1900000000")
    for path in build(tmp_path / "later", files=FMUS).paths:
        assert path.read_bytes() != (built / path.name).read_bytes()


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


@pytest.mark.parametrize("changed", [*FILES, *TOOLS])
def test_after_a_change_of_source_or_tool_nothing_old_comes_back(kept, tmp_path, changed):
    """All that a change can touch is made anew, and nothing else; the GUID is another if anything is."""
    cache, before = kept
    file = changed if changed in FILES else ""
    anew, change = (FILES[file], "") if file else TOOLS[changed]
    after = build_after(tmp_path, cache, "new", file, change)
    assert {what for what in after if after[what] == "new"} == anew
    assert (after["guid"] != before["guid"]) == bool(anew)
    assert before["guid"] == guid(SHAFT_FMU)
