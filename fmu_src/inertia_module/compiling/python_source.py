"""Source text of the kernel: syntax trees, comments, and the modules that define names."""

from __future__ import annotations

import ast
import functools
import importlib.util
import io
import sys
import tokenize
import types
from pathlib import Path
from typing import Any, NamedTuple

from . import CompilationError

# result of the look-up of a local name of a function
LOCAL = object()


class KernelLanguageError(CompilationError):
    """A construct of Python is outside the language of the kernel; the message contains file and line."""


class SourceFile(NamedTuple):
    """A file of Python.

    Attributes:
        path: path of the file.
        tree: syntax tree.
        comments: comments without the sign #, by line number.
    """

    path: Path
    tree: ast.Module
    comments: dict[int, str]


@functools.cache
def source_file(module: str) -> SourceFile:
    """Read the source of an imported module.

    Args:
        module: name of the module.
    """
    path = Path(str(sys.modules[module].__file__))
    text = path.read_text(encoding="utf-8")
    comments = {}
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT and "fmt:" not in token.string:
            comments[token.start[0]] = token.string.lstrip("# ").replace("*/", "* /")
    return SourceFile(path, ast.parse(text), comments)


@functools.cache
def definition(function: types.FunctionType) -> ast.FunctionDef:
    """Return the syntax tree of a function.

    Args:
        function: function of a module.

    Raises:
        KernelLanguageError: the function is not defined at the top level of a module.
    """
    for statement in source_file(function.__module__).tree.body:
        if isinstance(statement, ast.FunctionDef) and statement.name == function.__name__:
            return statement
    raise KernelLanguageError(f"{function.__module__}.{function.__qualname__} must be a function of a module")


@functools.cache
def defining_module(module: str, name: str) -> tuple[str, str]:
    """Return the module that defines a name, and its name there.

    Args:
        module: module that uses the name.
        name: the name in this module.
    """
    for statement in source_file(module).tree.body:
        if isinstance(statement, ast.ImportFrom):
            for alias in statement.names:
                if name == (alias.asname or alias.name):
                    relative = "." * statement.level + (statement.module or "")
                    package = sys.modules[module].__package__
                    return defining_module(importlib.util.resolve_name(relative, package), alias.name)
    return module, name


class Scope:
    """Names of a function: its local names and the names of its module.

    Args:
        function: the function.

    Attributes:
        module: name of the module.
        path: path of the module.
        tree: syntax tree of the function.
        parameters: names of the parameters.
        local: names of parameters and local variables.
    """

    def __init__(self, function: types.FunctionType) -> None:
        self.module = function.__module__
        self.path = source_file(self.module).path
        self.tree = definition(function)
        self.parameters = [argument.arg for argument in self.tree.args.args]
        self.local = {*self.parameters, *stored_names(self.tree)}

    def reject(self, node: ast.AST, reason: str) -> KernelLanguageError:
        """Return the error for a construct outside the language.

        Args:
            node: the construct.
            reason: message.
        """
        line = getattr(node, "lineno", self.tree.lineno)
        return KernelLanguageError(f"{self.path}:{line}: {reason}")

    def look_up(self, node: ast.AST) -> Any:
        """Return the value of a global name or of an attribute of a module; otherwise LOCAL.

        Args:
            node: the name or attribute.
        """
        if isinstance(node, ast.Name) and node.id not in self.local:
            return vars(sys.modules[self.module]).get(node.id, LOCAL)
        if isinstance(node, ast.Attribute):
            base = self.look_up(node.value)
            return getattr(base, node.attr) if isinstance(base, types.ModuleType) else LOCAL
        return LOCAL

    def origin(self, node: ast.Name | ast.Attribute) -> tuple[str, str]:
        """Return the module that defines a constant, and its name there.

        Args:
            node: the name or attribute.
        """
        if isinstance(node, ast.Name):
            return defining_module(self.module, node.id)
        return defining_module(self.look_up(node.value).__name__, node.attr)


def stored_names(*nodes: ast.AST) -> list[str]:
    """Return the names that statements assign to, in the order of the text, with repetitions.

    Args:
        nodes: syntax trees of the statements.
    """
    names = (name for node in nodes for name in ast.walk(node) if isinstance(name, ast.Name))
    return [name.id for name in names if isinstance(name.ctx, ast.Store)]


def mentions(node: ast.AST, name: str) -> bool:
    """Return True if an expression or a statement mentions a name.

    Args:
        node: syntax tree.
        name: the name.
    """
    return any(isinstance(part, ast.Name) and part.id == name for part in ast.walk(node))
