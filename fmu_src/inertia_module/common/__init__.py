"""Modules that all layers use: errors, files, quantities with units, the terminal."""
