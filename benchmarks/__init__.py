"""Benchmarks: measurements of the speeds in the documentation (`make bench`)."""
