"""An interpreter of the C that this project prints, over any of the number types of `numbers`.

It runs the printed text itself, so that a slip of the printer (a sign, an index, an integer division) shows,
and it checks memory on the way: reading what was never written, or outside an object, raises with name and
line.

Numbers follow the C types: a `double` holds a number of the chosen arithmetic, integers are Python integers
with C's rules (truncating division; overflow of signed types raises).  A floating literal stands for the
decimal number that it shows, not for the nearest double.  `Unsupported` names the line of anything outside
the subset: declarations, `for`, `if`, `return`, `break`, `continue`, expressions, calls, structs,
enumerations, macros and the math functions in `MATH_FUNCTIONS`.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any, TypeAlias

from pycparser import c_ast, c_parser

from krhpr.validation import numbers
from krhpr.validation.numbers import EXACT, Arithmetic, Exact

# Errors


class CError(Exception):
    """The C text did something wrong, or something that the interpreter does not know."""


class Unsupported(CError):
    """A construct outside the subset."""


class UninitialisedRead(CError):
    """A variable or an element was read before it was written."""


class OutOfBounds(CError):
    """An access outside an object, or through a null pointer."""


def _where(node: Any) -> str:
    coordinate = getattr(node, "coord", None)
    return f"{coordinate.file}:{coordinate.line}" if coordinate is not None else "unknown line"


def _unsupported(node: Any, what: str) -> Unsupported:
    return Unsupported(f"{_where(node)}: {what}")


# Types


@dataclass(frozen=True)
class Void:
    """No value."""


@dataclass(frozen=True)
class Real:
    """`double`."""


@dataclass(frozen=True)
class Integer:
    """An integer type of so many bits."""

    bits: int
    signed: bool


@dataclass(frozen=True)
class Pointer:
    """A pointer; `const` if its target may not be written."""

    target: CType
    const: bool = field(default=False, compare=False)


@dataclass(frozen=True)
class Vector:
    """An array of `length` elements (None in a parameter that leaves it open)."""

    element: CType
    length: int | None


@dataclass(eq=False)
class Record:
    """A struct; the same only as itself."""

    name: str
    fields: dict[str, CType] = field(default_factory=dict)
    complete: bool = False


CType: TypeAlias = "Void | Real | Integer | Pointer | Vector | Record"

REAL = Real()
INT = Integer(32, True)
LONG = Integer(64, True)
BOOL = Integer(1, False)
NULL_POINTER = Pointer(Void())

_INTEGER_NAMES = {
    "_Bool": BOOL,
    "char": Integer(8, True),
    "signed char": Integer(8, True),
    "unsigned char": Integer(8, False),
    "short": Integer(16, True),
    "short int": Integer(16, True),
    "unsigned short": Integer(16, False),
    "int": INT,
    "signed": INT,
    "signed int": INT,
    "unsigned": Integer(32, False),
    "unsigned int": Integer(32, False),
    "long": LONG,
    "long int": LONG,
    "long long": LONG,
    "unsigned long": Integer(64, False),
    "unsigned long int": Integer(64, False),
    "unsigned long long": Integer(64, False),
}

_PRELUDE = """
typedef unsigned long size_t; typedef long ptrdiff_t; typedef _Bool bool;
typedef signed char int8_t; typedef short int16_t; typedef int int32_t; typedef long int64_t;
typedef unsigned char uint8_t; typedef unsigned short uint16_t; typedef unsigned int uint32_t;
typedef unsigned long uint64_t;
"""


def _show(ctype: CType) -> str:
    match ctype:
        case Void():
            return "void"
        case Real():
            return "double"
        case Integer(bits, signed):
            return f"{'' if signed else 'unsigned '}{bits}-bit integer"
        case Pointer(target):
            return f"pointer to {_show(target)}"
        case Vector(element, length):
            return f"array of {'' if length is None else length} {_show(element)}"
        case Record(name=name):
            return f"struct {name}"


def _cells(ctype: CType) -> int:
    """The number of memory cells of an object: one for each scalar or struct of an array, else one."""
    if isinstance(ctype, Vector):
        if ctype.length is None:
            raise Unsupported("an array without a length")
        return ctype.length * _cells(ctype.element)
    return 1


def _innermost(ctype: CType) -> CType:
    while isinstance(ctype, Vector):
        ctype = ctype.element
    return ctype


# Memory


class _Unset:
    def __repr__(self) -> str:
        return "unset"


UNSET = _Unset()


class Block:
    """An object in memory: its cells (numbers, pointers, structs or `UNSET`) and their common type."""

    __slots__ = ("arithmetic", "cells", "ctype", "name")

    def __init__(
        self, cells: list[Any], ctype: CType | None, name: str, arithmetic: Arithmetic | None = None
    ) -> None:
        self.cells = cells
        self.ctype = ctype
        self.name = name
        self.arithmetic = arithmetic

    def name_of(self, index: int) -> str:
        """What to call a cell in a message."""
        name = self.name or "array"
        return name if len(self.cells) == 1 else f"{name}[{index}]"


def _flatten(values: Any) -> Iterator[Any]:
    if hasattr(values, "tolist"):
        values = values.tolist()
    if isinstance(values, Iterable):
        for value in values:
            yield from _flatten(value)
    else:
        yield values


class Array:
    """A pointer into memory; Python hands arrays to C functions, and reads them afterwards, as these.

    `Array([1, 2, 3])` makes new memory with a copy of the values (nested sequences are flattened, row by
    row), `Array.unset(9)` memory that was never written.  Indices count from where the pointer points.
    Messages call it by the `name`, or by that of the parameter to which it is handed first.
    """

    __slots__ = ("_block", "_high", "_low", "_start")

    def __init__(self, values: Any, name: str = "") -> None:
        self._block = Block(list(_flatten(values)), None, name)
        self._start, self._low, self._high = 0, 0, len(self._block.cells)

    @classmethod
    def unset(cls, length: int, name: str = "") -> Array:
        """New memory for `length` elements, none of them written."""
        return cls([UNSET] * length, name)

    @classmethod
    def _view(cls, block: Block, start: int, low: int, high: int) -> Array:
        self = cls.__new__(cls)
        self._block, self._start, self._low, self._high = block, start, low, high
        return self

    def __len__(self) -> int:
        return self._high - self._start

    def _cell(self, index: int) -> int:
        if not -len(self) <= index < len(self):
            raise IndexError(f"{self._block.name}: index {index} of {len(self)} elements")
        return self._start + index % len(self)

    def __getitem__(self, index: int) -> Any:
        cell = self._cell(index)
        value = self._block.cells[cell]
        if value is UNSET:
            raise UninitialisedRead(f"{self._block.name_of(cell)} was never written")
        return value

    def __setitem__(self, index: int, value: Any) -> None:
        block, cell = self._block, self._cell(index)
        if block.ctype is None:
            block.cells[cell] = value
        else:
            _put(block, cell, _from_python(value, block.ctype, block.arithmetic or EXACT, block.name))

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def at(self, offset: int) -> Array:
        """The pointer `offset` elements further on, into the same memory (`&a[offset]`)."""
        return Array._view(self._block, self._start + offset, self._low, self._high)

    def is_set(self, index: int) -> bool:
        """Whether the element was written."""
        return self._block.cells[self._cell(index)] is not UNSET

    def __repr__(self) -> str:
        return f"Array({self._block.cells[self._start : self._high]!r}, name={self._block.name!r})"


class Struct:
    """A struct in memory: its fields are attributes (numbers, `Array`s, `Struct`s, `Array`s of `Struct`s).

    Fields take plain numbers, which become numbers of the program's arithmetic; an array field takes a
    sequence of its full length, nested or flat.  Reading a field that was never written raises.
    """

    __slots__ = ("_arithmetic", "_blocks", "_name", "_record")
    _record: Record
    _blocks: dict[str, Block]
    _arithmetic: Arithmetic
    _name: str

    def __init__(self, record: Record, arithmetic: Arithmetic, name: str) -> None:
        blocks = {key: _new_block(ctype, f"{name}.{key}", arithmetic) for key, ctype in record.fields.items()}
        object.__setattr__(self, "_record", record)
        object.__setattr__(self, "_blocks", blocks)
        object.__setattr__(self, "_arithmetic", arithmetic)
        object.__setattr__(self, "_name", name)

    def __dir__(self) -> list[str]:
        return sorted(self._record.fields)

    def __getattr__(self, name: str) -> Any:
        if name not in self._record.fields:
            raise AttributeError(f"struct {self._record.name} has no field {name}")
        block = self._blocks[name]
        if isinstance(self._record.fields[name], Vector):
            return Array._view(block, 0, 0, len(block.cells))
        if block.cells[0] is UNSET:
            raise UninitialisedRead(f"{block.name} was never written")
        return block.cells[0]

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in self._record.fields:
            raise AttributeError(f"struct {self._record.name} has no field {name}")
        ctype, block = self._record.fields[name], self._blocks[name]
        values = list(_flatten(value)) if isinstance(ctype, Vector) else [value]
        if len(values) != len(block.cells):
            raise ValueError(f"{block.name} takes {len(block.cells)} values, not {len(values)}")
        for index, item in enumerate(values):
            _put(block, index, _from_python(item, _innermost(ctype), self._arithmetic, block.name))

    def __repr__(self) -> str:
        fields = ", ".join(f"{key}={block.cells!r}" for key, block in self._blocks.items())
        return f"<struct {self._record.name} {fields}>"


def _new_block(ctype: CType, name: str, arithmetic: Arithmetic) -> Block:
    count, innermost = _cells(ctype), _innermost(ctype)
    if not isinstance(innermost, Record):
        return Block([UNSET] * count, innermost, name, arithmetic)
    if not innermost.complete:
        raise Unsupported(f"{name}: struct {innermost.name} is incomplete")
    names = [name] if not isinstance(ctype, Vector) else [f"{name}[{i}]" for i in range(count)]
    return Block([Struct(innermost, arithmetic, item) for item in names], innermost, name, arithmetic)


def _put(block: Block, index: int, value: Any) -> None:
    """Write a cell; a struct is copied field by field, unwritten fields included."""
    if isinstance(value, Struct):
        target: Struct = block.cells[index]
        for key, source in value._blocks.items():
            for cell, item in enumerate(source.cells):
                _put(target._blocks[key], cell, item)
    else:
        block.cells[index] = value


def _from_python(value: Any, ctype: CType, arithmetic: Arithmetic, name: str) -> Any:
    """A value handed in from Python as one of type `ctype`."""
    match ctype:
        case Real():
            return arithmetic.lift(value)
        case Integer():
            return _fit(operator.index(value), ctype, name)
        case Record():
            if not isinstance(value, Struct) or value._record is not ctype:
                raise TypeError(f"{name}: {_show(ctype)} expected, {value!r} given")
            return value
        case Pointer(target, const):
            return _pointer_from_python(value, target, const, arithmetic, name)
        case _:
            raise TypeError(f"{name}: no value of type {_show(ctype)} can be handed over")


def _pointer_from_python(
    value: Any, target: CType, const: bool, arithmetic: Arithmetic, name: str
) -> Array | None:
    innermost = _innermost(target)
    if value is None:
        return None
    if isinstance(value, Struct):
        value = Array([value], value._name)
    if not isinstance(value, Array) and not const:
        raise TypeError(f"{name}: an Array is expected for what the function may write")
    pointer = value if isinstance(value, Array) else Array(value, name)
    block = pointer._block
    if block.ctype is None:
        block.cells[:] = [
            item if item is UNSET else _from_python(item, innermost, arithmetic, name) for item in block.cells
        ]
        block.ctype, block.arithmetic = innermost, arithmetic
        block.name = block.name or name
    elif block.ctype != innermost:
        raise TypeError(f"{name}: {_show(innermost)} expected, but {block.name} is of {_show(block.ctype)}")
    return pointer


def _fit(value: int, ctype: Integer, where: str) -> int:
    """An integer as the type holds it: unsigned types wrap round, signed ones raise on overflow."""
    if ctype == BOOL:
        return int(value != 0)
    if not ctype.signed:
        return value & ((1 << ctype.bits) - 1)
    if not -(1 << (ctype.bits - 1)) <= value < 1 << (ctype.bits - 1):
        raise CError(f"{where}: {value} overflows a {_show(ctype)}")
    return value


# Preprocessor


_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'", re.DOTALL)
_IDENTIFIER = re.compile(r"\.?\b\d[\w.]*|\b[A-Za-z_]\w*|\"(?:\\.|[^\"\\\n])*\"")
_DIRECTIVE = re.compile(r"\s*#\s*(\w*)\s*(.*?)\s*$")


def _strip_comment(match: re.Match[str]) -> str:
    text = match.group()
    return " " + "\n" * text.count("\n") if text.startswith("/") else text


@dataclass(frozen=True)
class _FunctionMacro:
    """A macro with parameters, `#define KRHPR_PADDED(n) ...`; its calls stand on one line."""

    parameters: tuple[str, ...]
    body: str


class _Preprocessor:
    """Comments, conditionals and macros; `#include` is dropped, all files being given at once."""

    def __init__(self, builtin: Iterable[str]) -> None:
        self.builtin = frozenset(builtin)
        self.macros: dict[str, str | _FunctionMacro] = {"__restrict": "restrict", "__restrict__": "restrict"}
        self.macros |= {"__inline": "inline", "__inline__": "inline", "__STDC_VERSION__": "199901L"}
        self.macros |= {"_Pragma": _FunctionMacro(("text",), "")}

    def process(self, text: str, name: str) -> str:
        """The text without directives, each line in its place."""
        text = _COMMENT.sub(_strip_comment, text)
        text = re.sub(r"(?:[^\n]*\\\n)+[^\n]*", _join_continued, text)
        output = [f'# 1 "{name}"']
        conditions: list[tuple[bool, bool]] = []  # (this branch is read, some branch was read)
        for number, line in enumerate(text.split("\n"), 1):
            directive = _DIRECTIVE.match(line) if line.lstrip().startswith("#") else None
            active = all(read for read, _ in conditions)
            if directive is None:
                output.append(self.expand(line) if active else "")
                continue
            output.append("")
            self._directive(directive[1], directive[2], conditions, f"{name}:{number}")
        if conditions:
            raise Unsupported(f"{name}: a conditional without #endif")
        return "\n".join(output)

    def expand(self, text: str, hidden: frozenset[str] = frozenset()) -> str:
        """The text with its macros replaced."""

        output, position = [], 0
        while match := _IDENTIFIER.search(text, position):
            output.append(text[position : match.start()])
            position = match.end()
            word = match.group()
            macro = None if word in hidden else self.macros.get(word)
            if isinstance(macro, _FunctionMacro):
                arguments, end = _macro_arguments(text, position)
                if arguments is None:
                    output.append(word)
                    continue
                if len(arguments) != len(macro.parameters):
                    raise Unsupported(f"{word} takes {len(macro.parameters)} arguments: {text.strip()}")
                given = {
                    name: self.expand(argument, hidden)
                    for name, argument in zip(macro.parameters, arguments, strict=True)
                }
                body = _substituted(macro.body, given)
                output.append(self.expand(body, hidden | {word}))
                position = end
            else:
                output.append(word if macro is None else self.expand(macro, hidden | {word}))
        return "".join([*output, text[position:]])

    def _directive(self, name: str, rest: str, conditions: list[tuple[bool, bool]], where: str) -> None:
        active = all(read for read, _ in conditions)
        outer = all(read for read, _ in conditions[:-1])
        if name in ("ifdef", "ifndef"):
            holds = active and self._is_defined(rest) == (name == "ifdef")
            conditions.append((holds, holds))
        elif name == "if":
            holds = active and self._holds(rest, where)
            conditions.append((holds, holds))
        elif name in ("elif", "else", "endif") and not conditions:
            raise Unsupported(f"{where}: #{name} without #if")
        elif name == "elif":
            taken = conditions[-1][1]
            holds = outer and not taken and self._holds(rest, where)
            conditions[-1] = (holds, taken or holds)
        elif name == "else":
            conditions[-1] = (not conditions[-1][1], True)
        elif name == "endif":
            conditions.pop()
        elif active:
            self._simple_directive(name, rest, where)

    def _simple_directive(self, name: str, rest: str, where: str) -> None:
        if name == "define":
            definition = re.match(r"([A-Za-z_]\w*)(?:\(([\w\s,]*)\))?(.*)", rest)
            if (
                definition is None
                or definition[3].startswith("(")
                or (definition[2] is not None and "#" in rest)
            ):
                raise Unsupported(f"{where}: the macro {rest!r}")
            macro: str | _FunctionMacro = definition[3].strip()
            if definition[2] is not None:
                parameters = tuple(part.strip() for part in definition[2].split(",") if part.strip())
                macro = _FunctionMacro(parameters, definition[3].strip())
            if definition[1] not in self.builtin:
                self.macros[definition[1]] = macro
        elif name == "undef":
            self.macros.pop(rest, None)
        elif name not in ("include", "pragma", ""):
            raise Unsupported(f"{where}: #{name} {rest}")

    def _is_defined(self, name: str) -> bool:
        return name in self.macros or name in self.builtin

    def _holds(self, condition: str, where: str) -> bool:
        def defined(match: re.Match[str]) -> str:
            return str(int(self._is_defined(match[1] or match[2])))

        text = re.sub(r"\bdefined\s*(?:\(\s*(\w+)\s*\)|(\w+))", defined, condition)
        text = re.sub(r"\b[A-Za-z_]\w*", "0", self.expand(text))
        try:
            declaration = c_parser.CParser().parse(f"long x = ({text});").ext[0]
        except c_parser.ParseError as error:
            raise Unsupported(f"{where}: #if {condition}") from error
        return _integer_constant(declaration.init, {}) != 0


def _substituted(body: str, given: Mapping[str, str]) -> str:
    """The body of a macro with its parameters replaced."""
    return _IDENTIFIER.sub(lambda found: given.get(found.group(), found.group()), body)


def _macro_arguments(text: str, position: int) -> tuple[list[str] | None, int]:
    """The arguments in parentheses that follow, and where they end; None where there are none."""
    start = re.compile(r"\s*\(").match(text, position)
    if start is None:
        return None, position
    arguments, depth, begin = [], 1, start.end()
    for index in range(begin, len(text)):
        depth += (text[index] == "(") - (text[index] == ")")
        if depth == 0 or (depth == 1 and text[index] == ","):
            arguments.append(text[begin:index].strip())
            begin = index + 1
        if depth == 0:
            return [] if arguments == [""] else arguments, index + 1
    raise Unsupported(f"the arguments of a macro go on beyond the line: {text.strip()}")


def _join_continued(match: re.Match[str]) -> str:
    text = match.group()
    return text.replace("\\\n", " ") + "\n" * text.count("\\\n")


# Constants


_SUFFIXED = re.compile(r"(0[xX][0-9a-fA-F]+|\d+)([uUlL]*)")
_INTEGER_OPERATORS: dict[str, Callable[[int, int], int]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": lambda a, b: abs(a) // abs(b) * (1 if (a < 0) == (b < 0) else -1),
    "%": lambda a, b: abs(a) % abs(b) * (-1 if a < 0 else 1),
    "&": operator.and_,
    "|": operator.or_,
    "^": operator.xor,
    "<<": operator.lshift,
    ">>": operator.rshift,
}
_INTEGER_SIGNS: dict[str, Callable[[int], int]] = {
    "-": operator.neg,
    "+": operator.pos,
    "~": operator.invert,
}
_COMPARISONS: dict[str, Callable[[Any, Any], Any]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}


def _integer_literal(node: Any) -> tuple[int, Integer]:
    match = _SUFFIXED.fullmatch(node.value)
    if match is None:
        raise _unsupported(node, f"the literal {node.value}")
    digits, suffix = match[1], match[2].lower()
    octal = len(digits) > 1 and digits[0] == "0" and digits[1] not in "xX"
    value = int(digits, 8) if octal else int(digits, 0)
    bits = 64 if "l" in suffix or value >= 1 << 31 else 32
    return value, Integer(bits, "u" not in suffix)


def _real_literal(node: Any) -> Fraction:
    text = node.value
    if text[-1] in "lLdD" or (text[-1] in "fF" and not text.lower().startswith("0x")):
        raise _unsupported(node, f"the literal {text}: only double is known")
    if text.lower().startswith("0x"):
        return Fraction(float.fromhex(text))
    return Fraction(text)


def _integer_constant(node: Any, enumerators: Mapping[str, int]) -> int:
    """The value of an integer constant expression (array lengths, enumerators, #if)."""
    match node:
        case c_ast.Constant() if "int" in node.type:
            return _integer_literal(node)[0]
        case c_ast.ID() if node.name in enumerators:
            return enumerators[node.name]
        case c_ast.UnaryOp(op="-" | "+" | "!" | "~"):
            value = _integer_constant(node.expr, enumerators)
            return {"-": -value, "+": value, "!": int(not value), "~": ~value}[node.op]
        case c_ast.BinaryOp(op="&&" | "||"):
            holds = _integer_constant(node.left, enumerators) != 0
            if holds == (node.op == "||"):
                return int(holds)
            return int(_integer_constant(node.right, enumerators) != 0)
        case c_ast.BinaryOp():
            left, right = (_integer_constant(side, enumerators) for side in (node.left, node.right))
            if node.op in _COMPARISONS:
                return int(_COMPARISONS[node.op](left, right))
            if node.op in "/%" and right == 0:
                raise CError(f"{_where(node)}: division by zero")
            return _INTEGER_OPERATORS[node.op](left, right)
        case _:
            raise _unsupported(node, "not an integer constant expression")


# Declarations


class _Types:
    """The typedefs, structs and enumerators of a program."""

    def __init__(self) -> None:
        self.typedefs: dict[str, CType] = {}
        self.records: dict[str, Record] = {}
        self.enumerators: dict[str, int] = {}

    def resolve(self, node: Any, name: str = "") -> CType:
        """The type that a type node means; `name` is given to a struct without a tag."""
        match node:
            case c_ast.TypeDecl() | c_ast.Typename():
                return self.resolve(node.type, name)
            case c_ast.PtrDecl():
                return Pointer(self.resolve(node.type, name), _is_const(node.type))
            case c_ast.ArrayDecl():
                length = None if node.dim is None else _integer_constant(node.dim, self.enumerators)
                return Vector(self.resolve(node.type, name), length)
            case c_ast.IdentifierType():
                return self._named(node)
            case c_ast.Struct():
                return self._record(node, name)
            case c_ast.Enum():
                self._enumerate(node)
                return INT
            case _:
                raise _unsupported(node, f"the type {type(node).__name__}")

    def parameter(self, node: Any) -> tuple[CType, int | None]:
        """The type of a parameter, arrays being pointers, and the number of cells that an array promises."""
        ctype = self.resolve(node.type)
        if not isinstance(ctype, Vector):
            return ctype, None
        extent = None if ctype.length is None else _cells(ctype)
        return Pointer(ctype.element, _is_const(node.type.type)), extent

    def _named(self, node: Any) -> CType:
        text = " ".join(node.names)
        if text in self.typedefs:
            return self.typedefs[text]
        if text == "double":
            return REAL
        if text == "void":
            return Void()
        ordered = " ".join(sorted(node.names, key=["signed", "unsigned", "short", "long"].__contains__)[::-1])
        for candidate in (text, ordered):
            if candidate in _INTEGER_NAMES:
                return _INTEGER_NAMES[candidate]
        raise _unsupported(node, f"the type {text}")

    def _record(self, node: Any, name: str) -> Record:
        tag = node.name or name or "(unnamed)"
        record = self.records.setdefault(node.name, Record(tag)) if node.name else Record(tag)
        if node.decls is not None:
            if record.complete:
                raise _unsupported(node, f"struct {tag} is declared twice")
            for declaration in node.decls:
                if not isinstance(declaration, c_ast.Decl) or declaration.bitsize is not None:
                    raise _unsupported(declaration, "this member of a struct")
                if declaration.name is None:
                    raise _unsupported(declaration, "a member without a name")
                record.fields[declaration.name] = self.resolve(declaration.type, declaration.name)
            record.complete = True
        return record

    def _enumerate(self, node: Any) -> None:
        value = -1
        for item in node.values.enumerators if node.values is not None else ():
            value = value + 1 if item.value is None else _integer_constant(item.value, self.enumerators)
            self.enumerators[item.name] = value


def _is_const(node: Any) -> bool:
    while isinstance(node, c_ast.ArrayDecl):
        node = node.type
    return "const" in (getattr(node, "quals", None) or ())


# Expressions and statements, compiled to closures over a frame (the list of a call's local blocks)


Frame: TypeAlias = list[Block]
Get: TypeAlias = Callable[[Frame], Any]
Location: TypeAlias = tuple[Block, int, int, int]  # block, cell, and the bounds of the object that it lies in
Locate: TypeAlias = Callable[[Frame], Location]
Run: TypeAlias = Callable[[Frame], Any]  # None, _BREAK, _CONTINUE or (value,) for return

_BREAK = object()
_CONTINUE = object()


@dataclass(frozen=True)
class Expression:
    """A typed expression: how to get its value and, if it designates an object, where that lies."""

    ctype: CType
    get: Get
    locate: Locate | None = None


@dataclass
class Function:
    """A compiled function."""

    name: str
    returns: CType
    parameters: list[tuple[str, CType, int | None]]
    slots: int = 0
    body: Run | None = None
    running: bool = False

    def call(self, values: Sequence[Any]) -> Any:
        """Run the function on converted arguments."""
        if self.running:
            raise Unsupported(f"{self.name} is recursive")
        frame: Frame = [None] * self.slots  # type: ignore[list-item]
        for slot, ((name, ctype, extent), value) in enumerate(zip(self.parameters, values, strict=True)):
            if extent is not None and value is not None:
                value = _narrow(value, extent, f"argument {name} of {self.name}")
            if isinstance(value, Struct):
                frame[slot] = _new_block(ctype, name, value._arithmetic)
                _put(frame[slot], 0, value)
            else:
                frame[slot] = Block([value], ctype, name)
        self.running = True
        try:
            assert self.body is not None
            outcome = self.body(frame)
        finally:
            self.running = False
        if isinstance(outcome, tuple):
            return outcome[0]
        if not isinstance(self.returns, Void):
            raise CError(f"{self.name} ends without returning a value")
        return None


def _narrow(pointer: Array, extent: int, what: str) -> Array:
    """The pointer with the bounds that an array parameter promises."""
    available = pointer._high - pointer._start
    if pointer._start < pointer._low or available < extent:
        raise OutOfBounds(f"{what} needs {extent} elements, {pointer._block.name} has {available} left")
    return Array._view(pointer._block, pointer._start, pointer._start, pointer._start + extent)


def _read(location: Location, where: str) -> Any:
    block, cell = location[0], location[1]
    value = block.cells[cell]
    if value is UNSET:
        raise UninitialisedRead(f"{where}: {block.name_of(cell)} is read before it is written")
    return value


MATH_FUNCTIONS: dict[str, tuple[CType, int, Callable[..., Any]]] = {
    "sin": (REAL, 1, numbers.sin),
    "cos": (REAL, 1, numbers.cos),
    "sqrt": (REAL, 1, numbers.sqrt),
    "fabs": (REAL, 1, numbers.fabs),
    "atan2": (REAL, 2, numbers.arctan2),
    "floor": (REAL, 1, numbers.floor),
    "hypot": (REAL, 2, numbers.hypot),
    "fmax": (REAL, 2, numbers.fmax),
    "fmin": (REAL, 2, numbers.fmin),
    "isfinite": (INT, 1, lambda x: int(numbers.isfinite(x))),
    "isnan": (INT, 1, lambda x: int(numbers.isnan(x))),
}

_REAL_OPERATORS: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": numbers.divide,
}


def _common_integer(left: Integer, right: Integer) -> Integer:
    """The type in which an operation on two integers is done."""
    bits = max(left.bits, right.bits, 32)
    unsigned = any(not side.signed and side.bits == bits for side in (left, right))
    return Integer(bits, not unsigned)


class _Compiler:
    """Compiles one function of a program."""

    def __init__(self, program: CProgram) -> None:
        self.program = program
        self.types = program._types
        self.arithmetic = program.arithmetic
        self.scopes: list[dict[str, tuple[int, CType]]] = [{}]
        self.slots = 0
        self.returns: CType = Void()

    # Statements

    def function(self, node: Any, function: Function) -> None:
        """Compile the body of a function whose head is known."""
        self.returns = function.returns
        for name, ctype, _ in function.parameters:
            self._declare(name, ctype)
        function.body = self.statement(node.body)
        function.slots = self.slots

    def _declare(self, name: str, ctype: CType) -> int:
        self.scopes[-1][name] = (self.slots, ctype)
        self.slots += 1
        return self.slots - 1

    def statement(self, node: Any) -> Run:
        """A statement as a function of the frame; an arithmetic error in it is noted with the line."""
        run = self._statement(node)
        if isinstance(node, c_ast.Compound | c_ast.For | c_ast.If | None):
            return run
        where = _where(node)

        def located(frame: Frame) -> Any:
            try:
                return run(frame)
            except (ArithmeticError, TypeError) as error:
                _note(error, where)
                raise

        return located

    def _statement(self, node: Any) -> Run:
        match node:
            case c_ast.Compound():
                return self._compound(node)
            case c_ast.Decl():
                return self._declaration(node)
            case c_ast.DeclList():
                return _sequence([self.statement(item) for item in node.decls])
            case c_ast.For():
                return self._for(node)
            case c_ast.If():
                return self._if(node)
            case c_ast.Return():
                return self._return(node)
            case c_ast.Break():
                return lambda frame: _BREAK
            case c_ast.Continue():
                return lambda frame: _CONTINUE
            case c_ast.EmptyStatement() | c_ast.Pragma():
                return lambda frame: None
            case c_ast.Assignment() | c_ast.UnaryOp() | c_ast.FuncCall() | c_ast.ExprList() | c_ast.Cast():
                get = self.expression(node, used=False).get

                def evaluate(frame: Frame) -> None:
                    get(frame)

                return evaluate
            case _:
                raise _unsupported(node, f"the statement {type(node).__name__}")

    def _compound(self, node: Any) -> Run:
        self.scopes.append({})
        statements = [self.statement(item) for item in node.block_items or ()]
        self.scopes.pop()
        return _sequence(statements)

    def _for(self, node: Any) -> Run:
        self.scopes.append({})
        start = self.statement(node.init) if node.init is not None else None
        condition = self.truth(node.cond) if node.cond is not None else None
        advance = self.expression(node.next, used=False).get if node.next is not None else None
        body = self.statement(node.stmt)
        self.scopes.pop()

        def run(frame: Frame) -> Any:
            if start is not None:
                start(frame)
            while condition is None or condition(frame):
                outcome = body(frame)
                if outcome is _BREAK:
                    break
                if outcome is not None and outcome is not _CONTINUE:
                    return outcome
                if advance is not None:
                    advance(frame)
            return None

        return run

    def _if(self, node: Any) -> Run:
        condition = self.truth(node.cond)
        then = self.statement(node.iftrue) if node.iftrue is not None else None
        other = self.statement(node.iffalse) if node.iffalse is not None else None
        where = _where(node)

        def run(frame: Frame) -> Any:
            try:
                holds = condition(frame)
            except (ArithmeticError, TypeError) as error:
                _note(error, where)
                raise
            branch = then if holds else other
            return None if branch is None else branch(frame)

        return run

    def _return(self, node: Any) -> Run:
        if node.expr is None:
            if not isinstance(self.returns, Void):
                raise _unsupported(node, "return without a value")
            return lambda frame: (None,)
        get = self.converted(self.expression(node.expr), self.returns, node)
        return lambda frame: (get(frame),)

    def _declaration(self, node: Any) -> Run:
        if isinstance(node.type, c_ast.Struct | c_ast.Enum):
            self.types.resolve(node.type)
            return lambda frame: None
        constant = _is_const(node.type)
        if "extern" in node.storage or ("static" in node.storage and not constant):
            raise _unsupported(node, f"{node.name}: static or external variables inside functions")
        if isinstance(node.type, c_ast.FuncDecl):
            raise _unsupported(node, f"{node.name}: a function declared inside a function")
        ctype = self.types.resolve(node.type)
        if isinstance(ctype, Vector) and ctype.length is None and isinstance(node.init, c_ast.InitList):
            ctype = Vector(ctype.element, len(node.init.exprs))
        if isinstance(_innermost(ctype), Void):
            raise _unsupported(node, f"{node.name}: a variable of type void")
        _check_complete(ctype, node)
        slot = self._declare(node.name, ctype)  # C: the name is known within its own initialiser
        fill = self.initialiser(ctype, node.init) if node.init is not None else None
        name, arithmetic = node.name, self.arithmetic

        def run(frame: Frame) -> None:
            block = frame[slot] = _new_block(ctype, name, arithmetic)
            if fill is not None:
                fill(frame, block, 0)

        return run

    def initialiser(self, ctype: CType, node: Any) -> Callable[[Frame, Block, int], None]:
        """How to write an object of type `ctype`, from some cell of a block on, from its initialiser."""
        if not isinstance(node, c_ast.InitList):
            if isinstance(ctype, Vector):
                raise _unsupported(node, "an array initialised without braces")
            get = self.converted(self.expression(node), ctype, node)
            return lambda frame, block, cell: _put(block, cell, get(frame))
        if isinstance(ctype, Vector):
            return self._vector_initialiser(ctype, node)
        if isinstance(ctype, Record):
            return self._record_initialiser(ctype, node)
        raise _unsupported(node, "braces around a scalar")

    def _vector_initialiser(self, ctype: Vector, node: Any) -> Callable[[Frame, Block, int], None]:
        assert ctype.length is not None
        size, arithmetic, items = _cells(ctype.element), self.arithmetic, node.exprs
        if _is_zero_list(node):
            items = []
        if len(items) > ctype.length:
            raise _unsupported(node, f"{len(items)} initialisers for {ctype.length} elements")
        parts = [self.initialiser(ctype.element, item) for item in items]

        def fill(frame: Frame, block: Block, cell: int) -> None:
            for index in range(cell + len(parts) * size, cell + _cells(ctype)):
                _clear(block, index, arithmetic)
            for number, part in enumerate(parts):
                part(frame, block, cell + number * size)

        return fill

    def _record_initialiser(self, ctype: Record, node: Any) -> Callable[[Frame, Block, int], None]:
        arithmetic, names = self.arithmetic, list(ctype.fields)
        parts: dict[str, Callable[[Frame, Block, int], None]] = {}
        for position, item in enumerate(() if _is_zero_list(node) else node.exprs):
            if isinstance(item, c_ast.NamedInitializer):
                if len(item.name) != 1 or not isinstance(item.name[0], c_ast.ID):
                    raise _unsupported(item, "this designator")
                name, value = item.name[0].name, item.expr
            elif len(parts) != position or position >= len(names):
                raise _unsupported(item, f"this initialiser of struct {ctype.name}")
            else:
                name, value = names[position], item
            if name not in ctype.fields:
                raise _unsupported(item, f"struct {ctype.name} has no field {name}")
            parts[name] = self.initialiser(ctype.fields[name], value)

        def fill(frame: Frame, block: Block, cell: int) -> None:
            _clear(block, cell, arithmetic)
            for name, part in parts.items():
                part(frame, block.cells[cell]._blocks[name], 0)

        return fill

    # Expressions

    def truth(self, node: Any) -> Callable[[Frame], bool]:
        """An expression as a condition."""
        expression = self.expression(node)
        get = expression.get
        match _decayed(expression.ctype):
            case Integer() | Real():
                return lambda frame: bool(get(frame) != 0)
            case Pointer():
                return lambda frame: get(frame) is not None
            case _:
                raise _unsupported(node, f"a condition of type {_show(expression.ctype)}")

    def converted(self, expression: Expression, ctype: CType, node: Any) -> Get:
        """The value of an expression as one of type `ctype` (assignment, argument, return, cast)."""
        get, source, where = expression.get, _decayed(expression.ctype), _where(node)
        match source, ctype:
            case (Real(), Real()):
                return get
            case (Integer(), Real()):
                real = self.arithmetic.real
                return lambda frame: real(get(frame))
            case (Integer(), Integer()):
                if source == ctype:
                    return get
                return lambda frame: _fit(get(frame), ctype, where)
            case (Real(), Integer()):
                return lambda frame: _fit(_truncated(get(frame), where), ctype, where)
            case (Pointer(), Pointer()) if source.target == ctype.target or source == NULL_POINTER:
                return get
            case (Record(), Record()) if source is ctype:
                return get
            case _:
                raise _unsupported(node, f"{_show(source)} where {_show(ctype)} is expected")

    def expression(self, node: Any, used: bool = True) -> Expression:
        """Any expression; array values are pointers to the first element."""
        match node:
            case c_ast.Constant():
                return self._constant(node)
            case c_ast.ID():
                return self._identifier(node)
            case c_ast.ArrayRef():
                return self._subscript(node)
            case c_ast.StructRef():
                return self._field(node)
            case c_ast.UnaryOp():
                return self._unary(node)
            case c_ast.BinaryOp(op="&&" | "||"):
                return self._logical(node)
            case c_ast.BinaryOp():
                return self._binary(node.op, self.expression(node.left), self.expression(node.right), node)
            case c_ast.Assignment():
                return self._assignment(node)
            case c_ast.TernaryOp():
                return self._conditional(node)
            case c_ast.Cast():
                return self._cast(node)
            case c_ast.FuncCall():
                return self._call(node, used)
            case c_ast.ExprList():
                parts = [self.expression(item, used=False) for item in node.exprs]
                return Expression(parts[-1].ctype, lambda frame: [part.get(frame) for part in parts][-1])
            case _:
                raise _unsupported(node, f"the expression {type(node).__name__}")

    def _constant(self, node: Any) -> Expression:
        if "char" in node.type or node.type == "string":
            raise _unsupported(node, f"the literal {node.value}")
        if "int" in node.type:
            value, ctype = _integer_literal(node)
            return Expression(ctype, lambda frame: value)
        return self._number(_real_literal(node))

    def _number(self, value: Fraction) -> Expression:
        real = self.arithmetic.real
        if self.arithmetic.fixed:
            number = real(value)
            return Expression(REAL, lambda frame: number)
        return Expression(REAL, lambda frame: real(value))

    def _identifier(self, node: Any) -> Expression:
        name: str = node.name
        for scope in reversed(self.scopes):
            if name in scope:
                return self._local(*scope[name], node)
        if name in self.program._globals:
            ctype, block = self.program._globals[name]
            location = (block, 0, 0, len(block.cells))
            return self._place(ctype, lambda frame: location, node)
        if name in self.types.enumerators:
            value = self.types.enumerators[name]
            return Expression(INT, lambda frame: value)
        if name == "NULL":
            return Expression(NULL_POINTER, lambda frame: None)
        if name in ("true", "false"):
            truth = int(name == "true")
            return Expression(INT, lambda frame: truth)
        if name in self.program._constants:
            constant = self.program._constants[name]
            return Expression(REAL, lambda frame: constant())
        raise _unsupported(node, f"{name} is not declared")

    def _local(self, slot: int, ctype: CType, node: Any) -> Expression:
        def locate(frame: Frame) -> Location:
            block = frame[slot]
            return block, 0, 0, len(block.cells)

        return self._place(ctype, locate, node)

    def _place(self, ctype: CType, locate: Locate, node: Any) -> Expression:
        """An expression that designates an object; a place that is an array has a pointer as its value."""
        where = _where(node)
        if isinstance(ctype, Vector):
            size = _cells(ctype)

            def decay(frame: Frame) -> Array:
                block, cell, _, _ = locate(frame)
                return Array._view(block, cell, cell, cell + size)

            return Expression(ctype, decay, locate)
        return Expression(ctype, lambda frame: _read(locate(frame), where), locate)

    def _subscript(self, node: Any) -> Expression:
        base, index = self.expression(node.name), self.expression(node.subscript)
        if not isinstance(index.ctype, Integer):
            raise _unsupported(node, f"a subscript of type {_show(index.ctype)}")
        where, get_index = _where(node), index.get
        if isinstance(base.ctype, Vector) and base.locate is not None:
            element, length, origin = base.ctype.element, base.ctype.length, base.locate
            assert length is not None
            size = _cells(element)

            def in_array(frame: Frame) -> Location:
                block, cell, low, high = origin(frame)
                number = get_index(frame)
                if not 0 <= number < length:
                    raise OutOfBounds(f"{where}: index {number} of {length} elements of {block.name}")
                return block, cell + number * size, low, high

            return self._place(element, in_array, node)
        target = _decayed(base.ctype)
        if not isinstance(target, Pointer):
            raise _unsupported(node, f"a subscript of {_show(base.ctype)}")
        return self._behind(base.get, get_index, target.target, node)

    def _behind(self, pointer: Get, index: Get, target: CType, node: Any) -> Expression:
        """The object that lies `index` objects behind the one that a pointer points to."""
        if isinstance(target, Void):
            raise _unsupported(node, "access through a pointer to void")
        where, size = _where(node), _cells(target)

        def locate(frame: Frame) -> Location:
            base = pointer(frame)
            if base is None:
                raise OutOfBounds(f"{where}: access through a null pointer")
            offset = index(frame)
            cell = base._start + offset * size
            if cell < base._low or cell + size > base._high:
                raise OutOfBounds(
                    f"{where}: index {offset} of {base._block.name}, "
                    f"{(base._high - base._start) // size} elements from there on"
                )
            return base._block, cell, base._low, base._high

        return self._place(target, locate, node)

    def _field(self, node: Any) -> Expression:
        base = self.expression(node.name)
        if node.type == "->":
            pointer = _decayed(base.ctype)
            if not isinstance(pointer, Pointer):
                raise _unsupported(node, f"-> on {_show(base.ctype)}")
            base = self._behind(base.get, lambda frame: 0, pointer.target, node)
        record, name, get_struct = base.ctype, node.field.name, base.get
        if not isinstance(record, Record):
            raise _unsupported(node, f".{name} of {_show(record)}")
        if name not in record.fields:
            raise _unsupported(node, f"struct {record.name} has no field {name}")

        def locate(frame: Frame) -> Location:
            block = get_struct(frame)._blocks[name]
            return block, 0, 0, len(block.cells)

        return self._place(record.fields[name], locate, node)

    def _unary(self, node: Any) -> Expression:
        if node.op in ("++", "--", "p++", "p--"):
            return self._step(node)
        if node.op == "sizeof":
            raise _unsupported(node, "sizeof")
        operand = self.expression(node.expr)
        get, ctype, where = operand.get, operand.ctype, _where(node)
        match node.op, ctype:
            case ("&", _) if operand.locate is not None:
                locate = operand.locate
                return Expression(Pointer(ctype), lambda frame: Array._view(*locate(frame)))
            case ("*", Pointer() | Vector()):
                pointer = _decayed(ctype)
                assert isinstance(pointer, Pointer)
                return self._behind(get, lambda frame: 0, pointer.target, node)
            case ("!", _):
                holds = self.truth(node.expr)
                return Expression(INT, lambda frame: int(not holds(frame)))
            case ("-", Real()):
                return Expression(REAL, lambda frame: -get(frame))
            case ("+", Real()):
                return Expression(REAL, get)
            case ("-" | "+" | "~", Integer()):
                common = _common_integer(ctype, INT)
                change = _INTEGER_SIGNS[node.op]
                return Expression(common, lambda frame: _fit(change(get(frame)), common, where))
            case _:
                raise _unsupported(node, f"{node.op} on {_show(ctype)}")

    def _step(self, node: Any) -> Expression:
        target = self.expression(node.expr)
        one = Expression(INT, lambda frame: 1)
        old, new = self._update(target, node.op[-1], one, node)
        return Expression(target.ctype, old if node.op.startswith("p") else new)

    def _update(self, target: Expression, sign: str, amount: Expression, node: Any) -> tuple[Get, Get]:
        """The two readings of `target = target sign amount`: the former value, and the new one."""
        if target.locate is None or isinstance(target.ctype, Vector | Record):
            raise _unsupported(node, "this target of an assignment")
        locate, where = target.locate, _where(node)
        held: list[Any] = [None]
        before = Expression(target.ctype, lambda frame: held[0])
        after = self._binary(sign, before, amount, node)
        get = self.converted(after, target.ctype, node)

        def update(frame: Frame) -> tuple[Any, Any]:
            location = locate(frame)
            old = held[0] = _read(location, where)
            new = get(frame)
            location[0].cells[location[1]] = new
            return old, new

        return lambda frame: update(frame)[0], lambda frame: update(frame)[1]

    def _assignment(self, node: Any) -> Expression:
        target, value = self.expression(node.lvalue), self.expression(node.rvalue)
        if node.op != "=":
            return Expression(target.ctype, self._update(target, node.op[:-1], value, node)[1])
        if target.locate is None or isinstance(target.ctype, Vector):
            raise _unsupported(node, "this target of an assignment")
        locate, get = target.locate, self.converted(value, target.ctype, node)

        def assign(frame: Frame) -> Any:
            item = get(frame)
            block, cell, _, _ = locate(frame)
            _put(block, cell, item)
            return item

        return Expression(target.ctype, assign)

    def _logical(self, node: Any) -> Expression:
        left, right = self.truth(node.left), self.truth(node.right)
        if node.op == "&&":
            return Expression(INT, lambda frame: int(left(frame) and right(frame)))
        return Expression(INT, lambda frame: int(left(frame) or right(frame)))

    def _binary(self, sign: str, left: Expression, right: Expression, node: Any) -> Expression:
        a, b = _decayed(left.ctype), _decayed(right.ctype)
        if isinstance(a, Pointer) or isinstance(b, Pointer):
            return self._pointer_operation(sign, left, right, node)
        if isinstance(a, Integer) and isinstance(b, Integer):
            return self._integer_operation(sign, left, right, node)
        get_a, get_b = (self.converted(side, REAL, node) for side in (left, right))
        if sign in _COMPARISONS:
            compare = _COMPARISONS[sign]
            return Expression(INT, lambda frame: int(compare(get_a(frame), get_b(frame))))
        if sign not in _REAL_OPERATORS:
            raise _unsupported(node, f"{sign} on double")
        compute = _REAL_OPERATORS[sign]
        return Expression(REAL, lambda frame: compute(get_a(frame), get_b(frame)))

    def _integer_operation(self, sign: str, left: Expression, right: Expression, node: Any) -> Expression:
        assert isinstance(left.ctype, Integer) and isinstance(right.ctype, Integer)
        shift = sign in ("<<", ">>")
        common = _common_integer(left.ctype, INT if shift else right.ctype)
        where = _where(node)
        get_a, get_b = self.converted(left, common, node), self.converted(right, common, node)
        if sign in _COMPARISONS:
            compare = _COMPARISONS[sign]
            return Expression(INT, lambda frame: int(compare(get_a(frame), get_b(frame))))
        compute = _INTEGER_OPERATORS[sign]

        def operate(frame: Frame) -> int:
            a, b = get_a(frame), get_b(frame)
            if b == 0 and sign in "/%":
                raise CError(f"{where}: integer division by zero")
            if shift and not 0 <= b < common.bits:
                raise CError(f"{where}: shift by {b} bits")
            return _fit(compute(a, b), common, where)

        return Expression(common, operate)

    def _pointer_operation(self, sign: str, left: Expression, right: Expression, node: Any) -> Expression:
        a, b, where = _decayed(left.ctype), _decayed(right.ctype), _where(node)
        get_a, get_b = left.get, right.get
        if isinstance(a, Integer) and sign == "+":
            a, b, get_a, get_b = b, a, get_b, get_a
        if isinstance(a, Pointer) and isinstance(b, Integer) and sign in "+-":
            size, direction = _cells(a.target), 1 if sign == "+" else -1
            return Expression(a, lambda frame: _moved(get_a(frame), direction * get_b(frame) * size, where))
        if isinstance(a, Pointer) and isinstance(b, Pointer):
            if sign in ("==", "!="):
                wanted = sign == "=="
                return Expression(INT, lambda frame: int(_same_place(get_a(frame), get_b(frame)) == wanted))
            if sign == "-" and a == b:
                size = _cells(a.target)
                return Expression(LONG, lambda frame: _distance(get_a(frame), get_b(frame), where) // size)
        raise _unsupported(node, f"{_show(a)} {sign} {_show(b)}")

    def _conditional(self, node: Any) -> Expression:
        condition = self.truth(node.cond)
        then, other = self.expression(node.iftrue), self.expression(node.iffalse)
        a, b = _decayed(then.ctype), _decayed(other.ctype)
        if isinstance(a, Integer) and isinstance(b, Integer):
            ctype: CType = _common_integer(a, b)
        elif isinstance(a, Integer | Real) and isinstance(b, Integer | Real):
            ctype = REAL
        else:
            ctype = b if a == NULL_POINTER else a
        get_a, get_b = self.converted(then, ctype, node), self.converted(other, ctype, node)

        def choose(frame: Frame) -> Any:
            try:
                holds = condition(frame)
            except numbers.Undecidable:
                # equal values, as of the larger of two equal balls: whichever it is, the hull encloses it
                x, y = get_a(frame), get_b(frame)
                if not (isinstance(x, numbers.Ball) and isinstance(y, numbers.Ball)):
                    raise
                return x.hull(y)
            return get_a(frame) if holds else get_b(frame)

        return Expression(ctype, choose)

    def _cast(self, node: Any) -> Expression:
        ctype, value = self.types.resolve(node.to_type), self.expression(node.expr)
        if isinstance(ctype, Void):
            return Expression(ctype, value.get)
        return Expression(ctype, self.converted(value, ctype, node))

    def _call(self, node: Any, used: bool) -> Expression:
        if not isinstance(node.name, c_ast.ID):
            raise _unsupported(node, "a call through a pointer")
        name = node.name.name
        arguments = [self.expression(item) for item in (node.args.exprs if node.args is not None else ())]
        if name in self.program._definitions:
            function = self.program._function(name)
            wanted: list[CType] = [ctype for _, ctype, _ in function.parameters]
            result, compute = function.returns, None
        elif name in MATH_FUNCTIONS:
            result, count, compute = MATH_FUNCTIONS[name]
            wanted = [REAL] * count
        else:
            raise _unsupported(node, f"{name} is called but not defined")
        if len(wanted) != len(arguments):
            raise _unsupported(node, f"{name} takes {len(wanted)} arguments, {len(arguments)} given")
        if used and isinstance(result, Void):
            raise _unsupported(node, f"{name} has no value")
        gets = [self.converted(item, ctype, node) for item, ctype in zip(arguments, wanted, strict=True)]
        if compute is not None:
            operation = compute
            return Expression(result, lambda frame: operation(*[get(frame) for get in gets]))
        where = _where(node)

        def call(frame: Frame) -> Any:
            try:
                return function.call([get(frame) for get in gets])
            except CError as error:
                error.add_note(f"called from {where}")
                raise

        return Expression(result, call)


def _note(error: BaseException, where: str) -> None:
    """Say once where an arithmetic error came from."""
    if not getattr(error, "__notes__", ()):
        error.add_note(f"at {where}")


def _sequence(statements: list[Run]) -> Run:
    def run(frame: Frame) -> Any:
        for statement in statements:
            outcome = statement(frame)
            if outcome is not None:
                return outcome
        return None

    return run


def _decayed(ctype: CType) -> CType:
    return Pointer(ctype.element) if isinstance(ctype, Vector) else ctype


def _truncated(value: Any, where: str) -> int:
    if isinstance(value, Exact):
        return math.trunc(value.fraction)
    if isinstance(value, float) and math.isfinite(value):
        return math.trunc(value)
    raise CError(f"{where}: {value!r} as an integer")


def _moved(pointer: Array | None, cells: int, where: str) -> Array:
    if pointer is None:
        raise OutOfBounds(f"{where}: arithmetic on a null pointer")
    start = pointer._start + cells
    if not pointer._low <= start <= pointer._high:
        raise OutOfBounds(f"{where}: a pointer outside {pointer._block.name}")
    return Array._view(pointer._block, start, pointer._low, pointer._high)


def _same_place(a: Array | None, b: Array | None) -> bool:
    if a is None or b is None:
        return a is b
    return a._block is b._block and a._start == b._start


def _distance(a: Array | None, b: Array | None, where: str) -> int:
    if a is None or b is None or a._block is not b._block:
        raise OutOfBounds(f"{where}: the difference of pointers into different objects")
    return a._start - b._start


def _check_complete(ctype: CType, node: Any) -> None:
    innermost = _innermost(ctype)
    if isinstance(innermost, Record) and not innermost.complete:
        raise _unsupported(node, f"struct {innermost.name} is incomplete")
    _cells(ctype)


def _is_zero_list(node: Any) -> bool:
    """Whether the initialiser is `{0}` (or `{0.0}`), which clears an object of any type."""
    if len(node.exprs) != 1 or not isinstance(node.exprs[0], c_ast.Constant):
        return False
    return re.fullmatch(r"0|0\.0?|\.0", node.exprs[0].value) is not None


def _clear(block: Block, cell: int, arithmetic: Arithmetic) -> None:
    match block.ctype:
        case Real():
            block.cells[cell] = arithmetic.real(0)
        case Integer():
            block.cells[cell] = 0
        case Pointer():
            block.cells[cell] = None
        case _:
            for part in block.cells[cell]._blocks.values():
                for index in range(len(part.cells)):
                    _clear(part, index, arithmetic)


# Programs


class CProgram:
    """Parsed C, whose functions can be called on numbers of one arithmetic.

    `constants` adds to, or replaces, the values of NAN, INFINITY and M_PI: a number, or a function without
    arguments that makes one.  By default NAN and INFINITY are the floats of that name, which can be written
    and tested but not calculated with in exact arithmetic, and M_PI is the arithmetic's pi.

    `macros` are object-like macros that are defined beforehand, as a compiler's -D does.
    """

    def __init__(
        self,
        sources: Iterable[tuple[str, str]],
        arithmetic: Arithmetic = EXACT,
        constants: Mapping[str, Any] | None = None,
        macros: Mapping[str, str] | None = None,
    ) -> None:
        self.arithmetic = arithmetic
        self._constants: dict[str, Callable[[], Any]] = {
            "NAN": lambda: math.nan,
            "INFINITY": lambda: math.inf,
            "M_PI": arithmetic.pi,
        }
        for name, value in (constants or {}).items():
            self._constants[name] = value if callable(value) else _constantly(arithmetic.lift(value))
        self._types = _Types()
        self._definitions: dict[str, Any] = {}
        self._functions: dict[str, Function] = {}
        self._globals: dict[str, tuple[CType, Block]] = {}
        preprocessor = _Preprocessor([*self._constants, "NULL", "true", "false"])
        preprocessor.macros |= macros or {}
        text = "\n".join([_PRELUDE, *(preprocessor.process(source, name) for name, source in sources)])
        try:
            tree = c_parser.CParser().parse(text, "prelude")
        except c_parser.ParseError as error:
            raise Unsupported(f"the text does not parse as C99: {error}") from error
        for node in tree.ext:
            self._external(node)

    @classmethod
    def from_files(
        cls,
        paths: Iterable[str | Path],
        arithmetic: Arithmetic = EXACT,
        constants: Mapping[str, Any] | None = None,
        macros: Mapping[str, str] | None = None,
    ) -> CProgram:
        """The program in these files, headers before what uses them."""
        files = [Path(path) for path in paths]
        texts = [(file.name, file.read_text(encoding="utf-8")) for file in files]
        return cls(texts, arithmetic, constants, macros)

    @classmethod
    def from_text(
        cls,
        text: str,
        arithmetic: Arithmetic = EXACT,
        constants: Mapping[str, Any] | None = None,
        macros: Mapping[str, str] | None = None,
        name: str = "text.c",
    ) -> CProgram:
        """The program in this text."""
        return cls([(name, text)], arithmetic, constants, macros)

    @property
    def functions(self) -> tuple[str, ...]:
        """The names of the functions that are defined, in their order."""
        return tuple(self._definitions)

    @property
    def enumerators(self) -> dict[str, int]:
        """The enumeration constants by name, status codes for one."""
        return dict(self._types.enumerators)

    def check(self) -> None:
        """Compile all functions, so that what is unsupported shows without a call."""
        for name in self._definitions:
            self._function(name)

    def new_struct(self, name: str) -> Struct:
        """A struct of the type with this typedef name or tag, all fields unset."""
        record = self._types.typedefs.get(name, self._types.records.get(name))
        if not isinstance(record, Record) or not record.complete:
            raise KeyError(f"no struct {name}")
        return Struct(record, self.arithmetic, name)

    def call(self, name: str, *arguments: Any) -> Any:
        """Call a function.

        Pointers take an `Array`, a `Struct` or None; a pointer to const takes a plain sequence too.
        Plain numbers become numbers of the program's arithmetic, in arrays in place.
        """
        if name not in self._definitions:
            raise KeyError(f"no function {name}")
        function = self._function(name)
        if len(arguments) != len(function.parameters):
            raise TypeError(f"{name} takes {len(function.parameters)} arguments, {len(arguments)} given")
        return function.call(
            [
                _from_python(value, ctype, self.arithmetic, parameter)
                for value, (parameter, ctype, _) in zip(arguments, function.parameters, strict=True)
            ]
        )

    def parameters(self, name: str) -> tuple[str, ...]:
        """The names of a function's parameters, in their order."""
        return tuple(parameter for parameter, _, _ in self._function(name).parameters)

    def _function(self, name: str) -> Function:
        if name not in self._functions:
            node = self._definitions[name]
            head = node.decl.type
            parameters = []
            for item in head.args.params if head.args is not None else ():
                if isinstance(item, c_ast.Typename) and isinstance(self._types.resolve(item), Void):
                    continue
                if not isinstance(item, c_ast.Decl) or isinstance(item.type, c_ast.FuncDecl):
                    raise _unsupported(item, f"this parameter of {name}")
                parameters.append((item.name, *self._types.parameter(item)))
            function = Function(name, self._types.resolve(head.type), parameters)
            self._functions[name] = function
            try:
                _Compiler(self).function(node, function)
            except BaseException:
                del self._functions[name]
                raise
        return self._functions[name]

    def _external(self, node: Any) -> None:
        match node:
            case c_ast.Typedef():
                self._types.typedefs[node.name] = self._types.resolve(node.type, node.name)
            case c_ast.FuncDef():
                if node.decl.name in self._definitions:
                    raise _unsupported(node, f"{node.decl.name} is defined twice")
                self._definitions[node.decl.name] = node
            case c_ast.Decl() if isinstance(node.type, c_ast.Struct | c_ast.Enum):
                self._types.resolve(node.type)
            case c_ast.Decl() if isinstance(node.type, c_ast.FuncDecl):
                pass  # a prototype: calls need the definition
            case c_ast.Decl():
                self._constant_table(node)
            case c_ast.Pragma():
                pass
            case _:
                raise _unsupported(node, f"{type(node).__name__} outside of functions")

    def _constant_table(self, node: Any) -> None:
        if not _is_const(node.type) or node.init is None:
            raise _unsupported(node, f"{node.name}: variables outside of functions must be constant")
        compiler = _Compiler(self)
        run = compiler.statement(node)
        frame: Frame = [None] * compiler.slots  # type: ignore[list-item]
        run(frame)
        slot, ctype = compiler.scopes[0][node.name]
        self._globals[node.name] = (ctype, frame[slot])


def _constantly(value: Any) -> Callable[[], Any]:
    return lambda: value
