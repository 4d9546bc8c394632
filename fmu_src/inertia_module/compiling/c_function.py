"""A function of the kernel in C: statements, declarations and comments."""

from __future__ import annotations

import ast
import itertools
import re
import textwrap
import types
from typing import TYPE_CHECKING

from .c_expression import ARITHMETIC, PRIMARY, RELATION, Expression, Expressions, variable_name
from .c_types import INT, VOID, Array, Record, TupleType, Type, common_type, declaration
from .evaluation_order import Memory, called_function, check_order
from .python_source import LOCAL, Scope, mentions, source_file, stored_names

if TYPE_CHECKING:
    from .translate import KernelTranslator

WIDTH = 110
INDENT = "    "
NO_BREAK = "\N{NO-BREAK SPACE}"
# nested blocks of a statement, from the outside inwards
Path = tuple[int, ...]


def wrapped(line: str) -> list[str]:
    """Break a long line of C at spaces.

    Args:
        line: line with its indentation.

    Returns:
        The lines.
    """
    indent = " " * (len(line) - len(line.lstrip()))
    lines = textwrap.wrap(
        line.strip(), WIDTH, initial_indent=indent, subsequent_indent=indent + 2 * INDENT,
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip
    return [part.replace(NO_BREAK, " ") for part in lines]


def _unbroken(text: str) -> str:
    """Return a text with spaces at which no line is broken."""
    return text.replace(" ", NO_BREAK)


class Declarations:
    """Places of the declarations of a function's variables in C.

    The first assignment declares a variable if all its uses are in the same block or in inner blocks.
    Otherwise the declaration is at the top of the function.

    Args:
        scope: names of the function.

    Attributes:
        by_statement: names of the variables that a statement declares.
        at_top: names of the other variables.
    """

    def __init__(self, scope: Scope) -> None:
        self.by_statement: dict[ast.stmt, set[str]] = {}
        self.at_top: list[str] = []
        self._uses: dict[str, list[tuple[Path, ast.stmt]]] = {}
        self._names = scope.local - set(scope.parameters) - {"_"}
        self._collect(scope.tree.body, ())
        for name, uses in self._uses.items():
            first_path, first = uses[0]
            is_inside = all(path[: len(first_path)] == first_path for path, _ in uses)
            is_assigned = isinstance(first, ast.Assign) and not mentions(first.value, name)
            if is_inside and (isinstance(first, ast.For) or is_assigned):
                self.by_statement.setdefault(first, set()).add(name)
            else:
                self.at_top.append(name)

    def _add_uses(self, node: ast.AST, path: Path, statement: ast.stmt) -> None:
        for part in ast.walk(node):
            if isinstance(part, ast.Name) and part.id in self._names:
                self._uses.setdefault(part.id, []).append((path, statement))

    def _collect(self, statements: list[ast.stmt], path: Path) -> None:
        for statement in statements:
            if isinstance(statement, ast.If | ast.While):
                self._add_uses(statement.test, path, statement)
                self._collect(statement.body, (*path, id(statement.body)))
                self._collect(statement.orelse, (*path, id(statement.orelse)))
            elif isinstance(statement, ast.For):
                self._add_uses(statement.iter, path, statement)
                self._add_uses(statement.target, (*path, id(statement.body)), statement)
                self._collect(statement.body, (*path, id(statement.body)))
            else:
                self._add_uses(statement, path, statement)


class FunctionTranslator:
    """Translates one function for one combination of argument types.

    Args:
        kernel: definitions that all functions share.
        function: the function.
        arguments: types of its arguments.

    Attributes:
        result: type of its result; None if it returns nothing.
    """

    def __init__(
        self, kernel: KernelTranslator, function: types.FunctionType, arguments: tuple[Type, ...]
    ) -> None:
        self.scope = Scope(function)
        self.kernel = kernel
        self.comments = source_file(function.__module__).comments
        self.result: Type = None
        signature = self.scope.tree.args
        if signature.defaults or signature.vararg or signature.kwarg or signature.kwonlyargs:
            raise self.scope.reject(self.scope.tree, f"{function.__name__} must have plain arguments")
        self.variables: dict[str, Type] = dict(zip(self.scope.parameters, arguments, strict=True))
        self.expressions = Expressions(kernel, self.scope, self.variables)
        self.declarations = Declarations(self.scope)

    def translate(self) -> None:
        """Translate the statements repeatedly until the types of all variables are determined.

        Raises:
            KernelLanguageError: a statement is outside the language of the kernel.
        """
        body = self.scope.tree.body
        has_docstring = ast.get_docstring(self.scope.tree) is not None
        types_before: object = None
        while types_before != (types_before := (dict(self.variables), self.result)):
            self.lines: list[str] = []
            self.depth = 1
            self.last_line = (body[0].end_lineno if has_docstring else None) or self.scope.tree.lineno
            self.numbers = itertools.count(1)
            self._block(body[1:] if has_docstring else body)

    def text(self, storage: str, name: str) -> str:
        """Return the text of the translated function.

        Args:
            storage: storage class.
            name: name of the function in C.
        """
        text = "\n".join(self.lines)
        parameters = {
            variable_name(parameter): self.variables[parameter] for parameter in self.scope.parameters
        }
        unused = [parameter for parameter in parameters if not re.search(rf"\b{parameter}\b", text)]
        top = [f"{INDENT}(void){parameter};" for parameter in unused]
        top += [
            f"{INDENT}{declaration(self.variables[parameter], variable_name(parameter))};"
            for parameter in self.declarations.at_top
        ]
        arguments = ", ".join(
            _unbroken(declaration(kind, parameter)) for parameter, kind in parameters.items()
        )
        head = wrapped(f"{storage} {declaration(self.result or VOID, f'{name}({arguments})')}")
        return "\n".join(
            [*_comment(ast.get_docstring(self.scope.tree)), *head, "{", *top, *self.lines, "}", ""]
        )

    def _emit(self, text: str) -> None:
        self.lines += wrapped(INDENT * self.depth + text)

    def _new_name(self, stem: str) -> str:
        return next(name for name in (f"{stem}{n}" for n in self.numbers) if name not in self.scope.local)

    def _block(self, statements: list[ast.stmt]) -> None:
        for statement in statements:
            for line in range(self.last_line + 1, statement.lineno + 1):
                if line in self.comments:
                    self._emit(f"/* {self.comments[line]} */")
            self.last_line = statement.lineno
            method = getattr(self, f"_{type(statement).__name__.lower()}", None)
            if method is None or (getattr(statement, "orelse", None) and not isinstance(statement, ast.If)):
                text = ast.unparse(statement).splitlines()[0]
                raise self.scope.reject(statement, f"{text} is outside the language of the kernel")
            if not isinstance(statement, ast.If | ast.While | ast.For):
                check_order(self.scope, statement)
            try:
                method(statement)
            except TypeError as error:
                raise self.scope.reject(statement, str(error)) from None
            if not isinstance(statement, ast.If | ast.While | ast.For):
                self.last_line = statement.end_lineno or statement.lineno

    def _inner_block(self, statements: list[ast.stmt]) -> None:
        self.depth += 1
        self._block(statements)
        self.depth -= 1

    def _break(self, statement: ast.Break) -> None:
        self._emit("break;")

    def _continue(self, statement: ast.Continue) -> None:
        self._emit("continue;")

    def _expr(self, statement: ast.Expr) -> None:
        if not isinstance(statement.value, ast.Call):
            raise self.scope.reject(statement, f"{ast.unparse(statement)} has no effect")
        self._emit(f"{self.expressions.translate(statement.value).text};")

    def _return(self, statement: ast.Return) -> None:
        if statement.value is None:
            return self._emit("return;")
        value = self.expressions.translate(statement.value)
        self.result = common_type(self.result, value.type)
        return self._emit(f"return {value.value};")

    def _condition(self, node: ast.expr) -> str:
        check_order(self.scope, node)
        return self.expressions.scalar(node).text

    def _if(self, statement: ast.If, word: str = "if") -> None:
        self._emit(f"{word} ({self._condition(statement.test)}) {{")
        self._inner_block(statement.body)
        match statement.orelse:
            case [ast.If() as nested] if nested.col_offset == statement.col_offset:  # elif
                return self._if(nested, "} else if")
            case [_, *_]:
                self._emit("} else {")
                self._inner_block(statement.orelse)
        return self._emit("}")

    def _while(self, statement: ast.While) -> None:
        self._emit(f"while ({self._condition(statement.test)}) {{")
        self._inner_block(statement.body)
        self._emit("}")

    def _for(self, statement: ast.For) -> None:
        call, target = statement.iter, statement.target
        is_range = isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "range"
        if not (is_range and isinstance(call, ast.Call) and isinstance(target, ast.Name)):
            raise self.scope.reject(statement, "a loop must be of the form: for name in range(...)")
        check_order(self.scope, call)
        bounds = [self.expressions.scalar(bound) for bound in call.args]
        start = bounds[0].text if len(bounds) > 1 else "0"
        end, end_node = (bounds[1], call.args[1]) if len(bounds) > 1 else (bounds[0], call.args[0])
        step = self._constant_step(call)
        end_text = end.within(RELATION + 1)
        if not end.text.isdecimal() and self._may_change(end_node, statement.body):
            end_text = self._new_name("end")
            self._emit(f"const int64_t {end_text} = {end.text};")
        self.variables[target.id] = common_type(self.variables.get(target.id), INT)
        name = variable_name(target.id)
        is_declared = target.id in self.declarations.by_statement.get(statement, ())
        # a variable that is used after the loop keeps its last value, as in Python
        is_counter = is_declared and target.id not in stored_names(*statement.body)
        counter = name if is_counter else self._new_name("n")
        move = f"{counter}{'++' if step == 1 else f' += {step}'}"
        self._emit(f"for (int64_t {counter} = {start}; {counter} < {end_text}; {move}) {{")
        if not is_counter and target.id != "_":
            self._emit(f"{INDENT}{'int64_t ' * is_declared}{name} = {counter};")
        self._inner_block(statement.body)
        self._emit("}")

    def _constant_step(self, call: ast.Call) -> int:
        """Return the step of a range, a constant of at least 1."""
        node = call.args[2] if len(call.args) == 3 else ast.Constant(1)
        step = node.value if isinstance(node, ast.Constant) else self.scope.look_up(node)
        if type(step) is not int or step < 1:
            raise self.scope.reject(
                call, f"the step {ast.unparse(node)} must be an integer constant of at least 1"
            )
        return step

    def _may_change(self, bound: ast.expr, body: list[ast.stmt]) -> bool:
        """Return True if the bound of a loop may change within it; Python evaluates it once."""
        stored = set(stored_names(*body))
        return any(
            isinstance(part, ast.Call)
            or (isinstance(part, Memory) and self.scope.look_up(part) is LOCAL)
            or (isinstance(part, ast.Name) and part.id in stored)
            for part in ast.walk(bound)
        )

    def _augassign(self, statement: ast.AugAssign) -> None:
        operation = ast.BinOp(_as_load(statement.target), statement.op, statement.value)
        result = self.expressions.translate(ast.copy_location(operation, statement))
        target = self.expressions.translate(_as_load(statement.target))
        operator = ARITHMETIC.get(type(statement.op))
        if operator is not None and target.type == result.type:
            self._emit(f"{target.text} {operator[0]}= {self.expressions.scalar(statement.value).text};")
        else:
            self._assign_value(statement.target, result, ())

    def _assign(self, statement: ast.Assign) -> None:
        declared = self.declarations.by_statement.get(statement, ())
        value: ast.expr = statement.value
        for target in statement.targets:
            if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
                self._assign_items(statement, target, value, declared)
            else:
                self._assign_value(target, self.expressions.translate(value), declared)
            if not isinstance(value, ast.Constant):
                value = _as_load(target)  # in a = b = c the second target takes the value of the first

    def _assign_items(
        self, statement: ast.Assign, target: ast.Tuple, value: ast.Tuple, declared: set[str] | tuple[()]
    ) -> None:
        """Assign a, b = c, d one after the other."""
        if len(target.elts) != len(value.elts):
            raise self.scope.reject(
                statement, f"{ast.unparse(statement)} must have as many values as targets"
            )
        for n, (item, item_value) in enumerate(zip(target.elts, value.elts, strict=True)):
            if any(self._is_read(item, later) for later in value.elts[n + 1 :]):
                text = f"{ast.unparse(statement)} must be several statements: a value reads an earlier target"
                raise self.scope.reject(statement, text)
            self._assign_value(item, self.expressions.translate(item_value), declared)

    def _is_read(self, target: ast.expr, value: ast.expr) -> bool:
        """Return True if a value may read a target."""
        if isinstance(target, ast.Name):
            return mentions(value, target.id)
        parts = list(ast.walk(value))
        if any(called_function(self.scope, part) is not None for part in parts):
            return True
        if isinstance(target, ast.Attribute):
            return any(isinstance(part, ast.Attribute) and part.attr == target.attr for part in parts)
        return any(isinstance(part, ast.Subscript) for part in parts)

    def _assign_value(self, target: ast.expr, value: Expression, declared: set[str] | tuple[()]) -> None:
        """Assign a value to a variable or to a place in a record, or a tuple to several targets."""
        if isinstance(target, ast.Tuple):
            self._unpack(target, value, declared)
        elif not isinstance(target, ast.Name):
            place = self.expressions.translate(_as_load(target))
            if isinstance(place.type, Array) or isinstance(value.type, Array | TupleType):
                raise self.scope.reject(target, f"{ast.unparse(target)} must be assigned number by number")
            text = (
                f"*{value.text}" if isinstance(value.type, Record) and not value.is_embedded else value.text
            )
            self._emit(f"{place.text} = {text};")
        elif target.id != "_":
            kind = common_type(self.variables.get(target.id), value.type)
            self.variables[target.id] = kind
            name = variable_name(target.id)
            head = declaration(kind, name) if target.id in declared else name
            self._emit(f"{head} = {value.value};")

    def _unpack(self, target: ast.Tuple, value: Expression, declared: set[str] | tuple[()]) -> None:
        if not isinstance(value.type, TupleType) or len(value.type.items) != len(target.elts):
            raise self.scope.reject(target, f"{ast.unparse(target)} must be assigned as many values")
        name = value.text
        if not name.isidentifier():
            name = self._new_name("result")
            self._emit(f"const {declaration(value.type, name)} = {value.text};")
        for n, (item, kind) in enumerate(zip(target.elts, value.type.items, strict=True)):
            self._assign_value(item, Expression(f"{name}.item{n}", PRIMARY, kind), declared)


def _as_load(target: ast.expr) -> ast.expr:
    """Return a target of an assignment as an expression that reads it."""
    node = ast.parse(ast.unparse(target), mode="eval").body
    for part in ast.walk(node):
        ast.copy_location(part, target)
    return node


def _comment(docstring: str | None) -> list[str]:
    """Return the lines of a docstring as a comment of C."""
    if docstring is None:
        return []
    lines = docstring.replace("*/", "* /").splitlines()
    if len(lines) == 1:
        return [f"/* {lines[0]} */"]
    return ["/*", *(f" * {line}".rstrip() for line in lines), " */"]
