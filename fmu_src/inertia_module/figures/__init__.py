"""Figures of mechanisms, scenes and jobs, and the HTML report."""
