"""Log messages of FMU instances: each to its own, whatever fmpy's one logger of a process makes of them."""

from __future__ import annotations

import contextlib
import functools
import weakref
from collections.abc import Callable, Iterator
from ctypes import byref
from typing import Any, Protocol

# status of a warning in FMI 2.0; above it are errors
WARNING = 1


class Listener(Protocol):
    """Receiver of the messages of an instance."""

    def on_message(self, status: int, message: str) -> None:
        """Take a message; status as in FMI 2.0."""


# instances by the environment their callbacks carry, and what takes the messages of all others
_listeners: weakref.WeakValueDictionary[int, Listener] = weakref.WeakValueDictionary()
_others: list[tuple[list[str], list[str]]] = []


def _dispatch(environment: int | None, instance: bytes, status: int, category: bytes, message: bytes) -> None:
    """Pass a log message on to the instance it is for; others are printed, as fmpy does."""
    from fmpy.fmi1 import printLogMessage

    listener = _listeners.get(environment or 0)
    if listener is not None:
        listener.on_message(status, message.decode("utf-8", "replace"))
    elif _others and status > 0:
        warnings, errors = _others[-1]
        (warnings if status == WARNING else errors).append(message.decode("utf-8", "replace"))
    elif not _others:
        printLogMessage(environment, instance, status, category, message)


def pass_on(environment: int | None, status: int, category: bytes, message: bytes) -> None:
    """Log callback of an instance of FMI 3.0 that fmpy makes itself: its messages are no printf formats."""
    _dispatch(environment, b"", status, category, message)


def log_of(listener: Listener) -> Callable[..., None]:
    """Log callback of one instance of FMI 3.0."""
    known = weakref.ref(listener)

    def log(environment: int | None, status: int, category: bytes, message: bytes) -> None:
        found = known()
        if found is not None:
            found.on_message(status, message.decode("utf-8", "replace"))

    return log


@functools.cache
def _dispatcher() -> Any:
    from fmpy.fmi2 import fmi2CallbackLoggerTYPE

    return fmi2CallbackLoggerTYPE(_dispatch)


def _logger() -> Any:
    """The log callback of all instances, made anew the one that fmpy's proxy passes messages to.

    The proxy, which formats the messages, knows one callback a process: the last one given.
    """
    from fmpy.fmi2 import fmi2CallbackFunctions
    from fmpy.logging import addLoggerProxy

    callbacks = fmi2CallbackFunctions()
    callbacks.logger = _dispatcher()
    addLoggerProxy(byref(callbacks))
    return callbacks.logger


def callbacks_of(listener: Listener) -> Any:
    """Callbacks of one instance, with its own environment."""
    from fmpy.fmi1 import calloc, free
    from fmpy.fmi2 import (
        fmi2CallbackAllocateMemoryTYPE,
        fmi2CallbackFreeMemoryTYPE,
        fmi2CallbackFunctions,
    )

    callbacks = fmi2CallbackFunctions()
    callbacks.logger = _logger()
    callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
    callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
    callbacks.componentEnvironment = id(listener)
    _listeners[id(listener)] = listener
    return callbacks


@contextlib.contextmanager
def messages_of_others(warnings: list[str] | None = None) -> Iterator[list[str]]:
    """Collect warnings and errors of instances that fmpy makes itself.

    Args:
        warnings: list for the warnings; by default they come with the errors.
    """
    _logger()
    messages: list[str] = []
    _others.append((messages if warnings is None else warnings, messages))
    try:
        yield messages
    finally:
        _others.pop()
