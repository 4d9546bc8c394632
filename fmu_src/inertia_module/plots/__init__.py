"""Figures of mechanisms, scenes and studies."""
