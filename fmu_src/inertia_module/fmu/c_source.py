"""The kernel as C99, from its LLVM IR: for processors that no library in the FMU is for.

An instruction becomes a statement of its own, so that no compiler joins two of them: the bits are those of
the machine code, but for sin, exp and the like of another C library. Memory holds doubles, whole numbers and
bytes: it is copied from and to. Whole numbers are unsigned, which wrap.
"""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Iterable

from ..compiling import CompilationUnavailable
from ..compiling.ir import llvm_text
from ..contract.models import Model
from .archive import TEMPLATES, filled

# a type and a name in the text
TYPE = r"(?:\{[^{}]*\}|\[\d+ x \w+\]|double|ptr|i\d+|void|metadata)"
NAME = r'[%@](?:"[^"]*"|[-$.\w]+)'
C_TYPES = {"double": "double", "ptr": "char *", "i1": "int", "void": "void"}
# what makes a number of one or two, by its name and relation; capitals: of whole numbers with their signs
CALCULATIONS = {
    **{"fadd": "{a} + {b}", "fsub": "{a} - {b}", "fmul": "{a} * {b}", "fdiv": "{a} / {b}"},
    **{"frem": "fmod({a}, {b})", "fneg": "-{a}", "freeze": "{a}", "trunc": "{a}", "zext": "{a}"},
    **{"add": "{a} + {b}", "sub": "{a} - {b}", "mul": "{a} * {b}", "udiv": "{a} / {b}", "urem": "{a} % {b}"},
    **{"and": "{a} & {b}", "or": "{a} | {b}", "xor": "{a} ^ {b}", "shl": "{a} << {b}", "lshr": "{a} >> {b}"},
    **{"sdiv": "(word)({A} / {B})", "srem": "(word)({A} % {B})", "ashr": "(word)({A} >> {b})"},
    **{"sext": "(word){A}", "fptosi": "(word)(int64_t){a}", "sitofp": "(double){A}", "uitofp": "(double){a}"},
    **{"icmp eq": "{a} == {b}", "icmp ne": "{a} != {b}", "icmp ult": "{a} < {b}", "icmp ugt": "{a} > {b}"},
    **{"icmp ule": "{a} <= {b}", "icmp uge": "{a} >= {b}", "icmp slt": "{A} < {B}", "icmp sgt": "{A} > {B}"},
    **{"icmp sle": "{A} <= {B}", "icmp sge": "{A} >= {B}"},
    # where one is no number those with an o are false, with a u true
    **{"fcmp oeq": "{a} == {b}", "fcmp olt": "{a} < {b}", "fcmp ogt": "{a} > {b}", "fcmp ole": "{a} <= {b}"},
    **{
        "fcmp oge": "{a} >= {b}",
        "fcmp one": "{a} < {b} || {a} > {b}",
        "fcmp ord": "{a} == {a} && {b} == {b}",
    },
    **{"fcmp une": "{a} != {b}", "fcmp ult": "!({a} >= {b})", "fcmp ugt": "!({a} <= {b})"},
    **{"fcmp ule": "!({a} > {b})", "fcmp uge": "!({a} < {b})", "fcmp ueq": "!({a} < {b} || {a} > {b})"},
    "fcmp uno": "{a} != {a} || {b} != {b}",
    **{"smax": "{A} > {B} ? {a} : {b}", "smin": "{A} < {B} ? {a} : {b}"},
    **{"umax": "{a} > {b} ? {a} : {b}", "umin": "{a} < {b} ? {a} : {b}"},
}
# functions of the C library; calls that only tell the optimiser something
MATHEMATICS = (
    *("fabs", "sqrt", "floor", "ceil", "trunc", "copysign", "fmod", "pow", "hypot", "exp", "expm1", "log"),
    *("log1p", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh"),
)
HINTS = ("llvm.experimental.noalias", "llvm.lifetime", "llvm.assume")


def parts(text: str) -> list[str]:
    """Split a list at its commas, but not at those within brackets."""
    found, depth = [""], 0
    for letter in text:
        depth += (letter in "([{") - (letter in ")]}")
        if letter == "," and depth == 0:
            found.append("")
        else:
            found[-1] += letter
    return [part.strip() for part in found if part.strip()]


def members(kind: str) -> list[tuple[str, int]]:
    """Numbers that a type consists of: type and place in memory, in bytes, of each."""
    array = re.fullmatch(r"\[(\d+) x (\w+)\]", kind)
    kinds = [array[2]] * int(array[1]) if array else parts(kind[1:-1]) if kind[0] == "{" else [kind]
    found, place = [], 0
    for one in kinds:
        place += -place % size(one)
        found.append((one, place))
        place += size(one)
    return found


def size(kind: str) -> int:
    """Bytes of a type in memory."""
    if kind[0] in "[{":
        last, place = members(kind)[-1]
        return place + size(last)
    return int(kind[1:]) // 8 or 1 if kind[0] == "i" else 8


def signed(value: str, kind: str) -> str:
    """Value of a whole number whose uppermost bit is its sign."""
    rest = 64 - int(kind[1:])
    return f"((int64_t)((word){value} << {rest}) >> {rest})" if rest else f"(int64_t){value}"


def calculation(what: str, kind: str, to: str, a: str, b: str) -> str:
    """Expression in C of one of CALCULATIONS with operands of a type, whose result is of another."""
    if what not in CALCULATIONS:
        raise CompilationUnavailable(f"cannot translate to C: {what}")
    with_signs = [signed(value, kind) if kind[0] == "i" else "" for value in (a, b)]
    value = CALCULATIONS[what].format(a=a, b=b, A=with_signs[0], B=with_signs[1])
    # no bits that the type does not have
    return value if to in ("double", "ptr", "i64") else f"({value}) & {hex((1 << int(to[1:])) - 1)}u"


def constant(kind: str, text: str) -> str:
    """A constant in C."""
    if text in ("poison", "undef", "zeroinitializer", "null", "true", "false"):
        text = str(int(text == "true"))
    if kind == "ptr" and text != "0":
        raise CompilationUnavailable(f"cannot translate to C: address {text}")
    if kind in ("ptr", "i1"):
        return "NULL" if kind == "ptr" else text
    if kind != "double":
        return f"UINT64_C({int(text) % (1 << int(kind[1:]))})"
    value = struct.unpack(">d", bytes.fromhex(text[2:]))[0] if text.startswith("0x") else float(text)
    if not math.isfinite(value):
        return "NAN" if math.isnan(value) else f"({'-' * (value < 0.0)}HUGE_VAL)"
    return repr(value) if math.copysign(1.0, value) > 0.0 else f"({value!r})"


def plain(text: str) -> str:
    """Text without attributes, metadata and alignments."""
    shorter = re.sub(r" (?:captures|initializes|dereferenceable|range)\((?:[^()]|\([^()]*\))*\)", "", text)
    shorter = re.sub(r" (?:nuw|nsw|exact|disjoint|nneg|samesign|inbounds|nusw)(?= )", "", shorter)
    # a constant address in a table
    shorter = re.sub(rf"getelementptr \(i8, ptr ({NAME}), i64 (\d+)\)", r"\1+\2", shorter)
    return re.sub(r",? align \d+|,? ![.\w]+ !\d+| #\d+$", "", shorter)


class Function:
    """A function, translated line by line; a method for each kind of instruction that is no calculation.

    Attributes:
        head: its declaration in C. body: its lines in C. declared: its variables in C, by type.
    """

    def __init__(self, text: str, names: dict[str, str]) -> None:
        head, *lines, _ = map(plain, text.splitlines())
        self.names, self.block, self.body = names, "", list[str]()
        self.locals, self.declared = dict[str, str](), dict[str, list[str]]()
        # a place at a fixed distance from another is no variable of its own
        near = rf"  ({NAME}) = getelementptr i8, ptr ({NAME}), i64 (-?\d+)"
        constant_places = re.finditer(near, "\n".join(lines))
        self.places = {found[1]: (found[2], int(found[3])) for found in constant_places}
        # by block: what is set as it begins, with the values that blocks before it give
        self.phis: dict[str, list[tuple[str, str, dict[str, str]]]] = {}
        found = self._match(rf"define .*?(double|ptr|i\d+|void) ({NAME})\((.*)\)", head)
        arguments = []
        for one in parts(found[3]):
            kind, (name,) = self._operand(one)
            arguments.append(f"{C_TYPES.get(kind, 'word')} {'restrict ' * ('noalias' in one)}{name}")
        self.head = f"static {C_TYPES.get(found[1], 'word')} {names[found[2]]}({', '.join(arguments)})"
        block = ""
        for line in lines:
            begin = re.match(r"(\S+):", line)
            block = f"%{begin[1]}" if begin else block
            phi = re.match(rf"  ({NAME}) = phi ({TYPE}) (.*)", line)
            if phi:
                given = [self._match(r"\[ (.*), (%.*) \]", one) for one in parts(phi[3])]
                self.phis.setdefault(block, []).append((phi[1], phi[2], {one[2]: one[1] for one in given}))
        rest = iter(lines)
        for line in rest:
            begin = re.match(r"(\S+):", line)
            if begin:
                self._begin(f"%{begin[1]}")
            elif line.startswith("  switch"):
                self._switch(line, iter(lambda: next(rest), "  ]"))
            elif line:
                found = self._match(rf"  (?:({NAME}) = )?(?:(?:tail|notail) )?((\w+).*)", line)
                getattr(self, f"_{found[3]}", self._calculate)(found[1], found[2])

    @staticmethod
    def _match(pattern: str, text: str) -> re.Match[str]:
        found = re.match(pattern, text)
        if not found:
            raise CompilationUnavailable(f"cannot translate to C: {text[:80].strip()}")
        return found

    def _value(self, kind: str, text: str) -> list[str]:
        """Expressions in C of a value: a number each."""
        if text in self.places:
            base, offset = self.places[text]
            return [f"({self._value('ptr', base)[0]} {'-' if offset < 0 else '+'} {abs(offset)})"]
        if text[0] == "@":
            name, _, away = text.partition("+")
            return [f"((char *){self.names[name]} + {away or 0})"]
        if text[0] == "%":
            own, count = self.locals.setdefault(text, f"v{len(self.locals)}"), len(members(kind))
            return [own] if count == 1 else [f"{own}_{n}" for n in range(count)]
        if text[0] == "{":
            return [constant(*one.split()) for one in parts(text[1:-1])]
        return [constant(one, text) for one, _ in members(kind)]

    def _operand(self, text: str) -> tuple[str, list[str]]:
        """Type and value of what is written with its type, maybe with attributes."""
        kind = self._match(TYPE, text)[0]
        return kind, self._value(kind, text.rsplit(maxsplit=1)[-1])

    def _set(self, name: str, kind: str, values: list[str]) -> None:
        for variable, (one, _), value in zip(self._value(kind, name), members(kind), values, strict=True):
            self.declared.setdefault(C_TYPES.get(one, "word"), []).append(variable)
            self.body.append(f"{variable} = {value};")

    def _begin(self, block: str) -> None:
        if self.block:  # nothing leads back to the first one
            self.body.append(f"{self.locals.setdefault(f'{block}:', f'b{len(self.locals)}')}:;")
        self.block = block
        for name, kind, _ in self.phis.get(block, ()):
            for variable, (one, _) in zip(self._value(kind, name), members(kind), strict=True):
                self.declared.setdefault(C_TYPES.get(one, "word"), []).extend((variable, f"{variable}p"))
                self.body.append(f"{variable} = {variable}p;")

    def _go(self, block: str) -> str:
        """Statements that go from the block at hand to another one."""
        moves = []
        for name, kind, given in self.phis.get(block, ()):
            new = self._value(kind, given[self.block])
            moves += [f"{one}p = {value};" for one, value in zip(self._value(kind, name), new, strict=True)]
        return " ".join([*moves, f"goto {self.locals.setdefault(f'{block}:', f'b{len(self.locals)}')};"])

    def _switch(self, line: str, cases: Iterable[str]) -> None:
        found = self._match(rf"  switch ({TYPE} {NAME}), label ({NAME})", line)
        self.body.append(f"switch ({self._operand(found[1])[1][0]}) {{")
        for case in cases:
            one = self._match(rf"\s+({TYPE}) (-?\d+), label ({NAME})", case)
            self.body.append(f"case {constant(one[1], one[2])}: {self._go(one[3])}")
        self.body.append(f"default: {self._go(found[2])} }}")

    def _phi(self, name: str, text: str) -> None:
        """Nothing: it is set as its block begins."""

    def _unreachable(self, name: str, text: str) -> None:
        self.body.append("abort();")

    def _br(self, name: str, text: str) -> None:
        *condition, block = re.findall(rf"i1 \S+|(?<=label ){NAME}", text)
        if condition:
            truth, first = self._operand(condition[0].rstrip(","))[1][0], condition[1]
            self.body.append(f"if ({truth}) {{ {self._go(first)} }}")
        self.body.append(self._go(block))

    def _ret(self, name: str, text: str) -> None:
        value = "" if text == "ret void" else f" {self._operand(text[4:])[1][0]}"
        self.body.append(f"return{value};")

    def _call(self, name: str, text: str) -> None:
        found = self._match(rf"call .*?({TYPE}) ({NAME})\((.*)\)", text)
        if found[2].startswith(HINTS, 1):
            return
        given = [self._operand(one) for one in parts(found[3])]
        values, known = [one for _, (one,) in given], re.sub(r"^@(llvm\.)?|\.[fip]\d.*", "", found[2])
        call = f"{self.names.get(found[2], known)}({', '.join(values)})"
        if known in ("memset", "memcpy"):
            self.body.append(f"{known}({', '.join(values[:3])});")
        elif known in CALCULATIONS:
            self._set(name, found[1], [calculation(known, found[1], found[1], *values)])
        elif found[2] not in self.names and known not in MATHEMATICS:
            raise CompilationUnavailable(f"cannot translate to C: {known}")
        elif name:
            self._set(name, found[1], [call])
        else:
            self.body.append(f"{call};")

    def _store(self, name: str, text: str) -> None:
        (kind, values), (_, (place,)) = (self._operand(one) for one in parts(text[6:]))
        for (one, offset), value in zip(members(kind), values, strict=True):
            self.body.append(f"put_{one}({place}{f' + {offset}' if offset else ''}, {value});")

    def _load(self, name: str, text: str) -> None:
        kind, at = parts(text[5:])
        place = self._operand(at)[1][0]
        self._set(name, kind, [f"get_{one}({place}{f' + {n}' if n else ''})" for one, n in members(kind)])

    def _getelementptr(self, name: str, text: str) -> None:
        if name not in self.places:
            kind, base, step = parts(text.partition(" ")[2])
            place, by = (self._operand(one)[1][0] for one in (base, step))
            self._set(name, "ptr", [f"{place} + (ptrdiff_t){by} * {size(kind)}"])

    def _alloca(self, name: str, text: str) -> None:
        memory = f"m{len(self.locals)}"
        self.declared.setdefault("word", []).append(f"{memory}[{-(-size(parts(text[7:])[0]) // 8)}]")
        self._set(name, "ptr", [f"(char *){memory}"])

    def _select(self, name: str, text: str) -> None:
        (_, (chosen,)), (kind, ones), (_, others) = (self._operand(one) for one in parts(text[7:]))
        self._set(name, kind, [f"{chosen} ? {a} : {b}" for a, b in zip(ones, others, strict=True)])

    def _insertvalue(self, name: str, text: str) -> None:
        whole, one, place = parts(text.partition(" ")[2])
        kind, values = self._operand(whole)
        values[int(place)] = self._operand(one)[1][0]
        self._set(name, kind, values)

    def _extractvalue(self, name: str, text: str) -> None:
        whole, place = parts(text.partition(" ")[2])
        kind, values = self._operand(whole)
        self._set(name, members(kind)[int(place)][0], [values[int(place)]])

    def _calculate(self, name: str, text: str) -> None:
        """An operation on numbers, a comparison or a conversion."""
        found = self._match(rf"([fi]cmp \w+|\w+) (.*?)(?: to ({TYPE}))?$", text)
        first, *others = parts(found[2])
        kind, (a,) = self._operand(first)
        (b,) = self._value(kind, others[0]) if others else (a,)
        to = found[3] or ("i1" if "cmp" in found[1] else kind)
        self._set(name, to, [calculation(found[1], kind, to, a, b)])

    def text(self) -> str:
        """The function in C."""
        lines = [f"{kind} {', '.join(names)};" for kind, names in self.declared.items() if kind != "char *"]
        lines += [f"char *{', *'.join(names)};" for kind, names in self.declared.items() if kind == "char *"]
        return "\n".join([f"{self.head} {{", *lines, *self.body, "}"])


def numbers_of(escaped: str) -> str:
    """Numbers of 64 bits each in C, of a table's bytes as the text has them."""

    def byte(code: re.Match[bytes]) -> bytes:
        return b"\\" if code[1] == b"\\" else bytes.fromhex(code[1].decode())

    content = re.sub(rb"\\(\\|[0-9A-F]{2})", byte, escaped.encode())
    return ", ".join(f"UINT64_C({number})" for (number,) in struct.iter_unpack("<Q", content))


def c_source(model: Model) -> str:
    """The kernel of a model in C99, a file whose one visible function is the entry."""
    text = llvm_text(model)
    tables = re.findall(rf"^({NAME}) = .*constant \[\d+ x i8\] c\"(.*)\"", text, flags=re.M)
    functions = re.findall(r"^define .*?^\}$", text, flags=re.M | re.S)
    names = {name: f"t{n}" for n, (name, _) in enumerate(tables)}
    names |= {re.search(rf" ({NAME})\(", one)[1]: f"f{n}" for n, one in enumerate(functions)}  # type: ignore[index]
    translated = [Function(one, names) for one in functions]
    values = {
        **{"model": model, "entry": names[f"@{model.symbol}"], "functions": translated},
        "tables": [(names[name], numbers_of(escaped)) for name, escaped in tables],
    }
    return filled(TEMPLATES / "kernel.c", values)
