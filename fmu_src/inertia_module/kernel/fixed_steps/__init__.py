"""The solvers: each follows one contact mode to its end or to that of a step."""
