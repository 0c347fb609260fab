"""C's conversions: a value as one of another type, or as a truth value."""

from __future__ import annotations

import math
from typing import Any

from pycparser import c_ast

from krhpr.validation.c_interpreter.compiled import Condition, Expression, Get
from krhpr.validation.c_interpreter.errors import CError, unsupported, where
from krhpr.validation.c_interpreter.integers import fit
from krhpr.validation.c_interpreter.types import (
    NULL_POINTER,
    CType,
    Integer,
    Pointer,
    Real,
    Record,
    decayed,
    show,
)
from krhpr.validation.numbers import Arithmetic, Exact


def converted(expression: Expression, ctype: CType, arithmetic: Arithmetic, node: c_ast.Node) -> Get:
    """The value of an expression as one of type `ctype` (operand, assignment, argument, return, cast)."""
    get, source, line = expression.get, decayed(expression.ctype), where(node)
    match source, ctype:
        case (Real(), Real()):
            return get
        case (Integer(), Real()):
            real = arithmetic.real
            return lambda frame: real(get(frame))
        case (Integer(), Integer()):
            if source == ctype:
                return get
            return lambda frame: fit(get(frame), ctype, line)
        case (Real(), Integer()):
            return lambda frame: fit(_truncated(get(frame), line), ctype, line)
        case (Pointer(), Pointer()) if source.target == ctype.target or source == NULL_POINTER:
            return get
        case (Record(), Record()) if source is ctype:
            return get
        case _:
            raise unsupported(node, f"{show(source)} where {show(ctype)} is expected")


def _truncated(value: Any, line: str) -> int:
    if isinstance(value, Exact):
        return math.trunc(value.fraction)
    if isinstance(value, float) and math.isfinite(value):
        return math.trunc(value)
    raise CError(f"{line}: {value!r} as an integer")


def truth(expression: Expression, node: c_ast.Node) -> Condition:
    """An expression as a condition."""
    get = expression.get
    match decayed(expression.ctype):
        case Integer() | Real():
            return lambda frame: bool(get(frame) != 0)
        case Pointer():
            return lambda frame: get(frame) is not None
        case _:
            raise unsupported(node, f"a condition of type {show(expression.ctype)}")
