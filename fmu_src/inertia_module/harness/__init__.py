"""FMUs driven by names: instances, runs, systems."""
