"""Small vector algebra in the thesis' notation, for SymPy matrices and graphs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import sympy as sp

E = sp.Matrix([[0, -1], [1, 0]])
"""The planar quarter turn (2.6): E a is a turned by 90 degrees counter-clockwise."""

NO_LENGTH = sp.Rational(1, 10**150)
"""Beside the square of a length nothing, in any unit.  It keeps slopes finite where points meet, and makes
what has no size singular before squares of an inverse are more than a double holds."""


def dot(a: sp.Matrix, b: sp.Matrix) -> Any:
    """a^T b."""
    return sum((x * y for x, y in zip(a, b, strict=True)), sp.Integer(0))


def cross(a: sp.Matrix, b: sp.Matrix) -> sp.Matrix:
    """a x b in space."""
    return sp.Matrix(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]],
    )


def cross2(a: sp.Matrix, b: sp.Matrix) -> Any:
    """a_x b_y - a_y b_x = (E a) . b in the plane."""
    return a[0] * b[1] - a[1] * b[0]


def turned(cosine: Any, sine: Any, v: sp.Matrix) -> sp.Matrix:
    """R(phi) v in the plane."""
    return sp.Matrix([cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1]])


def dependence(vectors: Sequence[sp.Matrix]) -> list[Any]:
    """lambda_i = v_j x v_k of three vectors of the plane, for which sum lambda_i v_i = 0."""
    return [cross2(vectors[(i + 1) % 3], vectors[(i + 2) % 3]) for i in range(3)]


def concurrence(weights: Sequence[Any], directions: Sequence[sp.Matrix], points: Sequence[sp.Matrix]) -> Any:
    """det of three lines of the plane, rows (direction, moment): zero where they meet in a point or are
    parallel.  `weights` is the dependence of the directions.
    """
    moments = (cross2(point, v) for point, v in zip(points, directions, strict=True))
    return sum((w * moment for w, moment in zip(weights, moments, strict=True)), sp.Integer(0))


def lines_meet(normals: Sequence[sp.Matrix], right: Sequence[Any], weights: Sequence[Any]) -> sp.Matrix:
    """The point x of the plane with n_i . x = g_i for three consistent equations, where sum w_i n_i = 0.

    Each pair of lines gives it with the determinant w_i = n_j x n_k; weighted by w_i no pair of parallel
    lines divides by zero.
    """
    total = sp.zeros(2, 1)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        total += weights[i] * (right[k] * (E * normals[j]) - right[j] * (E * normals[k]))
    return total / sum(w**2 for w in weights)


def determinant3(m: sp.Matrix) -> Any:
    """The determinant of a 3 x 3 matrix as the triple product of its rows."""
    return dot(m.row(0).T, cross(m.row(1).T, m.row(2).T))


def solve3(m: sp.Matrix, right: sp.Matrix) -> tuple[sp.Matrix, Any]:
    """Cramer's rule: the solution of m x = right times det(m), and det(m).

    The columns of the adjugate are the cross products of the rows of m.
    """
    a, b, c = (m.row(i).T for i in range(3))
    bc, ca, ab = cross(b, c), cross(c, a), cross(a, b)
    return bc * right[0] + ca * right[1] + ab * right[2], dot(a, bc)


def solve_structured(
    m: sp.Matrix, right: sp.Matrix, named: Callable[[Any], Any] = lambda value: value
) -> sp.Matrix:
    """Solve m x = right for the small matrices of sub-legs, using their zeros.

    Rows with one entry are solved on their own; a block of two that is left is solved by Cramer's rule.  More
    than that (three coupled rows) falls back to `solve3`.  `named` gives a quotient that is used twice a
    name, without which SymPy divides each product.
    """
    n = m.rows
    solution: list[Any] = [None] * n
    rows, columns = list(range(n)), list(range(n))
    residual = list(right)
    progress = True
    while progress and rows:
        progress = False
        for row in rows:
            present = [column for column in columns if m[row, column] != 0]
            if len(present) == 1:
                column = present[0]
                solution[column] = residual[row] / m[row, column]
                rows.remove(row)
                columns.remove(column)
                for other in rows:
                    if m[other, column] != 0:
                        residual[other] = residual[other] - m[other, column] * solution[column]
                progress = True
                break
    if len(rows) == 2:
        (i, j), (p, q) = rows, columns
        determinant = m[i, p] * m[j, q] - m[i, q] * m[j, p]
        if residual[i] == 0:
            quotient = named(residual[j] / determinant)
            solution[p], solution[q] = -quotient * m[i, q], quotient * m[i, p]
        elif residual[j] == 0:
            quotient = named(residual[i] / determinant)
            solution[p], solution[q] = quotient * m[j, q], -quotient * m[j, p]
        else:
            solution[p] = (residual[i] * m[j, q] - residual[j] * m[i, q]) / determinant
            solution[q] = (residual[j] * m[i, p] - residual[i] * m[j, p]) / determinant
    elif len(rows) == 3:
        scaled, determinant = solve3(m.extract(rows, columns), sp.Matrix([residual[row] for row in rows]))
        for column, value in zip(columns, scaled, strict=True):
            solution[column] = value / determinant
    elif rows:
        raise ValueError(f"no rule to solve {len(rows)} coupled rows")
    return sp.Matrix(solution)


def solve_columns(a: sp.Matrix, b: sp.Matrix, named: Callable[[Any], Any] = lambda value: value) -> sp.Matrix:
    """a^-1 b, by `solve_structured` column by column."""
    if a == sp.eye(a.rows):
        return b
    columns = [solve_structured(a, b.col(j), named) for j in range(b.cols)]
    return sp.Matrix.hstack(*columns)
