"""Key of the map of fidelity averaged: tells whether the one in hand is that of these parameters."""

from ..fields import MAP_LOSSES, MAP_SHAPE


def is_map_of(p, d):
    """Tell whether the map in d is that of these parameters (fields.MAP_KEY)."""
    for n in range(len(d.map_key)):
        if d.map_key[n] != key_number(p, d, n):
            return False
    return d.map_ready == 1.0


def key_number(p, d, n):
    """Number n of what the map depends on (fields.MAP_KEY)."""
    last = len(d.map_key) - 1
    if n == last:
        return p.drive
    if n == last - 1:
        return p.input_inertia
    if n == last - 2:
        return p.link2_inertia
    return p.numbers[n if n < MAP_SHAPE else n - MAP_SHAPE + MAP_LOSSES]


def mark_map(p, d):
    """Mark the map in d as that of these parameters."""
    for n in range(len(d.map_key)):
        d.map_key[n] = key_number(p, d, n)
    d.map_ready = 1.0
