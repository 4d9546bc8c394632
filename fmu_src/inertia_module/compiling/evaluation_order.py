"""Rejects expressions whose value depends on the order in which C evaluates their operands.

Python evaluates operands from left to right. C does not define the order, except for `and`, `or` and
`if ... else`. Therefore, if an operand calls a function that writes to a record, the other operands must not
read a record.
"""

from __future__ import annotations

import ast
import functools
import types

from .python_source import LOCAL, Scope, definition

Memory = ast.Attribute | ast.Subscript


@functools.cache
def writes(function: types.FunctionType) -> bool:
    """Return True if a function writes to a record or an array of its caller.

    Args:
        function: function of the kernel.
    """
    scope = Scope(function)
    return any(
        (isinstance(node, Memory) and isinstance(node.ctx, ast.Store)) or calls_writer(scope, node)
        for node in ast.walk(definition(function))
    )


def called_function(scope: Scope, node: ast.AST) -> types.FunctionType | None:
    """Return the kernel's function in a call; None if the node is no such call.

    Args:
        scope: names of the calling function.
        node: the call.
    """
    function = scope.look_up(node.func) if isinstance(node, ast.Call) else None
    return function if isinstance(function, types.FunctionType) else None


def calls_writer(scope: Scope, node: ast.AST) -> bool:
    """Return True if a node is a call of a function that writes.

    Args:
        scope: names of the function that contains the node.
        node: syntax tree of an expression.
    """
    function = called_function(scope, node)
    return function is not None and writes(function)


def contains_writer(scope: Scope, node: ast.AST) -> bool:
    """Return True if an expression contains a call that writes.

    Args:
        scope: names of the function that contains the node.
        node: syntax tree of an expression.
    """
    return any(calls_writer(scope, part) for part in ast.walk(node))


def reads_memory(scope: Scope, node: ast.AST) -> bool:
    """Return True if the value of an expression may depend on records or arrays.

    Args:
        scope: names of the function that contains the node.
        node: syntax tree of an expression.
    """
    return any(
        (isinstance(part, Memory) and scope.look_up(part) is LOCAL)
        or (isinstance(part, ast.Call) and called_function(scope, part) is not None)
        for part in ast.walk(node)
    )


def operands(node: ast.AST) -> list[ast.expr]:
    """Return the parts of an expression or an assignment that C evaluates in any order.

    Args:
        node: the expression or assignment.
    """
    match node:
        case ast.BinOp():
            return [node.left, node.right]
        case ast.Compare():
            return [node.left, *node.comparators]
        case ast.Call():
            return [*node.args, *(keyword.value for keyword in node.keywords)]
        case ast.Tuple():
            return node.elts
        case ast.Subscript():
            return [node.value, node.slice]
        case ast.AugAssign():
            return [node.target, node.value]
        case ast.Assign(targets=[ast.Subscript() as target]):
            return [target.slice, node.value]
    return []


def check_order(scope: Scope, statement: ast.AST) -> None:
    """Raise an error if the result of a statement depends on the order of its operands.

    Args:
        scope: names of the function.
        statement: the statement, or an expression.

    Raises:
        KernelLanguageError: an operand writes to a record, and another operand may read it.
    """
    for node in ast.walk(statement):
        parts = operands(node)
        writers = [part for part in parts if contains_writer(scope, part)]
        if writers and any(reads_memory(scope, part) for part in parts if part is not writers[0]):
            call = ast.unparse(writers[0])
            raise scope.reject(
                node, f"C may evaluate {call}, which writes to a record, before or after the rest"
            )
