"""Numeric core of the inertia module.

The functions of this package import ``math`` and each other, and read and write records of doubles
(fields.py). They allocate no memory and raise no exceptions, but return a status code. The same source
therefore runs as plain Python and compiled (:mod:`inertia_module.compiling.load`).
"""
