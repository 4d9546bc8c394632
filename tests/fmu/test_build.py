import os
import subprocess
import sys

import pytest

from inertia_module import compiled
from inertia_module.fmu import builder

FLAVOURS = ("InertiaModulePy", "DrivenShaft")
DRIVE = """
import sys
for name in {blocked!r}:
    sys.modules[name] = None
from inertia_module.instance import Fmu
with Fmu({path!r}, inputs={{{drive!r}: 100.0, "load_torque": 10.0}}, tolerance=1e-9) as fmu:
    fmu.advance(1.0)
    print(fmu.messages[0])
    print(fmu["omega_out"].hex())
"""


def drive(path, blocked=(), **environment):
    drive = "hub_speed" if path.stem == "DrivenShaft" else "omega1"
    code = DRIVE.format(path=str(path), blocked=list(blocked), drive=drive)
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=os.environ | environment
    )
    return done.stdout.splitlines()


def test_host_without_numba_runs_the_plain_kernel_with_the_same_bits(fmu_path):
    compiled_message, compiled_result = drive(fmu_path)
    plain_message, plain_result = drive(fmu_path, blocked=("numba", "llvmlite"))
    assert compiled_message == "the kernel is compiled"
    assert "plain Python" in plain_message
    assert plain_result == compiled_result


def test_compiled_kernel_is_kept_in_a_cache(fmu_path):
    drive(fmu_path)
    # with the cache there, numba is not imported any more
    assert drive(fmu_path, blocked=("numba",))[0] == "the kernel is compiled"


def test_interrupted_build_leaves_the_old_file_and_no_other(tmp_path, monkeypatch):
    paths = builder.build(tmp_path)
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


def test_build_says_what_it_is_doing(tmp_path, monkeypatch):
    monkeypatch.setattr(builder, "is_cached", lambda name: False)
    stages = []
    builder.build(tmp_path / "new" / "folder", stages.append)
    assert stages[:2] == ["packing InertiaModulePy.fmu", "packing DrivenShaft.fmu"]
    assert "compiling the kernel" in stages[2]


def test_build_tells_when_there_is_no_compiler(tmp_path, monkeypatch):
    def unavailable(name):
        raise compiled.CompilationUnavailable("no numba here")

    monkeypatch.setattr(builder, "load", unavailable)
    stages = []
    builder.build(tmp_path, stages.append)
    assert "no numba here" in stages[-1]
