"""Test the language of the kernel: each construct gives the same bits in C; other constructs are rejected."""

import ctypes
import importlib.util
import itertools
import os
import subprocess
import sys

import kernel_language as language
import pytest

from inertia_module.compiling.c_compiler import link
from inertia_module.compiling.c_types import DOUBLE, INT
from inertia_module.compiling.python_source import KernelLanguageError
from inertia_module.compiling.targets import host_target
from inertia_module.compiling.translate import HEAD, INLINED, KernelTranslator, c_name, translate
from inertia_module.interface.models import DRIVEN_SHAFT, INERTIA_MODULE
from inertia_module.interface.records import record_type

KERNEL_HEADER = b"#include <stdint.h>\n"
EXPORTED = '__attribute__((visibility("default"))) double run_{name}(double a, double b, int64_t n, {record})'


def new_translator():
    names = {
        id(language.RECORD): "x",
        id(language.RECORD[3][1]): "inner",
        id(language.RECORD[4][1]): "several",
    }
    return KernelTranslator(names)


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """Return a shared library with all functions of kernel_language."""
    pytest.importorskip("ziglang", reason="ziglang is not installed")
    translator = new_translator()
    record = translator.record(language.RECORD)
    wrappers = []
    for function in language.FUNCTIONS:
        name, _ = translator.call(function, (DOUBLE, DOUBLE, INT, record))
        head = EXPORTED.format(name=function.__name__, record="struct kernel_x *x")
        wrappers += [f"{head};", f"{head}\n{{\n    return {name}(a, b, n, x);\n}}"]
    text = "\n".join([HEAD.format(name="test"), translator.definitions(), *wrappers, ""])
    path = tmp_path_factory.mktemp("language") / f"language{host_target().suffix}"
    path.write_bytes(link(host_target(), path.name, {"language.c": text.encode(), "kernel.h": KERNEL_HEADER}))
    return ctypes.CDLL(str(path))


@pytest.mark.parametrize("function", language.FUNCTIONS, ids=lambda function: function.__name__)
def test_a_construct_gives_the_same_bits_in_c(function, library):
    kind = record_type(language.RECORD)
    in_c = getattr(library, f"run_{function.__name__}")
    in_c.restype, in_c.argtypes = ctypes.c_double, [ctypes.c_double] * 2 + [ctypes.c_int64, ctypes.c_void_p]
    for a, b, n in itertools.product((2.75, -3.5, 0.3), (1.25, -0.5, 0.3), (1, 2, 5)):
        in_python = kind()
        in_python.numbers[:] = [0.5 + 0.25 * place for place in range(len(in_python.numbers))]
        record = kind.from_buffer_copy(in_python)
        expected = function(a, b, n, in_python)
        assert in_c(a, b, n, ctypes.addressof(record)) == float(expected), (a, b, n)
        assert bytes(record) == bytes(in_python), (a, b, n)


# A statement in a function f(a, n, x), and a part of the message.
OUTSIDE = {
    "y = [a, a]": "List|\\[a, a\\]",
    "y = {1: a}": "outside the language",
    "y = [i for i in x.row]": "outside the language",
    "y = f'{a}'": "outside the language",
    "y = lambda: a": "outside the language",
    "y = 'text'": "a constant must be a number \\(got 'text'\\)",
    "with a: pass": "outside the language",
    "try:\n        y = a\n    except ValueError:\n        y = 0.0": "outside the language",
    "raise ValueError": "outside the language",
    "assert a > 0.0": "outside the language",
    "del a": "outside the language",
    "import math": "outside the language",
    "global TABLE": "outside the language",
    "y: float = a": "outside the language",
    "for i in (1, 2): y = i": "for name in range",
    "for i in x.row: y = i": "for name in range",
    "for i in range(0, n, n): y = i": "step n must be an integer constant of at least 1",
    "for i in range(n, 0, -1): y = i": "step -1 must be an integer constant of at least 1",
    "pass": "pass is outside the language",
    "return a, 1.0": "no type holds the values",
    "while a > 1.0:\n        a -= 1.0\n    else:\n        a = 0.0": "outside the language",
    "for i in range(n):\n        a += 1.0\n    else:\n        a = 0.0": "outside the language",
    "y = a in (1.0, 2.0)": "unknown operator in a in",
    "y = a is None": "unknown operator|must be a number",
    "y = a // 2.0": "unknown operator in a // 2.0",
    "y = a ** 2": "write a \\*\\* 2 as a product",
    "y = n << 1": "unknown operator",
    "y = ~n": "unknown operator",
    "y = x.row[-1]": "must be an integer of at least 0",
    "y = x.row[a]": "index a must be an integer",
    "y = x.row[0:2]": "outside the language",
    "y = a[0]": "must be an array",
    "y = x.third": "unknown field third of kernel_x",
    "y = a.real": "must be a record",
    "y = unknown": "unknown name unknown",
    "y = unknown(a)": "unknown function unknown",
    "y = sum(x.row)": "unknown function sum",
    "y = math.gamma(a)": "unknown function math.gamma",
    "y = abs(n)": "argument of abs must be a float",
    "y = max(x.inner, x.inner)": "arguments of max must be numbers",
    "y = total_of(numbers=x.row)": "no keywords",
    "y = pair(a)": "pair must have 2 arguments \\(got 1\\)",
    "y, z = pair(a, 1.0), 1.0, 2.0": "as many values",
    "y, z = a": "as many values",
    "y = pair(a, 1.0) == (a, 1.0)": "must be a number",
    "y = -pair(a, 1.0)": "must be a number",
    "y = x.row\n    y = a": "no type holds the values",
    "x.row = x.row": "number by number",
    "a, n = n, a": "a value reads an earlier target",
    "x.first, a = 1.0, x.first": "a value reads an earlier target",
    "a + 1.0": "has no effect",
    "y = 0.0 < total_of(x.row) < 1.0": "would evaluate total_of\\(x.row\\) twice",
    "y = bump(x) + bump(x)": "C may evaluate bump\\(x\\)",
    "y = bump(x) + x.first": "C may evaluate bump\\(x\\)",
    "y = x.first - 2.0 * bump(x)": "C may evaluate 2.0 \\* bump\\(x\\)",
    "y = max(bump(x), x.first)": "C may evaluate",
    "y = pair(bump(x), bump(x))": "C may evaluate",
    "y = x.first < bump(x)": "C may evaluate",
    "x.first += bump(x)": "C may evaluate",
    "x.row[int(x.first)] = bump(x)": "C may evaluate",
    "if bump(x) > x.first: a = 0.0": "C may evaluate",
    "y = through(x) * x.first": "C may evaluate",
    "y = f(a, n, x)": "must not call itself",
    "y = with_default(a, a)": "with_default must have plain arguments",
    "y = TEXTS[0]": "TEXTS must be a number or a table",
}
MODULE = """
import math
from kernel_language import TABLE, pair, total_of

TEXTS = ("a", "b")


def bump(x):
    x.first += 1.0
    return x.first


def through(x):
    return bump(x)


def with_default(a, b=1.0):
    return a + b


def f(a, n, x):
    {statement}
    return 0.0
"""


def function_of(statement, tmp_path, monkeypatch):
    """Return the function f of a module that contains this statement."""
    path = tmp_path / "outside_language.py"
    path.write_text(MODULE.format(statement=statement))
    spec = importlib.util.spec_from_file_location(f"outside_language_{abs(hash(statement))}", path)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, spec.name, module)
    spec.loader.exec_module(module)
    return module.f


def translated(function):
    translator = new_translator()
    translator.call(function, (DOUBLE, INT, translator.record(language.RECORD)))
    return translator.definitions()


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
@pytest.mark.parametrize("statement", OUTSIDE)
def test_a_construct_outside_the_language_is_rejected(statement, tmp_path, monkeypatch):
    function = function_of(statement, tmp_path, monkeypatch)
    with pytest.raises(KernelLanguageError, match=OUTSIDE[statement]) as error:
        translated(function)
    path, line, _ = str(error.value).split(":", 2)
    assert path.endswith(".py")
    assert int(line) > 1


@pytest.mark.parametrize(
    "statement",
    [
        "y = bump(x) + a",  # No other expression reads the record.
        "y = bump(x) > 1.0 and x.first > 2.0",  # The evaluation goes from left to right.
        "y = bump(x) if a > 0.0 else x.first",
        "x.first = bump(x)",
        "a += bump(x)",
    ],
)
def test_writing_call_is_accepted_with_a_certain_order(statement, tmp_path, monkeypatch):
    assert "bump(x)" in translated(function_of(statement, tmp_path, monkeypatch))


def test_comments_and_docstrings_stay(tmp_path, monkeypatch):
    text = translated(
        function_of('"""Return 0."""\n    # the reason\n    y = a  # beside it', tmp_path, monkeypatch)
    )
    assert "/* Return 0. */" in text
    assert "    /* the reason */\n    /* beside it */\n    double y = a;" in text


def test_the_same_source_gives_the_same_text():
    """Processes with other hash seeds have other orders of sets."""
    command = [sys.executable, "-m", "inertia_module.compiling.translate", DRIVEN_SHAFT.name]
    texts = [
        subprocess.run(
            command, env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True, check=True
        ).stdout
        for seed in ("1", "2")
    ]
    assert texts[0] == texts[1] == translate(DRIVEN_SHAFT).encode()


def test_inlined_functions_exist():
    text = translate(INERTIA_MODULE)
    for name in INLINED:
        module, _, function = name.rpartition(".")
        assert f"{c_name(module, function)}(" in text, name


def test_lines_are_readable():
    lines = translate(INERTIA_MODULE).splitlines()
    assert max(map(len, lines)) <= 120
