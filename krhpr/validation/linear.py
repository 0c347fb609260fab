"""Linear algebra on exact numbers: matrices as lists of rows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from krhpr.validation.numbers import Ball, Exact

Matrix = list[list[Any]]


def matrix(values: Sequence[Any], columns: int) -> Matrix:
    """Rows of a flat, row-major sequence."""
    return [list(values[start : start + columns]) for start in range(0, len(values), columns)]


def times(a: Matrix, b: Matrix) -> Matrix:
    """The product of two matrices."""
    return [[dot(row, column) for column in zip(*b, strict=True)] for row in a]


def apply(a: Matrix, v: Sequence[Any]) -> list[Any]:
    """The product of a matrix and a vector."""
    return [dot(row, v) for row in a]


def transpose(a: Matrix) -> Matrix:
    """Rows as columns."""
    return [list(column) for column in zip(*a, strict=True)]


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """The scalar product."""
    return sum((x * y for x, y in zip(a, b, strict=True)), Exact(0))


def cross(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    """The vector product in space."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def plus(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    """The sum of two vectors."""
    return [x + y for x, y in zip(a, b, strict=True)]


def minus(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    """The difference of two vectors."""
    return [x - y for x, y in zip(a, b, strict=True)]


def scaled(factor: Any, a: Sequence[Any]) -> list[Any]:
    """A multiple of a vector."""
    return [factor * x for x in a]


def identity(n: int) -> Matrix:
    """The unit matrix."""
    return [[Exact(int(i == j)) for j in range(n)] for i in range(n)]


def determinant(a: Matrix) -> Any:
    """The determinant, by elimination."""
    rows = [list(row) for row in a]
    result: Any = Exact(1)
    for k in range(len(rows)):
        pivot = _pivot(rows, k)
        if pivot is None:
            return Exact(0)
        if pivot != k:
            rows[k], rows[pivot] = rows[pivot], rows[k]
            result = -result
        result = result * rows[k][k]
        _eliminate(rows, k, range(k + 1, len(rows)))
    return result


def solve(a: Matrix, b: Matrix) -> Matrix:
    """x with a x = b, by elimination; ZeroDivisionError for a singular matrix."""
    n = len(a)
    rows = [[*row, *right] for row, right in zip(a, b, strict=True)]
    for k in range(n):
        pivot = _pivot(rows, k)
        if pivot is None:
            raise ZeroDivisionError("the matrix is singular")
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [entry / rows[k][k] for entry in rows[k]]
        _eliminate(rows, k, (i for i in range(n) if i != k))
    return [row[n:] for row in rows]


def _eliminate(rows: Matrix, k: int, others: Any) -> None:
    for i in others:
        factor = rows[i][k] / rows[k][k]
        rows[i] = [x - factor * y for x, y in zip(rows[i], rows[k], strict=True)]


def _pivot(rows: Matrix, k: int) -> int | None:
    """The row with the largest entry in column k, from row k on."""
    best, size = None, 0.0
    for i in range(k, len(rows)):
        entry = rows[i][k]
        here = (
            abs(float(entry.enclosure.mid()))
            if isinstance(entry, Ball)
            else abs(float(Exact(entry).fraction))
        )
        if here > size:
            best, size = i, here
    return best
