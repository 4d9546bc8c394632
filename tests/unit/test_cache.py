"""Test cache files: a damaged, empty or foreign file is ignored and written again."""

import ctypes
import shutil

import pytest

from inertia_module.common import files
from inertia_module.compiling import CompilationError, c_compiler
from inertia_module.compiling.targets import LINUX64, TARGETS, host_target
from inertia_module.fmu import native_fmu
from inertia_module.fmu.builder import SHAFT_FMU
from inertia_module.interface.models import DRIVEN_SHAFT

NAME, CONTENT = "kernel-linux.so", bytes(range(256)) * 40
DAMAGES = {
    "cut": lambda path: path.write_bytes(path.read_bytes()[:-1]),
    "empty": lambda path: path.write_bytes(b""),
    "of another program": lambda path: path.write_bytes(b"\x7fELF" + CONTENT),
    "gone": lambda path: path.unlink(),
    "a link to nothing": lambda path: (path.unlink(), path.symlink_to("nothing")),
}


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """Return an empty cache folder."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("INERTIA_MODULE_CACHE", str(folder))
    return folder


@pytest.fixture
def made():
    """Return a function that counts how often a content is made."""
    return []


def cached(made, source=b"source", name=NAME):
    def make():
        made.append(name)
        return source * (name != NAME) + CONTENT

    return files.cached(name, {"source": source}, make)


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_file_is_replaced_by_a_complete_file(cache, made, damage):
    path = cached(made)
    assert path == cached(made)
    assert (len(made), path.read_bytes(), path.suffix) == (1, CONTENT, ".so")
    DAMAGES[damage](path)
    assert files.cached_file(NAME, {"source": b"source"}) is None
    assert cached(made).read_bytes() == cached(made).read_bytes() == CONTENT
    assert len(made) == 2


def test_a_file_of_other_sources_or_of_another_name_is_not_used(cache, made):
    path, other = cached(made), cached(made, b"another source")
    third = cached(made, name="kernel-windows.dll")
    assert (len({path, other, third}), len(made)) == (3, 3)
    # The content of a file under another name is invalid.
    third.rename(path)
    assert cached(made).read_bytes() == CONTENT
    assert len(made) == 4


def test_folder_instead_of_a_file_is_an_error_with_its_name(cache, made):
    path = cached(made)
    path.unlink()
    path.mkdir()
    with pytest.raises(OSError, match=path.name):
        cached(made)


def test_read_only_cache_folder_is_an_error_before_the_work(tmp_path, monkeypatch, made):
    place = tmp_path / "file"
    place.write_text("no folder")
    monkeypatch.setenv("INERTIA_MODULE_CACHE", str(place / "cache"))
    expected = r"cannot write to .*: .*file is not a folder; INERTIA_MODULE_CACHE names another"
    with pytest.raises(OSError, match=expected):
        cached(made)
    assert not made


def test_objects_and_libraries_are_checked_before_they_go_into_an_fmu(cache, monkeypatch):
    def compiled(target, arguments, folder):
        (folder / arguments[-1]).write_bytes(b"object")

    def build():
        return [
            c_compiler.object_file(DRIVEN_SHAFT, LINUX64),
            native_fmu.library(SHAFT_FMU, "GUID", LINUX64, lambda stage: None),
        ]

    monkeypatch.setattr(c_compiler, "run_compiler", compiled)
    monkeypatch.setattr(native_fmu, "with_kernel", lambda *_: b"library")
    good = build()
    assert good == [b"object", b"library"]
    for path in cache.iterdir():
        path.write_bytes(b"of somebody else")
    assert build() == good


def test_another_compiler_makes_the_library_of_this_platform(cache, monkeypatch):
    monkeypatch.setenv("INERTIA_MODULE_CC", "gcc")
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    path = c_compiler.kernel_library(DRIVEN_SHAFT)
    assert path.parent == cache
    assert ctypes.CDLL(str(path)).inertia_module_kernel
    with pytest.raises(CompilationError, match="gcc compiles only for"):
        c_compiler.object_file(DRIVEN_SHAFT, next(one for one in TARGETS if one != host_target()))


def test_missing_compiler_is_an_error_with_its_name(cache, monkeypatch):
    monkeypatch.setenv("INERTIA_MODULE_CC", "no-such-compiler -O1")
    expected = r"INERTIA_MODULE_CC must be the command of a C compiler \(got 'no-such-compiler -O1'\)"
    with pytest.raises(CompilationError, match=expected):
        c_compiler.kernel_library(DRIVEN_SHAFT)
