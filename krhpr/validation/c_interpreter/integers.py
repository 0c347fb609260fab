"""C's rules for integers, on those of Python: operations, ranges, literals and constant expressions."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Mapping
from typing import Any

from pycparser import c_ast

from krhpr.validation.c_interpreter.errors import CError, unsupported, where
from krhpr.validation.c_interpreter.types import BOOL, Integer, show

OPERATORS: dict[str, Callable[[int, int], int]] = {
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
SIGNS: dict[str, Callable[[int], int]] = {
    "-": operator.neg,
    "+": operator.pos,
    "~": operator.invert,
}
COMPARISONS: dict[str, Callable[[Any, Any], Any]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
"""These compare doubles as well."""

_LITERAL = re.compile(r"(0[xX][0-9a-fA-F]+|\d+)([uUlL]*)")


def fit(value: int, ctype: Integer, place: str) -> int:
    """An integer as the type holds it: unsigned types wrap round, signed ones raise on overflow."""
    if ctype == BOOL:
        return int(value != 0)
    if not ctype.signed:
        return value & ((1 << ctype.bits) - 1)
    if not -(1 << (ctype.bits - 1)) <= value < 1 << (ctype.bits - 1):
        raise CError(f"{place}: {value} overflows a {show(ctype)}")
    return value


def common(left: Integer, right: Integer) -> Integer:
    """The type in which an operation on two integers is done."""
    bits = max(left.bits, right.bits, 32)
    unsigned = any(not side.signed and side.bits == bits for side in (left, right))
    return Integer(bits, not unsigned)


def literal(node: c_ast.Constant) -> tuple[int, Integer]:
    """The value and the type of an integer literal."""
    match = _LITERAL.fullmatch(node.value)
    if match is None:
        raise unsupported(node, f"the literal {node.value}")
    digits, suffix = match[1], match[2].lower()
    octal = len(digits) > 1 and digits[0] == "0" and digits[1] not in "xX"
    value = int(digits, 8) if octal else int(digits, 0)
    bits = 64 if "l" in suffix or value >= 1 << 31 else 32
    return value, Integer(bits, "u" not in suffix)


def constant(node: c_ast.Node, enumerators: Mapping[str, int]) -> int:
    """The value of an integer constant expression (array lengths, enumerators, #if)."""
    match node:
        case c_ast.Constant() if "int" in node.type:
            return literal(node)[0]
        case c_ast.ID() if node.name in enumerators:
            return enumerators[node.name]
        case c_ast.UnaryOp(op="!"):
            return int(not constant(node.expr, enumerators))
        case c_ast.UnaryOp() if node.op in SIGNS:
            return SIGNS[node.op](constant(node.expr, enumerators))
        case c_ast.BinaryOp(op="&&" | "||"):
            holds = constant(node.left, enumerators) != 0
            if holds == (node.op == "||"):
                return int(holds)
            return int(constant(node.right, enumerators) != 0)
        case c_ast.BinaryOp():
            left, right = (constant(side, enumerators) for side in (node.left, node.right))
            if node.op in COMPARISONS:
                return int(COMPARISONS[node.op](left, right))
            if node.op in "/%" and right == 0:
                raise CError(f"{where(node)}: division by zero")
            return OPERATORS[node.op](left, right)
        case _:
            raise unsupported(node, "not an integer constant expression")
