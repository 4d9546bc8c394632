"""Maps of fidelity averaged, kept for the process: instances alike share the work of the first."""

from __future__ import annotations

import threading
from collections import OrderedDict
from typing import Any

from ..kernel import fields

MOST_MAPS = 64
# what the kernel's build_map writes and is to find again
_FIELDS = ("map_ready", "map_key", "map_lock", "map_inertia", "map_evaluations", "forward", "backward")

_lock = threading.Lock()
_maps: OrderedDict[tuple[float, ...], Any] = OrderedDict()


def _key(parameters: Any) -> tuple[float, ...]:
    """The parameters the map depends on."""
    return tuple(getattr(parameters, name) for name in fields.MAP_KEY)


def recall(parameters: Any, derived: Any) -> None:
    """Copy the map of these parameters into the record of derived constants, if one is kept."""
    with _lock:
        kept = _maps.get(_key(parameters))
    if kept is not None:
        for name in _FIELDS:
            setattr(derived, name, getattr(kept, name))


def keep(parameters: Any, derived: Any) -> None:
    """Keep the map that the kernel has built; the oldest of too many is forgotten."""
    with _lock:
        _maps[_key(parameters)] = type(derived).from_buffer_copy(derived)
        _maps.move_to_end(_key(parameters))
        while len(_maps) > MOST_MAPS:
            _maps.popitem(last=False)
