"""Evaluating a CasADi function over the number types of `numbers`, instruction by instruction.

A CasADi SX function is a straight-line program; walking its instructions computes what CasADi computes,
without rounding.  Constants have been doubles since CasADi read them: one that is no dyadic fraction (a
third, a tenth) is the double next to it, unless the caller's `constant` knows better.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import casadi

from krhpr.validation import numbers
from krhpr.validation.numbers import EXACT, Arithmetic, Ball


class UnknownOperation(NotImplementedError):
    """The function contains an operation that the walker does not know."""


def evaluate(
    function: casadi.Function,
    arguments: Sequence[Any],
    arithmetic: Arithmetic = EXACT,
    constant: Callable[[float], Any] | None = None,
) -> list[list[list[Any]]]:
    """The outputs of an SX function, each as a list of rows.

    An argument is a flat sequence of all entries in column-major order, a list of rows, or a number for a
    scalar.  Entries of sparse inputs that CasADi knows to be zero are ignored; those of outputs are exact
    zeros.  `constant` turns CasADi's constants into numbers (by default, into the double's exact value).
    Every instruction is carried out: a conditional does not shield the branch that is not taken.
    """
    if not function.is_a("SXFunction"):
        raise UnknownOperation(f"{function.name()} is no SX function; expand() makes one of an MX function")
    if function.n_in() != len(arguments):
        raise ValueError(f"{function.name()} takes {function.n_in()} arguments, {len(arguments)} given")
    inputs = [_nonzeros(function, index, argument, arithmetic) for index, argument in enumerate(arguments)]
    outputs: list[list[Any]] = [[None] * function.nnz_out(i) for i in range(function.n_out())]
    work: list[Any] = [None] * function.sz_w()
    read = constant or arithmetic.real
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        source, target = function.instruction_input(k), function.instruction_output(k)
        if operation == casadi.OP_CONST:
            work[target[0]] = arithmetic.lift(read(function.instruction_constant(k)))
        elif operation == casadi.OP_INPUT:
            work[target[0]] = inputs[source[0]][source[1]]
        elif operation == casadi.OP_OUTPUT:
            outputs[target[0]][target[1]] = work[source[0]]
        elif operation in _OPERATIONS:
            result = _OPERATIONS[operation](*[work[i] for i in source])
            work[target[0]] = arithmetic.lift(result)
        else:
            raise UnknownOperation(f"{function.name()}: operation {operation_name(operation)}")
    return [_dense(function.sparsity_out(i), values, arithmetic) for i, values in enumerate(outputs)]


def operation_name(operation: int) -> str:
    """The name of a CasADi operation code."""
    names = (name for name in dir(casadi) if name.startswith("OP_") and getattr(casadi, name) == operation)
    return next(names, str(operation))


def _nonzeros(function: casadi.Function, index: int, argument: Any, arithmetic: Arithmetic) -> list[Any]:
    """The structural non-zeros of an argument, in CasADi's order."""
    sparsity = function.sparsity_in(index)
    rows, columns = sparsity.shape
    items = list(argument) if hasattr(argument, "__iter__") else [argument]
    if items and hasattr(items[0], "__iter__"):
        matrix = [list(row) for row in items]
        if len(matrix) != rows or any(len(row) != columns for row in matrix):
            raise ValueError(f"{function.name_in(index)} is {rows} x {columns}")
        items = [matrix[row][column] for column in range(columns) for row in range(rows)]
    if len(items) != rows * columns:
        raise ValueError(f"{function.name_in(index)} has {rows * columns} entries, {len(items)} given")
    places = zip(sparsity.row(), sparsity.get_col(), strict=True)
    return [arithmetic.lift(items[row + column * rows]) for row, column in places]


def _dense(sparsity: casadi.Sparsity, values: list[Any], arithmetic: Arithmetic) -> list[list[Any]]:
    rows, columns = sparsity.shape
    matrix = [[arithmetic.real(0) for _ in range(columns)] for _ in range(rows)]
    for row, column, value in zip(sparsity.row(), sparsity.get_col(), values, strict=True):
        matrix[row][column] = value
    return matrix


def _truth(x: Any) -> bool:
    return bool(x != 0)


def _sign(x: Any) -> int:
    return int(x > 0) - int(x < 0)


def _power(x: Any, exponent: Any) -> Any:
    if isinstance(x, float) and isinstance(exponent, float):
        try:
            return math.pow(x, exponent)
        except OverflowError:
            return math.inf
        except ValueError:
            return math.nan
    if isinstance(exponent, Ball):
        if not exponent.enclosure.is_integer():
            raise UnknownOperation(f"a power with the exponent {exponent!r}")
        exponent = int(exponent.enclosure.mid().fmpq())
    return x**exponent


def _if_else_zero(condition: Any, value: Any) -> Any:
    return value if _truth(condition) else 0


_OPERATIONS: dict[int, Callable[..., Any]] = {
    casadi.OP_ASSIGN: lambda x: x,
    casadi.OP_ADD: lambda x, y: x + y,
    casadi.OP_SUB: lambda x, y: x - y,
    casadi.OP_MUL: lambda x, y: x * y,
    casadi.OP_DIV: numbers.divide,
    casadi.OP_NEG: lambda x: -x,
    casadi.OP_SQ: lambda x: x * x,
    casadi.OP_TWICE: lambda x: x + x,
    casadi.OP_INV: lambda x: numbers.divide(1.0 if isinstance(x, float) else 1, x),
    casadi.OP_CONSTPOW: _power,
    casadi.OP_POW: _power,
    casadi.OP_SQRT: numbers.sqrt,
    casadi.OP_SIN: numbers.sin,
    casadi.OP_COS: numbers.cos,
    casadi.OP_ATAN2: numbers.arctan2,
    casadi.OP_HYPOT: numbers.hypot,
    casadi.OP_FABS: numbers.fabs,
    casadi.OP_FLOOR: numbers.floor,
    casadi.OP_FMIN: numbers.fmin,
    casadi.OP_FMAX: numbers.fmax,
    casadi.OP_SIGN: _sign,
    casadi.OP_LT: lambda x, y: bool(x < y),
    casadi.OP_LE: lambda x, y: bool(x <= y),
    casadi.OP_EQ: lambda x, y: bool(x == y),
    casadi.OP_NE: lambda x, y: bool(x != y),
    casadi.OP_NOT: lambda x: not _truth(x),
    casadi.OP_AND: lambda x, y: _truth(x) and _truth(y),
    casadi.OP_OR: lambda x, y: _truth(x) or _truth(y),
    casadi.OP_IF_ELSE_ZERO: _if_else_zero,
}
