"""Source text of the kernel: trees, comments, and where a name is defined."""

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

from . import CompilationUnavailable

# result of a look-up of a name that only the function knows
LOCAL = object()


class NotInLanguage(CompilationUnavailable):
    """A construct of Python that is outside the language of the kernel, with file and line."""


class Comment(NamedTuple):
    """A comment: its text, and whether the line has nothing else."""

    text: str
    is_alone: bool


class SourceFile(NamedTuple):
    """A file of Python: its path, its tree, and its comments by line."""

    path: Path
    tree: ast.Module
    comments: dict[int, Comment]


@functools.cache
def source_file(module: str) -> SourceFile:
    """Read the source of an imported module."""
    path = Path(str(sys.modules[module].__file__))
    text = path.read_text(encoding="utf-8")
    comments = {}
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT and "fmt:" not in token.string:
            is_alone = not token.line[: token.start[1]].strip()
            comments[token.start[0]] = Comment(token.string.lstrip("# ").replace("*/", "* /"), is_alone)
    return SourceFile(path, ast.parse(text), comments)


@functools.cache
def definition(function: types.FunctionType) -> ast.FunctionDef:
    """Return the tree of a function of a module."""
    for statement in source_file(function.__module__).tree.body:
        if isinstance(statement, ast.FunctionDef) and statement.name == function.__name__:
            return statement
    raise NotInLanguage(f"{function.__module__}.{function.__qualname__} must be a function of a module")


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
    """Names of a function: its local ones, and those of its module.

    Args:
        function: the function.
    """

    def __init__(self, function: types.FunctionType) -> None:
        self.module = function.__module__
        self.path = source_file(self.module).path
        self.tree = definition(function)
        self.parameters = [argument.arg for argument in self.tree.args.args]
        self.local = {*self.parameters, *stored_names(self.tree)}

    def reject(self, node: ast.AST, reason: str) -> NotInLanguage:
        """Return the error for a construct outside the language."""
        line = getattr(node, "lineno", self.tree.lineno)
        return NotInLanguage(f"{self.path}:{line}: {reason}")

    def look_up(self, node: ast.AST) -> Any:
        """Return the value of a name, or of a name of a module, outside the function; else LOCAL."""
        if isinstance(node, ast.Name) and node.id not in self.local:
            return vars(sys.modules[self.module]).get(node.id, LOCAL)
        if isinstance(node, ast.Attribute):
            base = self.look_up(node.value)
            return getattr(base, node.attr) if isinstance(base, types.ModuleType) else LOCAL
        return LOCAL

    def origin(self, node: ast.Name | ast.Attribute) -> tuple[str, str]:
        """Return the module that defines a constant, and its name there."""
        if isinstance(node, ast.Name):
            return defining_module(self.module, node.id)
        return defining_module(self.look_up(node.value).__name__, node.attr)


def stored_names(*nodes: ast.AST) -> list[str]:
    """Return the names that statements assign to, in the order of the text, with repetitions."""
    names = (name for node in nodes for name in ast.walk(node) if isinstance(name, ast.Name))
    return [name.id for name in names if isinstance(name.ctx, ast.Store)]


def reads(node: ast.AST, name: str) -> bool:
    """Return True if an expression or a statement mentions a name."""
    return any(isinstance(part, ast.Name) and part.id == name for part in ast.walk(node))
