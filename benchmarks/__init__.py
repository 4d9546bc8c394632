"""Benchmarks: what the docs say of speed, measured (`make bench`)."""
