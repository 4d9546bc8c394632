import json
import os
import shutil
import sys
import zipfile
from importlib import metadata
from pathlib import Path

import pytest

from inertia_module.common.files import PACKAGE_FOLDER, cache_folder
from inertia_module.compiling import CompilationUnavailable, targets
from inertia_module.compiling.targets import LINUX_ARM
from inertia_module.fmu import builder, native_fmu, python_fmu
from inertia_module.fmu.archive import DESCRIPTION, archive
from inertia_module.fmu.builder import FMUS, SHAFT_FMU, WEB_KERNEL, build
from inertia_module.fmu.native_fmu import guid
from tests.system.programs import process

from .test_archive import content_of
from .test_python_fmu import drive


def test_interrupted_build_leaves_the_old_files_and_no_others(built, tmp_path, monkeypatch):
    paths = [Path(shutil.copy(built / fmu.file_name, tmp_path)) for fmu in FMUS]
    before = [path.read_bytes() for path in paths]

    def interrupted(*_):
        raise KeyboardInterrupt

    for where in ("os.replace", "inertia_module.fmu.builder.python_fmu"):
        with monkeypatch.context() as patched:
            patched.setattr(where, interrupted)
            with pytest.raises(KeyboardInterrupt):
                build(tmp_path)
        assert [path.read_bytes() for path in paths] == before
        assert sorted(tmp_path.iterdir()) == sorted(paths)


def repacked(change):
    """Change of a file: an FMU packed anew, with what another change makes of its content by name."""

    def changed(path):
        with zipfile.ZipFile(path) as packed:
            content = {name: packed.read(name) for name in packed.namelist()}
        path.write_bytes(archive(change(content)))

    return changed


def without(name):
    return repacked(lambda content: {other: content[other] for other in content if other != name})


def of_another_guid(content):
    return content | {DESCRIPTION: content[DESCRIPTION].replace(b'guid="{', b'guid="{0')}


@pytest.mark.parametrize("fmu", FMUS, ids=lambda fmu: fmu.identifier)
def test_fmu_just_built_is_current_whatever_the_date_and_nothing_is_packed_to_find_out(
    built, fmu, monkeypatch
):
    for part in (native_fmu, python_fmu):
        monkeypatch.delattr(part, "archive")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1900000000")
    assert builder.is_current(built / fmu.file_name, fmu)


@pytest.mark.parametrize(
    "change",
    [
        repacked(of_another_guid),
        without(DESCRIPTION),
        without("binaries/linux64/InertiaModule.so"),
        lambda path: path.write_bytes(path.read_bytes()[:1000]),
        Path.unlink,
        lambda path: shutil.copy(path.with_name("another.fmu"), path),
    ],
    ids=["another build", "no description", "a platform less", "cut short", "missing", "another model"],
)
def test_fmu_that_is_not_as_it_would_be_built_now_is_not_current(built, tmp_path, change):
    path = Path(shutil.copy(built / builder.MODULE_FMU.file_name, tmp_path))
    shutil.copy(built / SHAFT_FMU.file_name, tmp_path / "another.fmu")
    assert builder.is_current(path, builder.MODULE_FMU)
    change(path)
    assert not builder.is_current(path, builder.MODULE_FMU)


def test_python_fmu_of_another_source_is_not_current(built, monkeypatch):
    path, files = built / builder.PYTHON_FMU.file_name, python_fmu.bundled_files()
    changed = files | {"contract/messages.py": b"# another build\n" + files["contract/messages.py"]}
    monkeypatch.setattr(python_fmu, "bundled_files", lambda: changed)
    assert not builder.is_current(path, builder.PYTHON_FMU)


@pytest.mark.parametrize(
    "system, processor, folder",
    [
        ("linux", "x86_64", "linux64"),
        ("win32", "AMD64", "win64"),
        ("win32", "ARM64", "aarch64-windows"),
        ("linux", "aarch64", "aarch64-linux"),
        ("darwin", "arm64", "darwin64"),
    ],
)
def test_this_platform_is_known_by_the_names_that_systems_give_it(monkeypatch, system, processor, folder):
    monkeypatch.setattr(targets.sys, "platform", system)
    monkeypatch.setattr(targets.platform, "machine", lambda: processor)
    assert targets.here().folder == folder


def test_build_says_what_it_is_doing(tmp_path, monkeypatch):
    monkeypatch.setattr(builder, "is_cached", lambda name: False)
    stages = []
    build(tmp_path / "new" / "folder", stages.append)
    assert "translating the kernels" in stages[0]
    assert [stage for stage in stages if stage.startswith("building")] == [
        "building InertiaModule.fmu",
        "building InertiaModule3.fmu",
        "building InertiaModulePy.fmu",
        "building DrivenShaft.fmu",
        "building DrivenShaft3.fmu",
        "building InertiaModule.wasm",
    ]


@pytest.mark.parametrize("missing", ["ziglang", "numba"])
def test_without_a_tool_the_python_fmu_is_built_and_the_rest_is_skipped_with_the_reason(
    tmp_path, monkeypatch, missing
):
    def installed(name):
        if name == missing:
            raise metadata.PackageNotFoundError(name)
        return version(name)

    version = metadata.version
    monkeypatch.setattr(metadata, "version", installed)
    monkeypatch.setitem(sys.modules, missing, None)  # so it is not found
    built = build(tmp_path)
    assert [path.name for path in built.paths] == ["InertiaModulePy.fmu"]
    assert {"InertiaModule.fmu", "DrivenShaft.fmu"} <= set(built.skipped)
    assert all(f"{missing} is not installed" in reason for reason in built.skipped.values())
    message, _ = drive(built.paths[0])
    assert message.startswith("the kernel is plain Python, for there is no compiled one")


def test_a_platform_that_fails_is_skipped_and_the_others_are_built(tmp_path, monkeypatch):
    def fails(fmu, guid, target, progress):
        if target is LINUX_ARM:
            raise CompilationUnavailable("no such processor")
        return real(fmu, guid, target, progress)

    real = builder.native_fmu.__globals__["library"]
    monkeypatch.setitem(builder.native_fmu.__globals__, "library", fails)
    built = build(tmp_path)
    assert len(built.paths) == len(FMUS) + 1
    assert built.skipped["InertiaModule for aarch64-linux-gnu"] == "no such processor"


# --- the same source and tools give the same bytes, whoever builds it, where and when; others give others ---

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


def elsewhere(folder, *arguments, **environment):
    """Run Python as another user would, in a folder and a time zone of theirs; what it prints."""
    home, temporary = folder / "home of somebody else", folder / "t"
    home.mkdir(parents=True)
    temporary.mkdir()
    other = {"HOME": str(home), "USERPROFILE": str(home), "USER": "somebody", "LOGNAME": "somebody"}
    other |= {"TMPDIR": str(temporary), "TZ": "Asia/Tokyo", "LANG": "tr_TR.UTF-8", "PYTHONHASHSEED": "7"}
    other |= {"INERTIA_MODULE_CACHE": str(cache_folder().absolute()), "NUMBA_OPT": "1"}
    other |= {"PYTHONPATH": str(PACKAGE_FOLDER.parent)}
    return process(*arguments, folder=home, **(other | environment)).stdout


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
