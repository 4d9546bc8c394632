"""Key of the map of fidelity averaged, the first numbers of p: tells whether the one in hand is theirs."""


def is_map_of(p, d):
    """Tell whether the map in d is that of these parameters."""
    for n in range(len(d.map_key)):
        if d.map_key[n] != p.numbers[n]:
            return False
    return d.map_ready == 1.0


def mark_map(p, d):
    """Mark the map in d as that of these parameters."""
    for n in range(len(d.map_key)):
        d.map_key[n] = p.numbers[n]
    d.map_ready = 1.0
