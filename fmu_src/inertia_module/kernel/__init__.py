"""Numeric core of the inertia module: one idea a file, arrays of doubles in and out.

The functions below this package import ``math`` and each other, nothing else. They allocate
nothing and raise nothing (a status code comes back), so the same source runs as plain Python
and compiled (see :mod:`inertia_module.compiling.load`).
"""
