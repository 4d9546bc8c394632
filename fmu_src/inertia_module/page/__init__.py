"""The module in a browser: one HTML file with the machine, its kernel and a run."""
