"""Test the command `new`, keys on the command line, the version, and the kernel in a wheel."""

import json
import re
import runpy
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from unittest.mock import Mock

import pytest
from rejected import assert_rejected

from inertia_module import __version__
from inertia_module.common.examples import example, examples
from inertia_module.common.files import cache_folder
from inertia_module.compiling import CompilationError, load
from inertia_module.fmu import builder
from inertia_module.interface.models import MODELS
from inertia_module.model import Module, choose_kernel
from inertia_module.scene import load_scene
from tests.system.programs import assert_one_line_error, command, process, stdout_of

ROOT = Path(__file__).parents[2]
COPIED = tomllib.loads(Path(__file__).with_name("new.toml").read_text(encoding="utf-8"))


def test_version_of_package_changelog_and_citation_agree():
    assert command("--version").stdout == f"inertia-module {__version__}\n"
    assert f"\n## [{__version__}] - " in (ROOT / "CHANGELOG.md").read_text()
    assert f"\nversion: {__version__}\n" in (ROOT / "CITATION.cff").read_text()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", COPIED)
def test_new_copies_an_example_with_its_files_and_prints_the_next_commands(name, folder):
    files, last_commands = COPIED[name]
    lines = command("new", name).stdout.splitlines()
    assert lines[: len(files) + 1] == [*(f"created: {file}" for file in files), "Next steps:"]
    commands = [line.removeprefix("  ") for line in lines[len(files) + 1 :]]
    assert "\n".join(commands).endswith(last_commands)
    source = example(name)
    assert Path(files[0]).read_bytes() == source.read_bytes()
    assert all((folder / file).read_bytes() == source.with_name(file).read_bytes() for file in files)
    message = f"error: {files[0]} already exists. Choose another name with -o.\n"
    assert command("new", name).stderr == message


def test_new_overwrites_no_files_and_lists_skipped_files_in_json(folder):
    printed = command("new", "fit_rig", "-o", "here/rig.toml").stdout.splitlines()[-1]
    assert printed.startswith("  inertia-module fit here/rig.csv here/rig.toml --free imbalance_mass=0.5:2")
    Path("here/rig.toml").unlink()
    again = command("new", "fit_rig", "-o", "here/rig.toml")
    assert_one_line_error(again, "rig.csv already exists. Choose another name with -o.")
    assert not Path("here/rig.toml").exists()
    printed = json.loads(stdout_of("new", "planar", "-o", "other.toml", "--json"))
    assert printed == {"files": ["other.toml"]}


def test_new_without_a_name_lists_all_examples_by_title():
    lines = stdout_of("new").splitlines()
    assert all(len(line) <= 80 for line in lines)
    titles = json.loads(stdout_of("new", "--json"))["examples"]
    assert titles["reference"] == "R1: a bevel inertia module starts a flywheel"
    assert titles["tutorial"].startswith("Tutorial: ")
    assert list(titles) == list(examples())
    names = [line.split()[0] for line in lines if re.match("  \\w", line)]
    assert sorted(names) == sorted(titles)
    words = " ".join(" ".join(lines).split())
    assert all(title and title in words for title in titles.values())


def test_all_scenes_programs_and_the_notebook_are_examples():
    files = [path for kind in ("toml", "ipynb", "py") for path in ROOT.glob(f"examples/**/*.{kind}")]
    parts = {"averaged_module.py", "frequency_response.py", "speed_control_margins.py"}
    parts |= {"speed_control_report.py", "fit_rig_data.py"}
    copied = [path for path in files if path.name not in parts and path.parent.name != "coupling"]
    assert sorted(copied) == sorted(examples().values())
    assert example("planar.py").suffix == ".py"
    assert_rejected(r"^unknown example 'plenary'; did you mean 'planar'\?$", example, "plenary")


def test_keys_are_set_as_in_a_scene_file_on_the_command_line_too(fmu, tmp_path):
    keys = ["imbalance_mass=1.5 kg", "drive.omega1=50 rad/s", "satellites=2", 'run.outputs=["omega2"]']
    scene = load_scene(example("planar"), keys)
    parameters = scene.parameters()
    assert (parameters["imbalance_mass"], parameters["satellites"]) == (1.5, 2)
    assert (scene.drive.omega1, scene.run.outputs) == (50.0, ["omega2"])
    tables = {"mechanism": scene.tables["mechanism"]}
    assert load_scene(example("planar"), tables).mechanism == scene.mechanism
    for keys, sentence in (
        ("imbalance_mass", r"expected KEY=VALUE \(got 'imbalance_mass'\)$"),
        (
            "imbalance_mas=1",
            r"planar.toml: unknown key 'mechanism.imbalance_mas'; did you mean ",
        ),
    ):
        assert_rejected(sentence, load_scene, example("planar"), [keys])
    options = ("--set", "run.stop_time=20 ms", "--set", "drive.omega1=60 rad/s", "--fmu", fmu, "--json")
    summary = json.loads(stdout_of("run", example("planar"), *options, "-o", tmp_path))["summary"]
    assert summary["simulated_time"] == pytest.approx(0.02)
    assert summary["omega1_maximum"] == 60.0


@pytest.mark.parametrize("name", ["planar", "reference"])
def test_scene_without_a_loop_runs_without_python_control(fmu, name):
    code = (
        "import sys; from inertia_module import load_scene, run_scene, scene_figure;"
        "scene_figure(run_scene(load_scene(sys.argv[1], {'run.stop_time': '10 ms'}), sys.argv[2]));"
        "print(sorted({'control', 'scipy'} & set(sys.modules)))"
    )
    assert process("-c", code, example(name), fmu).stdout == "[]\n"


def test_kernel_of_a_wheel_equals_the_kernel_of_its_native_fmu(built, tmp_path, monkeypatch, compiled):
    def run():
        module = Module(compiled).start(omega1=100.0, load_torque=5.0)
        module.advance(0.05)
        return module.snapshot()

    expected = run()
    monkeypatch.setenv("INERTIA_MODULE_CACHE", str(tmp_path))
    monkeypatch.setattr(load, "ready_made", lambda file: built / file)
    load.load.cache_clear()
    assert run() == expected
    load.load(MODELS["DrivenShaft"])
    load.load.cache_clear()
    assert {path.stem.partition("-")[0] for path in tmp_path.iterdir()} == set(MODELS)


# Memory is reserved without use. Then the kernel is loaded and runs.
FAR_APART = """
import numpy
from inertia_module.model import Module

held = [numpy.empty(3 * 2**30, "u1"), *(numpy.empty(200 * 2**20, "u1") for _ in range(20))]
module = Module("compiled").start(omega1=100.0, load_torque=10.0)
module.advance(0.01)
print(module["omega2"])
"""


def test_compiled_kernel_loads_at_distant_addresses(compiled):
    assert float(process("-c", FAR_APART).stdout) == pytest.approx(0.969128517, abs=1e-7)


def test_simultaneous_linkers_leave_a_single_complete_library(tmp_path, monkeypatch, compiled):
    for path in (*cache_folder().glob("DrivenShaft-*.o"), *cache_folder().glob("DrivenShaft-*.xz")):
        shutil.copy(path, tmp_path)
    (tmp_path / "zig").symlink_to(cache_folder() / "zig")
    before = set(tmp_path.iterdir())
    monkeypatch.setenv("INERTIA_MODULE_CACHE", str(tmp_path))
    code = "from inertia_module.model import DrivenShaft; DrivenShaft('compiled').load_kernel()"
    running = [subprocess.Popen([sys.executable, "-c", code]) for _ in range(2)]
    assert [process.wait() for process in running] == [0, 0]
    assert len(set(tmp_path.iterdir()) - before) == 1


def test_wheel_needs_no_build(built, tmp_path, monkeypatch):
    monkeypatch.setattr(builder, "ready_made", lambda file: built / file)
    monkeypatch.setattr(builder.NativeFmu, "content", lambda *_: pytest.fail("compiled"))
    assert builder.current_fmu(folder=tmp_path) == built / "InertiaModule.fmu"
    done = builder.build(tmp_path)
    assert not done.skipped
    assert all(path.read_bytes() == (built / path.name).read_bytes() for path in done.paths)
    assert command("export", example("planar"), "-o", tmp_path / "export").exit_code == 0


def test_plain_python_is_not_taken_silently(monkeypatch):
    monkeypatch.delenv("INERTIA_MODULE_KERNEL", raising=False)
    monkeypatch.setattr(load, "load", Mock(side_effect=CompilationError("there is no compiler")))
    with pytest.warns(
        RuntimeWarning, match=r"slower\. No compiled kernel is available: there is no compiler$"
    ):
        choose_kernel("auto")


def test_fmu_that_cannot_be_built_is_an_error(tmp_path, monkeypatch):
    nothing = builder.Build(skipped={"InertiaModule.fmu": "there is no compiler"})
    monkeypatch.setattr(builder, "build", lambda *_: nothing)
    with pytest.raises(RuntimeError, match=r"cannot build InertiaModule.fmu: there is no compiler"):
        builder.current_fmu(folder=tmp_path)


def test_installed_clone_excludes_built_files_and_sdist_gives_a_complete_wheel_or_an_error(tmp_path, built):
    pytest.importorskip("hatchling")
    hook = runpy.run_path(str(ROOT / "hatch_build.py"))["ReadyMade"]

    def forced(folder, version="standard"):
        """Return the folders in a wheel that its build fills from a folder."""
        data = {"force_include": {}}
        hook(str(folder), {}, None, None, "", "wheel").initialize(version, data)
        return set(data["force_include"].values())

    clone, sdist = tmp_path / "clone", tmp_path / "sdist"
    (clone / "build").mkdir(parents=True)
    (clone / "build" / "InertiaModule.fmu").write_bytes(b"of an older source")
    assert forced(clone) == {"inertia_module/examples"}
    assert forced(clone, "editable") == set()
    viewer = sdist / "fmu_src" / "inertia_module" / "viewer"
    viewer.mkdir(parents=True)
    (sdist / "PKG-INFO").touch()
    with pytest.raises(
        FileNotFoundError, match=r"missing files of the wheel: build/InertiaModule.fmu, .* Run make dist\.$"
    ):
        forced(sdist)
    (sdist / "build").symlink_to(built)
    (viewer / "template.html").touch()
    ready = {f"inertia_module/ready/{path.name}" for path in built.iterdir() if path.is_file()}
    assert forced(sdist) == ready | {"inertia_module/examples"}


def test_empty_name_of_the_cache_folder_is_ignored(monkeypatch):
    monkeypatch.delenv("INERTIA_MODULE_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", "")
    assert cache_folder().is_absolute()
