"""Operators that make a value of values; `expressions` has those that write, `places` those that designate
objects.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from pycparser import c_ast

from krhpr.validation import numbers
from krhpr.validation.c_interpreter import integers
from krhpr.validation.c_interpreter.compiled import Condition, Expression, Frame, Get
from krhpr.validation.c_interpreter.conversions import converted, truth
from krhpr.validation.c_interpreter.errors import CError, unsupported, where
from krhpr.validation.c_interpreter.integers import COMPARISONS, fit
from krhpr.validation.c_interpreter.pointers import distance, moved, same_place
from krhpr.validation.c_interpreter.types import (
    INT,
    LONG,
    NULL_POINTER,
    REAL,
    CType,
    Integer,
    Pointer,
    Real,
    cells,
    decayed,
    show,
)
from krhpr.validation.numbers import Arithmetic

_REAL_OPERATORS: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": numbers.divide,
}


def unary(sign: str, operand: Expression, node: c_ast.UnaryOp) -> Expression:
    """The operators `!`, `-`, `+` and `~`."""
    get, ctype, line = operand.get, operand.ctype, where(node)
    match sign, ctype:
        case ("!", _):
            holds = truth(operand, node.expr)
            return Expression(INT, lambda frame: int(not holds(frame)))
        case ("-", Real()):
            return Expression(REAL, lambda frame: -get(frame))
        case ("+", Real()):
            return Expression(REAL, get)
        case ("-" | "+" | "~", Integer()):
            common = integers.common(ctype, INT)
            change = integers.SIGNS[sign]
            return Expression(common, lambda frame: fit(change(get(frame)), common, line))
        case _:
            raise unsupported(node, f"{sign} on {show(ctype)}")


def logical(sign: str, left: Condition, right: Condition) -> Expression:
    """`&&` and `||`, whose right side runs only where the left one leaves the result open."""
    if sign == "&&":
        return Expression(INT, lambda frame: int(left(frame) and right(frame)))
    return Expression(INT, lambda frame: int(left(frame) or right(frame)))


def binary(
    sign: str, left: Expression, right: Expression, arithmetic: Arithmetic, node: c_ast.Node
) -> Expression:
    """Arithmetic, comparisons, shifts and bits; `node` says where."""
    a, b = decayed(left.ctype), decayed(right.ctype)
    if isinstance(a, Pointer) or isinstance(b, Pointer):
        return _of_pointers(sign, left, right, node)
    if isinstance(a, Integer) and isinstance(b, Integer):
        shared = integers.common(a, INT if sign in ("<<", ">>") else b)
        get_a, get_b = (converted(side, shared, arithmetic, node) for side in (left, right))
        return _of_integers(sign, get_a, get_b, shared, node)
    get_a, get_b = (converted(side, REAL, arithmetic, node) for side in (left, right))
    if sign in COMPARISONS:
        return _comparison(sign, get_a, get_b)
    if sign not in _REAL_OPERATORS:
        raise unsupported(node, f"{sign} on double")
    compute = _REAL_OPERATORS[sign]
    return Expression(REAL, lambda frame: compute(get_a(frame), get_b(frame)))


def _comparison(sign: str, get_a: Get, get_b: Get) -> Expression:
    compare = COMPARISONS[sign]
    return Expression(INT, lambda frame: int(compare(get_a(frame), get_b(frame))))


def _of_integers(sign: str, get_a: Get, get_b: Get, shared: Integer, node: c_ast.Node) -> Expression:
    if sign in COMPARISONS:
        return _comparison(sign, get_a, get_b)
    compute, shift, line = integers.OPERATORS[sign], sign in ("<<", ">>"), where(node)

    def operate(frame: Frame) -> int:
        a, b = get_a(frame), get_b(frame)
        if b == 0 and sign in "/%":
            raise CError(f"{line}: integer division by zero")
        if shift and not 0 <= b < shared.bits:
            raise CError(f"{line}: shift by {b} bits")
        return fit(compute(a, b), shared, line)

    return Expression(shared, operate)


def _of_pointers(sign: str, left: Expression, right: Expression, node: c_ast.Node) -> Expression:
    a, b, line = decayed(left.ctype), decayed(right.ctype), where(node)
    get_a, get_b = left.get, right.get
    if isinstance(a, Integer) and sign == "+":
        a, b, get_a, get_b = b, a, get_b, get_a
    if isinstance(a, Pointer) and isinstance(b, Integer) and sign in "+-":
        size, direction = cells(a.target), 1 if sign == "+" else -1
        return Expression(a, lambda frame: moved(get_a(frame), direction * get_b(frame) * size, line))
    if isinstance(a, Pointer) and isinstance(b, Pointer):
        if sign in ("==", "!="):
            wanted = sign == "=="
            return Expression(INT, lambda frame: int(same_place(get_a(frame), get_b(frame)) == wanted))
        if sign == "-" and a == b:
            size = cells(a.target)
            return Expression(LONG, lambda frame: distance(get_a(frame), get_b(frame), line) // size)
    raise unsupported(node, f"{show(a)} {sign} {show(b)}")


def conditional(
    condition: Condition,
    then: Expression,
    other: Expression,
    arithmetic: Arithmetic,
    node: c_ast.TernaryOp,
) -> Expression:
    """`condition ? then : other`, in the type that both have in common."""
    ctype = _shared(decayed(then.ctype), decayed(other.ctype))
    get_a, get_b = (converted(side, ctype, arithmetic, node) for side in (then, other))

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


def _shared(a: CType, b: CType) -> CType:
    if isinstance(a, Integer) and isinstance(b, Integer):
        return integers.common(a, b)
    if isinstance(a, Integer | Real) and isinstance(b, Integer | Real):
        return REAL
    return b if a == NULL_POINTER else a
