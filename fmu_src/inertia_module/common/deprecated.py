"""Deprecated names: each works for one release, with a DeprecationWarning that contains the new name.

MODULES lists the renamed modules, which a finder of the import system replaces. renamed_names and
renamed_attributes make the function __getattr__ of a module or of a class with renamed members, and
renamed_arguments a decorator for renamed arguments.
"""

from __future__ import annotations

import functools
import importlib
import importlib.abc
import importlib.util
import sys
import warnings
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any, ParamSpec, TypeVar

Arguments = ParamSpec("Arguments")
Returned = TypeVar("Returned")

PACKAGE = __name__.partition(".")[0]
# packages whose lines are not the user of a name
INTERNAL = (PACKAGE, "importlib", "pydantic")
# new name of each renamed module within the package; other modules in a renamed folder keep their names
MODULES = {
    "bridge": "control",
    "contract": "interface",
    "fidelity.trials": "fidelity.measure",
    "figures": "plots",
    "figures.jobs": "plots.studies",
    "figures.report": "report.html_report",
    "harness": "fmi",
    "harness.chart": "analysis.converter_chart",
    "harness.fmu": "fmi.instance",
    "jobs": "studies",
    "jobs.batch": "studies.batch_run",
    "jobs.design": "studies.design_search",
    "jobs.fit": "studies.parameter_fit",
    "jobs.orders": "studies.order_analysis",
    "jobs.sweep": "studies.parameter_sweep",
    "loops": "driveline",
    "memory": "model",
    "page": "viewer",
}


def warn_renamed(old: str, new: str) -> None:
    """Warn that a name is deprecated, at the line outside of this package that uses the name.

    Args:
        old: old name.
        new: new name.
    """
    frame = sys._getframe(1)
    while frame.f_back and str(frame.f_globals.get("__name__")).partition(".")[0] in INTERNAL:
        frame = frame.f_back
    values = frame.f_globals
    warnings.warn_explicit(
        f"{old} is deprecated; use {new}",
        DeprecationWarning,
        frame.f_code.co_filename,
        frame.f_lineno,
        values.get("__name__", "__main__"),
        values.setdefault("__warningregistry__", {}),
    )


def new_module(name: str) -> str | None:
    """Return the new name of a renamed module within the package; None for other modules.

    Args:
        name: old name within the package, such as "loops.engine".
    """
    folder, _, rest = name.partition(".")
    return MODULES.get(name) or (f"{MODULES[folder]}.{rest}" if folder in MODULES else None)


class RenamedModule(ModuleType):
    """A module under its old name; the first use of it warns."""

    has_warned = False

    def __getattr__(self, name: str) -> object:
        if name.startswith("__"):
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        new = f"{PACKAGE}.{new_module(self.__name__.partition('.')[2])}"
        value = getattr(importlib.import_module(new), name)
        if not self.has_warned:
            warn_renamed(self.__name__, new)
        self.has_warned = True
        setattr(self, name, value)
        return value


class RenamedModules(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finder and loader of the modules of this package under their old names."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return a specification of a renamed module, otherwise None.

        Args:
            fullname: absolute name of the module.
            path: search path of its parent, not used.
            target: module of a reload, not used.
        """
        package, _, name = fullname.partition(".")
        if package != PACKAGE or new_module(name) is None:
            return None
        return ModuleSpec(fullname, self, is_package=True)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Return the module of a specification.

        Args:
            spec: specification from find_spec.
        """
        name = spec.name.partition(".")[2]
        if importlib.util.find_spec(f"{PACKAGE}.{new_module(name)}") is None:
            raise ModuleNotFoundError(f"No module named {spec.name!r}", name=spec.name)
        return RenamedModule(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        """Do nothing, because a RenamedModule loads the new module at its first use.

        Args:
            module: module from create_module.
        """


def install() -> None:
    """Add the finder of renamed modules to the import system; first, because old empty folders can remain."""
    sys.meta_path.insert(0, RenamedModules())


def renamed_module(name: str) -> RenamedModule | None:
    """Import a module of this package by its old name, with a warning; return None for another name.

    Args:
        name: old name within the package.
    """
    if name not in MODULES:
        return None
    module = importlib.import_module(f"{PACKAGE}.{name}")
    assert isinstance(module, RenamedModule)
    if not module.has_warned:
        warn_renamed(module.__name__, f"{PACKAGE}.{MODULES[name]}")
    module.has_warned = True
    return module


def renamed_names(module: str, **names: str) -> Callable[[str], object]:
    """Return the function __getattr__ of a module whose names have changed.

    Args:
        module: absolute name of the module.
        names: new names by old name; "MODULE:NAME" for a name that is now in another module of the package.
    """

    def getattr_(name: str) -> object:
        if name not in names:
            raise AttributeError(f"module {module!r} has no attribute {name!r}")
        place, _, new = names[name].rpartition(":")
        new_place = f"{PACKAGE}.{place}" if place else module
        value: object = getattr(importlib.import_module(new_place), new)
        warn_renamed(f"{module}.{name}", f"{new_place}.{new}")
        setattr(sys.modules[module], name, value)  # an import reads the name twice, and warns once
        return value

    return getattr_


def renamed_attributes(**names: str) -> Callable[[object, str], Any]:
    """Return the method __getattr__ of a class whose attributes have changed their names.

    Args:
        names: new names by old name.
    """

    def getattr_(self: object, name: str) -> Any:
        kind = type(self).__name__
        if name not in names:
            raise AttributeError(f"{kind!r} object has no attribute {name!r}")
        warn_renamed(f"{kind}.{name}", f"{kind}.{names[name]}")
        return getattr(self, names[name])

    return getattr_


def renamed_arguments(
    **names: str,
) -> Callable[[Callable[Arguments, Returned]], Callable[Arguments, Returned]]:
    """Return a decorator that accepts arguments under their old names.

    Args:
        names: new names by old name.
    """

    def decorate(function: Callable[Arguments, Returned]) -> Callable[Arguments, Returned]:
        @functools.wraps(function)
        def call(*values: Arguments.args, **options: Arguments.kwargs) -> Returned:
            for old in options.keys() & names.keys():
                warn_renamed(f"{function.__qualname__}({old}=...)", f"{names[old]}=...")
                if names[old] in options:
                    raise TypeError(f"{function.__qualname__} got both {old} and {names[old]}")
                options[names[old]] = options.pop(old)
            return function(*values, **options)

        return call

    return decorate
