"""The elastic output alone."""
