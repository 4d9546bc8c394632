"""The kernel in C: bits of the machine code; every kind of instruction; what there is no C for."""

import ctypes
import struct
from pathlib import Path

import pytest

from inertia_module.common.files import sources
from inertia_module.compiling import CompilationUnavailable, load
from inertia_module.compiling.linking import link
from inertia_module.compiling.targets import here
from inertia_module.contract.models import DRIVEN_SHAFT
from inertia_module.fmu import c_source
from inertia_module.fmu.linking import shell_files
from inertia_module.memory import DrivenShaft


def library_of(text, tmp_path):
    """A shared library of a kernel in C."""
    pytest.importorskip("ziglang", reason="ziglang is not installed")
    files = {name: file for name, file in shell_files(DRIVEN_SHAFT, "", 2).items() if name.endswith(".h")}
    files |= {"kernel.c": text.encode(), "entry.c": sources("compiling/entry.c")["compiling/entry.c"]}
    path = tmp_path / f"kernel{here().suffix}"
    path.write_bytes(link(here(), path.name, files, f"-DKERNEL={DRIVEN_SHAFT.symbol}"))
    return path


def run():
    """State of a driven shaft after some steps."""
    shaft = DrivenShaft("compiled").start(hub_speed=50.0, load_torque=3.0)
    for _ in range(20):
        shaft.advance(0.01)
    return shaft.save()


def test_a_kernel_in_c_has_the_bits_of_the_machine_code(tmp_path, monkeypatch, compiled):
    expected = run()
    path = library_of(c_source.c_source(DRIVEN_SHAFT), tmp_path)
    monkeypatch.setattr(load, "_library", lambda model: path)
    load.load.cache_clear()
    found = run()
    load.load.cache_clear()
    assert found == expected


def test_instructions_do_what_llvm_says(tmp_path, monkeypatch):
    program = Path(__file__).with_name("instructions.ll").read_text()
    text = program.replace("ENTRY", DRIVEN_SHAFT.symbol)
    monkeypatch.setattr(c_source, "llvm_text", lambda model: text)
    kernel = ctypes.CDLL(str(library_of(c_source.c_source(DRIVEN_SHAFT), tmp_path))).inertia_module_kernel
    kernel.argtypes, kernel.restype = load.CALLS[""], ctypes.c_int64
    x, y = (ctypes.c_double * 2)(3.0, -200.7), (ctypes.c_double * 8)()
    assert kernel(0, None, None, None, x, y, None, 5.0) == 2
    # -200 % 3 is -2 with the sign of C; -200 >> 1 is -100; the lowest byte of -200 is 56
    assert list(y[:3]) == [-401.4, 0.0, min(-2 * (-2 - 100), 56)]
    assert y[3] == struct.unpack("<Q", b'\\"' + bytes(6))[0]
    assert str(list(y[4:7])) == "[1.0, -0.0, 1.5]"
    assert bytes(y)[56] == 7
    assert kernel(0, None, None, None, x, y, None, 2.0) == -1
    assert kernel(0, None, None, None, x, y, None, float("nan")) == -1


@pytest.mark.parametrize(
    "line", ["%b = bitcast double %h to i64", "%b = fadd half %h, %h", "call void @asm sideeffect(i64 1)"]
)
def test_what_there_is_no_c_for_is_told(line, monkeypatch):
    text = f"define i64 @{DRIVEN_SHAFT.symbol}(i64 %op, double %h) {{\nentry:\n  {line}\n  ret i64 0\n}}\n"
    monkeypatch.setattr(c_source, "llvm_text", lambda model: text)
    with pytest.raises(CompilationUnavailable, match="there is no C for"):
        c_source.c_source(DRIVEN_SHAFT)
