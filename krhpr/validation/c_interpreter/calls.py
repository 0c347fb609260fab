"""Calls, of the program's own functions and of those of math.h."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from pycparser import c_ast

from krhpr.validation import numbers
from krhpr.validation.c_interpreter.compiled import Expression, Frame, Function, Get
from krhpr.validation.c_interpreter.conversions import converted
from krhpr.validation.c_interpreter.errors import CError, unsupported, where
from krhpr.validation.c_interpreter.scope import Environment
from krhpr.validation.c_interpreter.types import INT, REAL, CType

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
"""By name: the type of the result, the number of arguments, all double, and what computes it."""


def call(node: c_ast.FuncCall, arguments: Sequence[Expression], environment: Environment) -> Expression:
    """The value of a call; of type void where it has none."""
    name = node.name.name
    function = environment.function(name)
    if function is not None:
        gets = _converted(node, arguments, [ctype for _, ctype, _ in function.parameters], environment)
        return Expression(function.returns, _of_program(function, gets, where(node)))
    if name in MATH_FUNCTIONS:
        result, count, compute = MATH_FUNCTIONS[name]
        gets = _converted(node, arguments, [REAL] * count, environment)
        return Expression(result, lambda frame: compute(*[get(frame) for get in gets]))
    raise unsupported(node, f"{name} is called but not defined")


def _converted(
    node: c_ast.FuncCall, arguments: Sequence[Expression], wanted: Sequence[CType], environment: Environment
) -> list[Get]:
    if len(wanted) != len(arguments):
        raise unsupported(node, f"{node.name.name} takes {len(wanted)} arguments, {len(arguments)} given")
    return [
        converted(item, ctype, environment.arithmetic, node)
        for item, ctype in zip(arguments, wanted, strict=True)
    ]


def _of_program(function: Function, gets: Sequence[Get], line: str) -> Get:
    def run(frame: Frame) -> Any:
        try:
            return function.call([get(frame) for get in gets])
        except CError as error:
            error.add_note(f"called from {line}")
            raise

    return run
