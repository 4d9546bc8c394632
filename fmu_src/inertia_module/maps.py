"""Maps of fidelity averaged, kept for the process: instances alike share the work of the first."""

from __future__ import annotations

import threading
from array import array
from collections import OrderedDict

from .kernel import slots

MOST_MAPS = 64

_lock = threading.Lock()
_maps: OrderedDict[bytes, bytes] = OrderedDict()


def _key(parameters: array[float]) -> bytes:
    """The parameters the map depends on."""
    mechanism = parameters[slots.P_LAYOUT : slots.P_J16 + 1]
    return mechanism.tobytes() + parameters[slots.P_J2 : slots.P_J2 + 1].tobytes()


def recall(parameters: array[float], derived: array[float]) -> None:
    """Copy the map of these parameters into the derived constants, if one is kept."""
    with _lock:
        kept = _maps.get(_key(parameters))
    if kept is not None:
        memoryview(derived).cast("B")[8 * slots.D_AVERAGED :] = kept


def keep(parameters: array[float], derived: array[float]) -> None:
    """Keep the map that the kernel has built; the oldest of too many is forgotten."""
    with _lock:
        _maps[_key(parameters)] = derived[slots.D_AVERAGED :].tobytes()
        _maps.move_to_end(_key(parameters))
        while len(_maps) > MOST_MAPS:
            _maps.popitem(last=False)
