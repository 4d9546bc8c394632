"""HTML report of a scene."""
