"""Simulation of FMUs with access by name: instances, runs, checks, charts."""
