"""The motion in fixed steps, complementarity of impulses and end velocities in each."""
