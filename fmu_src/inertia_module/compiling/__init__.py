"""From the kernel's Python to machine code that can be called."""
