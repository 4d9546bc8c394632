"""Command line as ``python -m inertia_module``."""

from .cli import main

main()
