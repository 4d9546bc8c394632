"""Expressions of the kernel's language in C: the same operations in the same order."""

from __future__ import annotations

import ast
import math
import types
from typing import TYPE_CHECKING, NamedTuple

from .c_types import BOOL, DOUBLE, INT, SCALARS, Array, Record, TupleType, Type, common_type, type_name
from .python_source import Scope

if TYPE_CHECKING:
    from .translate import KernelTranslator

# precedence of the operators of C, from low to high
TERNARY, OR, AND, BIT_AND, EQUALITY, RELATION, SUM, PRODUCT, UNARY, PRIMARY = range(10)
ARITHMETIC = {
    ast.Add: ("+", SUM),
    ast.Sub: ("-", SUM),
    ast.Mult: ("*", PRODUCT),
    ast.Div: ("/", PRODUCT),
    ast.BitAnd: ("&", BIT_AND),
}
COMPARISONS = {
    ast.Eq: ("==", EQUALITY),
    ast.NotEq: ("!=", EQUALITY),
    ast.Lt: ("<", RELATION),
    ast.LtE: ("<=", RELATION),
    ast.Gt: (">", RELATION),
    ast.GtE: (">=", RELATION),
}
# functions of the module math by type of their result; `math.floor` is a double in C
MATH_FUNCTIONS = {
    **dict.fromkeys(("sqrt", "floor", "ceil", "copysign", "fmod", "exp", "expm1", "log", "log1p"), DOUBLE),
    "pow": DOUBLE,
    **dict.fromkeys(("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh"), DOUBLE),
    **dict.fromkeys(("isfinite", "isnan", "isinf"), BOOL),
}
MATH_CONSTANTS = {math.inf: "INFINITY"}
# names that variables of C must not have: keywords, and functions that a variable would hide
RESERVED = frozenset(MATH_FUNCTIONS) | frozenset(
    """
    auto bool case char const default do double enum extern false float goto inline int long register restrict
    short signed sizeof static struct switch true typedef union unsigned void volatile
    """.split()  # noqa: SIM905 (a list of 28 strings is a line each)
)
# definitions of the operations of Python that have no operator in C
HELPERS = {
    "larger": "double larger(double a, double b)\n{\n    return b > a ? b : a;\n}",
    "smaller": "double smaller(double a, double b)\n{\n    return b < a ? b : a;\n}",
    "larger_int": "int64_t larger_int(int64_t a, int64_t b)\n{\n    return b > a ? b : a;\n}",
    "smaller_int": "int64_t smaller_int(int64_t a, int64_t b)\n{\n    return b < a ? b : a;\n}",
    "modulo": """double modulo(double a, double b) /* has the sign of b */
{
    const double rest = fmod(a, b);
    if (rest != 0.0)
        return (b < 0.0) != (rest < 0.0) ? rest + b : rest;
    return b < 0.0 ? -0.0 : 0.0;
}""",
    "modulo_int": "int64_t modulo_int(int64_t a, int64_t b)\n{\n    return (a % b + b) % b;\n}",
    "floor_divide": "int64_t floor_divide(int64_t a, int64_t b)\n{\n    return (a - (a % b + b) % b) / b;\n}",
}


class Expression(NamedTuple):
    """An expression of C.

    Attributes:
        text: its text.
        precedence: binding of its outermost operator.
        type: its type.
        is_embedded: True for a record within another record, which needs the operator & for its address.
    """

    text: str
    precedence: int
    type: Type
    is_embedded: bool = False

    def within(self, precedence: int) -> str:
        """Return the text as an operand, in brackets if the operator binds more strongly.

        Args:
            precedence: binding of the operator.
        """
        return self.text if self.precedence >= precedence else f"({self.text})"

    @property
    def value(self) -> str:
        """Text of the value: for a record, its address."""
        return f"&{self.text}" if self.is_embedded else self.text


def variable_name(name: str) -> str:
    """Return the name of a variable in C.

    Args:
        name: name in Python.
    """
    return f"{name}_" if name in RESERVED else name


class Expressions:
    """Translates the expressions of one function.

    Args:
        kernel: definitions that all functions share.
        scope: names of the function.
        variables: types of its variables by name; a variable is missing until its type is determined.
    """

    def __init__(self, kernel: KernelTranslator, scope: Scope, variables: dict[str, Type]) -> None:
        self.kernel, self.scope, self.variables = kernel, scope, variables

    def translate(self, node: ast.expr) -> Expression:
        """Return the translation of an expression.

        Args:
            node: the expression.

        Raises:
            KernelLanguageError: the expression is outside the language of the kernel.
        """
        value = self.scope.look_up(node)
        if isinstance(node, ast.Attribute) and self.scope.look_up(node.value) is math:
            return Expression(MATH_CONSTANTS.get(value, repr(value)), PRIMARY, DOUBLE)
        if isinstance(value, int | float | tuple) and isinstance(node, ast.Name | ast.Attribute):
            numbers = value if isinstance(value, tuple) else (value,)
            if not all(type(number) in (int, float) for number in numbers):
                raise self.scope.reject(node, f"{ast.unparse(node)} must be a number or a table of numbers")
            return self.kernel.constant(*self.scope.origin(node), value)
        method = getattr(self, f"_{type(node).__name__.lower()}", None)
        if method is None:
            raise self.scope.reject(node, f"{ast.unparse(node)} is outside the language of the kernel")
        expression: Expression = method(node)
        return expression

    def scalar(self, node: ast.expr) -> Expression:
        """Return the translation of an expression whose value must be a number or a truth value.

        Args:
            node: the expression.

        Raises:
            KernelLanguageError: the value has another type.
        """
        expression = self.translate(node)
        if expression.type is not None and expression.type not in SCALARS:
            raise self.scope.reject(
                node, f"{ast.unparse(node)} must be a number (got {type_name(expression.type)})"
            )
        return expression

    def _constant(self, node: ast.Constant) -> Expression:
        if isinstance(node.value, bool):
            return Expression(str(node.value).lower(), PRIMARY, BOOL)
        if isinstance(node.value, int | float):
            return Expression(repr(node.value), PRIMARY, INT if isinstance(node.value, int) else DOUBLE)
        raise self.scope.reject(node, f"a constant must be a number (got {node.value!r})")

    def _name(self, node: ast.Name) -> Expression:
        if node.id not in self.scope.local:
            raise self.scope.reject(node, f"unknown name {node.id}")
        return Expression(variable_name(node.id), PRIMARY, self.variables.get(node.id))

    def _attribute(self, node: ast.Attribute) -> Expression:
        base = self.translate(node.value)
        if not isinstance(base.type, Record):
            raise self.scope.reject(node, f"{ast.unparse(node.value)} must be a record")
        if node.attr == "numbers":
            return Expression(f"NUMBERS({base.value})", PRIMARY, Array(DOUBLE, base.type.size))
        if node.attr not in base.type.fields:
            raise self.scope.reject(node, f"unknown field {node.attr} of {base.type.name}")
        kind = base.type.fields[node.attr]
        text = f"{base.within(PRIMARY)}{'.' if base.is_embedded else '->'}{node.attr}"
        return Expression(text, PRIMARY, kind, isinstance(kind, Record))

    def _subscript(self, node: ast.Subscript) -> Expression:
        base, index = self.translate(node.value), self.translate(node.slice)
        if isinstance(base.type, TupleType) and index.text.isdecimal():
            return Expression(
                f"{base.within(PRIMARY)}.item{index.text}", PRIMARY, base.type.items[int(index.text)]
            )
        if not isinstance(base.type, Array):
            raise self.scope.reject(node, f"{ast.unparse(node.value)} must be an array or a table")
        if index.type not in (INT, BOOL, None) or isinstance(node.slice, ast.UnaryOp):
            raise self.scope.reject(node, f"index {ast.unparse(node.slice)} must be an integer of at least 0")
        kind = base.type.element
        return Expression(f"{base.within(PRIMARY)}[{index.text}]", PRIMARY, kind, isinstance(kind, Record))

    def _tuple(self, node: ast.Tuple) -> Expression:
        items = [self.translate(item) for item in node.elts]
        kind = TupleType(tuple(item.type for item in items))
        if None in kind.items:  # the next pass determines the types
            return Expression("", PRIMARY, None)
        name = self.kernel.tuple_name(kind)
        return Expression(f"({name}){{{', '.join(item.value for item in items)}}}", PRIMARY, kind)

    def _unaryop(self, node: ast.UnaryOp) -> Expression:
        operand = self.scalar(node.operand)
        if isinstance(node.op, ast.Not):
            return Expression(f"!{operand.within(UNARY)}", UNARY, BOOL)
        if not isinstance(node.op, ast.USub):
            raise self.scope.reject(node, f"unknown operator in {ast.unparse(node)}")
        return Expression(f"-{operand.within(PRIMARY)}", UNARY, common_type(operand.type, INT))

    def _binop(self, node: ast.BinOp) -> Expression:
        left, right = self.scalar(node.left), self.scalar(node.right)
        kind = common_type(common_type(left.type, right.type), INT)
        match node.op:
            case ast.Mod():
                name = "modulo" if kind == DOUBLE else "modulo_int"
                return Expression(f"{name}({left.text}, {right.text})", PRIMARY, kind)
            case ast.FloorDiv() if kind == INT:
                return Expression(f"floor_divide({left.text}, {right.text})", PRIMARY, INT)
            case ast.Pow():
                raise self.scope.reject(node, f"write {ast.unparse(node)} as a product or with math.pow")
        if type(node.op) not in ARITHMETIC:
            raise self.scope.reject(node, f"unknown operator in {ast.unparse(node)}")
        operator, precedence = ARITHMETIC[type(node.op)]
        if operator == "/":
            left = Expression(f"(double){left.within(UNARY)}", UNARY, DOUBLE) if kind == INT else left
            kind = DOUBLE
        if operator == "&":  # C compilers warn of operands without brackets
            return Expression(f"{left.within(PRIMARY)} & {right.within(PRIMARY)}", BIT_AND, kind)
        return Expression(
            f"{left.within(precedence)} {operator} {right.within(precedence + 1)}", precedence, kind
        )

    def _boolop(self, node: ast.BoolOp) -> Expression:
        operator, precedence = (" && ", AND) if isinstance(node.op, ast.And) else (" || ", OR)
        operands = [self.scalar(value) for value in node.values]
        # brackets also around && within ||: C compilers warn without them
        return Expression(operator.join(operand.within(AND + 1) for operand in operands), precedence, BOOL)

    def _compare(self, node: ast.Compare) -> Expression:
        sides = [node.left, *node.comparators]
        for inner in sides[1:-1]:
            if any(isinstance(part, ast.Call) for part in ast.walk(inner)):
                raise self.scope.reject(node, f"C would evaluate {ast.unparse(inner)} twice")
        comparisons = []
        for left, operator, right in zip(sides, node.ops, sides[1:], strict=False):
            if type(operator) not in COMPARISONS:
                raise self.scope.reject(node, f"unknown operator in {ast.unparse(node)}")
            sign, precedence = COMPARISONS[type(operator)]
            operands = [self.scalar(side).within(RELATION + 1) for side in (left, right)]
            comparisons.append(Expression(f"{operands[0]} {sign} {operands[1]}", precedence, BOOL))
        if len(comparisons) == 1:
            return comparisons[0]
        return Expression(" && ".join(comparison.text for comparison in comparisons), AND, BOOL)

    def _ifexp(self, node: ast.IfExp) -> Expression:
        condition, first, second = (
            self.scalar(node.test),
            self.translate(node.body),
            self.translate(node.orelse),
        )
        texts = [
            Expression(item.value, item.precedence, None).within(TERNARY + 1) for item in (first, second)
        ]
        kind = common_type(first.type, second.type)
        return Expression(f"{condition.within(TERNARY + 1)} ? {texts[0]} : {texts[1]}", TERNARY, kind)

    def _call(self, node: ast.Call) -> Expression:
        if node.keywords:
            raise self.scope.reject(node, f"arguments must have no keywords in {ast.unparse(node)}")
        function = self.scope.look_up(node.func)
        arguments = [self.translate(argument) for argument in node.args]
        if isinstance(function, types.FunctionType):
            return self._kernel_call(node, function, arguments)
        texts = ", ".join(argument.text for argument in arguments)
        if isinstance(function, types.BuiltinFunctionType):
            if function.__module__ != "math" or function.__name__ not in MATH_FUNCTIONS:
                raise self.scope.reject(node, f"unknown function {ast.unparse(node.func)}")
            return Expression(f"{function.__name__}({texts})", PRIMARY, MATH_FUNCTIONS[function.__name__])
        if isinstance(node.func, ast.Name) and node.func.id in ("abs", "float", "int", "len", "max", "min"):
            return self._builtin_call(node, node.func.id, arguments)
        raise self.scope.reject(node, f"unknown function {ast.unparse(node.func)}")

    def _kernel_call(
        self, node: ast.Call, function: types.FunctionType, arguments: list[Expression]
    ) -> Expression:
        if function.__code__.co_argcount != len(arguments):
            count = function.__code__.co_argcount
            raise self.scope.reject(
                node, f"{function.__name__} must have {count} arguments (got {len(arguments)})"
            )
        name, kind = self.kernel.call(function, tuple(argument.type for argument in arguments))
        return Expression(f"{name}({', '.join(argument.value for argument in arguments)})", PRIMARY, kind)

    def _builtin_call(self, node: ast.Call, name: str, arguments: list[Expression]) -> Expression:
        first, kind = arguments[0], arguments[0].type
        if name == "len":
            if not isinstance(kind, Array):
                raise self.scope.reject(node, f"{ast.unparse(node.args[0])} must be an array or a table")
            return Expression(str(kind.length), PRIMARY, INT)
        for argument in arguments:
            if argument.type not in (*SCALARS, None):
                raise self.scope.reject(node, f"arguments of {name} must be numbers")
            kind = common_type(kind, argument.type)
        if name in ("int", "float"):
            target = INT if name == "int" else DOUBLE
            return first if kind == target else Expression(f"({target}){first.within(UNARY)}", UNARY, target)
        if name == "abs":
            if kind == INT:
                raise self.scope.reject(node, "the argument of abs must be a float")
            return Expression(f"fabs({first.text})", PRIMARY, DOUBLE)
        kind = common_type(kind, INT)
        helper = {"max": "larger", "min": "smaller"}[name] + ("" if kind == DOUBLE else "_int")
        text = first.text
        for argument in arguments[1:]:
            text = f"{helper}({text}, {argument.text})"
        return Expression(text, PRIMARY, kind)
