"""Test the FMU archives and their unpacked files: libraries, documentation, icons."""

import json
import os
import re
import shutil
import sys
import zipfile
from importlib import metadata
from pathlib import Path, PurePosixPath
from unittest.mock import Mock

import numpy as np
import pytest
from lxml import etree
from PIL import Image

from inertia_module.common.files import PACKAGE_FOLDER, cache_folder
from inertia_module.compiling import CompilationError, targets
from inertia_module.compiling.load import SHIPPED
from inertia_module.compiling.targets import LINUX_ARM, TARGETS
from inertia_module.fmi.instance import Fmu
from inertia_module.fmu import builder, native_fmu, python_fmu
from inertia_module.fmu.archive import DESCRIPTION
from inertia_module.fmu.builder import FMUS, PYTHON_FMU, SHAFT_FMU, WEB_KERNEL, build
from inertia_module.fmu.component import MANIFEST, PLATFORM
from inertia_module.fmu.native_fmu import METADATA
from inertia_module.fmu.python_fmu import bundled_files
from tests.packed import files_of, with_content, with_words
from tests.ready import HERE
from tests.system.programs import command, process

from .test_python_fmu import drive

FLAVOURS = [fmu.identifier for fmu in FMUS]
NATIVE = [fmu for fmu in FMUS if fmu is not PYTHON_FMU]
PAGES = ("index.html", "mechanism.png", "licenses/license.txt", "fmi-ls-ref.txt")
DOCUMENTATION = {f"documentation/{name}" for name in PAGES}
ICONS = {f"terminalsAndIcons/{name}" for name in ("icon.png", "icon.svg", "flange.png", "flange.svg")}
PAPERS = {
    2: DOCUMENTATION | {"modelDescription.xml", "model.png"},
    3: DOCUMENTATION | {"modelDescription.xml", "terminalsAndIcons/terminalsAndIcons.xml"} | ICONS,
}
LARGEST = 1_800_000
LICENCES = "documentation/licenses"


def test_archive_is_complete_and_unpacks_within_its_folder(fmu_path):
    with zipfile.ZipFile(fmu_path) as archive:
        assert archive.testzip() is None
        names, infos = archive.namelist(), archive.infolist()
    assert names[0] == "modelDescription.xml"
    assert len(names) == len({name.lower() for name in names})
    for info in infos:
        path = PurePosixPath(info.filename)
        assert not path.is_absolute()
        assert ".." not in path.parts
        assert "\\" not in info.filename
        assert info.filename.isascii()
        assert info.external_attr >> 16 == 0o644  # All users can read the file; nobody can execute it.
        assert info.compress_type == zipfile.ZIP_DEFLATED
    assert files_of(fmu_path)["documentation/licenses/license.txt"].startswith(b"MIT License")


def check_native(folder, fmu, targets):
    content = files_of(folder / fmu.file_name)
    files = {name for name in content if name.startswith("extra/org.")}
    assert files >= {METADATA, "extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml"}
    files |= PAPERS[fmu.fmi] | {fmu.library_path(target) for target in targets}
    if targets == TARGETS:
        files |= {"sources/all.c"} | ({"sources/buildDescription.xml"} if fmu.fmi == 3 else set())
        if fmu.fmi == 3:
            files |= {MANIFEST, f"binaries/{PLATFORM}/{fmu.identifier}.wasm", f"{LICENCES}/fmi-ls-wasm.txt"}
    assert content.keys() == files


@pytest.mark.parametrize("fmu", NATIVE, ids=lambda fmu: fmu.identifier)
def test_native_fmu_contains_only_libraries_and_documents(fmu, built):
    check_native(built, fmu, HERE)
    assert not builder.is_current(built / fmu.file_name, fmu)


def test_fmus_for_all_platforms_are_small_and_hold_all_libraries(built_for_all):
    for fmu in FMUS:
        assert (built_for_all / fmu.file_name).stat().st_size < LARGEST
        assert builder.is_current(built_for_all / fmu.file_name, fmu)
    for fmu in NATIVE:
        check_native(built_for_all, fmu, TARGETS)


def test_python_fmu_holds_its_source_and_the_compiled_kernel(built):
    content = files_of(built / PYTHON_FMU.file_name)
    assert content.keys() > PAPERS[2]
    needed = content["documentation/externalDependencies.txt"].decode()
    assert "Python 3.11" in needed
    assert "glibc 2.32" in needed
    assert b"Permission is hereby granted" in content["documentation/licenses/pythonfmu.txt"]
    inside = {name.split("/", 2)[2] for name in content if name.startswith("resources/inertia_module_")}
    libraries = {f"{SHIPPED.name}/{name}" for name in ("linux64.so", "win64.dll")}
    assert inside == bundled_files().keys() | libraries


# --- documentation and pictures ---


ICON = (200, 200)


def test_page_of_the_fmu_links_to_its_files_and_lists_every_variable(unpacked, model):
    folder = unpacked / "documentation"
    # Close all elements, so that the text is XML.
    text = re.sub("<((meta|img|br|hr)[^>]*)>", r"<\1/>", (folder / "index.html").read_text(encoding="utf-8"))
    page = etree.fromstring(text)
    licences = {f"licenses/{path.name}" for path in (folder / "licenses").iterdir()}
    assert licences >= {"licenses/license.txt"}
    beside = {"mechanism.png", "fmi-ls-ref.txt"} | licences
    assert set(page.xpath("//@src | //@href")) == beside
    assert all((folder / reference).is_file() for reference in beside)
    first, *sections = page.xpath("//h1/text() | //h2/text()")
    assert first == model.title
    assert sections[:5] == [
        "How it works",
        "Coupling",
        "Order of calls",
        "Invalid input",
        "Limits of the model",
    ]
    flanges = [
        name for end in model.terminals for name in (end.name, end.speed, end.torque, end.angle) if name
    ]
    names = page.xpath("//td/code/text()")
    assert sorted(names) == sorted([*(variable.name for variable in model.variables), *flanges])


def test_icon_is_a_square_with_the_machine_in_colours(unpacked, description):
    name = "model.png" if description.fmiVersion == "2.0" else "terminalsAndIcons/icon.png"
    with Image.open(unpacked / name) as icon:
        assert icon.size == ICON
        assert icon.mode == "RGBA"
        small = np.asarray(icon.resize((100, 100)))
    assert 0.2 < (small[..., 3] > 128).mean() < 0.8  # The icon is neither empty nor a square of one colour.
    assert len({tuple(pixel) for pixel in small[small[..., 3] == 255] // 32}) > 5
    with Image.open(unpacked / "documentation" / "mechanism.png") as picture:
        assert min(picture.size) > 2 * ICON[0]


# --- an FMU with other content ---


def test_rebuilt_fmu_is_reloaded(built, tmp_path):
    path = tmp_path / "one.fmu"
    shutil.copy(built / "InertiaModule.fmu", path)
    with Fmu(path) as before:
        shutil.copy(built / "DrivenShaft.fmu", path)
        with Fmu(path) as after:
            after.advance(0.01)
            assert "hub_speed" in after.variables
            assert "hub_speed" not in before.variables
        before.advance(0.01)


# --- builds: unchanged files, current FMUs, parts that are rebuilt after a change ---


def test_interrupted_build_keeps_the_old_files_only(built, tmp_path, monkeypatch):
    paths = [Path(shutil.copy(built / fmu.file_name, tmp_path)) for fmu in FMUS]
    before = [path.read_bytes() for path in paths]
    for where in ("os.replace", "inertia_module.fmu.python_fmu.PythonFmu.content"):
        with monkeypatch.context() as patched:
            patched.setattr(where, Mock(side_effect=KeyboardInterrupt))
            with pytest.raises(KeyboardInterrupt):
                build(tmp_path, targets=HERE)
        assert [path.read_bytes() for path in paths] == before
        assert sorted(tmp_path.iterdir()) == sorted(paths)


def without(name):
    """Return a change of an FMU that deletes a file."""
    return lambda path: with_content(path, {n: data for n, data in files_of(path).items() if n != name})


@pytest.mark.parametrize("fmu", FMUS, ids=lambda fmu: fmu.identifier)
def test_new_fmu_is_current_on_any_date_without_packing(built, fmu, monkeypatch):
    for part in (native_fmu, python_fmu):
        monkeypatch.delattr(part, "archive")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1900000000")
    assert builder.is_current(built / fmu.file_name, fmu, HERE)


CHANGES = {
    "another build": lambda path: with_words(path, path, DESCRIPTION, b'guid="{', b'guid="{0'),
    "no description": without(DESCRIPTION),
    "a platform less": without("binaries/linux64/InertiaModule.so"),
    "cut short": lambda path: path.write_bytes(path.read_bytes()[:1000]),
    "missing": Path.unlink,
    "another model": lambda path: shutil.copy(path.with_name("another.fmu"), path),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_fmu_of_other_sources_is_not_current(built, tmp_path, change):
    path = Path(shutil.copy(built / builder.MODULE_FMU.file_name, tmp_path))
    shutil.copy(built / SHAFT_FMU.file_name, tmp_path / "another.fmu")
    assert builder.is_current(path, builder.MODULE_FMU, HERE)
    change(path)
    assert not builder.is_current(path, builder.MODULE_FMU, HERE)


def test_python_fmu_of_another_source_is_not_current(built, monkeypatch):
    path, files = built / builder.PYTHON_FMU.file_name, python_fmu.bundled_files()
    changed = files | {"interface/messages.py": b"# another build\n" + files["interface/messages.py"]}
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
def test_platform_follows_from_the_names_of_systems(monkeypatch, system, processor, folder):
    monkeypatch.setattr(targets.sys, "platform", system)
    monkeypatch.setattr(targets.platform, "machine", lambda: processor)
    assert targets.host_target().folder == folder


@pytest.mark.parametrize("missing, options", [("ziglang", []), ("ziglang", ["--json"])])
def test_without_a_tool_the_python_fmu_is_built_and_the_rest_is_skipped_with_the_reason(
    tmp_path, monkeypatch, missing, options
):
    def installed(name):
        if name == missing:
            raise metadata.PackageNotFoundError(name)
        return version(name)

    version = metadata.version
    monkeypatch.setattr(metadata, "version", installed)
    monkeypatch.setitem(sys.modules, missing, None)  # The import then fails.
    done = command("build", "-o", tmp_path, *options)
    assert done.exit_code == 1
    reasons = re.findall("^skipped (.*?): (.*)", done.stderr, re.M)
    skipped = json.loads(done.stdout)["skipped"] if options else dict(reasons)
    (path,) = tmp_path.iterdir()
    assert not options or json.loads(done.stdout)["fmus"] == [str(path)]
    assert path.name == "InertiaModulePy.fmu"
    assert {"InertiaModule.fmu", "DrivenShaft.fmu"} <= set(skipped)
    for reason in skipped.values():
        assert f"{missing} is not installed. Run pip install 'inertia-module[fast]'." in reason
    message, _ = drive(path)
    assert message.startswith("the kernel is plain Python (no compiled kernel is available")


def test_build_reports_progress_and_skips_a_failed_platform(tmp_path, monkeypatch):
    def fails(fmu, guid, target, progress):
        if target is LINUX_ARM:
            raise CompilationError("no such processor")
        return real(fmu, guid, target, progress)

    real = native_fmu.library
    monkeypatch.setattr(native_fmu, "library", fails)
    stages = []
    built = build(tmp_path / "new" / "folder", stages.append, targets=(*HERE, LINUX_ARM))
    building = [f"building {file.file_name}" for file in (*FMUS, WEB_KERNEL)]
    assert [stage for stage in stages if stage.startswith("building")] == building
    assert len(built.paths) == len(FMUS) + 1
    assert built.skipped["InertiaModule for aarch64-linux-gnu"] == "no such processor"


# --- reproducible builds: the same bytes for the same source and tools ---

# The compilers of these builds write a word: "old" and, after each change, "new".
BUILDS = """
import json
import os
import sys

from inertia_module.common import files
from inertia_module.compiling import c_compiler
from inertia_module.compiling.targets import LINUX64
from inertia_module.fmu import native_fmu
from inertia_module.fmu.builder import SHAFT_FMU


def build(word):
    def compiled(target, arguments, folder):
        (folder / arguments[-1]).write_bytes(word.encode())

    c_compiler.run_compiler = compiled
    native_fmu.with_kernel = lambda *_: word.encode()
    guid = SHAFT_FMU.guid()
    print(json.dumps({
        "object": c_compiler.object_file(SHAFT_FMU.model, LINUX64).decode(),
        "library": native_fmu.library(SHAFT_FMU, guid, LINUX64, lambda stage: None).decode(),
        "guid": guid,
    }), flush=True)


files.cache_folder().mkdir()
build("old")
for file, change in json.loads(sys.argv[1]):
    path = files.PACKAGE_FOLDER / file
    before = path.read_bytes()
    added = b"/* changed */" if file.endswith((".c", ".h")) else b"# changed"
    path.write_bytes(before + added * (change == ""))
    if not os.fork():
        exec(change)
        build("new")
        os._exit(0)
    assert os.wait()[1] == 0
    path.write_bytes(before)
"""
ALL, LINKED = {"object", "library"}, {"library"}
OTHER_VERSION = """
import importlib.metadata as metadata
installed = metadata.version
metadata.version = lambda name: "99" if name == "{}" else installed(name)
"""
OTHER_FIELDS = """
first, *others = SHAFT_FMU.model.records
vars(SHAFT_FMU.model)["records"] = (first[::-1], *others)
"""
# Parts that are rebuilt after a change of a file of the package.
FILES = {
    "kernel/inertia.py": ALL,
    "interface/records.py": ALL,
    "compiling/translate.py": ALL,
    "compiling/c_compiler.py": ALL,
    "fmu/linking.py": LINKED,
    "fmu/native_fmu.py": LINKED,
    "compiling/targets.py": ALL,
    "fmu/shell/values.c": LINKED,
    "compiling/kernel.h": ALL,
    # The table of variables depends on the fields of the records, not on its texts.
    "interface/variables.py": set(),
}
# Parts that are rebuilt after a change of a tool or its code.
TOOLS = {
    "Python": (set(), "import platform; platform.python_version = lambda: '3.99.0'"),
    "ziglang": (ALL, OTHER_VERSION.format("ziglang")),
    "fields of records": (ALL, OTHER_FIELDS),
    "headers of FMI 2.0": (LINKED, "native_fmu.header_folder = lambda: files.PACKAGE_FOLDER"),
    "the same": (set(), "pass"),
}


BUILD_FOR_TARGETS = """
from pathlib import Path
from inertia_module.compiling.targets import TARGETS
from inertia_module.fmu.builder import build
build(Path({!r}), targets=TARGETS[:{}])
"""


def elsewhere(folder, *arguments, **environment):
    """Run Python as another user, in another folder and time zone, and return its output."""
    home, temporary = folder / "home of somebody else", folder / "t"
    home.mkdir(parents=True)
    temporary.mkdir()
    other = {"HOME": str(home), "USERPROFILE": str(home), "USER": "somebody", "LOGNAME": "somebody"}
    other |= {"TMPDIR": str(temporary), "TZ": "Asia/Tokyo", "LANG": "tr_TR.UTF-8", "PYTHONHASHSEED": "7"}
    other |= {"INERTIA_MODULE_CACHE": str(cache_folder().absolute())}
    other |= {"PYTHONPATH": str(PACKAGE_FOLDER.parent)}
    return process(*arguments, folder=home, **(other | environment)).stdout


def test_files_do_not_depend_on_user_and_folder(tmp_path):
    two = TARGETS[:2]
    build(tmp_path / "own", targets=two)
    moved, cache, other = (tmp_path / name for name in ("moved", "cache", "other"))
    shutil.copytree(PACKAGE_FOLDER, moved / PACKAGE_FOLDER.name, ignore=shutil.ignore_patterns("__pycache__"))
    cache.mkdir()
    # Build all parts again, except the libraries of the compiler.
    (cache / "zig").symlink_to(cache_folder() / "zig")
    own = {"INERTIA_MODULE_CACHE": str(cache), "PYTHONPATH": str(moved)}
    elsewhere(tmp_path / "user", "-c", BUILD_FOR_TARGETS.format(str(other), len(two)), **own)
    user = os.path.expanduser("~") + os.sep
    for file in (*FMUS, WEB_KERNEL):
        path = tmp_path / "own" / file.file_name
        assert (other / file.file_name).read_bytes() == path.read_bytes(), file.file_name
        libraries = files_of(path) if path.suffix == ".fmu" else {path.name: path.read_bytes()}
        for name in [name for name in libraries if not name.endswith((".py", ".txt", ".html"))]:
            for text in (str(tmp_path), str(PACKAGE_FOLDER), user, "somebody", "kernel.o", "tables.o"):
                assert text.encode() not in libraries[name], name


def test_second_build_writes_the_same_files_except_the_date(built, tmp_path, monkeypatch):
    for path in build(tmp_path / "again", targets=HERE).paths:
        assert path.read_bytes() == (built / path.name).read_bytes()
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1900000000")
    for path in build(tmp_path / "later", files=(PYTHON_FMU, SHAFT_FMU), targets=HERE).paths:
        assert path.read_bytes() != (built / path.name).read_bytes()


@pytest.mark.skipif(os.name == "nt", reason="processes are not forked on Windows")
def test_change_of_source_or_tool_invalidates_the_cache(tmp_path):
    """Only parts that depend on the change are rebuilt; the GUID changes if any part changes."""
    package = tmp_path / PACKAGE_FOLDER.name
    shutil.copytree(PACKAGE_FOLDER, package, ignore=shutil.ignore_patterns("__pycache__"))
    changes = [(file, "") for file in FILES] + [("__init__.py", code) for _, code in TOOLS.values()]
    own = {"INERTIA_MODULE_CACHE": str(tmp_path / "cache"), "PYTHONPATH": str(tmp_path)}
    printed = elsewhere(tmp_path / "user", "-c", BUILDS, json.dumps(changes), **own)
    before, *after = map(json.loads, printed.splitlines())
    assert before["guid"] == SHAFT_FMU.guid()
    expected = FILES | {tool: anew for tool, (anew, _) in TOOLS.items()}
    pairs = dict(zip(expected, after, strict=True))
    assert {
        change: {what for what in built if built[what] == "new"} for change, built in pairs.items()
    } == expected
    assert {change for change in pairs if pairs[change]["guid"] != before["guid"]} == {
        change for change, anew in expected.items() if anew
    }
