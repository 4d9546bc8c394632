"""The files in the FMUs, as a host unpacks them: libraries, documentation, pictures."""

import os
import re
import shutil
import signal
import subprocess
import sys
import zipfile
from pathlib import Path, PurePosixPath

import numpy as np
import pytest
from lxml import etree
from PIL import Image

from inertia_module.compiling.load import SHIPPED
from inertia_module.compiling.targets import TARGETS
from inertia_module.fmu.builder import FMUS, PYTHON_FMU
from inertia_module.fmu.native_fmu import library_path
from inertia_module.fmu.python_fmu import bundled_files
from inertia_module.harness.fmu import Fmu, FmuError
from tests.system.programs import process

FLAVOURS = [fmu.identifier for fmu in FMUS]
NATIVE = [fmu for fmu in FMUS if fmu is not PYTHON_FMU]
DOCUMENTATION = {f"documentation/{name}" for name in ("index.html", "mechanism.png", "licenses/license.txt")}
ICONS = {f"terminalsAndIcons/{name}" for name in ("icon.png", "icon.svg", "flange.png", "flange.svg")}
PAPERS = {
    2: DOCUMENTATION | {"modelDescription.xml", "model.png"},
    3: DOCUMENTATION | {"modelDescription.xml", "terminalsAndIcons/terminalsAndIcons.xml"} | ICONS,
}
LARGEST = 1_200_000


def content_of(path):
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_archive_is_small_and_whole_and_unpacks_within_its_folder(fmu_path):
    assert fmu_path.stat().st_size < LARGEST
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
        assert info.external_attr >> 16 == 0o644  # readable and nothing more
        assert info.compress_type == zipfile.ZIP_DEFLATED
    assert content_of(fmu_path)["documentation/licenses/license.txt"].startswith(b"MIT License")


@pytest.mark.parametrize("fmu", NATIVE, ids=lambda fmu: fmu.identifier)
def test_native_fmu_holds_its_libraries_and_its_papers_and_nothing_else(fmu, built):
    libraries = {library_path(fmu, target) for target in TARGETS}
    assert content_of(built / fmu.file_name).keys() == PAPERS[fmu.fmi] | libraries


def test_python_fmu_holds_its_source_and_the_compiled_kernel(built):
    content = content_of(built / PYTHON_FMU.file_name)
    assert content.keys() > PAPERS[2]
    needed = content["documentation/externalDependencies.txt"].decode()
    assert "Python 3.11" in needed
    assert "glibc 2.32" in needed
    assert b"Permission is hereby granted" in content["documentation/licenses/pythonfmu.txt"]
    inside = {name.split("/", 2)[2] for name in content if name.startswith("resources/inertia_module_")}
    libraries = {f"{SHIPPED.name}/{name}" for name in ("linux64.so", "win64.dll")}
    assert inside == bundled_files().keys() | libraries


# --- documentation and pictures, as a host shows them ---


ROOT = Path(__file__).parents[2]
PICTURES = ROOT / "fmu_src" / "inertia_module" / "fmu" / "pictures"
ICON = (200, 200)


def test_page_refers_to_files_of_the_fmu_says_what_the_model_computes_and_lists_every_variable(
    unpacked, model
):
    folder = unpacked / "documentation"
    # as XML, where every element is closed in its turn
    text = re.sub("<((meta|img|br|hr)[^>]*)>", r"<\1/>", (folder / "index.html").read_text(encoding="utf-8"))
    page = etree.fromstring(text)
    licences = {f"licenses/{path.name}" for path in (folder / "licenses").iterdir()}
    assert licences >= {"licenses/license.txt"}
    assert set(page.xpath("//@src | //@href")) == {"mechanism.png"} | licences
    assert all((folder / reference).is_file() for reference in ("mechanism.png", *licences))
    first, *sections = page.xpath("//h1/text() | //h2/text()")
    assert first == model.title
    assert sections[:5] == [
        "What it computes",
        "How to couple it",
        "Order of calls",
        "Refusals",
        "What is not modelled",
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
    assert 0.2 < (small[..., 3] > 128).mean() < 0.8  # neither empty nor a square of one colour
    assert len({tuple(pixel) for pixel in small[small[..., 3] == 255] // 32}) > 5
    with Image.open(unpacked / "documentation" / "mechanism.png") as picture:
        assert min(picture.size) > 2 * ICON[0]


def test_pictures_are_what_the_code_draws(tmp_path):
    process(ROOT / "docs" / "make_icons.py", tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        path.name for path in PICTURES.iterdir()
    )
    for path in PICTURES.glob("*.png"):
        with Image.open(path) as kept, Image.open(tmp_path / path.name) as drawn:
            one, other = (np.asarray(picture.convert("RGBA"), dtype=float) for picture in (kept, drawn))
        assert one.shape == other.shape
        # another version of the library may smooth an edge or place a letter otherwise
        assert np.abs(one - other).mean() < 1.0, path.name


# --- what an FMU is unpacked to: one folder for all instances in a process, none when that has ended ---


FORGOTTEN = "from inertia_module.harness.fmu import Fmu; fmus = [Fmu({path!r}) for _ in range(3)]; "
FORK = (
    "import multiprocessing; child = multiprocessing.get_context('fork').Process(target={}); child.start(); "
)
# how a process with instances that nobody closes may end, and what it then returns
ENDS = {
    "at its end": ("", 0),
    "by an error": ("1 / 0", 1),
    "by sys.exit": ("import sys; sys.exit(3)", 3),
    "as the command does": (
        "import inertia_module.cli as cli; cli.app = lambda: None; cli.main()",
        0,
    ),
    "with a process forked from it": (FORK.format("fmus[0].advance, args=(0.01,)") + "child.join()", 0),
    "a forked one": (FORK.format("Fmu, args=(other,)") + "child.join()", 0),
}
# it waits where it would otherwise end, until it is told to
WAITS = (
    "import sys, time, inertia_module.cli as cli;"
    "cli.app = lambda: (print('ready', flush=True), time.sleep(60)); cli.main()"
)


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """The temporary folder, here and of processes started."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    monkeypatch.setenv("TMPDIR", str(folder))
    return folder


@pytest.fixture(scope="module")
def module(built):
    return built / "InertiaModule.fmu"


def test_instances_of_a_process_share_one_folder_that_the_last_one_removes(module, temporary):
    with Fmu(module) as first:
        with Fmu(module) as second:
            second.advance(0.01)
            assert len(list(temporary.iterdir())) == 1
        first.advance(0.01)
        assert len(list(temporary.iterdir())) == 1
    assert not list(temporary.iterdir())


def test_what_cannot_be_instantiated_leaves_nothing(module, temporary, tmp_path):
    broken = tmp_path / "broken.fmu"
    broken.write_bytes(module.read_bytes()[:-100])
    with pytest.raises(FmuError):
        Fmu(broken)
    with pytest.raises(FmuError):
        Fmu(module, parameters={"imbalance_mass": -1.0})
    assert not list(temporary.iterdir())


def test_an_fmu_built_anew_is_seen(built, tmp_path):
    path = tmp_path / "one.fmu"
    shutil.copy(built / "InertiaModule.fmu", path)
    with Fmu(path) as before:
        shutil.copy(built / "DrivenShaft.fmu", path)
        with Fmu(path) as after:
            after.advance(0.01)
            assert "hub_speed" in after.variables
            assert "hub_speed" not in before.variables
        before.advance(0.01)


@pytest.mark.parametrize("end", ENDS)
def test_instances_that_nobody_closes_leave_nothing_when_their_process_ends(end, module, temporary, built):
    code, status = ENDS[end]
    other = f"other = {str(built / 'DrivenShaft.fmu')!r}; "
    process("-c", FORGOTTEN.format(path=str(module)) + other + code, statuses=(status,))
    assert not list(temporary.iterdir())


@pytest.mark.skipif(os.name == "nt", reason="Windows ends processes without telling them")
def test_the_command_leaves_nothing_when_it_is_told_to_end(module, temporary):
    command = [sys.executable, "-c", FORGOTTEN.format(path=str(module)) + WAITS]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as running:
        assert running.stdout.readline() == "ready\n"
        assert len(list(temporary.iterdir())) == 1
        running.terminate()
    assert running.returncode == 128 + signal.SIGTERM
    assert not list(temporary.iterdir())
