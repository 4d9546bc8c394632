"""Models in memory, by names; the FMUs are shells of them."""
