"""Simulation of FMUs with access by name: instances, runs, results, checks."""
