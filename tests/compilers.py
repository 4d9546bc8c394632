"""C compilers of the system."""

import os
import shutil
import subprocess

import pytest


def system_compiler(flags=()):
    """Return a C compiler of the system whose programs run with these flags; otherwise skip the test."""
    program = "int main(void) { return 0; }"
    for path in filter(None, map(shutil.which, ("gcc", "clang", "cc"))):
        command = [path, *flags, "-x", "c", "-", "-o", os.devnull]
        done = subprocess.run(command, input=program, text=True, capture_output=True, check=False)
        if done.returncode == 0:
            return path
    pytest.skip(f"no C compiler of the system makes programs that run with {' '.join(flags) or '-'}")
