import shutil
import sys
import zipfile
from importlib import metadata
from pathlib import Path

import pytest

from inertia_module.compiling import CompilationUnavailable, targets
from inertia_module.compiling.targets import LINUX_ARM
from inertia_module.fmu import builder, native_fmu, python_fmu
from inertia_module.fmu.archive import DESCRIPTION, archive

from .test_python_fmu import drive


def test_interrupted_build_leaves_the_old_files_and_no_others(built, tmp_path, monkeypatch):
    paths = [Path(shutil.copy(built / fmu.file_name, tmp_path)) for fmu in builder.FMUS]
    before = [path.read_bytes() for path in paths]

    def interrupted(*_):
        raise KeyboardInterrupt

    for where in ("os.replace", "inertia_module.fmu.builder.python_fmu"):
        with monkeypatch.context() as patched:
            patched.setattr(where, interrupted)
            with pytest.raises(KeyboardInterrupt):
                builder.build(tmp_path)
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


@pytest.mark.parametrize("fmu", builder.FMUS, ids=lambda fmu: fmu.identifier)
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
    shutil.copy(built / builder.SHAFT_FMU.file_name, tmp_path / "another.fmu")
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
    builder.build(tmp_path / "new" / "folder", stages.append)
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
    built = builder.build(tmp_path)
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
    built = builder.build(tmp_path)
    assert len(built.paths) == len(builder.FMUS) + 1
    assert built.skipped["InertiaModule for aarch64-linux-gnu"] == "no such processor"
