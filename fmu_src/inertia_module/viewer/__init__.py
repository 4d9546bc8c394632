"""Interactive viewer: one HTML file with the mechanism, the kernel and a recorded run."""
