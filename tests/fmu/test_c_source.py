"""The kernel in C: bits of the machine code; every kind of instruction; what there is no C for."""

import ctypes
import itertools
import math
import operator
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


# a kernel of its own: entry and what it calls; x in x[0] and x[1], results from y[0] on
PROGRAM = Path(__file__).with_name("instructions.ll").read_text()


def kernel_of(text, tmp_path, monkeypatch):
    """The entry of a text in LLVM's language, by way of C."""
    monkeypatch.setattr(c_source, "llvm_text", lambda model: text.replace("ENTRY", model.symbol))
    kernel = ctypes.CDLL(str(library_of(c_source.c_source(DRIVEN_SHAFT), tmp_path))).inertia_module_kernel
    kernel.argtypes, kernel.restype = load.CALLS[""], ctypes.c_int64
    return kernel


def test_instructions_do_what_llvm_says(tmp_path, monkeypatch):
    kernel = kernel_of(PROGRAM, tmp_path, monkeypatch)
    x, y = (ctypes.c_double * 2)(3.0, -200.7), (ctypes.c_double * 8)()
    assert kernel(0, None, None, None, x, y, None, 5.0) == 2
    # -200 % 3 is -2 with the sign of C; -200 >> 1 is -100; the lowest byte of -200 is 56
    assert list(y[:3]) == [-401.4, 2.5, min(-2 * (-2 - 100), 56)]
    assert y[3] == struct.unpack("<Q", b'\\"' + bytes(6))[0]
    assert str(list(y[4:7])) == "[1.0, -0.0, 2.5]"
    assert bytes(y)[56] == 3
    assert kernel(0, None, None, None, x, y, None, 2.0) == -1
    assert kernel(0, None, None, None, x, y, None, float("nan")) == -1


ORDER = {name: getattr(operator, name) for name in ("lt", "le", "gt", "ge")}


def compared(first, second):
    """Every comparison that there is C for, and what LLVM has it be."""
    none = math.isnan(first + second)
    found = {"fcmp oeq": first == second, "fcmp une": first != second, "fcmp ord": not none, "fcmp uno": none}
    found |= {"fcmp one": not none and first != second, "fcmp ueq": none or first == second}
    for name, of in ORDER.items():
        found |= {f"fcmp o{name}": of(first, second), f"fcmp u{name}": none or of(first, second)}
    numbers = [0 if math.isnan(value) else int(value) for value in (first, second)]
    found |= {"icmp eq": operator.eq(*numbers), "icmp ne": operator.ne(*numbers)}
    for name, of in ORDER.items():
        found |= {f"icmp s{name}": of(*numbers), f"icmp u{name}": of(*(value % 2**64 for value in numbers))}
    return found


def test_comparisons_are_true_where_those_of_llvm_are(tmp_path, monkeypatch):
    names = compared(0.0, 0.0)
    assert set(names) == {name for name in c_source.CALCULATIONS if "cmp" in name}
    lines = [next(line for line in PROGRAM.splitlines() if line.startswith("define")), "entry:"]
    for record, kind in (("u", "i64"), ("x", "double")):
        lines += [f"  %{record}_b = getelementptr i8, ptr %{record}, i64 8"]
        lines += [
            f"  %{record}0 = load {kind}, ptr %{record}",
            f"  %{record}1 = load {kind}, ptr %{record}_b",
        ]
    for n, name in enumerate(names):
        operands = "double %x0, %x1" if name.startswith("f") else "i64 %u0, %u1"
        lines += [f"  %truth{n} = {name} {operands}", f"  %whole{n} = zext i1 %truth{n} to i64"]
        lines += [
            f"  %place{n} = getelementptr i8, ptr %y, i64 {8 * n}",
            f"  store i64 %whole{n}, ptr %place{n}",
        ]
    text = "\n".join([*lines, "  ret i64 0", "}", ""])
    kernel = kernel_of(text, tmp_path, monkeypatch)
    for values in itertools.product((-1.0, 2.0, 3.0, math.nan), repeat=2):
        x, truths = (ctypes.c_double * 2)(*values), (ctypes.c_int64 * len(names))()
        u = (ctypes.c_int64 * 2)(*(0 if math.isnan(value) else int(value) for value in values))
        assert kernel(0, None, None, u, x, truths, None, 0.0) == 0
        assert dict(zip(names, map(bool, truths), strict=True)) == compared(*values), values


@pytest.mark.parametrize(
    "line",
    [
        *("%b = bitcast double %h to i64", "%b = fadd half %h, %h", "call void @asm sideeffect(i64 1)"),
        "store double %h, ptr inttoptr (i64 8 to ptr)",
    ],
)
def test_what_there_is_no_c_for_is_told(line, monkeypatch):
    text = f"define i64 @{DRIVEN_SHAFT.symbol}(i64 %op, double %h) {{\nentry:\n  {line}\n  ret i64 0\n}}\n"
    monkeypatch.setattr(c_source, "llvm_text", lambda model: text)
    with pytest.raises(CompilationUnavailable, match="cannot translate to C: "):
        c_source.c_source(DRIVEN_SHAFT)
